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

"""A camera that restarts in another mode, and its camera infos."""

import numpy as np
import pytest
from fault_stream import FaultStream, camera_info, image, mask_of
from sensor_msgs.msg import CameraInfo, Image

from lsc_pose_ros.data_types.camera import Intrinsics


def test_camera_returns_with_another_resolution(stream: FaultStream) -> None:
    frame = stream.frame
    doubled = Intrinsics(*(2 * each for each in frame.camera[:4]))
    large = {
        'depth': frame.depth.repeat(2, 0).repeat(2, 1),
        'labels': frame.labels.repeat(2, 0).repeat(2, 1),
        'camera': doubled,
    }
    restart_camera(stream)
    first = stream.ask(stream.good(**large))
    assert np.isfinite(first.positions).any()
    restart_camera(stream)
    stream.recovers()


def restart_camera(stream: FaultStream) -> None:
    """Replace the publishers, as a driver that ends and starts again."""
    for publisher in (stream.depth, stream.info):
        stream.node.destroy_publisher(publisher)
    stream.depth = stream.node.create_publisher(Image, 'depth/image', 10)
    stream.info = stream.node.create_publisher(CameraInfo, 'depth/camera_info', 10)
    stream.connect()


def test_camera_returns_with_another_encoding(stream: FaultStream) -> None:
    frame = stream.frame
    metres = stream.ask(stream.good())
    millimetres = np.rint(1000 * frame.depth).astype('<u2')
    header = stream.next_header()
    stream.publish(
        image(header, '16UC1', millimetres),
        image(header, '16UC1', mask_of(frame.labels)),
        camera_info(header, frame.camera, frame.depth.shape),
    )
    found = stream.wait_for_answer(header)
    np.testing.assert_allclose(found.positions, metres.positions, atol=1e-3)


def test_camera_returns_with_other_intrinsics(stream: FaultStream) -> None:
    fx, fy, cx, cy = stream.frame.camera[:4]
    before = stream.ask(stream.good()).positions
    other = stream.ask(stream.good(camera=Intrinsics(fx, fy, cx + 20, cy))).positions
    shift = 20 / fx * np.nanmedian(before[..., 2])
    assert np.nanmedian(before[..., 0] - other[..., 0]) == pytest.approx(shift, rel=0.2)


def test_camera_infos_that_differ_each_frame_are_not_logged_each_frame(
    stream: FaultStream,
) -> None:
    stream.reactivate()
    frame = stream.frame
    for number in range(40):
        header = stream.next_header()
        info = camera_info(header, frame.camera, frame.depth.shape)
        info.k[0] += 0.01 * number
        info.p = [1.0, *([0.0] * 11)] if number % 2 else [0.0] * 12
        # One that is not known, and one that is: the log says which is used.
        info.distortion_model = f'model {number}' if number % 2 else 'plumb_bob'
        info.d = [0.001 * number, 0.0, 0.0, 0.0, 0.0]
        stream.publish(
            image(header, '32FC1', frame.depth.astype('<f4')),
            image(header, '16UC1', mask_of(frame.labels)),
            info,
        )
        stream.wait_for_answer(header)
    lines = [line for line in stream.program.output.splitlines() if 'camera_info' in line]
    assert 1 <= len(lines) < 20, lines
    assert any('the distortion plumb_bob' in line for line in lines)


ABSURD_MATRICES = {
    'zero': [0.0] * 9,
    'NaN': [np.nan] * 9,
    'infinite': [np.inf] * 9,
    'negative': [-140.0, 0.0, 80.0, 0.0, -140.0, 60.0, 0.0, 0.0, 1.0],
    'huge': [1e20, 0.0, 80.0, 0.0, 1e20, 60.0, 0.0, 0.0, 1.0],
    'tiny': [1e-17, 0.0, 80.0, 0.0, 1e-17, 60.0, 0.0, 0.0, 1.0],
    'far centre': [140.0, 0.0, 1e20, 0.0, 140.0, -1e300, 0.0, 0.0, 1.0],
}


def test_absurd_matrices_are_refused(stream: FaultStream) -> None:
    frame = stream.frame
    for matrix in ABSURD_MATRICES.values():
        header = stream.next_header()
        info = camera_info(header, frame.camera, frame.depth.shape)
        info.k = matrix
        stream.publish(
            image(header, '32FC1', frame.depth.astype('<f4')),
            image(header, '16UC1', mask_of(frame.labels)),
            info,
        )
        stream.taken()
    stream.recovers()
    assert len(stream.answered) == 1
    assert stream.program.prints('/depth/camera_info: the matrix K')


def test_camera_info_that_never_comes_is_told_and_when_it_comes_all_is_well(
    stream: FaultStream,
) -> None:
    stream.reactivate()
    frame = stream.frame
    headers = []
    for _ in range(3):
        header = stream.next_header()
        headers.append(header)
        stream.publish(
            image(header, '32FC1', frame.depth.astype('<f4')),
            image(header, '16UC1', mask_of(frame.labels)),
            None,
        )
    stream.taken()
    assert stream.program.prints('no camera info received on /depth/camera_info (1 publisher)')
    assert not stream.answered
    stream.info.publish(camera_info(headers[-1], frame.camera, frame.depth.shape))
    stream.wait_for_answer(headers[-1])
