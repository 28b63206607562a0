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

"""Skirts, coat tails, hats, backpacks and bags in the rest pose."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.synthetic.body.body_file import BodyModel
from lsc_pose_ros.synthetic.body.body_mesh import RestBody
from lsc_pose_ros.synthetic.outfit.outfit import Garment, rigid
from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.shapes import Mesh, join, leaves, loft, rounded

_RINGS = 9
_ADULT_STATURE = 1.7  # metres; the things of smaller people are proportionally smaller
_SKIRT, _HAT, _BACKPACK, _BAG, _HELD, _BUN = 0.2, 0.16, 0.1, 0.08, 0.14, 0.06  # probabilities


class _Wearer:
    """The measures of a person that garments are made for."""

    def __init__(self, body: BodyModel, rest: RestBody) -> None:
        self.rest = rest
        strongest = body.bones[body.skin_bones[:, 0]]
        self._starts = {
            name: rest.vertices[np.char.startswith(strongest, name)]
            for name in ('head', 'spine', 'upperleg', 'pelvis', 'root', 'lowerleg')
        }
        self.scale = float(np.ptp(rest.vertices[:, 1])) / _ADULT_STATURE

    def joint(self, name: str) -> NDArray[np.float64]:
        position: NDArray[np.float64] = self.rest.joints[JOINT_NUMBERS[name]]
        return position

    def skin(self, *bones: str) -> NDArray[np.float64]:
        return np.concatenate([self._starts[name] for name in bones])


def sample_garments(body: BodyModel, rest: RestBody, stream: RandomStream) -> list[Garment]:
    """Sample what a person wears besides tight clothes; often nothing.

    Args:
        body: the body model.
        rest: the dressed person in the rest pose.
        stream: the source of randomness.
    """
    wearer = _Wearer(body, rest)
    garments = []
    if stream.bernoulli(_SKIRT):
        garments.append(_skirt(wearer, stream))
    if stream.bernoulli(_HAT):
        garments.append(_hat(wearer, stream))
    elif stream.bernoulli(_BUN):
        garments.append(_bun(wearer, stream))
    if stream.bernoulli(_BACKPACK):
        garments.append(_backpack(wearer, stream))
    elif stream.bernoulli(_BAG):
        garments += _shoulder_bag(wearer, stream)
    for side in ('l', 'r'):
        if stream.bernoulli(0.5 * _HELD):
            garments.append(_held(wearer, side, stream))
    return garments


def _skirt(wearer: _Wearer, stream: RandomStream) -> Garment:
    """Return a skirt or the lower part of a coat, from the waist to between thigh and ankle."""
    hip, knee, ankle = (wearer.joint(f'l_{name}')[1] for name in ('hip', 'knee', 'ankle'))
    waist = hip + 0.6 * (wearer.joint('torso')[1] - hip)
    hem = stream.choose(((0.4, 0.45), (0.4, 0.95), (0.2, 1.6))) + stream.between(-0.2, 0.2)
    low = hip - min(hem, 1.0) * (hip - knee) - max(hem - 1.0, 0.0) * (knee - ankle)
    heights = np.linspace(low, waist, _RINGS)
    flare, loose = stream.between(0.0, 0.12), stream.between(0.01, 0.04)
    skin = wearer.skin('spine', 'pelvis', 'root', 'upperleg', 'lowerleg')
    half = np.array([_half_sizes(skin, height) for height in heights])
    # A skirt does not become narrower below the widest point above.
    wide = np.maximum.accumulate(half[::-1], axis=0)[::-1]
    fall = np.clip((hip - heights) / (hip - low), 0.0, 1.0)
    grown = wide[:, :2] + loose + flare * fall[:, None]
    shift = half[:, 2]
    mesh = loft(heights, grown[:, 0], grown[:, 1], exponent=0.85, sides=20, shift=shift)
    mesh = Mesh(mesh.vertices, mesh.triangles[: -2 * 20])  # open at both ends
    return Garment(mesh, _skirt_weights(mesh.vertices, hip, knee), _SKIRT_JOINTS)


_SKIRT_JOINTS = tuple(
    JOINT_NUMBERS[name]
    for name in ('torso', 'pelvis', 'l_hip', 'r_hip', 'l_knee', 'r_knee', 'l_ankle', 'r_ankle')
)


def _half_sizes(skin: NDArray[np.float64], height: float) -> tuple[float, float, float]:
    """Return half width, half depth and middle z of the skin around a height, metres."""
    near = skin[np.abs(skin[:, 1] - height) < 0.04]
    if not len(near):
        return 0.0, 0.0, 0.0
    back, front = near[:, 2].min(), near[:, 2].max()
    return (
        float(np.abs(near[:, 0]).max()),
        float(0.5 * (front - back)),
        float(0.5 * (front + back)),
    )


def _skirt_weights(
    vertices: NDArray[np.float64], hip: float, knee: float
) -> dict[str, NDArray[np.float64]]:
    """Return weights of pelvis and thighs: a skirt hangs between the thighs."""
    low = np.clip((hip - vertices[:, 1]) / (0.7 * (hip - knee)), 0.0, 1.0)
    left = np.clip(0.5 + vertices[:, 0] / 0.2, 0.0, 1.0)
    left = left * left * (3 - 2 * left)
    return {'root': 1 - low, 'upperleg02.L': low * left, 'upperleg02.R': low * (1 - left)}


def _hat(wearer: _Wearer, stream: RandomStream) -> Garment:
    """Return a cap, a hat with a brim, a helmet or a hood."""
    skin = wearer.skin('head')
    top = float(skin[:, 1].max())
    crown = skin[skin[:, 1] > top - 0.12 * wearer.scale]
    wide = float(np.abs(crown[:, 0]).max())
    back, front = float(crown[:, 2].min()), float(crown[:, 2].max())
    deep, middle = 0.5 * (front - back), 0.5 * (front + back)
    over, high = stream.between(0.005, 0.035), stream.between(0.01, 0.1)
    low = top - stream.between(0.07, 0.11) * wearer.scale
    heights = np.array([low, 0.5 * (low + top), top, top + high])
    radii = np.array([1.0, 1.0, 0.85, stream.between(0.2, 0.8)])
    meshes = [loft(heights, radii * (wide + over), radii * (deep + over), shift=middle)]
    kind, brim = stream.uniform(), stream.between(0.03, 0.1)
    if kind < 0.35:
        rim = (wide + brim, wide + brim), (deep + brim, deep + brim)
        meshes.append(loft((low, low + 0.01), *rim, shift=middle))
    elif kind < 0.7:
        peak = loft((low, low + 0.01), (0.8 * wide, 0.8 * wide), (brim, brim), shift=front)
        meshes.append(peak)
    return rigid(join(meshes), 'head', (JOINT_NUMBERS['head'],))


def _bun(wearer: _Wearer, stream: RandomStream) -> Garment:
    """Return hair that is tied at the back of the head, or curly hair around it."""
    skin = wearer.skin('head')
    high, back = float(skin[:, 1].max()), float(skin[:, 2].min())
    radius = stream.between(0.03, 0.06)
    if stream.bernoulli(0.5):
        ball = rounded((radius, radius, radius), 1.0)
        offset = np.array([0.0, high - stream.between(0.0, 0.12), back])
        mesh = ball._replace(vertices=ball.vertices + offset)
    else:
        angles = 2 * np.pi * np.arange(90) / 13
        rows = np.arange(90) / 90
        size = 0.09 + radius
        points = size * np.stack(
            [np.cos(angles) * np.sqrt(1 - rows**2), rows, np.sin(angles) * np.sqrt(1 - rows**2)],
            axis=1,
        )
        points = points[(points[:, 2] < 0.03) | (points[:, 1] > 0.6 * size)]
        mesh = leaves(points + np.array([0.0, high - 0.1, back + 0.09]), 0.07)
    return rigid(mesh, 'head', (JOINT_NUMBERS['head'],))


def _backpack(wearer: _Wearer, stream: RandomStream) -> Garment:
    scale = wearer.scale
    half = (
        0.5
        * scale
        * np.array(
            [stream.between(0.24, 0.36), stream.between(0.35, 0.55), stream.between(0.1, 0.28)]
        )
    )
    high = wearer.joint('neck')[1] - stream.between(0.02, 0.12) * scale
    trunk = wearer.skin('spine')
    back = float(trunk[np.abs(trunk[:, 1] - (high - half[1])) < half[1], 2].min())
    mesh = rounded(half, stream.between(0.3, 0.6))
    mesh = mesh._replace(
        vertices=mesh.vertices + np.array([0.0, high - half[1], back - 0.8 * half[2]])
    )
    worn = rigid(mesh, 'spine02', (JOINT_NUMBERS['torso'], JOINT_NUMBERS['neck']))
    return worn._replace(behind=True)


def _shoulder_bag(wearer: _Wearer, stream: RandomStream) -> list[Garment]:
    """Return a bag at a hip and its strap over the other or the same shoulder."""
    side, over = (1.0 if stream.bernoulli(0.5) else -1.0), (1.0 if stream.bernoulli(0.5) else -1.0)
    scale = wearer.scale
    half = (
        0.5
        * scale
        * np.array(
            [stream.between(0.06, 0.14), stream.between(0.2, 0.35), stream.between(0.2, 0.4)]
        )
    )
    hips = wearer.skin('root', 'pelvis', 'upperleg')
    hip = wearer.joint('l_hip')
    near = hips[np.abs(hips[:, 1] - hip[1]) < 0.1]
    middle = np.array([side * (float(np.abs(near[:, 0]).max()) + 0.8 * half[0]), hip[1], hip[2]])
    bag = rounded(half, 0.4)
    bag = bag._replace(vertices=bag.vertices + middle)
    joint = JOINT_NUMBERS['l_hip' if side > 0 else 'r_hip']
    shoulder = 0.6 * wearer.joint('l_shoulder') * (over, 1.0, 1.0) + 0.4 * wearer.joint('neck')
    trunk = wearer.skin('spine')
    front = float(trunk[:, 2].max()) + 0.01
    top = shoulder + np.array([0.0, 0.05, 0.0])
    middle_front = 0.5 * (top + middle)
    middle_front[2] = front
    points = np.array([top, middle_front, middle])
    wide = np.array([0.02, 0.0, 0.0])
    strap = Mesh(
        np.concatenate([points - wide, points + wide]),
        np.array([[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]]),
    )
    high = np.array([1.0, 0.5, 0.0] * 2)
    torso = (JOINT_NUMBERS['torso'], JOINT_NUMBERS['neck'], joint)
    return [
        rigid(bag, 'root', (joint,))._replace(behind=True),
        Garment(strap, {'spine01': high, 'root': 1 - high}, torso, behind=True),
    ]


def _held(wearer: _Wearer, side: str, stream: RandomStream) -> Garment:
    """Return a small thing in a hand: a cup, a bottle, a telephone, a book, a stick."""
    kind = stream.uniform()
    if kind < 0.4:
        half = (0.04, stream.between(0.05, 0.14), 0.04)
    elif kind < 0.75:
        half = (stream.between(0.03, 0.12), 0.01, stream.between(0.06, 0.16))
    else:
        half = (0.015, stream.between(0.15, 0.6), 0.015)
    mesh = rounded(half, 0.4)
    turn = stream.between(0.0, 2 * np.pi)
    cosine, sine = np.cos(turn), np.sin(turn)
    axes = np.array([[1.0, 0.0, 0.0], [0.0, cosine, -sine], [0.0, sine, cosine]])
    hand, wrist = wearer.joint(f'{side}_hand'), wearer.joint(f'{side}_wrist')
    middle = hand + 0.5 * (hand - wrist)
    moved = mesh._replace(vertices=mesh.vertices @ axes.T + middle)
    return rigid(moved, f'wrist.{side.upper()}', (JOINT_NUMBERS[f'{side}_hand'],))
