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

"""The file of the parametric body model: shape space, skin and rig.

It is MakeHuman's body, packed by `bake_body`: numpy arrays in a zip archive, no executable code.
"""

import os
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import archive
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.resources.package_files import resource

VERSION = 1

BODY = archive('a body', 'skin_bones.npy')


class BodyModel(NamedTuple):
    """The body model of all people: P = V + B + 20 points that depend on the shape, skin and rig.

    The first V points are the skin's vertices, the next B are the heads of the bones (the points
    that they rotate about), and the last 20 are the joints. All are given in the rest pose:
    upright, arms half raised; x to the person's left, y up, z forward.

    Attributes:
        mean: metres, shape (P, 3), float32.
        components: displacements of the points, in steps: K principal components of all shapes,
            then the decrease and the increase of each of M measures; shape (K + 2 M, P, 3), int16.
        steps: the size of one step of each component, metres, shape (K + 2 M,), float64.
        corners: weights of the principal components at the corners of the shape space: sex, age,
            muscle, weight, height, proportions; shape (2, 4, 3, 3, 3, 3, K), float32.
        measures: names of the measures, shape (M,).
        triangles: numbers of vertices, counter-clockwise seen from outside, shape (T, 3), uint16.
        skin_bones: the bones that each vertex follows, the strongest first, shape (V, 8), uint8.
        skin_weights: the skinning weights in units of 1/65535, shape (V, 8), uint16.
        bones: names of the bones, parents before children, shape (B,).
        parents: the number of each bone's parent, -1 for the root, shape (B,), int16.
        joint_bones: the bone that carries each joint, shape (20,), uint8.
        provenance: source and licence of the data.
    """

    mean: NDArray[np.float32]
    components: NDArray[np.int16]
    steps: NDArray[np.float64]
    corners: NDArray[np.float32]
    measures: NDArray[np.str_]
    triangles: NDArray[np.uint16]
    skin_bones: NDArray[np.uint8]
    skin_weights: NDArray[np.uint16]
    bones: NDArray[np.str_]
    parents: NDArray[np.int16]
    joint_bones: NDArray[np.uint8]
    provenance: str


_ARRAYS: dict[str, tuple[str, int]] = {
    'mean': ('float32', 2),
    'components': ('int16', 3),
    'steps': ('float64', 1),
    'corners': ('float32', 7),
    'triangles': ('uint16', 2),
    'skin_bones': ('uint8', 2),
    'skin_weights': ('uint16', 2),
    'parents': ('int16', 1),
    'joint_bones': ('uint8', 1),
}


def save_body(path: str | os.PathLike[str], body: BodyModel) -> None:
    """Write `body` to `path`.

    Raises:
        InputError: the file cannot be written, or another kind of file is there.
    """
    arrays: dict[str, Any] = {**body._asdict(), 'version': VERSION}
    # The axes are stored one after the other, because that compresses better.
    arrays['components'] = np.ascontiguousarray(np.moveaxis(body.components, 2, 1))
    write_output(Path(path), BODY, lambda file: np.savez_compressed(file, **arrays))


def load_body(path: str | os.PathLike[str] | None = None) -> BodyModel:
    """Return the body model in the file `path`, or the package's own if `path` is None.

    Raises:
        InputError: the file does not exist or is not a body model.
    """
    return _load(Path(path) if path is not None else resource('bodies', 'body.npz'))


@cache
def _load(path: Path) -> BodyModel:
    try:
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in (*BodyModel._fields, 'version')}
    except FileNotFoundError as error:
        msg = f'there is no body file {path}'
        raise InputError(msg) from error
    except Exception as error:  # a damaged file can raise almost anything in numpy
        raise _wrong(path, str(error) or type(error).__name__) from error
    if arrays.pop('version') != VERSION:
        raise _wrong(path, 'its version is not supported')
    for name, (kind, dimensions) in _ARRAYS.items():
        array = arrays[name]
        if array.dtype != kind or array.ndim != dimensions:
            raise _wrong(path, f'its array {name} is {array.dtype} with {array.ndim} dimensions')
    arrays['components'] = np.ascontiguousarray(np.moveaxis(arrays['components'], 1, 2))
    arrays['provenance'] = str(arrays['provenance'])
    body = BodyModel(**arrays)
    if not _fits(body):
        raise _wrong(path, 'the shapes of its arrays do not fit')
    return body


def _fits(body: BodyModel) -> bool:
    vertices, bones, components = len(body.skin_bones), len(body.bones), len(body.steps)
    points = vertices + bones + len(JOINT_NAMES)
    return (
        body.mean.shape == (points, 3)
        and body.components.shape == (components, points, 3)
        and body.corners.shape == (2, 4, 3, 3, 3, 3, components - 2 * len(body.measures))
        and body.skin_bones.shape == body.skin_weights.shape == (vertices, 8)
        and body.triangles.shape[1] == 3
        and bool((body.triangles < vertices).all())
        and bool((body.skin_bones < bones).all())
        and body.parents.shape == (bones,)
        and bool((body.parents < np.arange(bones)).all())
        and bool((body.parents[1:] >= 0).all())
        and body.joint_bones.shape == (len(JOINT_NAMES),)
        and bool((body.joint_bones < bones).all())
    )


def _wrong(path: Path, why: str) -> InputError:
    return InputError(f'{path} is not a usable body file ({why}); install the package again')
