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

from collections.abc import Sequence
from types import SimpleNamespace

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import (
    EQUIDISTANT,
    PLUMB_BOB,
    RATIONAL_POLYNOMIAL,
    Intrinsics,
    Lens,
)
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.camera_info import image_camera
from lsc_pose_ros.messages.rectification import ImageSource

K = [500.0, 0.0, 320.0, 0.0, 510.0, 240.0, 0.0, 0.0, 1.0]
P = [500.0, 0.0, 320.0, 0.0, 0.0, 510.0, 240.0, 0.0, 0.0, 0.0, 1.0, 0.0]
OTHER_P = [450.0, 0.0, 310.0, 0.0, 0.0, 455.0, 235.0, 0.0, 0.0, 0.0, 1.0, 0.0]


def info(
    k: list[float] = K,
    binning: tuple[int, int] = (0, 0),
    region: tuple[int, ...] = (0, 0, 0, 0),
    *,
    model: str = PLUMB_BOB,
    d: Sequence[float] = (),
    p: list[float] = P,
) -> SimpleNamespace:
    names = ('x_offset', 'y_offset', 'width', 'height')
    return SimpleNamespace(
        height=480,
        width=640,
        distortion_model=model,
        d=np.array(d, float),
        k=np.array(k),
        p=np.array(p),
        binning_x=binning[0],
        binning_y=binning[1],
        roi=SimpleNamespace(**dict(zip(names, region, strict=True))),
    )


def test_k_gives_the_intrinsics() -> None:
    assert image_camera(info())[:3] == (480, 640, Intrinsics(500.0, 510.0, 320.0, 240.0))


def test_binning_joins_pixels() -> None:
    found = image_camera(info(binning=(2, 3)))
    assert found[:3] == (160, 320, Intrinsics(250.0, 170.0, 160.0, 80.0))


def test_region_moves_the_principal_point() -> None:
    found = image_camera(info(region=(100, 40, 200, 120)))
    assert found[:3] == (120, 200, Intrinsics(500.0, 510.0, 220.0, 200.0))


def test_pixel_of_a_binned_region_shows_what_it_showed_on_the_sensor() -> None:
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


D5, D8 = (0.1, -0.2, 0.001, 0.002, 0.05), (0.1, -0.2, 0.001, 0.002, 0.05, 0.3, 0.2, 0.1)


@pytest.mark.parametrize(
    ('model', 'd', 'lens'),
    [
        (PLUMB_BOB, D5, Lens(PLUMB_BOB, D5)),
        (PLUMB_BOB, D5[:4], Lens(PLUMB_BOB, D5[:4])),
        (PLUMB_BOB, D8, Lens(RATIONAL_POLYNOMIAL, D8)),
        (RATIONAL_POLYNOMIAL, D8, Lens(RATIONAL_POLYNOMIAL, D8)),
        (RATIONAL_POLYNOMIAL, (*D8, *[0.0] * 6), Lens(RATIONAL_POLYNOMIAL, (*D8, *[0.0] * 4))),
        (EQUIDISTANT, D5[:4], Lens(EQUIDISTANT, D5[:4])),
        ('fisheye', D5[:4], Lens(EQUIDISTANT, D5[:4])),
        (EQUIDISTANT, (0.0,) * 4, Lens(EQUIDISTANT, (0.0,) * 4)),  # is no pinhole camera
        (EQUIDISTANT, (), None),
        (PLUMB_BOB, (), None),
        (PLUMB_BOB, (0.0,) * 5, None),
        (RATIONAL_POLYNOMIAL, (0.0,) * 8, None),
        ('', (0.0,) * 5, None),
        ('unheard_of', (), None),
    ],
)
def test_d_gives_the_lens(model: str, d: tuple[float, ...], lens: Lens | None) -> None:
    found = image_camera(info(model=model, d=d))
    assert found.camera == Intrinsics(500.0, 510.0, 320.0, 240.0, lens)
    assert not found.warning
    assert (lens.model if lens else 'no distortion') in found.choice


@pytest.mark.parametrize(
    ('model', 'd'), [('unheard_of', D5), ('', D5), (RATIONAL_POLYNOMIAL, (*D8, 0, 0, 0, 0, 0.1))]
)
def test_unknown_distortion_is_named_and_ignored(model: str, d: tuple[float, ...]) -> None:
    found = image_camera(info(model=model, d=d))
    assert found.camera.lens is None
    assert repr(model) in found.warning
    assert 'centimetres off' in found.warning


def test_distortion_that_is_not_finite_is_refused() -> None:
    with pytest.raises(InputError, match=r'distortion D .* not finite'):
        image_camera(info(d=(0.1, float('nan'))))


RAW = Intrinsics(500.0, 510.0, 320.0, 240.0)
RECTIFIED = Intrinsics(450.0, 455.0, 310.0, 235.0)


@pytest.mark.parametrize(
    ('topic', 'choice', 'd', 'camera'),
    [
        # A part of the name decides first.
        ('/depth/image_rect', 'auto', D5, RECTIFIED),
        ('/depth/image_rect_raw', 'auto', D5, RECTIFIED),
        ('/depth/image_rect/compressedDepth', 'auto', (), RECTIFIED),
        ('/depth/image_raw', 'auto', D5, RAW._replace(lens=Lens(PLUMB_BOB, D5))),
        ('/depth/image_raw', 'auto', (), RAW),
        ('/direct/image_raw', 'auto', (), RAW),  # 'rect' is no word of it
        ('/rectified_cameras/1/image_raw', 'auto', (), RAW),
        ('/raw_cameras/1/image_rect', 'auto', D5, RECTIFIED),
        ('/rect/depth/image', 'auto', D5, RECTIFIED),
        # Then the distortion: a rectified image has none.
        ('/depth/image', 'auto', D5, RAW._replace(lens=Lens(PLUMB_BOB, D5))),
        ('/depth/image', 'auto', (), RECTIFIED),
        # The user's choice comes before all.
        ('/depth/image_raw', 'true', D5, RECTIFIED),
        ('/depth/image_rect', 'false', D5, RAW._replace(lens=Lens(PLUMB_BOB, D5))),
    ],
)
def test_raw_images_use_k_and_rectified_ones_p(
    topic: str, choice: str, d: tuple[float, ...], camera: Intrinsics
) -> None:
    found = image_camera(info(p=OTHER_P, d=d), ImageSource(topic, choice))
    assert found.camera == camera
    assert found.choice.startswith('rectified' if camera == RECTIFIED else 'raw')


def test_rectified_images_of_a_camera_without_p_use_k_without_distortion() -> None:
    found = image_camera(info(p=[0.0] * 12, d=D5), ImageSource('/depth/image_rect'))
    assert found.camera == RAW


def test_binning_and_region_apply_to_p_too() -> None:
    source = ImageSource('/depth/image_rect')
    found = image_camera(info(p=OTHER_P, binning=(2, 2), region=(100, 40, 200, 120)), source)
    assert found[:3] == (60, 100, Intrinsics(225.0, 227.5, 105.0, 97.5))
    assert found.sensor == '640 x 480, of which 200 x 120, binned 2 x 2'
