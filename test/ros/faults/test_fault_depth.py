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

"""Depth images of numbers that are no depths."""

import numpy as np
import pytest
from fault_stream import FaultStream, camera_info, image, mask_of

LARGEST = float(np.finfo(np.float32).max)

ABSURD = [0.0, np.nan, np.inf, -np.inf, -1.0, LARGEST, -LARGEST, 1e-40, 1e19, 0.05, 100.0]


@pytest.mark.parametrize('value', ABSURD)
def test_body_of_one_absurd_depth_has_no_joints(stream: FaultStream, value: float) -> None:
    found = stream.ask(stream.good(depth=np.full_like(stream.frame.depth, value)))
    assert found.bodies.tolist() == [1]
    assert np.isnan(found.positions).all()


@pytest.mark.parametrize('value', ABSURD)
def test_absurd_depths_among_others_do_no_harm(stream: FaultStream, value: float) -> None:
    depth = stream.frame.depth.copy()
    depth[np.random.default_rng(3).random(depth.shape) < 0.2] = value
    stream.ask(stream.good(depth=depth))


@pytest.mark.parametrize('seed', range(5))
def test_depth_of_random_bytes_does_no_harm(stream: FaultStream, seed: int) -> None:
    random = np.random.default_rng(seed)
    depth = np.frombuffer(random.bytes(4 * stream.frame.depth.size), '<f4')
    stream.ask(stream.good(depth=depth.reshape(stream.frame.depth.shape)))


@pytest.mark.parametrize('seed', range(3))
def test_noise_within_the_range_does_no_harm(stream: FaultStream, seed: int) -> None:
    shape = stream.frame.depth.shape
    depth = np.random.default_rng(seed).uniform(0.1, 20, shape).astype(np.float32)
    everything = np.ones(shape, np.int32)
    for labels in (stream.frame.labels, everything):
        stream.ask(stream.good(depth=depth, labels=labels))


def test_floats_in_the_wrong_order_of_bytes_do_no_harm(stream: FaultStream) -> None:
    frame = stream.frame
    header = stream.next_header()
    depth = image(header, '32FC1', frame.depth.astype('<f4'), is_bigendian=1)
    mask = image(header, '16UC1', mask_of(frame.labels))
    stream.publish(depth, mask, camera_info(header, frame.camera, frame.depth.shape))
    stream.wait_for_answer(header)
