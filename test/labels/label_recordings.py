# Copyright 2026 lsc_pose_ros contributors
# SPDX-License-Identifier: Apache-2.0
#
# Licensed under the Apache License, Version 2.0 (the "License");
# you may not use this file except in compliance with the License.
# You may obtain a copy of the License at
#
#     http://www.apache.org/licenses/LICENSE-2.0
#
# Unless required by applicable law or agreed to in writing, software
# distributed under the License is distributed on an "AS IS" BASIS,
# WITHOUT WARRANTIES OR CONDITIONS OF ANY KIND, either express or implied.
# See the License for the specific language governing permissions and
# limitations under the License.

"""Recordings for the tests of labels: depth images, and joints in messages of other programs."""

from types import SimpleNamespace

import numpy as np
from ros_messages import header, serialise

from lsc_pose_ros.bags import RecordingWriter
from lsc_pose_ros.bags.serialization.type_store import message_class
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES

CAMERA = Intrinsics(60.0, 60.0, 31.5, 23.5)
CAMERA_FRAME = 'camera_depth_optical'
START = 1_700_000_000_000_000_000
FRAME_TIME = 100_000_000
FRAMES = 5

TF_MESSAGE = 'tf2_msgs/msg/TFMessage'
MARKER_ARRAY = 'visualization_msgs/msg/MarkerArray'

# A person who faces the camera, 2 m before it: metres in the optical frame.
_SIDE = {
    'shoulder': (0.18, -0.4), 'elbow': (0.3, -0.2), 'wrist': (0.35, 0.0), 'hand': (0.36, 0.05),
    'hip': (0.1, 0.05), 'knee': (0.12, 0.3), 'ankle': (0.12, 0.5), 'foot': (0.13, 0.55),
}  # fmt: skip
_MIDDLE = {'head': -0.65, 'neck': -0.45, 'torso': -0.2, 'pelvis': 0.05}


def pose(moment):
    """The true joints, shape (20, 3), `moment` seconds after the start: the body moves evenly."""
    joints = np.zeros((len(JOINT_NAMES), 3))
    for number, name in enumerate(JOINT_NAMES):
        if name in _MIDDLE:
            joints[number] = 0, _MIDDLE[name], 2.0
        else:
            x, y = _SIDE[name[2:]]
            joints[number] = (x if name[0] == 'l' else -x), y, 2.0
    return joints + moment * np.array([0.1, 0.02, 0.05])


def stamps():
    return [START + number * FRAME_TIME for number in range(FRAMES)]


def seconds(stamp):
    return (stamp - START) * 1e-9


def frame(stamp, body=1):
    depth = np.full((48, 64), 4.0, np.float32)
    labels = np.full((48, 64), NO_BODY, np.int32)
    depth[2:45, 14:52] = 1.9
    labels[2:45, 14:52] = body
    return Frame(stamp, CAMERA_FRAME, depth, labels, CAMERA, None)


def write_recording(path, messages=(), body=1):
    """Write the frames, and (topic, type, stamp, data) of other programs."""
    with RecordingWriter(path) as writer:
        for stamp in stamps():
            writer.write_frame(frame(stamp, body))
        for topic, kind, stamp, data in messages:
            writer.write(topic, kind, stamp, data)
    return path


def vector(kind, values):
    return message_class(f'geometry_msgs/msg/{kind}')(
        **dict(zip('xyzw', map(float, values), strict=False))
    )


def transform(stamp, parent, child, translation, rotation=(0, 0, 0, 1)):
    return message_class('geometry_msgs/msg/TransformStamped')(
        header=header(stamp, parent),
        child_frame_id=child,
        transform=message_class('geometry_msgs/msg/Transform')(
            translation=vector('Vector3', translation), rotation=vector('Quaternion', rotation)
        ),
    )


def tf(stamp, transforms, topic='/tf'):
    message = message_class(TF_MESSAGE)(transforms=transforms)
    return topic, TF_MESSAGE, stamp, serialise(message, TF_MESSAGE)


def sphere(stamp, identifier, position, *, frame_id=CAMERA_FRAME, namespace='', action=0):
    time = message_class('builtin_interfaces/msg/Time')(sec=0, nanosec=0)
    duration = SimpleNamespace(sec=0, nanosec=0)
    colour = message_class('std_msgs/msg/ColorRGBA')(r=1.0, g=0.0, b=0.0, a=1.0)
    file = message_class('visualization_msgs/msg/MeshFile')(filename='', data=np.zeros(0, 'u1'))
    texture = message_class('sensor_msgs/msg/CompressedImage')(
        header=SimpleNamespace(stamp=time, frame_id=''), format='', data=np.zeros(0, 'u1')
    )
    return message_class('visualization_msgs/msg/Marker')(
        header=header(stamp, frame_id),
        ns=namespace,
        id=identifier,
        type=2,
        action=action,
        pose=message_class('geometry_msgs/msg/Pose')(
            position=vector('Point', position), orientation=vector('Quaternion', (0, 0, 0, 1))
        ),
        scale=vector('Vector3', (0.05, 0.05, 0.05)),
        color=colour,
        lifetime=duration,
        frame_locked=False,
        points=[],
        colors=[],
        texture_resource='',
        texture=texture,
        uv_coordinates=[],
        text='',
        mesh_resource='',
        mesh_file=file,
        mesh_use_embedded_materials=False,
    )


def markers(stamp, spheres, topic='/body_tracking_data'):
    message = message_class(MARKER_ARRAY)(markers=spheres)
    return topic, MARKER_ARRAY, stamp, serialise(message, MARKER_ARRAY)
