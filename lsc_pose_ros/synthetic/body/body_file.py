"""The file of the parametric body: its shape space, its skin and its rig.

MakeHuman's body as `bake` packs it: numpy arrays in a zip archive, nothing that can run.
"""

import os
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.package_files import resource

VERSION = 1


class Body(NamedTuple):
    """Everybody's body: P = V + B + 20 points that follow the shape, and what moves them.

    The first V points are the skin's vertices, the next B the heads of the bones, about which
    they turn, the last 20 the joints of the vocabulary. All are at rest: upright, arms held half
    way down; x to the person's left, y up, z forward.

    Attributes:
        mean: metres, shape (P, 3), float32.
        components: how the shape moves the points, in steps: K principal components of all
            shapes, then less and more of each of M measures; shape (K + 2 M, P, 3), int16.
        steps: metres that one step of each component is, shape (K + 2 M,), float64.
        corners: the principal components' weights at the corners of the space of shapes: sex,
            age, muscle, weight, height, proportions; shape (2, 4, 3, 3, 3, 3, K), float32.
        measures: their names, shape (M,).
        triangles: vertices counter-clockwise as seen from outside, shape (T, 3), uint16.
        skin_bones: the bones that each vertex follows, the strongest first, shape (V, 8), uint8.
        skin_weights: how much, in 65535ths, shape (V, 8), uint16.
        bones: their names, parents before children, shape (B,).
        parents: the number of each bone's parent, -1 for the root, shape (B,), int16.
        joint_bones: the bone that carries each joint of the vocabulary, shape (20,), uint8.
        provenance: where it comes from, and its licence.
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


def save_body(path: str | os.PathLike[str], body: Body) -> None:
    """Write `body` to `path`, beside it first and then renamed.

    Raises:
        InputError: the file cannot be written.
    """
    target = Path(path)
    beside = target.with_name(f'.{target.name}.{os.getpid()}.part')
    arrays: dict[str, Any] = {**body._asdict(), 'version': VERSION}
    # Each axis on its own compresses better.
    arrays['components'] = np.ascontiguousarray(np.moveaxis(body.components, 2, 1))
    try:
        with beside.open('wb') as file:
            np.savez_compressed(file, **arrays)
        beside.replace(target)
    except OSError as error:
        msg = f'cannot write the body {target}: {error.strerror or error}'
        raise InputError(msg) from error
    finally:
        beside.unlink(missing_ok=True)


def load_body(path: str | os.PathLike[str] | None = None) -> Body:
    """Return the body in the file `path`; without it, the one that comes with the package.

    Raises:
        InputError: there is no such file, or it is no body.
    """
    return _load(Path(path) if path is not None else resource('bodies', 'body.npz'))


@cache
def _load(path: Path) -> Body:
    try:
        with np.load(path, allow_pickle=False) as archive:
            arrays = {name: archive[name] for name in (*Body._fields, 'version')}
    except FileNotFoundError as error:
        msg = f'there is no body file {path}'
        raise InputError(msg) from error
    except Exception as error:  # numpy lets through whatever a damaged file makes it stumble on
        raise _wrong(path, str(error) or type(error).__name__) from error
    if arrays.pop('version') != VERSION:
        raise _wrong(path, 'it is of another version')
    for name, (kind, dimensions) in _ARRAYS.items():
        array = arrays[name]
        if array.dtype != kind or array.ndim != dimensions:
            raise _wrong(path, f'its part {name} is {array.dtype} of {array.ndim} dimensions')
    arrays['components'] = np.ascontiguousarray(np.moveaxis(arrays['components'], 1, 2))
    arrays['provenance'] = str(arrays['provenance'])
    body = Body(**arrays)
    if not _fits(body):
        raise _wrong(path, 'its parts do not fit together')
    return body


def _fits(body: Body) -> bool:
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
