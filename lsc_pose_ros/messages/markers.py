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

"""The shapes that draw skeletons in RViz, live and in recordings."""

from collections.abc import Collection
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.settings.table import DrawingSettings

NAMESPACE_JOINTS = 'joints'
NAMESPACE_BONES = 'bones'
JOINT_DIAMETER = 0.06
BONE_WIDTH = 0.02

# The opacity of a joint with confidence 0: it must not look like a missing joint.
_LEAST_ALPHA = 0.25

# The palette of Okabe and Ito, which colour-blind people can distinguish, and grey.
_COLOURS = np.array(
    [
        (0.00, 0.45, 0.70),
        (0.90, 0.62, 0.00),
        (0.00, 0.62, 0.45),
        (0.80, 0.47, 0.65),
        (0.34, 0.71, 0.91),
        (0.84, 0.37, 0.00),
        (0.94, 0.89, 0.26),
        (0.60, 0.60, 0.60),
    ],
    dtype=np.float32,
)


class MarkerShape(NamedTuple):
    """The values of one visualization_msgs/Marker.

    Attributes:
        namespace: identifies the marker together with `identifier`.
        identifier: the body's number.
        kind: 'spheres' at the points, or 'lines' between pairs of successive points.
        action: 'add' draws or replaces the marker, 'delete' removes it.
        points: metres in the camera's optical frame, shape (n, 3).
        colours: red, green, blue, alpha of each point, 0 to 1, shape (n, 4).
        size: the spheres' diameter or the lines' width in metres.
        lifetime_ns: how long it is shown if nothing replaces it, in nanoseconds.
    """

    namespace: str
    identifier: int
    kind: Literal['spheres', 'lines']
    action: Literal['add', 'delete']
    points: NDArray[np.float32]
    colours: NDArray[np.float32]
    size: float
    lifetime_ns: int


class MarkerUpdater:
    """Computes the shapes of successive frames, which delete the bodies that have left."""

    def __init__(self, edges: NDArray[np.int32]) -> None:
        """Start with nothing drawn.

        Args:
            edges: the bones, pairs of indices into the joints, shape (E, 2).
        """
        self._edges = edges
        self._drawn: frozenset[int] = frozenset()

    def update(self, skeletons: Skeletons, settings: DrawingSettings) -> list[MarkerShape]:
        """Return the shapes that replace those of the last frame by those of `skeletons`."""
        bodies = frozenset(skeletons.bodies.tolist())
        shapes = skeleton_markers(
            skeletons,
            self._edges,
            minimum_confidence=settings.minimum_confidence,
            gone=self._drawn - bodies,
        )
        self._drawn = bodies
        return [shape._replace(lifetime_ns=settings.marker_lifetime_ns) for shape in shapes]


def skeleton_markers(
    skeletons: Skeletons,
    edges: NDArray[np.int32],
    *,
    minimum_confidence: float = 0.0,
    gone: Collection[int] = frozenset(),
) -> list[MarkerShape]:
    """Return the shapes that draw `skeletons`: the joints and the bones of each body.

    Args:
        skeletons: B bodies of J joints.
        edges: pairs of indices into the joints, shape (E, 2).
        minimum_confidence: joints with less confidence are left out.
        gone: numbers of the bodies to delete.
    """
    shapes = [shape for body in sorted(gone) for shape in _deleted(int(body))]
    for row, body in enumerate(skeletons.bodies):
        positions, confidence = skeletons.positions[row], skeletons.confidence[row]
        seen = np.isfinite(positions).all(axis=1) & (confidence >= minimum_confidence)
        colours = _colours(int(body), confidence)
        both = edges[seen[edges].all(axis=1)].reshape(-1)
        shapes.append(_added(int(body), 'spheres', positions[seen], colours[seen]))
        shapes.append(_added(int(body), 'lines', positions[both], colours[both]))
    return shapes


def _colours(body: int, confidence: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return a colour for each joint, shape (J, 4); less confident joints are fainter."""
    colours = np.empty((len(confidence), 4), np.float32)
    colours[:, :3] = _COLOURS[body % len(_COLOURS)]
    colours[:, 3] = _LEAST_ALPHA + (1 - _LEAST_ALPHA) * np.clip(np.nan_to_num(confidence), 0, 1)
    return colours


def _added(
    body: int,
    kind: Literal['spheres', 'lines'],
    points: NDArray[np.float32],
    colours: NDArray[np.float32],
) -> MarkerShape:
    spheres = kind == 'spheres'
    return MarkerShape(
        namespace=NAMESPACE_JOINTS if spheres else NAMESPACE_BONES,
        identifier=body,
        kind=kind,
        # RViz rejects a list without points, and an old shape must not stay.
        action='add' if len(points) else 'delete',
        points=points,
        colours=colours,
        size=JOINT_DIAMETER if spheres else BONE_WIDTH,
        lifetime_ns=DrawingSettings().marker_lifetime_ns,
    )


def _deleted(body: int) -> list[MarkerShape]:
    nothing = np.zeros((0, 3), np.float32), np.zeros((0, 4), np.float32)
    return [_added(body, 'spheres', *nothing), _added(body, 'lines', *nothing)]
