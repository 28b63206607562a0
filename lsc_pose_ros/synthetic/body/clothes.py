"""Clothes and hair: the skin of a person at rest, moved outward where something covers it.

A depth camera sees no more of them than that bodies are wider, and less smooth, than naked ones.
What hangs free, a skirt or a scarf, is not among them.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.body_file import Body
from lsc_pose_ros.synthetic.body.body_mesh import Rest

# The bones, by how their names begin, that carry what a piece of clothing covers.
_PARTS: dict[str, tuple[str, ...]] = {
    'trunk': ('spine', 'clavicle', 'shoulder'),
    'hips': ('root', 'pelvis'),
    'upper_arm': ('upperarm',),
    'forearm': ('lowerarm',),
    'thigh': ('upperleg',),
    'shank': ('lowerleg',),
    'foot': ('foot', 'toes'),
}
PARTS: tuple[str, ...] = (*_PARTS, 'scalp', 'mane')
"""Parts of the body that can be covered: limbs, what hair grows on, what long hair falls on."""

_WAVES = 4
_SHORTEST, _LONGEST = 0.12, 0.6  # of the waves, metres
_FOLDS = 0.6  # by what share of its thickness cloth rises and sinks
_GROWN_UP = 1.7  # metres; clothes of smaller people are thinner


class Wardrobe(NamedTuple):
    """Where clothes sit on a body.

    Attributes:
        triangles: of the body, shape (T, 3).
        shares: how much each vertex belongs to each of PARTS, shape (V, 9).
    """

    triangles: NDArray[np.uint16]
    shares: NDArray[np.float64]


def open_wardrobe(body: Body) -> Wardrobe:
    """Return where clothes sit on `body`."""
    shares = {name: _follows(body, starts) for name, starts in _PARTS.items()}
    # Trousers hang over the ankles.
    over = shares['foot'] * _ramp(_from_joint(body, 'l_foot')[:, 1], 0.0, 0.05)
    shares['shank'] += over
    shares['foot'] -= over
    shares |= {'scalp': _scalp(body), 'mane': _mane(body)}
    return Wardrobe(body.triangles, np.stack([shares[part] for part in PARTS], axis=1))


def dress(wardrobe: Wardrobe, rest: Rest, random: np.random.Generator) -> Rest:
    """Return a person at rest with clothes and hair; the joints stay where they are."""
    thickness = draw_thickness(random) * (np.ptp(rest.vertices[:, 1]) / _GROWN_UP)
    folds = _draw_folds(rest.vertices, random)
    outward = vertex_normals(rest.vertices, wardrobe.triangles)
    moved = (wardrobe.shares @ thickness) * folds
    return rest._replace(vertices=rest.vertices + moved[:, None] * outward)


def draw_thickness(random: np.random.Generator) -> NDArray[np.float64]:
    """Draw how far each of PARTS is covered on a grown-up, metres, shape (9,)."""
    # All chances at once: the same seed gives the same clothes whatever is chosen.
    top, sleeve, coat, bottom, leg, wide, shoe, hair, long = random.random(9)
    shirt = 0.004 + 0.030 * top**2
    if coat < 0.15:
        shirt += 0.02
    trousers = 0.003 + 0.018 * bottom**2
    bare_arms, bare_shanks = sleeve < 0.4, leg < 0.25
    fullness = 0.020 * hair
    return np.array(
        [
            shirt,
            max(shirt, trousers),
            shirt * 0.8,
            0.0 if bare_arms else shirt * 0.6,
            trousers + (shirt * 0.6 if coat < 0.15 else 0.0),
            0.0 if bare_shanks else trousers + 0.018 * wide**2,
            0.014 * shoe,
            0.003 + fullness * hair,
            (0.015 + fullness) if long < 0.3 else 0.0,
        ]
    )


@kernel
def vertex_normals(
    vertices: NDArray[np.float64], triangles: NDArray[np.uint16]
) -> NDArray[np.float64]:
    """Return the unit normal at each vertex, shape (V, 3); zero where there is none.

    It is the mean of the normals (b - a) x (c - a) of the triangles about it, larger ones count
    more.
    """
    normals = np.zeros_like(vertices)
    for triangle in range(len(triangles)):
        a, b, c = triangles[triangle, 0], triangles[triangle, 1], triangles[triangle, 2]
        for axis in range(3):
            one, two = (axis + 1) % 3, (axis + 2) % 3
            part = (vertices[b, one] - vertices[a, one]) * (vertices[c, two] - vertices[a, two])
            part -= (vertices[b, two] - vertices[a, two]) * (vertices[c, one] - vertices[a, one])
            normals[a, axis] += part
            normals[b, axis] += part
            normals[c, axis] += part
    for vertex in range(len(normals)):
        x, y, z = normals[vertex, 0], normals[vertex, 1], normals[vertex, 2]
        length = np.sqrt(x * x + y * y + z * z)
        if length > 0.0:
            for axis in range(3):
                normals[vertex, axis] /= length
    return normals


def _draw_folds(vertices: NDArray[np.float64], random: np.random.Generator) -> NDArray[np.float64]:
    """Draw by what factor cloth is thicker here and thinner there, shape (V,): a few waves."""
    chances = random.random((_WAVES, 5))
    across = 2 * chances[:, :3] - 1
    across[:, 1] *= 0.5  # folds hang
    across /= np.sqrt((across**2).sum(axis=1, keepdims=True)) + 1e-9
    lengths = _SHORTEST + (_LONGEST - _SHORTEST) * chances[:, 3]
    phases = vertices @ (across / lengths[:, None]).T + chances[:, 4]
    waves: NDArray[np.float64] = np.sin(2 * np.pi * phases).mean(axis=1)
    return 1 + _FOLDS * waves


def _follows(body: Body, starts: tuple[str, ...]) -> NDArray[np.float64]:
    """Return how much each vertex follows bones whose names begin so, shape (V,)."""
    chosen = np.array([str(name).startswith(starts) for name in body.bones])
    share: NDArray[np.float64] = (chosen[body.skin_bones] * body.skin_weights).sum(axis=1) / 65535
    return share


def _from_joint(body: Body, name: str) -> NDArray[np.float64]:
    """Return where each vertex of the average body is, seen from a joint, metres, (V, 3)."""
    points = body.mean.astype(np.float64)
    vertices = len(body.skin_bones)
    joint = points[vertices + len(body.bones) + JOINT_NUMBERS[name]]
    aside: NDArray[np.float64] = points[:vertices] - joint
    return aside


def _scalp(body: Body) -> NDArray[np.float64]:
    """Return how much hair grows at each vertex: on the head's top and back, none on the face."""
    aside = _from_joint(body, 'head')
    directions = aside / (np.sqrt((aside**2).sum(axis=1, keepdims=True)) + 1e-9)
    grown = _ramp(0.7 * directions[:, 1] - directions[:, 2], 0.0, 0.5)
    return _follows(body, ('head',)) * grown


def _mane(body: Body) -> NDArray[np.float64]:
    """Return how much long hair lies on each vertex: on the nape and between the shoulders."""
    aside = _from_joint(body, 'neck')
    behind = _ramp(-aside[:, 2], -0.02, 0.04)
    high = _ramp(aside[:, 1], -0.16, -0.02)
    narrow = _ramp(-np.abs(aside[:, 0]), -0.13, -0.07)
    return _follows(body, ('spine', 'neck', 'head')) * behind * high * narrow * (1 - _scalp(body))


def _ramp(values: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
    """Return a smooth way from 0 where a value is `low` or less to 1 where it is `high`."""
    share = np.clip((values - low) / (high - low), 0.0, 1.0)
    return share * share * (3 - 2 * share)
