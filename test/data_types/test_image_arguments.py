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

"""The checks of depth image, labels and intrinsics."""

from collections import namedtuple

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import EQUIDISTANT, PLUMB_BOB, Intrinsics, Lens
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.image_arguments import (
    MOST_PIXELS,
    ImageArguments,
    check_images,
    thin_out,
)
from lsc_pose_ros.errors import InputError

DEPTH = np.arange(20, dtype=np.float32).reshape(4, 5)
LABELS = np.full((4, 5), NO_BODY, np.int32)
CAMERA = Intrinsics(60.0, 61.0, 2.0, 1.5)


def test_right_arguments_are_returned_without_a_copy():
    checked = check_images(DEPTH, LABELS, CAMERA)
    assert checked.depth is DEPTH
    assert checked.labels is LABELS
    assert checked.camera == CAMERA


def read_only(image):
    image = image.copy()
    image.flags.writeable = False
    return image


@pytest.mark.parametrize(
    'convert',
    [
        lambda image: image.astype(image.dtype.newbyteorder('>')),
        lambda image: image.astype(np.dtype(f'{image.dtype.kind}8')),
        np.asfortranarray,
        lambda image: image[:, ::-1].copy()[:, ::-1],
        lambda image: np.repeat(image, 2, axis=1)[:, ::2],
        read_only,
    ],
    ids=['big endian', '64 bits', 'column by column', 'mirrored view', 'view', 'read-only'],
)
def test_other_layouts_are_converted(convert):
    checked = check_images(convert(DEPTH), convert(LABELS), CAMERA)
    for given, found in ((DEPTH, checked.depth), (LABELS, checked.labels)):
        np.testing.assert_array_equal(found, given)
        assert found.dtype == given.dtype
        assert found.flags.c_contiguous
        assert found.flags.writeable


@pytest.mark.parametrize('kind', [np.uint16, np.int16, np.int32, np.int64, np.uint8])
def test_integer_depth_is_refused_with_the_converter(kind):
    with pytest.raises(InputError, match=r'depth .*metres_from_millimetres'):
        check_images(DEPTH.astype(kind), LABELS, CAMERA)


@pytest.mark.parametrize('kind', [np.bool_, np.uint8, np.uint16, np.float32])
def test_mask_in_place_of_labels_is_refused_with_the_converter(kind):
    with pytest.raises(InputError, match=r'labels .*labels_from_mask'):
        check_images(DEPTH, np.ones((4, 5), kind), CAMERA)


def test_images_must_be_arrays_of_two_dimensions():
    with pytest.raises(InputError, match='depth is of type list'):
        check_images(DEPTH.tolist(), LABELS, CAMERA)
    with pytest.raises(InputError, match='depth is of type MaskedArray'):
        check_images(np.ma.array(DEPTH), LABELS, CAMERA)
    with pytest.raises(InputError, match=r'depth has the shape \(4, 5, 1\)'):
        check_images(DEPTH[..., None], LABELS, CAMERA)
    with pytest.raises(InputError, match=r'labels has the shape \(20,\)'):
        check_images(DEPTH, LABELS.ravel(), CAMERA)


def test_images_must_have_the_same_shape():
    with pytest.raises(InputError, match=r'labels has the shape \(4, 4\), but depth has \(4, 5\)'):
        check_images(DEPTH, LABELS[:, 1:], CAMERA)


@pytest.mark.parametrize(
    'camera',
    [
        np.diag([60.0, 61.0, 1.0]),
        (60.0, 61.0, 2.0, 1.5),
        namedtuple('Info', 'fx fy cx cy')(60.0, 61.0, 2.0, 1.5),  # noqa: PYI024
        None,
    ],
    ids=['matrix', 'tuple', 'other named tuple', 'None'],
)
def test_camera_must_be_intrinsics(camera):
    with pytest.raises(InputError, match=r'camera is of type .*Intrinsics\.from_matrix\(K\)'):
        check_images(DEPTH, LABELS, camera)


@pytest.mark.parametrize(
    'camera',
    [
        Intrinsics(0.0, 0.0, 0.0, 0.0),
        CAMERA._replace(fy=-61.0),
        CAMERA._replace(cx=np.nan),
        CAMERA._replace(fx=np.array([60.0, 61.0])),
        CAMERA._replace(fx='60 px'),
    ],
)
def test_intrinsics_must_be_those_of_a_camera(camera):
    with pytest.raises(InputError, match='focal lengths'):
        check_images(DEPTH, LABELS, camera)


def test_numbers_of_the_camera_become_floats():
    camera = Intrinsics(60, np.float32(61), np.int64(2), 1.5)
    assert [type(value) for value in check_images(DEPTH, LABELS, camera).camera[:4]] == [float] * 4


@pytest.mark.parametrize('coefficients', [[0.1, -0.2], np.array([0.1, -0.2])])
def test_coefficients_of_the_lens_become_a_tuple(coefficients):
    camera = CAMERA._replace(lens=Lens(PLUMB_BOB, coefficients))
    assert check_images(DEPTH, LABELS, camera).camera.lens == Lens(PLUMB_BOB, (0.1, -0.2))


@pytest.mark.parametrize(
    'lens',
    [
        (0.1, -0.2, 0.0, 0.0, 0.0),
        Lens('omnidirectional', (0.1,)),
        Lens(EQUIDISTANT, (0.1,) * 5),
        Lens(PLUMB_BOB, (np.nan,)),
    ],
)
def test_other_lens_is_refused(lens):
    with pytest.raises(InputError, match=r'lens|coefficients'):
        check_images(DEPTH, LABELS, CAMERA._replace(lens=lens))


@pytest.mark.parametrize('shape', [(1200, 1600), (1, MOST_PIXELS), (4, 5), (0, 0)])
def test_images_of_usual_size_are_not_thinned_out(shape):
    images = ImageArguments(np.zeros(shape, np.float32), np.zeros(shape, np.int32), CAMERA)
    assert thin_out(images) is images


@pytest.mark.parametrize('shape', [(3072, 4096), (1, 3 * MOST_PIXELS), (5 * MOST_PIXELS, 1)])
def test_pixels_of_a_large_image_that_are_left_are_where_they_were(shape):
    lens = Lens(PLUMB_BOB, (0.1, 0.0, 0.0, 0.0, 0.0))
    camera = Intrinsics(900.0, 910.0, 700.5, 1001.0, lens)
    rows, columns = np.mgrid[: shape[0], : shape[1]]
    depth = (1 + rows + columns / 8192).astype(np.float32)
    thin = thin_out(ImageArguments(depth, (rows ^ columns).astype(np.int32), camera))
    assert MOST_PIXELS / 5 < thin.depth.size == thin.labels.size <= MOST_PIXELS
    assert thin.depth.flags.carray
    assert thin.labels.flags.carray
    assert thin.camera.lens == lens
    height, width = thin.depth.shape
    for row, column in ((0, 0), (height - 1, width - 1), (height // 2, width // 3)):
        # The pixel on the same ray of the large image has the same depth.
        x = (column - thin.camera.cx) / thin.camera.fx
        y = (row - thin.camera.cy) / thin.camera.fy
        at = round(camera.cy + camera.fy * y), round(camera.cx + camera.fx * x)
        assert thin.depth[row, column] == depth[at]
        assert thin.labels[row, column] == at[0] ^ at[1]
