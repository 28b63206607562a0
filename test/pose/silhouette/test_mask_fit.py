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

"""A sloppy mask is fitted to the depth; an exact one is not changed."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.body_window import body_window
from lsc_pose_ros.pose.silhouette.cuts import SceneImage
from lsc_pose_ros.pose.silhouette.mask_fit import (
    BEHIND,
    CONTINUES,
    FACES_UP,
    SLOPE,
    SPECK,
    STEP,
    MaskRegion,
    faces_up,
    fit_mask,
    labels_fitted_to_depth,
    smooth_outline,
)
from lsc_pose_ros.pose.silhouette.silhouette import cut_out
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.synthetic.sloppy_masks import MaskError, distort

SIDES = ((0, 1), (0, -1), (1, 0), (-1, 0))
FOCAL_LENGTH = 100.0
REACH = 4


def ragged_region(seed: int) -> MaskRegion:
    """Return a body before a wall, both with noise, in a mask that is grown, holed and shifted."""
    rng = np.random.default_rng(seed)
    depth = np.full((40, 50), 3.0) + rng.normal(0, 0.02, (40, 50))
    depth[30:] -= 0.08 * np.arange(10)[:, None]
    body = np.zeros(depth.shape, np.bool_)
    body[8:36, 18:30] = body[12:16, 10:40] = True
    depth[body] = 2.0 + rng.normal(0, 0.02, body.sum())
    depth[12:16, 10:40] -= 0.2
    depth[rng.random(depth.shape) < 0.05] = 0
    error = MaskError((-2, 3, 0, 4)[seed % 4], ((0, 0), (0, 0), (3, -2), (2, 3))[seed % 4])
    mask = distort(body, error) & (depth > 0)
    free = ~distort(body, error)
    free[:, :6] &= seed % 2 == 0
    return MaskRegion(depth.astype(np.float32), mask, free, REACH, FOCAL_LENGTH)


def one_surface(a: float, b: float, gap: int = 1) -> bool:
    return abs(a - b) <= gap * (STEP + SLOPE * min(a, b))


def faces_up_twin(depth: np.ndarray) -> np.ndarray:
    found = np.zeros(depth.shape, np.bool_)
    for i, j in np.argwhere(depth[3:-3] > 0):
        above, here, below = (float(depth[i + n, j]) for n in (0, 3, 6))
        rise = above - below
        if above > 0 and below > 0 and rise > FACES_UP * 6 * here / FOCAL_LENGTH:
            found[i + 3, j] = above - here > rise / 4 and here - below > rise / 4
    return found


def surfaces_twin(region: MaskRegion, candidates: np.ndarray) -> list[list[tuple[int, int]]]:
    """The connected parts of the candidates."""
    left = {(int(i), int(j)) for i, j in np.argwhere(candidates)}
    found = []
    while left:
        part = [min(left)]
        left.remove(part[0])
        for i, j in part:
            for down, right in SIDES:
                other = i + down, j + right
                if other in left and one_surface(region.depth[i, j], region.depth[other]):
                    left.remove(other)
                    part.append(other)
        found.append(part)
    return found


def line_twin(region: MaskRegion, i: int, j: int, side: tuple[int, int]) -> list[tuple[int, int]]:
    """The pixels from (i, j) on to one side, up to the end of the region."""
    line = []
    while 0 <= i + side[0] < region.depth.shape[0] and 0 <= j + side[1] < region.depth.shape[1]:
        i, j = i + side[0], j + side[1]
        line.append((i, j))
    return line


def extends_twin(region: MaskRegion, i: int, j: int, side: tuple[int, int]) -> bool:
    last, gap = float(region.depth[i, j]), 1
    line = line_twin(region, i, j, side)
    for pixel in line[: REACH // 2]:
        z = float(region.depth[pixel])
        if z > 0:
            if not region.free[pixel] or not one_surface(z, last, gap):
                return False
            last, gap = z, 0
        gap += 1
    return len(line) < REACH // 2 or gap <= REACH // 4


def continues_twin(region: MaskRegion, part: list[tuple[int, int]]) -> bool:
    touching, matches = [], 0
    for i, j in part:
        results = []
        for side in SIDES:
            line = line_twin(region, i, j, side)[: 2 * REACH - 1]
            outside = [p for p in line if region.free[p] and region.depth[p] > 0]
            if outside:
                first = outside[0]
                same = one_surface(region.depth[i, j], region.depth[first])
                results.append(same and extends_twin(region, *first, side))
                touching += results[-1:] if first == line[0] else []
        matches += any(results)
    if touching:
        return bool(np.mean(touching) >= CONTINUES)
    return matches >= CONTINUES * len(part)


def fit_mask_twin(region: MaskRegion) -> np.ndarray:
    depth, mask, upwards = region.depth, region.mask, faces_up_twin(region.depth)
    candidates = np.zeros(mask.shape, np.bool_)
    for i, j in np.argwhere(mask):
        around = np.s_[max(i - REACH, 0) : i + REACH + 1, max(j - REACH, 0) : j + REACH + 1]
        behind = depth[i, j] > (1 + BEHIND) * depth[around][mask[around]].min()
        candidates[i, j] = not mask[around].all() and (behind or upwards[i, j])
    foreign = np.zeros(mask.shape, np.bool_)
    for part in surfaces_twin(region, candidates):
        if len(part) < SPECK * mask.sum() or continues_twin(region, part):
            foreign[tuple(np.transpose(part))] = True
    fitted = mask & ~foreign
    allowed = (region.free | mask) & ~upwards & (depth > 0)
    for _ in range(REACH if foreign.sum() > SPECK * mask.sum() else 2 * REACH):
        before = fitted.copy()
        for i, j in np.argwhere(before):
            for side in SIDES:
                for other in line_twin(region, i, j, side)[:1]:
                    fitted[other] |= allowed[other] and one_surface(depth[i, j], depth[other])
    return fitted


@pytest.mark.parametrize('seed', range(8))
def test_fitted_mask_is_that_of_the_rules(seed: int) -> None:
    region = ragged_region(seed)
    np.testing.assert_array_equal(
        faces_up(region.depth, FOCAL_LENGTH), faces_up_twin(region.depth)
    )
    np.testing.assert_array_equal(fit_mask(region), fit_mask_twin(region))


@pytest.fixture(scope='module')
def people_in_rooms() -> list:
    settings = SyntheticSettings(
        frames=8, seed=3, clip_length=1, background=True, width=320, height=240, yaw=60.0
    )
    return list(synthetic_frames(settings))


def with_error(frame, error: MaskError):
    labels = np.where(distort(frame.labels == 1, error), 1, NO_BODY).astype(np.int32)
    return frame._replace(labels=labels)


def fitted_labels(frame) -> np.ndarray:
    window = cut_out(frame.depth, frame.labels, 1)
    assert window is not None
    image = SceneImage(frame.depth, frame.labels, 1)
    return labels_fitted_to_depth(window, image, float(frame.camera.fy))


def overlap(frame, labels: np.ndarray, expected: np.ndarray) -> float:
    """Return the intersection over the union of two masks, of pixels with a depth."""
    found, right = ((each == 1) & (frame.depth > 0) for each in (labels, expected))
    return float((found & right).sum() / (found | right).sum())


@pytest.mark.parametrize(
    'error',
    [MaskError(5), MaskError(12), MaskError(-3), MaskError(0, (4, 5)), MaskError(0, (0, -9))],
)
def test_sloppy_mask_is_found_and_fitted(error, people_in_rooms) -> None:
    before, after = [], []
    for frame in people_in_rooms:
        sloppy = with_error(frame, error)
        window = cut_out(sloppy.depth, sloppy.labels, 1)
        outline = smooth_outline(window, SceneImage(sloppy.depth, sloppy.labels, 1))
        assert outline >= Settings().sloppy_outline
        before.append(overlap(frame, sloppy.labels, frame.labels))
        after.append(overlap(frame, fitted_labels(sloppy), frame.labels))
    # At least half of what is wrong is corrected.
    assert 1 - np.mean(after) < 0.5 * (1 - np.mean(before))


def test_exact_mask_is_not_changed(people_in_rooms) -> None:
    for frame in people_in_rooms:
        window = cut_out(frame.depth, frame.labels, 1)
        outline = smooth_outline(window, SceneImage(frame.depth, frame.labels, 1))
        assert outline < Settings().sloppy_outline
        kept = body_window(frame.depth, frame.labels, frame.camera, 1, Settings(occluder_step=0))
        np.testing.assert_array_equal(kept.depth, window.depth)


def test_mask_is_not_changed_if_the_background_was_removed(people_in_rooms) -> None:
    frame = people_in_rooms[0]
    depth = np.where(frame.labels == 1, frame.depth, 0).astype(np.float32)
    sloppy = with_error(frame, MaskError(-4))
    window = cut_out(depth, sloppy.labels, 1)
    kept = body_window(depth, sloppy.labels, frame.camera, 1, Settings(occluder_step=0))
    np.testing.assert_array_equal(kept.depth, window.depth)


def test_zero_fits_no_mask(people_in_rooms) -> None:
    sloppy = with_error(people_in_rooms[0], MaskError(8))
    off = Settings(occluder_step=0, sloppy_outline=0)
    window = cut_out(sloppy.depth, sloppy.labels, 1)
    kept = body_window(sloppy.depth, sloppy.labels, sloppy.camera, 1, off)
    np.testing.assert_array_equal(kept.depth, window.depth)


def test_mask_is_kept_if_the_fit_finds_no_better_outline(people_in_rooms) -> None:
    """Without any step in depth there is nothing that the mask could be fitted to."""
    frame = people_in_rooms[0]
    depth = np.full_like(frame.depth, 3)
    window = cut_out(depth, frame.labels, 1)
    assert smooth_outline(window, SceneImage(depth, frame.labels, 1)) == 1
    kept = body_window(depth, frame.labels, frame.camera, 1, Settings(occluder_step=0))
    np.testing.assert_array_equal(kept.depth, window.depth)


def test_speck_does_not_grow(people_in_rooms) -> None:
    frame = people_in_rooms[0]
    row, column = np.argwhere(frame.labels == 1).mean(axis=0).astype(int)
    labels = np.full_like(frame.labels, NO_BODY)
    labels[row : row + 30, column : column + 5] = 1
    labels[frame.labels != 1] = NO_BODY
    window = cut_out(frame.depth, labels, 1)
    kept = body_window(frame.depth, labels, frame.camera, 1, Settings(occluder_step=0))
    np.testing.assert_array_equal(kept.depth, window.depth)


def test_other_body_is_not_taken(people_in_rooms) -> None:
    frame = people_in_rooms[0]
    half = int(np.argwhere(frame.labels == 1)[:, 0].mean())
    labels = frame.labels.copy()
    labels[half:][labels[half:] == 1] = 2
    fitted = fitted_labels(frame._replace(labels=labels))
    np.testing.assert_array_equal(fitted == 2, labels == 2)


def test_joints_of_a_sloppy_mask_are_nearer_with_the_fit(small_model, people_in_rooms) -> None:
    errors = []
    for outline in (0.0, Settings().sloppy_outline):
        settings = small_model.settings._replace(sloppy_outline=outline)
        estimator = Estimator(small_model._replace(settings=settings))
        for frame in people_in_rooms:
            sloppy = with_error(frame, MaskError(6))
            found = estimator.estimate(sloppy.depth, sloppy.labels, sloppy.camera)
            expected = frame.ground_truth.positions[0][found.joints]
            errors.append(np.linalg.norm(found.positions[0] - expected, axis=1).mean())
    without, fitted = np.reshape(errors, (2, -1)).mean(axis=1)
    assert fitted < 0.7 * without
