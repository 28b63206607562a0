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

"""The camera that a CameraInfo describes."""

from types import SimpleNamespace

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.camera_info import image_camera

K = [500.0, 0.0, 320.0, 0.0, 510.0, 240.0, 0.0, 0.0, 1.0]


def info(
    k: list[float] = K, binning: tuple[int, int] = (0, 0), region: tuple[int, ...] = (0, 0, 0, 0)
) -> SimpleNamespace:
    names = ('x_offset', 'y_offset', 'width', 'height')
    return SimpleNamespace(
        height=480,
        width=640,
        k=np.array(k),
        binning_x=binning[0],
        binning_y=binning[1],
        roi=SimpleNamespace(**dict(zip(names, region, strict=True))),
    )


def test_k_gives_the_intrinsics() -> None:
    assert image_camera(info()) == (480, 640, Intrinsics(500.0, 510.0, 320.0, 240.0))


def test_binning_joins_pixels() -> None:
    assert image_camera(info(binning=(2, 3))) == (160, 320, Intrinsics(250.0, 170.0, 160.0, 80.0))


def test_region_moves_the_principal_point() -> None:
    found = image_camera(info(region=(100, 40, 200, 120)))
    assert found == (120, 200, Intrinsics(500.0, 510.0, 220.0, 200.0))


def test_a_pixel_of_a_binned_region_shows_what_it_showed_on_the_sensor() -> None:
    whole = image_camera(info()).camera
    part = image_camera(info(binning=(2, 2), region=(100, 40, 200, 120))).camera
    column, row = 31.0, 17.0
    seen = ((column - part.cx) / part.fx, (row - part.cy) / part.fy)
    assert seen == pytest.approx(
        ((100 + 2 * column - whole.cx) / whole.fx, (40 + 2 * row - whole.cy) / whole.fy)
    )


@pytest.mark.parametrize(
    ('k', 'why'),
    [
        ([0.0] * 9, 'is all zero'),
        ([-500.0, *K[1:]], 'no positive focal lengths'),
        ([*K[:4], 0.0, *K[5:]], 'no positive focal lengths'),
        ([float('nan'), *K[1:]], 'no positive focal lengths'),
        ([*K[:2], float('inf'), *K[3:]], 'no positive focal lengths'),
    ],
)
def test_k_of_no_camera_is_refused(k: list[float], why: str) -> None:
    with pytest.raises(InputError, match=why):
        image_camera(info(k))
