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

"""Synthetic people: sampled body, clothes and motion, standing on the floor."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.synthetic.body.body_file import BodyModel, load_body
from lsc_pose_ros.synthetic.body.body_mesh import PosedBody, RestBody, pose_body
from lsc_pose_ros.synthetic.body.clothes import clothes_regions, dress
from lsc_pose_ros.synthetic.body.population import BodySampler, Population
from lsc_pose_ros.synthetic.mocap.mocap import Mocap, load_mocap
from lsc_pose_ros.synthetic.motion.motion import Motion, RestingFractions, sample_motion
from lsc_pose_ros.synthetic.motion.walking import walking_motion
from lsc_pose_ros.synthetic.outfit.carried import CarriedSize, carried_load, sample_carried
from lsc_pose_ros.synthetic.outfit.garments import sample_garments
from lsc_pose_ros.synthetic.outfit.outfit import Outfit, outfit_of
from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.occupant import Occupant, regions_of
from lsc_pose_ros.synthetic.scene.placement import PersonExtent, ScenePlacement
from lsc_pose_ros.synthetic.scene.shapes import Mesh
from lsc_pose_ros.synthetic.scene.walking_paths import WalkingPath
from lsc_pose_ros.synthetic.settings import SyntheticSettings

# The directions in which `hull_vertices` looks for the outermost vertices of each bone.
_DIRECTIONS = np.array(
    [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z]
)


_LEVEL_THIGH = 0.5  # largest sine of the slope of a thigh on a seat
_BEHIND = 0.55  # distance of the trunk behind the ankles of who needs a seat, in thigh lengths
_SPREAD = 0.04  # edge of the cubes of `spread_vertices`, metres

RESTING = RestingFractions(seated=0.25, lying=0.05)
"""Fractions of people who sit on a seat or lie, in furnished rooms."""

_BEDDED_FRACTION = 0.6  # of those who lie, on a bed or sofa; the others lie on the floor
_BED_HEIGHTS = (0.3, 0.65)  # metres


class Attire(NamedTuple):
    """What a person wears and carries besides tight clothes.

    Attributes:
        outfit: follows the bones.
        seated_outfit: the same without what is in the way of a seat or bed.
        carried: what the hands carry if the pose allows it.
    """

    outfit: Outfit
    seated_outfit: Outfit
    carried: CarriedSize


class Lying(NamedTuple):
    """How a person lies in T frames.

    Attributes:
        lies: whether the person lies, shape (T,).
        lift: height of the bed or sofa below, metres, shape (T,); 0 is the floor.
    """

    lies: NDArray[np.bool_]
    lift: NDArray[np.float64]


class SyntheticPerson(NamedTuple):
    """One person in T frames.

    Attributes:
        rest: the dressed body in the rest pose.
        rotations: the bones' rotations relative to their parents, shape (T, B, 3, 3). The root's
            rotation maps the person's axes to a level frame: x right, y down, z away from the
            camera.
        pelvis_heights: height of the pelvis above the floor, metres, shape (T,).
        extent: the outermost points, relative to the floor below the pelvis.
        joints: the joints, in the same frame, metres, shape (T, 20, 3).
        seated: whether the person sits on a seat, shape (T,).
        attire: what the person wears and carries; None if only tight clothes.
        lying: how a person lies, or None if the person never does.
        path: where the person walks, relative to the position in the placement, metres, shape
            (T, 3); None for a person who stays. `extent` and `joints` include it.
    """

    rest: RestBody
    rotations: NDArray[np.float64]
    pelvis_heights: NDArray[np.float64]
    extent: PersonExtent
    joints: NDArray[np.float64]
    seated: NDArray[np.bool_]
    attire: Attire | None = None
    lying: Lying | None = None
    path: NDArray[np.float64] | None = None

    def single_frame(self, frame: int) -> 'SyntheticPerson':
        """Return the person with one frame only."""
        one = slice(frame, frame + 1)
        return SyntheticPerson(
            self.rest,
            self.rotations[one],
            self.pelvis_heights[one],
            PersonExtent(self.extent.points[one], self.extent.trunk[one]),
            self.joints[one],
            self.seated[one],
            self.attire,
            self.lying and Lying(self.lying.lies[one], self.lying.lift[one]),
            None if self.path is None else self.path[one],
        )

    def along(self, path: NDArray[np.float64]) -> 'SyntheticPerson':
        """Return the person who walks along a path, metres, shape (T, 3)."""
        extent = PersonExtent(self.extent.points + path[:, None], self.extent.trunk + path)
        return self._replace(extent=extent, joints=self.joints + path[:, None], path=path)


class PersonSampler:
    """Samples people and their motion for clips."""

    def __init__(self, settings: SyntheticSettings) -> None:
        """Load the body model and the motion capture that `settings` name.

        Raises:
            InputError: the motion capture files cannot be used.
        """
        self.body = load_body()
        self._population = Population(settings.age, settings.stature)
        self._yaw = float(np.radians(settings.yaw))
        self._rate = settings.rate
        self._body_sampler = BodySampler(self.body)
        self._clothes_regions = clothes_regions(self.body)
        self._hull = hull_vertices(self.body)
        self._hull_body = self.body._replace(
            skin_bones=self.body.skin_bones[self._hull],
            skin_weights=self.body.skin_weights[self._hull],
        )
        self._spread = spread_vertices(self.body)
        self._spread_body = self.body._replace(
            skin_bones=self.body.skin_bones[self._spread],
            skin_weights=self.body.skin_weights[self._spread],
        )
        self._spread_regions = regions_of(self._spread_body)
        self._mocap = _selected_mocap(settings)
        self._mocap_fraction = settings.mocap_fraction
        self._resting = RESTING if settings.furniture else None

    def sample_body(self, random: np.random.Generator) -> RestBody:
        """Sample a dressed body in the rest pose.

        Raises:
            InputError: the ages and the statures of the settings exclude each other.
        """
        undressed = self._body_sampler.sample(self._population, random)
        return dress(self._clothes_regions, undressed, random)

    def sample_attire(self, rest: RestBody, random: np.random.Generator) -> Attire:
        """Sample what a person wears and carries besides tight clothes."""
        stream = RandomStream(random)
        garments = sample_garments(self.body, rest, stream)
        on_seat = [each for each in garments if not each.behind]
        return Attire(
            outfit_of(self.body, rest, garments),
            outfit_of(self.body, rest, on_seat),
            sample_carried(stream),
        )

    def sample_person(
        self, rest: RestBody, count: int, random: np.random.Generator
    ) -> SyntheticPerson:
        """Sample the motion of a body in `count` frames.

        Raises:
            InputError: a motion capture file cannot be used.
        """
        captured = random.random() < self._mocap_fraction
        given = (self.body, rest, count, self._rate, self._yaw, random)
        if captured and self._mocap:
            motion = self._mocap.sample(*given)
        else:
            motion = sample_motion(*given, fractions=self._resting)
        person = self.stand_on_floor(rest, motion)
        if motion.lying is not None and motion.lying.any():
            return self._on_beds(person, motion.lying, random)
        return person

    def sample_walker(
        self, rest: RestBody, path: WalkingPath, random: np.random.Generator
    ) -> SyntheticPerson:
        """Sample a person who walks along a path, with the arms of motion capture if there is any.

        Raises:
            InputError: a motion capture file cannot be used.
        """
        motion = walking_motion(self.body, rest, path.distance, path.yaw)
        if random.random() < self._mocap_fraction and self._mocap:
            count = len(path.yaw)
            moved = self._mocap.sample(self.body, rest, count, self._rate, self._yaw, random)
            motion = Motion(moved.rotations, path.yaw)
        return self.stand_on_floor(rest, motion).along(path.positions)

    def _on_beds(
        self, person: SyntheticPerson, lying: NDArray[np.bool_], random: np.random.Generator
    ) -> SyntheticPerson:
        """Raise a person in some of the frames with `lying` to the height of a bed."""
        frames = 1 if self._rate else len(lying)
        low, high = _BED_HEIGHTS
        raised = (random.random(frames) < _BEDDED_FRACTION) * (
            low + (high - low) * random.random(frames)
        )
        lift = np.where(lying, raised, 0.0)
        up = np.array([0.0, -1.0, 0.0]) * lift[:, None, None]
        extent = PersonExtent(person.extent.points + up, person.extent.trunk + up[:, 0])
        return person._replace(
            pelvis_heights=person.pelvis_heights + lift,
            extent=extent,
            joints=person.joints + up,
            lying=Lying(lying, lift),
        )

    def stand_on_floor(self, rest: RestBody, motion: Motion) -> SyntheticPerson:
        """Return the person who moves by `motion`, lowest point on the floor in each frame."""
        rotations = motion.rotations.copy()
        rotations[:, 0] = _yaw_rotations(motion.yaw) @ rotations[:, 0]
        hull = rest._replace(vertices=rest.vertices[self._hull])
        posed = [pose_body(self._hull_body, hull, each, np.zeros(3)) for each in rotations]
        points = np.array([each.vertices for each in posed])
        pelvis_heights = points[:, :, 1].max(axis=1)
        points[..., 1] -= pelvis_heights[:, None]
        joints = np.array([each.joints for each in posed])
        joints[..., 1] -= pelvis_heights[:, None]
        extent = PersonExtent(points, joints[:, JOINT_NUMBERS['torso']])
        seated = looks_seated(joints) if motion.seated is None else motion.seated
        return SyntheticPerson(rest, rotations, pelvis_heights, extent, joints, seated)

    def occupant(
        self, person: SyntheticPerson, placement: ScenePlacement, number: int
    ) -> Occupant:
        """Return the space that a person takes up in all frames.

        Args:
            person: the person.
            placement: the positions of camera and people.
            number: the number of the person's position in `placement`.
        """
        spread, body = self._spread, self._spread_body
        rest = person.rest._replace(vertices=person.rest.vertices[spread])
        position = placement.positions[number]
        points = np.array(
            [
                pose_body(body, rest, each, position - np.array([0.0, height, 0.0])).vertices
                for each, height in zip(person.rotations, person.pelvis_heights, strict=True)
            ]
        )
        return Occupant(
            points,
            self._spread_regions,
            person.joints + position,
            seated=bool(person.seated.all()),
            raised=person.lying is not None and bool(person.lying.lift.all()),
        )

    def pose_in_camera(
        self, person: SyntheticPerson, frame: int, placement: ScenePlacement, number: int
    ) -> PosedBody:
        """Return the body of one frame in the optical frame.

        Args:
            person: the person.
            frame: the frame's number.
            placement: the positions of camera and people.
            number: the number of the person's position in `placement`.
        """
        rotations = person.rotations[frame].copy()
        rotations[0] = placement.tilt @ rotations[0]
        height = np.array([0.0, person.pelvis_heights[frame], 0.0])
        path = 0.0 if person.path is None else person.path[frame]
        position = placement.tilt @ (placement.positions[number] + path - height)
        return pose_body(self.body, person.rest, rotations, position)


def attire_meshes(
    person: SyntheticPerson, frame: int, posed: PosedBody, down: NDArray[np.float64]
) -> list[tuple[Mesh, NDArray[np.int32]]]:
    """Return the surfaces of what a person wears and carries, with the part of each triangle.

    Args:
        person: the person.
        frame: the frame's number.
        posed: the body in that frame.
        down: the direction of gravity in the body's frame, shape (3,).
    """
    if person.attire is None:
        return []
    attire = person.attire
    resting = person.seated[frame] or (person.lying is not None and person.lying.lies[frame])
    outfit = attire.seated_outfit if resting else attire.outfit
    worn = Mesh(outfit.posed(person.rest, posed), outfit.triangles.astype(np.int64))
    meshes = [(worn, outfit.parts)]
    if (
        len(person.seated) == 1 and person.lying is None
    ):  # in a video, a load would come and go with the pose
        load = carried_load(attire.carried, posed.joints, down)
        meshes.append((load.mesh, load.parts))
    return meshes


def looks_seated(joints: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return whether a person would fall backwards without a seat, in each frame, shape (T,).

    Both thighs are roughly level, and the trunk is well behind the ankles.

    Args:
        joints: in a level frame, y down, metres, shape (T, 20, 3).
    """
    at = {name: joints[:, number] for name, number in JOINT_NUMBERS.items()}
    across = (at['l_hip'] - at['r_hip'])[:, [0, 2]]
    across /= np.sqrt((across**2).sum(axis=1, keepdims=True)) + 1e-9
    ahead = np.stack([across[:, 1], -across[:, 0]], axis=1)
    trunk = (at['pelvis'] + at['torso'] + at['neck']) / 3
    seated = np.ones(len(joints), bool)
    for side in ('l', 'r'):
        thigh = at[f'{side}_knee'] - at[f'{side}_hip']
        length = np.sqrt((thigh**2).sum(axis=1)) + 1e-9
        behind = ((at[f'{side}_ankle'] - trunk)[:, [0, 2]] * ahead).sum(axis=1)
        seated &= (np.abs(thigh[:, 1]) < _LEVEL_THIGH * length) & (behind > _BEHIND * length)
        seated &= at[f'{side}_hip'][:, 1] < at[f'{side}_ankle'][:, 1] - 0.5 * length
    return seated


def spread_vertices(body: BodyModel) -> NDArray[np.int64]:
    """Return the numbers of vertices that are evenly spread over the skin, one per small cube."""
    vertices = body.mean[: len(body.skin_bones)].astype(np.float64)
    cubes = np.floor(vertices / _SPREAD).astype(np.int64)
    chosen: NDArray[np.int64] = np.unique(cubes, axis=0, return_index=True)[1]
    return np.sort(chosen)


def hull_vertices(body: BodyModel) -> NDArray[np.int64]:
    """Return the numbers of vertices whose convex hull approximates the skin's in any pose.

    Of the vertices that follow each bone most, these are the outermost ones in 26 directions.

    Returns:
        Numbers of vertices, ascending, shape (P,).
    """
    vertices = body.mean[: len(body.skin_bones)].astype(np.float64)
    # Rounded, so that the last bits, which differ between libraries, do not decide.
    along = np.round(vertices @ _DIRECTIONS.T, 9)
    bones = body.skin_bones[:, 0]
    chosen: set[int] = set()
    for bone in np.unique(bones):
        own = np.flatnonzero(bones == bone)
        chosen.update(own[along[own].argmax(axis=0)].tolist())
    return np.array(sorted(chosen))


def _yaw_rotations(yaw: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the rotations from people's axes (x left, y up, z forward) to the level frame.

    In the level frame, x is right, y is down and z is away from the camera. A person with yaw 0
    faces the camera and has the left hand at image right.
    """
    rotations = np.zeros((len(yaw), 3, 3))
    rotations[:, 0, 0], rotations[:, 0, 2] = np.cos(yaw), np.sin(yaw)
    rotations[:, 1, 1] = -1.0
    rotations[:, 2, 0], rotations[:, 2, 2] = np.sin(yaw), -np.cos(yaw)
    return rotations


def _selected_mocap(settings: SyntheticSettings) -> Mocap | None:
    if settings.mocap is None:
        return None
    mocap = load_mocap(settings.mocap, settings.mocap_mapping)
    if settings.mocap_only:
        mocap = mocap.only(settings.mocap_only)
    if settings.mocap_without:
        mocap = mocap.without(settings.mocap_without)
    return mocap
