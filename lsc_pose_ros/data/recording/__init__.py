"""Recordings of ROS 2: rosbag2 in MCAP or SQLite, read and written without ROS."""

from lsc_pose_ros.data.recording.frames import FrameReader, open_frames
from lsc_pose_ros.data.recording.raw import RawMessage, TopicSummary
from lsc_pose_ros.data.recording.reader import RawReader, read_messages
from lsc_pose_ros.data.recording.topics import DEFAULT_TOPICS, Topics
from lsc_pose_ros.data.recording.writer import RecordingWriter

__all__ = [
    'DEFAULT_TOPICS',
    'FrameReader',
    'RawMessage',
    'RawReader',
    'RecordingWriter',
    'TopicSummary',
    'Topics',
    'open_frames',
    'read_messages',
]
