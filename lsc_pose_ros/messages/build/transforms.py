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

"""Builds the message of TF."""

from typing import Any

from lsc_pose_ros.messages.build.headers import build_header
from lsc_pose_ros.messages.message_classes import MessageClasses
from lsc_pose_ros.messages.transforms import Transform
from lsc_pose_ros.messages.type_names import (
    QUATERNION,
    TF_MESSAGE,
    TRANSFORM,
    TRANSFORM_STAMPED,
    VECTOR3,
)


def build_transforms(classes: MessageClasses, stamp: int, transforms: list[Transform]) -> Any:  # noqa: ANN401
    """Return `transforms` as a tf2_msgs/TFMessage.

    Args:
        classes: the message classes.
        stamp: the depth image's, nanoseconds.
        transforms: the coordinate frames.
    """
    message = classes.find(TF_MESSAGE)
    return message(transforms=[_build_transform(classes, stamp, each) for each in transforms])


def _build_transform(classes: MessageClasses, stamp: int, transform: Transform) -> Any:  # noqa: ANN401
    find = classes.find
    return find(TRANSFORM_STAMPED)(
        header=build_header(classes, stamp, transform.parent),
        child_frame_id=transform.child,
        transform=find(TRANSFORM)(
            translation=find(VECTOR3)(**dict(zip('xyz', transform.translation, strict=True))),
            rotation=find(QUATERNION)(**dict(zip('xyzw', transform.rotation, strict=True))),
        ),
    )
