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

"""Serialized messages for the tests, made by rosbags alone; each field can be wrong."""

from types import SimpleNamespace

import numpy as np

from lsc_pose_ros.bags.serialization.type_store import message_class, typestore

IMAGE = 'sensor_msgs/msg/Image'
COMPRESSED_IMAGE = 'sensor_msgs/msg/CompressedImage'
CAMERA_INFO = 'sensor_msgs/msg/CameraInfo'
POINT_CLOUD = 'sensor_msgs/msg/PointCloud2'


def header(stamp, frame_id='camera'):
    seconds, rest = divmod(stamp, 10**9)
    time = message_class('builtin_interfaces/msg/Time')(sec=seconds, nanosec=rest)
    return message_class('std_msgs/msg/Header')(stamp=time, frame_id=frame_id)


def serialise(message, type_name, *, little_endian=True):
    return bytes(typestore().serialize_cdr(message, type_name, little_endian=little_endian))


def image(stamp, pixels, encoding, **changes):
    pixels = np.ascontiguousarray(pixels)
    fields = {
        'header': header(stamp),
        'height': pixels.shape[0],
        'width': pixels.shape[1],
        'encoding': encoding,
        'is_bigendian': 0,
        'step': pixels.strides[0],
        'data': pixels.view(np.uint8).reshape(-1),
        **changes,
    }
    return serialise(message_class(IMAGE)(**fields), IMAGE)


def compressed_image(stamp, text, data):
    message = message_class(COMPRESSED_IMAGE)(
        header=header(stamp), format=text, data=np.frombuffer(data, np.uint8)
    )
    return serialise(message, COMPRESSED_IMAGE)


def camera_info(stamp, *, shape=(48, 64), k=(60, 0, 31.5, 0, 61, 23.5, 0, 0, 1), **changes):
    roi = SimpleNamespace(x_offset=0, y_offset=0, height=0, width=0, do_rectify=False)
    fields = {
        'header': header(stamp),
        'height': shape[0],
        'width': shape[1],
        'distortion_model': '',
        'd': np.zeros(0),
        'k': np.array(k, np.float64),
        'r': np.zeros(9),
        'p': np.zeros(12),
        'binning_x': 0,
        'binning_y': 0,
        'roi': roi,
        **changes,
    }
    return serialise(message_class(CAMERA_INFO)(**fields), CAMERA_INFO)
