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

"""Builds the point cloud that carries skeletons."""

from functools import cache
from typing import Any

import numpy as np

from lsc_pose_ros.data_types.skeletons import Skeletons, pack
from lsc_pose_ros.messages.build.headers import build_header
from lsc_pose_ros.messages.message_classes import MessageClasses
from lsc_pose_ros.messages.parse import POINT_FIELD_TYPES
from lsc_pose_ros.messages.type_names import POINT_CLOUD, POINT_FIELD

_DATATYPES = {name: number for number, name in POINT_FIELD_TYPES.items()}


def build_skeletons(
    classes: MessageClasses, stamp: int, frame_id: str, skeletons: Skeletons
) -> Any:  # noqa: ANN401
    """Return an organised sensor_msgs/PointCloud2: height = bodies, width = joints.

    Args:
        classes: the message classes.
        stamp: the depth image's, nanoseconds.
        frame_id: the camera's optical frame.
        skeletons: B bodies of J joints.
    """
    points = pack(skeletons)
    bodies, joints = points.shape
    return classes.find(POINT_CLOUD)(
        header=build_header(classes, stamp, frame_id),
        height=bodies,
        width=joints,
        fields=_build_fields(classes, points.dtype),
        is_bigendian=False,
        point_step=points.itemsize,
        row_step=points.itemsize * joints,
        data=classes.octets(points.tobytes()),
        is_dense=bool(np.isfinite(skeletons.positions).all()),
    )


@cache
def _build_fields(classes: MessageClasses, dtype: np.dtype[np.void]) -> list[Any]:
    point_field = classes.find(POINT_FIELD)
    fields: Any = dtype.fields
    return [
        point_field(name=name, offset=offset, datatype=_DATATYPES[kind.str[1:]], count=1)
        for name, (kind, offset) in fields.items()
    ]
