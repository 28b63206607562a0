"""Recordings of ROS 2: rosbag2 in MCAP or SQLite, read and written without ROS."""

from lsc_pose_ros.bags.frames import FrameReader, open_recording
from lsc_pose_ros.bags.storage.reader import RecordingReader, read_messages
from lsc_pose_ros.bags.storage.serialized_messages import SerializedMessage, TopicSummary
from lsc_pose_ros.bags.storage.writer import RecordingWriter
from lsc_pose_ros.bags.topics import DEFAULT_TOPICS, Topics

__all__ = [
    'DEFAULT_TOPICS',
    'FrameReader',
    'RecordingReader',
    'RecordingWriter',
    'SerializedMessage',
    'TopicSummary',
    'Topics',
    'open_recording',
    'read_messages',
]
