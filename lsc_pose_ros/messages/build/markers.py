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

"""Builds the markers that draw skeletons in RViz."""

from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.messages.build.headers import build_duration, build_header
from lsc_pose_ros.messages.markers import MarkerShape
from lsc_pose_ros.messages.message_classes import MessageClasses
from lsc_pose_ros.messages.type_names import (
    COLOR_RGBA,
    COMPRESSED_IMAGE,
    MARKER,
    MARKER_ARRAY,
    MESH_FILE,
    POINT,
    POSE,
    QUATERNION,
    VECTOR3,
)

# The constants of visualization_msgs/Marker.
_TYPES = {'spheres': 7, 'lines': 5}  # SPHERE_LIST, LINE_LIST
_ACTIONS = {'add': 0, 'delete': 2}


def build_markers(
    classes: MessageClasses, stamp: int, frame_id: str, shapes: list[MarkerShape]
) -> Any:  # noqa: ANN401
    """Return `shapes` as a visualization_msgs/MarkerArray.

    Args:
        classes: the message classes.
        stamp: the depth image's, nanoseconds.
        frame_id: the camera's optical frame.
        shapes: the shapes to draw or delete.
    """
    header = build_header(classes, stamp, frame_id)
    markers = [_build_marker(classes, shape, header) for shape in shapes]
    return classes.find(MARKER_ARRAY)(markers=markers)


@cache
def _constant_fields(classes: MessageClasses) -> dict[str, Any]:
    """Return the fields that all markers have in common."""
    find = classes.find
    return {
        'pose': find(POSE)(
            position=find(POINT)(x=0.0, y=0.0, z=0.0),
            orientation=find(QUATERNION)(x=0.0, y=0.0, z=0.0, w=1.0),
        ),
        'color': find(COLOR_RGBA)(r=1.0, g=1.0, b=1.0, a=1.0),
        'frame_locked': False,
        'texture_resource': '',
        'texture': find(COMPRESSED_IMAGE)(
            header=build_header(classes, 0, ''), format='', data=classes.octets(b'')
        ),
        'uv_coordinates': [],
        'text': '',
        'mesh_resource': '',
        'mesh_file': find(MESH_FILE)(filename='', data=classes.octets(b'')),
        'mesh_use_embedded_materials': False,
    }


def _build_marker(classes: MessageClasses, shape: MarkerShape, header: Any) -> Any:  # noqa: ANN401
    point, color = classes.find(POINT), classes.find(COLOR_RGBA)
    # RViz uses only x of a line list's scale, but warns if y or z is 0.
    scale = classes.find(VECTOR3)(x=shape.size, y=shape.size, z=shape.size)
    return classes.find(MARKER)(
        header=header,
        ns=shape.namespace,
        id=shape.identifier,
        type=_TYPES[shape.kind],
        action=_ACTIONS[shape.action],
        scale=scale,
        lifetime=build_duration(classes, shape.lifetime_ns),
        points=_build_rows(lambda x, y, z: point(x=x, y=y, z=z), shape.points),
        colors=_build_rows(lambda r, g, b, a: color(r=r, g=g, b=b, a=a), shape.colours),
        **_constant_fields(classes),
    )


def _build_rows(build: Callable[..., Any], rows: NDArray[np.float32]) -> list[Any]:
    """Return one message for each row; equal rows, as of a joint with two bones, share one."""
    rows = np.ascontiguousarray(rows)
    keys = rows.view(f'V{rows.shape[1] * rows.itemsize}').ravel().tolist()
    unique = dict(zip(keys, rows.tolist(), strict=True))
    messages = {key: build(*row) for key, row in unique.items()}
    return [messages[key] for key in keys]
