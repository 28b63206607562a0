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

"""Frames drawn at random."""

import numpy as np
import pytest
from lsc_pose_experiments.drawn_frames import draw_frames, merge, restore


def stamps(drawn, frames):
    """Return which of `frames` were drawn, by the true joints."""
    known = {frame.ground_truth.positions.tobytes(): frame.stamp for frame in frames}
    return [known[each.ground_truth.positions.tobytes()] for each in drawn]


def test_a_smaller_draw_is_the_beginning_of_a_larger_one(people):
    all_of_them = draw_frames(people, 1000, (3, 1))
    assert sorted(stamps(all_of_them.frames, people)) == [frame.stamp for frame in people]
    assert stamps(all_of_them.frames, people) != [frame.stamp for frame in people]
    for wanted in (0, 1, 7, 239, 240):
        some = draw_frames(people, wanted, (3, 1))
        assert stamps(some.frames, people) == stamps(all_of_them.frames, people)[:wanted]
        assert some.labelled == 240
    other = draw_frames(people, 7, (4, 1))
    assert stamps(other.frames, people) != stamps(all_of_them.frames, people)[:7]


def test_draws_are_merged_by_their_turns(people):
    first, second = (draw_frames(people[k : k + 100], 30, (0, k)) for k in (0, 100))
    merged = merge([first, second])
    turns = [each.turn for each in merged]
    assert turns == sorted(turns)
    assert len(merged) == 60


def test_what_is_drawn_comes_back_as_it_was(people, simple_frames):
    for frames in (people[:4], simple_frames[:2]):
        draw = draw_frames(frames, 2, (0,))
        chosen = {frame.stamp: frame for frame in frames}
        for stamp, found in zip(stamps(draw.frames, frames), restore(draw.frames), strict=True):
            frame = chosen[stamp]
            np.testing.assert_allclose(found.depth, frame.depth, atol=1e-6)
            np.testing.assert_array_equal(found.labels, frame.labels)
            assert found.camera == frame.camera
            np.testing.assert_array_equal(
                found.ground_truth.positions, frame.ground_truth.positions
            )


def test_frames_without_labels_are_passed_over(people):
    ground_truth = people[1].ground_truth
    nobody = ground_truth._replace(positions=np.full_like(ground_truth.positions, np.nan))
    frames = [
        people[0]._replace(ground_truth=None),
        people[1]._replace(ground_truth=nobody),
        people[2],
    ]
    draw = draw_frames(frames, 3, (0,))
    assert draw.labelled == 1
    assert stamps(draw.frames, people) == [people[2].stamp]


def test_every_frame_is_as_likely_as_another(people):
    frames = people[:20]
    counts = dict.fromkeys((frame.stamp for frame in frames), 0)
    for seed in range(200):
        for stamp in stamps(draw_frames(frames, 5, (seed,)).frames, frames):
            counts[stamp] += 1
    assert list(counts.values()) == pytest.approx([50] * 20, abs=25)
