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

"""Random samples of frames."""

import numpy as np
import pytest
from lsc_pose_experiments.sampled_frames import decode_frames, merge, sample_frames


def stamps(drawn, frames):
    """Return the indices of the sampled `frames`, found by their ground truth."""
    known = {frame.ground_truth.positions.tobytes(): frame.stamp for frame in frames}
    return [known[each.ground_truth.positions.tobytes()] for each in drawn]


def test_smaller_sample_is_the_beginning_of_a_larger_one(people):
    all_of_them = sample_frames(people, 1000, (3, 1))
    assert sorted(stamps(all_of_them.frames, people)) == [frame.stamp for frame in people]
    assert stamps(all_of_them.frames, people) != [frame.stamp for frame in people]
    for wanted in (0, 1, 7, 239, 240):
        some = sample_frames(people, wanted, (3, 1))
        assert stamps(some.frames, people) == stamps(all_of_them.frames, people)[:wanted]
        assert some.labelled == 240
    other = sample_frames(people, 7, (4, 1))
    assert stamps(other.frames, people) != stamps(all_of_them.frames, people)[:7]


def test_samples_are_merged_by_rank(people):
    first, second = (sample_frames(people[k : k + 100], 30, (0, k)) for k in (0, 100))
    merged = merge([first, second])
    turns = [each.rank for each in merged]
    assert turns == sorted(turns)
    assert len(merged) == 60


def test_sampled_frames_are_lossless(people, simple_frames):
    for frames in (people[:4], simple_frames[:2]):
        draw = sample_frames(frames, 2, (0,))
        chosen = {frame.stamp: frame for frame in frames}
        for stamp, found in zip(
            stamps(draw.frames, frames), decode_frames(draw.frames), strict=True
        ):
            frame = chosen[stamp]
            np.testing.assert_allclose(found.depth, frame.depth, atol=1e-6)
            np.testing.assert_array_equal(found.labels, frame.labels)
            assert found.camera == frame.camera
            np.testing.assert_array_equal(
                found.ground_truth.positions, frame.ground_truth.positions
            )


def test_frames_without_labels_are_skipped(people):
    ground_truth = people[1].ground_truth
    nobody = ground_truth._replace(positions=np.full_like(ground_truth.positions, np.nan))
    frames = [
        people[0]._replace(ground_truth=None),
        people[1]._replace(ground_truth=nobody),
        people[2],
    ]
    draw = sample_frames(frames, 3, (0,))
    assert draw.labelled == 1
    assert stamps(draw.frames, people) == [people[2].stamp]


def test_all_frames_are_equally_likely(people):
    frames = people[:20]
    counts = dict.fromkeys((frame.stamp for frame in frames), 0)
    for seed in range(200):
        for stamp in stamps(sample_frames(frames, 5, (seed,)).frames, frames):
            counts[stamp] += 1
    assert list(counts.values()) == pytest.approx([50] * 20, abs=25)
