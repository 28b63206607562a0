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

"""Clothes and hair: displacement of the skin outwards where something covers it.

In a depth image, clothes make bodies wider and less smooth. `lsc_pose_ros.synthetic.outfit` has
skirts, hats and bags.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.synthetic.body.body_file import BodyModel
from lsc_pose_ros.synthetic.body.body_mesh import RestBody

# The bones of each region, by the beginning of their names.
_BONES_OF_REGION: dict[str, tuple[str, ...]] = {
    'trunk': ('spine', 'clavicle', 'shoulder'),
    'hips': ('root', 'pelvis'),
    'upper_arm': ('upperarm',),
    'forearm': ('lowerarm',),
    'thigh': ('upperleg',),
    'shank': ('lowerleg',),
    'foot': ('foot', 'toes'),
}
REGIONS: tuple[str, ...] = (*_BONES_OF_REGION, 'scalp', 'long_hair')
"""Regions that can be covered: by clothes, by short hair (scalp) and by long hair."""

_WAVES = 4
_SHORTEST, _LONGEST = 0.12, 0.6  # wavelengths, metres
_FOLDS = 0.6  # amplitude of the folds, as a fraction of the thickness
_ADULT_STATURE = 1.7  # metres; the clothes of smaller people are proportionally thinner


class ClothesRegions(NamedTuple):
    """The regions of a body that clothes and hair cover.

    Attributes:
        triangles: the body's triangles, shape (T, 3).
        weights: how much each vertex belongs to each of REGIONS, 0 to 1, shape (V, 9).
    """

    triangles: NDArray[np.uint16]
    weights: NDArray[np.float64]


def clothes_regions(body: BodyModel) -> ClothesRegions:
    """Return the regions of `body` that clothes and hair cover."""
    weights = {name: _bone_weights(body, starts) for name, starts in _BONES_OF_REGION.items()}
    # Trousers cover the ankles.
    over = weights['foot'] * _smoothstep(_offsets_from_joint(body, 'l_foot')[:, 1], 0.0, 0.05)
    weights['shank'] += over
    weights['foot'] -= over
    weights |= {'scalp': _scalp(body), 'long_hair': _long_hair(body)}
    return ClothesRegions(body.triangles, np.stack([weights[part] for part in REGIONS], axis=1))


def dress(regions: ClothesRegions, rest: RestBody, random: np.random.Generator) -> RestBody:
    """Return a person with random clothes and hair; the joints stay unchanged."""
    thickness = sample_thickness(random) * (np.ptp(rest.vertices[:, 1]) / _ADULT_STATURE)
    folds = _sample_folds(rest.vertices, random)
    outward = vertex_normals(rest.vertices, regions.triangles)
    moved = (regions.weights @ thickness) * folds
    return rest._replace(vertices=rest.vertices + moved[:, None] * outward)


def sample_thickness(random: np.random.Generator) -> NDArray[np.float64]:
    """Sample the thickness of the cover of each of REGIONS on an adult, metres, shape (9,)."""
    # Always nine numbers, whatever is chosen, so that later samples do not depend on the choice.
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
    """Return the unit normal at each vertex, shape (V, 3); zero if it is undefined.

    It is the normalised sum of (b - a) x (c - a) over the adjacent triangles, which weights them
    by their area.
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


def _sample_folds(
    vertices: NDArray[np.float64], random: np.random.Generator
) -> NDArray[np.float64]:
    """Sample a thickness factor per vertex, shape (V,): 1 plus the mean of a few plane waves."""
    uniforms = random.random((_WAVES, 5))
    across = 2 * uniforms[:, :3] - 1
    across[:, 1] *= 0.5  # folds are rather vertical
    across /= np.sqrt((across**2).sum(axis=1, keepdims=True)) + 1e-9
    lengths = _SHORTEST + (_LONGEST - _SHORTEST) * uniforms[:, 3]
    phases = vertices @ (across / lengths[:, None]).T + uniforms[:, 4]
    waves: NDArray[np.float64] = np.sin(2 * np.pi * phases).mean(axis=1)
    return 1 + _FOLDS * waves


def _bone_weights(body: BodyModel, starts: tuple[str, ...]) -> NDArray[np.float64]:
    """Return how much each vertex follows bones whose names begin with `starts`, shape (V,)."""
    chosen = np.array([str(name).startswith(starts) for name in body.bones])
    fraction: NDArray[np.float64] = (chosen[body.skin_bones] * body.skin_weights).sum(
        axis=1
    ) / 65535
    return fraction


def _offsets_from_joint(body: BodyModel, name: str) -> NDArray[np.float64]:
    """Return the vertices of the average body relative to a joint, metres, shape (V, 3)."""
    points = body.mean.astype(np.float64)
    vertices = len(body.skin_bones)
    joint = points[vertices + len(body.bones) + JOINT_NUMBERS[name]]
    offsets: NDArray[np.float64] = points[:vertices] - joint
    return offsets


def _scalp(body: BodyModel) -> NDArray[np.float64]:
    """Return the weight of hair at each vertex: on the top and the back of the head."""
    offsets = _offsets_from_joint(body, 'head')
    directions = offsets / (np.sqrt((offsets**2).sum(axis=1, keepdims=True)) + 1e-9)
    grown = _smoothstep(0.7 * directions[:, 1] - directions[:, 2], 0.0, 0.5)
    return _bone_weights(body, ('head',)) * grown


def _long_hair(body: BodyModel) -> NDArray[np.float64]:
    """Return the weight of long hair at each vertex: on the nape and between the shoulders."""
    offsets = _offsets_from_joint(body, 'neck')
    behind = _smoothstep(-offsets[:, 2], -0.02, 0.04)
    high = _smoothstep(offsets[:, 1], -0.16, -0.02)
    narrow = _smoothstep(-np.abs(offsets[:, 0]), -0.13, -0.07)
    return (
        _bone_weights(body, ('spine', 'neck', 'head'))
        * behind
        * high
        * narrow
        * (1 - _scalp(body))
    )


def _smoothstep(values: NDArray[np.float64], low: float, high: float) -> NDArray[np.float64]:
    """Return a smooth ramp: 0 if a value is `low` or less, 1 if it is `high` or more."""
    fraction = np.clip((values - low) / (high - low), 0.0, 1.0)
    return fraction * fraction * (3 - 2 * fraction)
