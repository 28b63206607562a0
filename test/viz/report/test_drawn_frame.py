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

"""The panel of one frame: caption, ground truth, silhouette, colours."""

import numpy as np
import pytest

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.stages import describe_body
from lsc_pose_ros.viz.drawing.colours import LEFT, MIDDLE, RIGHT, bone_colour, side_colour
from lsc_pose_ros.viz.report.drawn_frame import (
    DrawnFrame,
    caption,
    frame_entries,
    frame_panel,
    only_joints,
    silhouette_pixels,
)


def skeletons(*rows: list[float], joints: tuple[int, ...] = (0, 1, 2)) -> Skeletons:
    """Bodies numbered from 1, whose joints are at (x, 0, 2) metres."""
    positions = np.zeros((len(rows), len(joints), 3), np.float32)
    positions[..., 2] = 2
    positions[..., 0] = rows
    positions[np.isnan(positions[..., 0])] = np.nan
    return Skeletons(
        np.arange(1, len(rows) + 1, dtype=np.uint16),
        np.array(joints, np.uint16),
        positions,
        np.ones(positions.shape[:2], np.float32),
    )


def drawn(ground_truth: Skeletons | None, estimate: Skeletons | None) -> DrawnFrame:
    nothing = np.zeros((4, 4), np.float32)
    labels = np.full((4, 4), NO_BODY, np.int32)
    frame = Frame(0, '', nothing, labels, Intrinsics(9, 9, 2, 2), ground_truth)
    return DrawnFrame('frame 3', frame, estimate)


NAN = float('nan')


@pytest.mark.parametrize(
    ('ground_truth', 'estimate', 'said'),
    [
        ([[0.0, 0.0, 0.0]], [[0.01, 0.02, 0.06]], 'frame 3: 3.0 cm'),
        ([[0.0, NAN, 0.0]], [[0.01, 0.50, 0.03]], 'frame 3: 2.0 cm'),
        ([[0.0, 0.0, 0.0]], [[0.02, NAN, 0.04]], 'frame 3: 3.0 cm, 1 missing'),
        ([[0.0, 0.0, 0.0]], [[NAN, NAN, NAN]], 'frame 3: no estimate'),
        ([[0.0] * 3, [0.0] * 3], [[0.02] * 3], 'frame 3: 2.0 cm, 3 missing'),
        ([[NAN, NAN, NAN]], [[0.0, 0.0, 0.0]], 'frame 3'),
    ],
)
def test_caption_has_the_mean_error(
    ground_truth: list[list[float]], estimate: list[list[float]], said: str
) -> None:
    assert caption(drawn(skeletons(*ground_truth), skeletons(*estimate))) == said


def test_caption_says_what_is_compared() -> None:
    known, found = skeletons([0.0, 0.0, 0.0]), skeletons([0.01, 0.02, 0.06])
    compared = drawn(known, found)._replace(
        label='frame 3: 1 joint too deep', compared='from the model'
    )
    assert caption(compared) == 'frame 3: 1 joint too deep; 3.0 cm from the model'
    far = skeletons([100.0, 100.0, 100.0])
    assert caption(drawn(known, far)) == 'frame 3: 100 m'


def test_marked_joints_have_a_ring(people: list[Frame]) -> None:
    truth = people[0].ground_truth
    assert truth is not None
    plain = DrawnFrame('frame 0', people[0])
    marked = plain._replace(marked=truth.positions[0, :1])
    assert 'joint with a problem' in [str(entry.get_label()) for entry in frame_entries([marked])]
    assert len(frame_entries([plain])) == len(frame_entries([marked])) - 1
    figure = frame_panel(marked)
    pixel = project(truth.positions[0, :1], people[0].camera)
    rings = [
        dots for dots in figure.axes[0].collections if not len(np.asarray(dots.get_facecolor()))
    ]
    assert len(rings) == 1
    np.testing.assert_allclose(np.asarray(rings[0].get_offsets()), pixel)


def test_caption_without_ground_truth_or_estimate_is_the_label() -> None:
    known = skeletons([0.0, 0.0, 0.0])
    assert caption(drawn(known, None)) == 'frame 3'
    assert caption(drawn(None, known)) == 'frame 3'


def test_only_joints_follows_the_estimates_order_and_leaves_gaps() -> None:
    ground_truth = skeletons([0.1, 0.2, 0.3], joints=(0, 4, 12))
    kept = only_joints(ground_truth, np.array([12, 1, 4], np.uint16))
    np.testing.assert_allclose(kept.positions[0, :, 0], [0.3, np.nan, 0.2], rtol=1e-6)


@pytest.mark.parametrize('fill_holes', [0, 5])
def test_silhouette_pixels_are_those_of_the_method(fill_holes: int, people: list[Frame]) -> None:
    settings = Settings(points=50, fill_holes=fill_holes)
    depth = people[0].depth.copy()
    depth[::4, ::4] = 0
    frame = people[0]._replace(depth=depth)
    shape = describe_body(frame.depth, frame.labels, frame.camera, 1, settings)
    assert shape is not None
    wanted = shape.silhouette.points
    pixels = silhouette_pixels(frame, settings)
    np.testing.assert_allclose(pixels, project(wanted, frame.camera))
    rows, columns = pixels.round().astype(int)[:, ::-1].T
    of_the_body = frame.labels[rows, columns] == 1
    assert (of_the_body | (frame.depth[rows, columns] == 0)).all()
    assert of_the_body.all() == (fill_holes == 0)  # the mask knows nothing of what is filled


def test_sides_have_their_own_colours() -> None:
    assert [side_colour(name) for name in ('l_hand', 'r_hand', 'neck')] == [LEFT, RIGHT, MIDDLE]
    assert bone_colour('neck', 'l_shoulder') == LEFT
    assert bone_colour('r_hip', 'r_knee') == RIGHT
    assert bone_colour('l_hip', 'r_hip') == MIDDLE
    assert bone_colour('neck', 'head') == MIDDLE
