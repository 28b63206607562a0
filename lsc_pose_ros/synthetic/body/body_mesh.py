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

"""Skin and skeleton of one person: shaped by age, sex and build, then posed.

A person's frame is x to the left, y up, z forward. In the rest pose, all bones have the identity
orientation. The arms are then half raised, elbows slightly bent, palms forward and down.
`standing_orientations` returns the bones' orientations in the standing pose with hanging arms.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.body_file import BodyModel

AGES: tuple[float, ...] = (1.0, 10.0, 25.0, 90.0)
"""Years of MakeHuman's baby, child, young and old; shapes of other ages are interpolated."""


_ADULT_STATURE = 1.67
"""Stature of MakeHuman's base mesh, metres."""


class BodyShape(NamedTuple):
    """The body shape of a person.

    Attributes:
        age: years, 1 to 90.
        sex: 0 female, 1 male.
        height: 0 to 1, 0.5 is the average of that age and sex. Both ends are beyond the height of
            real people; see `with_stature`.
        weight: 0 to 1, thin to fat, 0.5 is average.
        muscle: 0 to 1, weak to strong, 0.5 is average.
        proportions: 0 to 1, uncommon to a sculptor's ideal, 0.5 is average.
        measures: change of single measures, -1 to 1, by the names in `BodyModel.measures`; 0 is
            the value that follows from the other parameters, both ends are extreme.
    """

    age: float = 30.0
    sex: float = 0.5
    height: float = 0.5
    weight: float = 0.5
    muscle: float = 0.5
    proportions: float = 0.5
    measures: Mapping[str, float] = MappingProxyType({})


class RestBody(NamedTuple):
    """One person's body in the rest pose.

    Attributes:
        vertices: the skin, metres, shape (V, 3).
        heads: the points that the bones rotate about, shape (B, 3).
        joints: the joints, shape (20, 3).
    """

    vertices: NDArray[np.float64]
    heads: NDArray[np.float64]
    joints: NDArray[np.float64]


class PosedBody(NamedTuple):
    """One person's body in a pose.

    Attributes:
        vertices: the skin, metres, shape (V, 3).
        heads: the points that the bones rotate about, shape (B, 3).
        joints: the joints, shape (20, 3).
        orientations: the orientation of each bone relative to the rest pose, shape (B, 3, 3).
    """

    vertices: NDArray[np.float64]
    heads: NDArray[np.float64]
    joints: NDArray[np.float64]
    orientations: NDArray[np.float64]


def shape_body(body: BodyModel, body_shape: BodyShape) -> RestBody:
    """Return the body of a person with the given shape in the rest pose.

    Raises:
        InputError: a value of the shape is out of range.
    """
    _check(body, body_shape)
    weights = _corner_weights(body, body_shape)
    points = mix_components(body.mean, body.components, weights * body.steps[: len(weights)])
    vertices, bones = len(body.skin_bones), len(body.bones)
    # The displacements of the measures are made for adults.
    size = float(np.ptp(points[:vertices, 1])) / _ADULT_STATURE
    moves = size * _measure_weights(body, body_shape) * body.steps[len(weights) :]
    if moves.any():
        points = mix_components(points, body.components[len(weights) :], moves)
    return RestBody(*np.split(points, [vertices, vertices + bones]))


def stature(rest: RestBody) -> float:
    """Return the standing height, metres: the vertical extent of the skin."""
    return float(np.ptp(rest.vertices[:, 1]))


def with_stature(body: BodyModel, body_shape: BodyShape, metres: float) -> BodyShape:
    """Return `body_shape` with the height at which the person is `metres` tall, within 1 mm.

    Raises:
        InputError: the stature is out of range for this age, sex and build.
    """
    heights = [0.0, 0.5, 1.0]
    reached = [stature(shape_body(body, body_shape._replace(height=height))) for height in heights]
    if not reached[0] <= metres <= reached[-1]:
        msg = (
            f'the stature {metres:g} m is out of range; for this age, sex and build give '
            f'{reached[0]:.2f} to {reached[-1]:.2f} m'
        )
        raise InputError(msg)
    # Between these three heights, the stature is almost linear.
    height = float(np.interp(metres, reached, heights))
    error = metres - stature(shape_body(body, body_shape._replace(height=height)))
    height = float(np.interp(metres + error, reached, heights))
    return body_shape._replace(height=height)


def named_rotations(
    body: BodyModel, named: Mapping[str, NDArray[np.float64]]
) -> NDArray[np.float64]:
    """Return the rotations of all bones relative to their parents, shape (B, 3, 3).

    Args:
        body: the body model.
        named: rotations by the bone's name, shape (3, 3) each; all other bones get the identity.

    Raises:
        InputError: a bone does not exist.
    """
    numbers = {str(name): number for number, name in enumerate(body.bones)}
    unknown = sorted(set(named) - set(numbers))
    if unknown:
        msg = f'unknown bone {", ".join(unknown)}; known bones are {", ".join(numbers)}'
        raise InputError(msg)
    rotations = np.tile(np.eye(3), (len(numbers), 1, 1))
    for name, rotation in named.items():
        rotations[numbers[name]] = rotation
    return rotations


def pose_body(
    body: BodyModel, rest: RestBody, rotations: NDArray[np.float64], position: NDArray[np.float64]
) -> PosedBody:
    """Pose a body by linear blend skinning: x' = sum_b w_b (R_b x + t_b).

    Args:
        body: the body model.
        rest: the person in the rest pose.
        rotations: each bone's rotation relative to its parent, in the parent's axes, shape
            (B, 3, 3). The root's rotation applies to the whole person, so it can include the
            change to the camera's frame.
        position: the position of the pelvis, metres, shape (3,).

    Returns:
        The body in the frame of `position`.
    """
    orientations, heads = forward_kinematics(
        np.ascontiguousarray(rotations, np.float64), body.parents, rest.heads
    )
    heads += position
    shifts = heads - np.einsum('bij,bj->bi', orientations, rest.heads)
    carriers = body.joint_bones
    joints = np.einsum('jkl,jl->jk', orientations[carriers], rest.joints) + shifts[carriers]
    vertices = blend_skin(rest.vertices, body.skin_bones, body.skin_weights, orientations, shifts)
    return PosedBody(vertices, heads, joints, orientations)


def relative_rotations(body: BodyModel, orientations: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the bones' rotations relative to their parents from their orientations, (B, 3, 3)."""
    local = orientations.copy()
    local[1:] = orientations[body.parents[1:]].transpose(0, 2, 1) @ orientations[1:]
    return local


def standing_orientations(body: BodyModel, rest: RestBody) -> NDArray[np.float64]:
    """Return the bones' orientations in the standing pose relative to the rest pose, (B, 3, 3).

    The arms hang at the sides, palms inwards, with the elbows' axes set to bend forwards. The legs
    are straight, the soles level, the toes forwards. Trunk, neck and head are as in the rest pose.
    A rotation R of a bone from the standing pose, in the person's axes, gives the orientation
    R times this one.
    """
    numbers = {str(name): number for number, name in enumerate(body.bones)}
    orientations = np.tile(np.eye(3), (len(numbers), 1, 1))
    for side in ('L', 'R'):
        at = {name[:-2]: rest.heads[n] for name, n in numbers.items() if name.endswith(side)}
        for name, turn in _straight_limbs(at).items():
            orientations[numbers[f'{name}.{side}']] = turn
    return orientations


def _straight_limbs(at: dict[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    """Return the orientations of the limb bones of one side; `at` maps names to their heads."""
    upper_arm, forearm = at['lowerarm01'] - at['upperarm01'], at['wrist'] - at['lowerarm01']
    palm = at['finger3-1'] - at['wrist']
    across = at['finger2-1'] - at['finger5-1']  # forwards when the palms face the thighs
    ahead = at['toes'] - at['foot']
    # The direction in which the elbow is bent in the rest pose.
    bend = forearm - forearm @ upper_arm / (upper_arm @ upper_arm) * upper_arm
    orientations = {
        'upperarm': _hanging(upper_arm, bend),
        'lowerarm': _hanging(forearm, -upper_arm),
        'wrist': _hanging(palm, across),
        'upperleg': _hanging(at['lowerleg01'] - at['upperleg01'], ahead),
        'lowerleg': _hanging(at['foot'] - at['lowerleg01'], ahead),
        'foot': _hanging(np.array([0.0, -1.0, 0.0]), ahead),
    }
    named = {
        f'{name}{part}': orientations[name] for name in _TWO_BONE_SEGMENTS for part in ('01', '02')
    }
    # The forearm's distal half takes half of the hand's rotation.
    twisted = _hanging(forearm, orientations['wrist'].T @ np.array([0.0, 0.0, 1.0]))
    named['lowerarm02'] = _hanging(
        forearm, (orientations['lowerarm'] + twisted).T @ np.array([0.0, 0.0, 1.0])
    )
    hand = {
        name: orientations['wrist'] for name in at if name.startswith(('wrist', 'meta', 'finger'))
    }
    return {**named, **hand, 'foot': orientations['foot'], 'toes': orientations['foot']}


_TWO_BONE_SEGMENTS = (
    'upperarm',
    'lowerarm',
    'upperleg',
    'lowerleg',
)  # their bones are in two halves


def _hanging(along: NDArray[np.float64], forwards: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation that maps `along` to -y and `forwards` as near to z as possible."""
    down = along / np.sqrt(along @ along)
    ahead = forwards - (forwards @ down) * down
    ahead /= np.sqrt(ahead @ ahead)
    return np.stack([np.cross(-down, ahead), -down, ahead])


def _check(body: BodyModel, body_shape: BodyShape) -> None:
    if not AGES[0] <= body_shape.age <= AGES[-1]:
        msg = f'the age is {body_shape.age:g} years; give {AGES[0]:g} to {AGES[-1]:g}'
        raise InputError(msg)
    for name in ('sex', 'height', 'weight', 'muscle', 'proportions'):
        value = getattr(body_shape, name)
        if not 0 <= value <= 1:
            msg = f'{name} is {value:g}; give 0 to 1'
            raise InputError(msg)
    for name, value in body_shape.measures.items():
        if name not in body.measures:
            msg = f'unknown measure {name}; the measures are {", ".join(body.measures)}'
            raise InputError(msg)
        if not -1 <= value <= 1:
            msg = f'{name} is {value:g}; give -1 to 1'
            raise InputError(msg)


def _corner_weights(body: BodyModel, body_shape: BodyShape) -> NDArray[np.float64]:
    """Return the weights of the principal components, shape (K,): multilinear in the corners."""
    weights = body.corners.astype(np.float64)
    age = float(np.interp(body_shape.age, AGES, range(len(AGES))))
    thirds = (body_shape.muscle, body_shape.weight, body_shape.height, body_shape.proportions)
    for position in (body_shape.sex, age, *(2 * value for value in thirds)):
        first = min(int(position), len(weights) - 2)
        fraction = position - first
        weights = (1 - fraction) * weights[first] + fraction * weights[first + 1]
    return weights


def _measure_weights(body: BodyModel, body_shape: BodyShape) -> NDArray[np.float64]:
    """Return the weights of the decrease and the increase of each measure, shape (2 M,)."""
    values = np.array([body_shape.measures.get(str(name), 0.0) for name in body.measures])
    return np.stack([np.maximum(-values, 0), np.maximum(values, 0)], axis=1).ravel()


@kernel
def mix_components(
    mean: NDArray[np.floating], components: NDArray[np.int16], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Return mean + sum_k weights_k components_k, shape (P, 3)."""
    points = mean.astype(np.float64)
    for k in range(len(weights)):
        weight = weights[k]
        if weight == 0.0:
            continue
        for p in range(len(points)):
            for axis in range(3):
                points[p, axis] += weight * components[k, p, axis]
    return points


@kernel
def forward_kinematics(
    rotations: NDArray[np.float64], parents: NDArray[np.int16], rest: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the bones' orientations, (B, 3, 3), and heads, (B, 3), with the root at the origin.

    R_b = R_parent L_b and h_b' = h_parent' + R_parent (h_b - h_parent).
    """
    orientations = rotations.copy()
    heads = np.zeros_like(rest)
    for bone in range(1, len(parents)):
        parent = parents[bone]
        for row in range(3):
            for column in range(3):
                total = 0.0
                for inner in range(3):
                    total += orientations[parent, row, inner] * rotations[bone, inner, column]
                orientations[bone, row, column] = total
            along = heads[parent, row]
            for inner in range(3):
                along += orientations[parent, row, inner] * (
                    rest[bone, inner] - rest[parent, inner]
                )
            heads[bone, row] = along
    return orientations, heads


@kernel
def blend_skin(
    rest: NDArray[np.float64],
    bones: NDArray[np.uint8],
    weights: NDArray[np.uint16],
    orientations: NDArray[np.float64],
    shifts: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the vertices x' = sum_b w_b (R_b x + t_b), shape (V, 3)."""
    posed = np.zeros_like(rest)
    for vertex in range(len(rest)):
        x, y, z = rest[vertex, 0], rest[vertex, 1], rest[vertex, 2]
        for influence in range(bones.shape[1]):
            weight = weights[vertex, influence] / 65535.0
            if weight == 0.0:  # they are sorted
                break
            bone = bones[vertex, influence]
            for row in range(3):
                rotated = orientations[bone, row, 0] * x + orientations[bone, row, 1] * y
                rotated += orientations[bone, row, 2] * z + shifts[bone, row]
                posed[vertex, row] += weight * rotated
    return posed
