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

"""What hides a body is marked, each rule against its definition and in a scene of its own."""

import itertools

import numpy as np
import pytest
from ragged_body import ragged_body

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.body_window import body_window
from lsc_pose_ros.pose.silhouette.cuts import (
    MARGIN_BACKGROUND,
    MARGIN_MEASURED,
    MEASURED_FRACTION,
    MIXED_PIXELS,
    SHADOW_DIVISOR,
    SLOPE_PIXELS,
    SceneImage,
    mark_cuts,
)
from lsc_pose_ros.pose.silhouette.preprocessing import Window
from lsc_pose_ros.pose.silhouette.silhouette import cut_out, find_edges

BODY = 3
STEP = 0.05
HEIGHT, WIDTH = 60, 80
CAMERA = Intrinsics(70.0, 70.0, 39.5, 29.5)


def scene(background: float = 4.0) -> tuple[np.ndarray, np.ndarray]:
    """Return the depth and the labels of a body 2 m away, in rows 20 to 39, columns 30 to 49."""
    depth = np.full((HEIGHT, WIDTH), background, np.float32)
    labels = np.full(depth.shape, NO_BODY, np.int32)
    depth[20:40, 30:50], labels[20:40, 30:50] = 2.0, BODY
    return depth, labels


def marked(depth: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """Return which pixels of the image are marked, shape (H, W)."""
    window = body_window(depth, labels, CAMERA, BODY, Settings())
    assert window is not None
    found = np.zeros((HEIGHT + 2, WIDTH + 2), np.bool_)
    rows, columns = window.depth.shape
    found[window.row + 1 :, window.column + 1 :][:rows, :columns] = np.isnan(window.depth)
    return found[1:-1, 1:-1]


def outline(rows: slice, columns: slice) -> np.ndarray:
    """Return a picture of some pixels, shape (H, W)."""
    picture = np.zeros((HEIGHT, WIDTH), np.bool_)
    picture[rows, columns] = True
    return picture


def mark_cuts_twin(window: Window, depth: np.ndarray, labels: np.ndarray) -> np.ndarray:
    """The rules of the module, pixel by pixel; without margins."""
    padded = np.pad(window.depth, 1, constant_values=np.inf)
    result, measured = window.depth.copy(), background_twin(window, depth, labels)
    for i, j in np.argwhere(window.depth == np.inf):
        near = padded[i : i + 3, j : j + 3]
        around = near[np.isfinite(near)]
        if not len(around) or depth[window.row + i, window.column + j] > 1.05 * around.max():
            continue
        sides = [(0, 1), (0, -1), (1, 0), (-1, 0)]
        straight = [s for s in sides if np.isfinite(padded[i + 1 - s[0], j + 1 - s[1]])]
        corners = list(itertools.product((1, -1), (1, -1)))
        for side in straight or corners:
            body = []
            for n in range(1, 2 + MIXED_PIXELS):
                k, m = i - n * side[0], j - n * side[1]
                if not (0 <= k < window.depth.shape[0] and 0 <= m < window.depth.shape[1]):
                    break
                if not np.isfinite(window.depth[k, m]):
                    break
                body.append(float(window.depth[k, m]))
            start = window.row + i, window.column + j
            if body and line_is_hidden(depth, labels, start, side, max(body), measured=measured):
                result[i, j] = np.nan
    return result


def background_twin(window: Window, depth: np.ndarray, labels: np.ndarray) -> bool:
    reach = depth.shape[1] // 8
    rows = slice(max(0, window.row - reach), window.row + window.depth.shape[0] + reach, 4)
    columns = slice(
        max(0, window.column - reach), window.column + window.depth.shape[1] + reach, 4
    )
    beside = depth[rows, columns][labels[rows, columns] < 0]
    return beside.size > 0 and (beside > 0).mean() >= MEASURED_FRACTION


def line_is_hidden(
    depth: np.ndarray,
    labels: np.ndarray,
    start: tuple[int, int],
    side: tuple[int, int],
    body: float,
    *,
    measured: bool,
) -> bool:
    """Follow one line away from the body."""
    reach = 1 + depth.shape[1] // SHADOW_DIVISOR if side[0] == 0 else 1 + MIXED_PIXELS
    line = []
    for n in range(reach + SLOPE_PIXELS):
        row, column = start[0] + n * side[0], start[1] + n * side[1]
        if not (0 <= row < depth.shape[0] and 0 <= column < depth.shape[1]):
            break
        line.append((float(depth[row, column]), labels[row, column] == BODY))
    mixed = 0
    for n, (z, own) in enumerate(line[:reach]):
        if z > 0:
            if own and n > 0:
                return False
            if z < (1 - STEP) * body:
                after = [(m, line[n + m][0]) for m in range(1, 5) if n + m < len(line)]
                slopes = [(z - other) / m for m, other in after if other > 0]
                slope = max([0.0, *slopes[-1:]])
                return z < (1 - STEP) * body - (n + 1 + MIXED_PIXELS) * slope
            mixed += 1
            if mixed > MIXED_PIXELS or z > (1 + STEP) * body:
                return False
        elif not measured:
            return False
    return measured and len(line) >= reach and all(own and not z > 0 for z, own in line[:reach])


@pytest.mark.parametrize('seed', range(6))
@pytest.mark.parametrize('background_removed', [False, True])
def test_marks_are_those_of_the_rules(seed, background_removed) -> None:
    depth, labels = ragged_body(seed)
    rng = np.random.default_rng(seed)
    depth[:, 20:] *= (
        rng.choice([0.8, 1.0, 1.2], (depth.shape[0] // 4, 10)).repeat(4, 0).repeat(4, 1)
    )
    labels[:, ::7] = NO_BODY
    if background_removed:
        depth[labels != BODY] = 0
    window = cut_out(depth, labels, BODY)
    assert window is not None
    found = mark_cuts(window, SceneImage(depth, labels, BODY), STEP)
    expected = mark_cuts_twin(window, depth, labels)
    np.testing.assert_array_equal(found.depth, expected)
    assert (np.isnan(expected).sum() > np.isnan(window.depth).sum()) == (not background_removed)


@pytest.mark.parametrize('background', [4.0, 2.2, 0.0])
def test_background_behind_the_body_or_without_depth_hides_nothing(background: float) -> None:
    assert not marked(*scene(background)).any()


def test_counter_before_the_body_is_marked_along_the_contact() -> None:
    depth, labels = scene()
    depth[35:], labels[35:] = 1.5, NO_BODY
    np.testing.assert_array_equal(marked(depth, labels), outline(slice(35, 36), slice(29, 51)))


def test_contact_with_a_nearer_surface_is_no_edge() -> None:
    depth, labels = scene()
    depth[35:], labels[35:] = 1.5, NO_BODY
    for step, count in ((STEP, 2), (0.0, 20)):
        window = body_window(depth, labels, CAMERA, BODY, Settings(occluder_step=step))
        assert window is not None
        edges = find_edges(window.depth, 0.04)
        lowest = edges[edges[:, 0] == 15]
        assert len(lowest) == count  # with a step, only the two ends beside the background


def test_other_person_in_front_hides_and_one_behind_does_not() -> None:
    for distance, hidden in ((1.2, True), (3.0, False)):
        depth, labels = scene()
        depth[10:50, 45:60], labels[10:50, 45:60] = distance, BODY + 1
        assert marked(depth, labels).any() == hidden


def test_shadow_between_the_body_and_a_nearer_surface_is_marked() -> None:
    depth, labels = scene()
    depth[:, 50:60] = 1.5
    depth[:, 50:54] = 0  # 4 of 80 pixels
    assert marked(depth, labels)[20:40, 50].all()


def test_shadow_of_the_body_on_the_background_is_background() -> None:
    depth, labels = scene()
    depth[:, 50:54] = 0
    assert not marked(depth, labels).any()


def test_wide_area_without_depth_is_background() -> None:
    depth, labels = scene()
    depth[:, 50:60] = 0
    depth[:, 60:] = 1.5
    assert not marked(depth, labels).any()


def test_floor_that_slopes_to_the_feet_does_not_hide_them() -> None:
    depth, labels = scene()
    depth[40:] = np.linspace(1.95, 1.0, 20, dtype=np.float32)[:, None]
    assert not marked(depth, labels).any()


def test_part_of_the_mask_without_depth_is_unknown() -> None:
    depth, labels = scene()
    depth[30:40, 30:50] = 0
    assert marked(depth, labels)[30, 30:50].all()
    depth, labels = scene(0.0)
    depth[30:40, 30:50] = 0
    assert not marked(depth, labels).any()


@pytest.mark.parametrize('turns', range(4))
def test_invalid_margin_is_outside_of_the_image(turns: int) -> None:
    depth, labels = (np.rot90(each, turns) for each in scene())
    for margin in (0, 1):
        invalid = np.rot90(depth, -turns).copy()
        mask = np.rot90(labels, -turns).copy()
        invalid[38 + margin :] = 0
        mask[38 + margin :] = NO_BODY
        both = (np.ascontiguousarray(np.rot90(each, turns)) for each in (invalid, mask))
        window = body_window(*both, CAMERA, BODY, Settings())
        assert window is not None
        found = np.rot90(window.depth, -turns)
        assert np.isnan(found[-1]).all()
        assert not np.isnan(found[:-1]).any()


def test_rows_above_the_head_without_depth_are_a_distant_background() -> None:
    depth, labels = scene()
    depth[:20] = 0
    depth[20:25][labels[20:25] != BODY] = 0
    assert not marked(depth, labels).any()
    fraction = (depth[25][labels[25] != BODY] > 0).mean()
    assert fraction > MARGIN_MEASURED
    assert (labels[25] != BODY).mean() > MARGIN_BACKGROUND


def test_zero_marks_nothing() -> None:
    depth, labels = scene()
    depth[35:], labels[35:] = 1.5, NO_BODY
    window = cut_out(depth, labels, BODY)
    assert window is not None
    assert mark_cuts(window, SceneImage(depth, labels, BODY), 0.0) is window


def test_body_without_depth_has_no_window() -> None:
    depth, labels = scene()
    assert body_window(np.zeros_like(depth), labels, CAMERA, BODY, Settings()) is None
