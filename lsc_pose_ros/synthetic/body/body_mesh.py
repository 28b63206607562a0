"""A person's skin and skeleton: shaped by age, sex and build, then posed.

A person's frame is x to the left, y up, z forward. At rest all bones are unturned: every bone's
axes are the person's. The arms are then held half way down, elbows a little bent, palms forward
and down; `straighten` says how bones are turned in a person who stands with hanging arms.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.body_file import Body

AGES: tuple[float, ...] = (1.0, 10.0, 25.0, 90.0)
"""Years of MakeHuman's baby, child, young and old; in between, shapes are mixed."""


_GROWN_UP = 1.67
"""Metres, the stature of the mesh that MakeHuman starts from."""


class Figure(NamedTuple):
    """What a person is like.

    Attributes:
        age: years, 1 to 90.
        sex: 0 female, 1 male.
        height: 0 to 1, 0.5 the average of that age and sex; both ends are no real people's, see
            `with_stature`.
        weight: 0 to 1, thin to fat, 0.5 average.
        muscle: 0 to 1, weak to strong, 0.5 average.
        proportions: 0 to 1, uncommon to a sculptor's ideal, 0.5 average.
        measures: by how much single measures differ from what follows from the rest, -1 to 1 by
            the name in `Body.measures`; both ends are extreme.
    """

    age: float = 30.0
    sex: float = 0.5
    height: float = 0.5
    weight: float = 0.5
    muscle: float = 0.5
    proportions: float = 0.5
    measures: Mapping[str, float] = MappingProxyType({})


class Rest(NamedTuple):
    """One person's body at rest.

    Attributes:
        vertices: of the skin, metres, shape (V, 3).
        heads: the points about which the bones turn, shape (B, 3).
        joints: of the vocabulary, shape (20, 3).
    """

    vertices: NDArray[np.float64]
    heads: NDArray[np.float64]
    joints: NDArray[np.float64]


class Posed(NamedTuple):
    """One person's body in a pose.

    Attributes:
        vertices: of the skin, metres, shape (V, 3).
        heads: the points about which the bones turn, shape (B, 3).
        joints: of the vocabulary, shape (20, 3).
        turns: how each bone is turned from rest, shape (B, 3, 3).
    """

    vertices: NDArray[np.float64]
    heads: NDArray[np.float64]
    joints: NDArray[np.float64]
    turns: NDArray[np.float64]


def shape_body(body: Body, figure: Figure) -> Rest:
    """Return the body at rest of a person like `figure`.

    Raises:
        InputError: a value of the figure is out of range.
    """
    _check(body, figure)
    weights = _corner_weights(body, figure)
    points = mix_components(body.mean, body.components, weights * body.steps[: len(weights)])
    vertices, bones = len(body.skin_bones), len(body.bones)
    # The measures' moves are made for grown-ups.
    size = float(np.ptp(points[:vertices, 1])) / _GROWN_UP
    moves = size * _measure_weights(body, figure) * body.steps[len(weights) :]
    if moves.any():
        points = mix_components(points, body.components[len(weights) :], moves)
    return Rest(*np.split(points, [vertices, vertices + bones]))


def stature(rest: Rest) -> float:
    """Return the standing height, metres, from the lowest to the highest point of the skin."""
    return float(np.ptp(rest.vertices[:, 1]))


def with_stature(body: Body, figure: Figure, metres: float) -> Figure:
    """Return `figure` with the height that makes the person `metres` tall, within 1 mm.

    Raises:
        InputError: nobody of this age and sex is so small or so tall.
    """
    heights = [0.0, 0.5, 1.0]
    reached = [stature(shape_body(body, figure._replace(height=height))) for height in heights]
    if not reached[0] <= metres <= reached[-1]:
        msg = (
            f'the stature {metres:g} m is out of range; for this age, sex and build give '
            f'{reached[0]:.2f} to {reached[-1]:.2f} m'
        )
        raise InputError(msg)
    # Between these three, stature is all but linear.
    height = float(np.interp(metres, reached, heights))
    missed = metres - stature(shape_body(body, figure._replace(height=height)))
    height = float(np.interp(metres + missed, reached, heights))
    return figure._replace(height=height)


def local_rotations(body: Body, named: Mapping[str, NDArray[np.float64]]) -> NDArray[np.float64]:
    """Return the rotations of all bones against their parents, shape (B, 3, 3).

    Args:
        body: the body.
        named: rotations, shape (3, 3), by the bone's name; a bone that is not named does not turn
            against its parent.

    Raises:
        InputError: there is no such bone.
    """
    numbers = {str(name): number for number, name in enumerate(body.bones)}
    unknown = sorted(set(named) - set(numbers))
    if unknown:
        msg = f'unknown bone {", ".join(unknown)}; the bones are {", ".join(numbers)}'
        raise InputError(msg)
    rotations = np.tile(np.eye(3), (len(numbers), 1, 1))
    for name, rotation in named.items():
        rotations[numbers[name]] = rotation
    return rotations


def pose_body(
    body: Body, rest: Rest, rotations: NDArray[np.float64], place: NDArray[np.float64]
) -> Posed:
    """Pose a body by linear blend skinning: x' = sum_b w_b (R_b x + t_b).

    Args:
        body: whose bones and skin.
        rest: the person at rest.
        rotations: each bone's against its parent, in axes that turn with the parent, as
            `local_rotations` returns them, shape (B, 3, 3). The root's turns the whole person, so
            it may also take the person into the camera's frame.
        place: where the pelvis goes, metres, shape (3,).

    Returns:
        The body in the frame in which `place` is given.
    """
    turns, heads = turn_bones(
        np.ascontiguousarray(rotations, np.float64), body.parents, rest.heads
    )
    heads += place
    shifts = heads - np.einsum('bij,bj->bi', turns, rest.heads)
    carriers = body.joint_bones
    joints = np.einsum('jkl,jl->jk', turns[carriers], rest.joints) + shifts[carriers]
    vertices = skin(rest.vertices, body.skin_bones, body.skin_weights, turns, shifts)
    return Posed(vertices, heads, joints, turns)


def to_local(body: Body, turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return bones' rotations against their parents, from their turns in space, (B, 3, 3)."""
    local = turns.copy()
    local[1:] = turns[body.parents[1:]].transpose(0, 2, 1) @ turns[1:]
    return local


def straighten(body: Body, rest: Rest) -> NDArray[np.float64]:
    """Return how bones are turned in space in a person who stands straight, shape (B, 3, 3).

    Arms hang at the sides, palms inwards, elbows about to bend forwards; legs are straight, knees
    about to bend backwards; soles are level, toes forwards. Trunk, neck and head are as at rest.
    To turn a limb's bone by R from there, in the person's axes, turn it in space by R times this.
    """
    numbers = {str(name): number for number, name in enumerate(body.bones)}
    turns = np.tile(np.eye(3), (len(numbers), 1, 1))
    for side in ('L', 'R'):
        at = {name[:-2]: rest.heads[n] for name, n in numbers.items() if name.endswith(side)}
        for name, turn in _straight_limbs(at).items():
            turns[numbers[f'{name}.{side}']] = turn
    return turns


def _straight_limbs(at: dict[str, NDArray[np.float64]]) -> dict[str, NDArray[np.float64]]:
    """Return the turns of one side's limb bones; `at` has their heads."""
    upper_arm, forearm = at['lowerarm01'] - at['upperarm01'], at['wrist'] - at['lowerarm01']
    palm = at['finger3-1'] - at['wrist']
    across = at['finger2-1'] - at['finger5-1']  # forwards when the palms face the thighs
    ahead = at['toes'] - at['foot']
    # The way in which the elbow is bent at rest.
    bend = forearm - forearm @ upper_arm / (upper_arm @ upper_arm) * upper_arm
    turns = {
        'upperarm': _hanging(upper_arm, bend),
        'lowerarm': _hanging(forearm, -upper_arm),
        'wrist': _hanging(palm, across),
        'upperleg': _hanging(at['lowerleg01'] - at['upperleg01'], ahead),
        'lowerleg': _hanging(at['foot'] - at['lowerleg01'], ahead),
        'foot': _hanging(np.array([0.0, -1.0, 0.0]), ahead),
    }
    named = {f'{name}{part}': turns[name] for name in _LONG for part in ('01', '02')}
    # The forearm's far half turns with the hand, half way.
    twisted = _hanging(forearm, turns['wrist'].T @ np.array([0.0, 0.0, 1.0]))
    named['lowerarm02'] = _hanging(
        forearm, (turns['lowerarm'] + twisted).T @ np.array([0.0, 0.0, 1.0])
    )
    hand = {name: turns['wrist'] for name in at if name.startswith(('wrist', 'meta', 'finger'))}
    return {**named, **hand, 'foot': turns['foot'], 'toes': turns['foot']}


_LONG = ('upperarm', 'lowerarm', 'upperleg', 'lowerleg')  # their bones are in two halves


def _hanging(along: NDArray[np.float64], forwards: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotation that brings `along` straight down and `forwards`, if it can, to z."""
    down = along / np.sqrt(along @ along)
    ahead = forwards - (forwards @ down) * down
    ahead /= np.sqrt(ahead @ ahead)
    return np.stack([np.cross(-down, ahead), -down, ahead])


def _check(body: Body, figure: Figure) -> None:
    if not AGES[0] <= figure.age <= AGES[-1]:
        msg = f'the age is {figure.age:g} years; give {AGES[0]:g} to {AGES[-1]:g}'
        raise InputError(msg)
    for name in ('sex', 'height', 'weight', 'muscle', 'proportions'):
        value = getattr(figure, name)
        if not 0 <= value <= 1:
            msg = f'{name} is {value:g}; give 0 to 1'
            raise InputError(msg)
    for name, value in figure.measures.items():
        if name not in body.measures:
            msg = f'unknown measure {name}; the measures are {", ".join(body.measures)}'
            raise InputError(msg)
        if not -1 <= value <= 1:
            msg = f'{name} is {value:g}; give -1 to 1'
            raise InputError(msg)


def _corner_weights(body: Body, figure: Figure) -> NDArray[np.float64]:
    """Return the principal components' weights, shape (K,): the multilinear mean of corners."""
    weights = body.corners.astype(np.float64)
    age = float(np.interp(figure.age, AGES, range(len(AGES))))
    thirds = (figure.muscle, figure.weight, figure.height, figure.proportions)
    for position in (figure.sex, age, *(2 * value for value in thirds)):
        first = min(int(position), len(weights) - 2)
        share = position - first
        weights = (1 - share) * weights[first] + share * weights[first + 1]
    return weights


def _measure_weights(body: Body, figure: Figure) -> NDArray[np.float64]:
    """Return the weights of less and more of each measure, shape (2 M,)."""
    values = np.array([figure.measures.get(str(name), 0.0) for name in body.measures])
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
def turn_bones(
    rotations: NDArray[np.float64], parents: NDArray[np.int16], rest: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return bones' turns in space, (B, 3, 3), and heads, (B, 3), the root's at the origin.

    R_b = R_parent L_b and h_b' = h_parent' + R_parent (h_b - h_parent).
    """
    turns = rotations.copy()
    heads = np.zeros_like(rest)
    for bone in range(1, len(parents)):
        parent = parents[bone]
        for row in range(3):
            for column in range(3):
                total = 0.0
                for inner in range(3):
                    total += turns[parent, row, inner] * rotations[bone, inner, column]
                turns[bone, row, column] = total
            along = heads[parent, row]
            for inner in range(3):
                along += turns[parent, row, inner] * (rest[bone, inner] - rest[parent, inner])
            heads[bone, row] = along
    return turns, heads


@kernel
def skin(
    rest: NDArray[np.float64],
    bones: NDArray[np.uint8],
    weights: NDArray[np.uint16],
    turns: NDArray[np.float64],
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
                turned = turns[bone, row, 0] * x + turns[bone, row, 1] * y
                turned += turns[bone, row, 2] * z + shifts[bone, row]
                posed[vertex, row] += weight * turned
    return posed
