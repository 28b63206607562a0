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

"""Generates synthetic frames: people in front of a depth camera, with exact masks and joints."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.numerics.jit import exact_kernel
from lsc_pose_ros.synthetic.body.body_mesh import PosedBody, RestBody
from lsc_pose_ros.synthetic.body.skin_parts import skin_parts
from lsc_pose_ros.synthetic.people import PersonSampler, SyntheticPerson, attire_meshes
from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.depth_image import DepthImage
from lsc_pose_ros.synthetic.scene.depth_loss import DepthLoss, apply_loss, sample_loss
from lsc_pose_ros.synthetic.scene.framing import Framing, Margins, clear_margins, sample_framing
from lsc_pose_ros.synthetic.scene.furnishing import furnish
from lsc_pose_ros.synthetic.scene.joint_visibility import joint_visibility
from lsc_pose_ros.synthetic.scene.mesh_render import RenderMesh, draw_over, render_meshes
from lsc_pose_ros.synthetic.scene.near_plane import cut_at_near_plane
from lsc_pose_ros.synthetic.scene.pixel_codes import pixel_codes, split_codes
from lsc_pose_ros.synthetic.scene.placement import (
    CameraConstraints,
    ScenePlacement,
    sample_placement,
)
from lsc_pose_ros.synthetic.scene.room import Room, render_room, sample_room
from lsc_pose_ros.synthetic.scene.shapes import join
from lsc_pose_ros.synthetic.scene.walking_paths import sample_crossing_paths
from lsc_pose_ros.synthetic.sensors.sensors import apply_sensor
from lsc_pose_ros.synthetic.settings import (
    SyntheticSettings,
    camera_of,
    check,
    clip_length_of,
    sensor_of,
)
from lsc_pose_ros.synthetic.sloppy_masks import with_sloppy_masks

__all__ = [
    'FRAME_ID',
    'SyntheticScene',
    'SyntheticSettings',
    'camera_of',
    'synthetic_frames',
    'synthetic_scenes',
]

FRAME_ID = 'camera_depth_optical_frame'

# Recordings start at this time (2023-11-14), so that the same seed gives the same file.
_EPOCH = 1_700_000_000_000_000_000

_STILL_RATE = 30.0
"""Rate of the stamps if the frames are independent of each other, Hz."""

_FURNISHING_NUMBERS = 8192
"""Random numbers for the furniture of a room; more than a room needs."""

_JOINT_PARTS = np.arange(1, 1 + len(JOINT_NAMES), dtype=np.int32)
"""The part of each joint."""

_PLACEMENT_TRIES = 10
"""How many motions are sampled before a placement counts as impossible."""


class SyntheticScene(NamedTuple):
    """A synthetic frame and more of its ground truth than a recording holds.

    Attributes:
        frame: the frame.
        parts: the part of the body that a pixel shows, 1 + the joint's number, or NO_PART where
            the label is NO_BODY; shape (H, W). See `skin_parts`.
        visibility: whether each joint of each person is SEEN, HIDDEN_BY_BODY, HIDDEN or OUTSIDE,
            shape (N, 20). See `lsc_pose_ros.data_types.visibility` and `joint_visibility`.
    """

    frame: Frame
    parts: NDArray[np.uint8]
    visibility: NDArray[np.uint8]


def synthetic_frames(settings: SyntheticSettings) -> Iterator[Frame]:
    """Generate frames with the exact positions of all 20 joints, hidden ones included.

    The same settings give the same frames. The first frames do not depend on `settings.frames`.

    Args:
        settings: what to generate.

    Returns:
        The frames. Depth is in whole millimetres; people are numbered from 1.

    Raises:
        InputError: the settings contradict each other.
    """
    frames = (scene.frame for scene in synthetic_scenes(settings))
    return with_sloppy_masks(frames, settings.seed) if settings.sloppy_masks else frames


def synthetic_scenes(settings: SyntheticSettings) -> Iterator[SyntheticScene]:
    """Generate the frames of `synthetic_frames`, always with exact masks, parts and visibility.

    Args:
        settings: what to generate.

    Raises:
        InputError: the settings contradict each other.
    """
    check(settings)
    return _scenes(_ClipGenerator(settings))


class _SceneState(NamedTuple):
    """People, camera and room in one or more successive frames."""

    people: list[SyntheticPerson]
    placement: ScenePlacement
    room: Room | None
    furniture: tuple[RenderMesh, ...] = ()
    margins: Margins = Margins()
    loss: DepthLoss = DepthLoss()


class _Generators(NamedTuple):
    """Independent random generators: whether there is a room does not change the people."""

    people: np.random.Generator
    sensor: np.random.Generator
    room: np.random.Generator


class _ClipGenerator:
    """Generates the frames of each clip from the seed and the clip's number."""

    def __init__(self, settings: SyntheticSettings) -> None:
        self.settings = settings
        self.length = clip_length_of(settings)
        self._sensor = sensor_of(settings)
        self._camera = camera_of(settings)
        self._sampler = PersonSampler(settings)
        self._parts = skin_parts(self._sampler.body)
        up, down = np.radians(settings.camera_tilt)
        self._constraints = CameraConstraints(
            self._camera,
            self._sensor.width,
            self._sensor.height,
            settings.distance,
            settings.camera_height,
            (float(up), float(down)),
            settings.cropped,
        )

    def clip(self, number: int) -> Iterator[SyntheticScene]:
        """Generate all scenes of one clip."""
        source = np.random.SeedSequence([self.settings.seed, number])
        random = _Generators(*(np.random.Generator(np.random.PCG64(s)) for s in source.spawn(3)))
        bodies = [self._sampler.sample_body(random.people) for _ in range(self.settings.people)]
        if self.settings.crossing:
            state = self._cross(bodies, random)
            for frame in range(self.length):
                yield self._render(state, frame, random.sensor)
            return
        people = [self._sampler.sample_person(rest, self.length, random.people) for rest in bodies]
        if self.settings.furniture:
            people = [
                each._replace(attire=self._sampler.sample_attire(each.rest, random.people))
                for each in people
            ]
        if self.settings.rate is not None:
            groups = [people]
        else:  # each frame has its own placement
            groups = [
                [person.single_frame(frame) for person in people] for frame in range(self.length)
            ]
        for group in groups:
            place = self._furnish if self.settings.furniture else self._place
            state = place(group, random)
            for frame in range(self.length // len(groups)):
                yield self._render(state, frame, random.sensor)

    def _place(self, people: list[SyntheticPerson], random: _Generators) -> _SceneState:
        """Sample a placement and, if the settings want one, a room that hides nobody."""
        framings = [Framing(self._constraints)] * _PLACEMENT_TRIES
        people, placement = self._placement(people, framings, random)
        return _SceneState(people, placement, self._room(people, placement, random))

    def _cross(self, bodies: list[RestBody], random: _Generators) -> _SceneState:
        """Sample people who walk across the view."""
        seconds = np.arange(self.length) / (self.settings.rate or _STILL_RATE)
        crossing = sample_crossing_paths(len(bodies), seconds, self._constraints, random.people)
        people = [
            self._sampler.sample_walker(rest, path, random.people)
            for rest, path in zip(bodies, crossing.paths, strict=True)
        ]
        return _SceneState(
            people, crossing.placement, self._room(people, crossing.placement, random)
        )

    def _room(
        self, people: list[SyntheticPerson], placement: ScenePlacement, random: _Generators
    ) -> Room | None:
        """Sample a room that hides nobody, if the settings want one."""
        if not self.settings.background:
            return None
        return sample_room([person.extent for person in people], placement, random.room)

    def _furnish(self, people: list[SyntheticPerson], random: _Generators) -> _SceneState:
        """Sample a placement in a furnished room."""
        stream = RandomStream(random.room, _FURNISHING_NUMBERS)
        framing = sample_framing(self._constraints, stream)
        half = _PLACEMENT_TRIES // 2
        framings = [framing] * half + [framing.relaxed(self._constraints)] * half
        people, placement = self._placement(people, framings, random)
        occupants = [
            self._sampler.occupant(person, placement, number)
            for number, person in enumerate(people)
        ]
        view = float(np.arctan(0.5 * self._sensor.width / self._camera.fx))
        furnishing = furnish(occupants, placement.camera_height, view, stream)
        mesh = join([piece.mesh for piece in furnishing.pieces])
        seen = cut_at_near_plane(mesh._replace(vertices=mesh.vertices @ placement.tilt.T))
        drawn = RenderMesh(seen.vertices, seen.triangles.astype(np.uint16), NO_BODY)
        loss = sample_loss(len(people), stream)
        if self._sensor.noise == 'none':
            loss = DepthLoss()
        return _SceneState(people, placement, furnishing.walls, (drawn,), framing.margins, loss)

    def _placement(
        self,
        people: list[SyntheticPerson],
        framings: Sequence[Framing],
        random: _Generators,
    ) -> tuple[list[SyntheticPerson], ScenePlacement]:
        """Sample a placement; if none is possible, sample other motions of the same bodies.

        Each element of `framings` is tried once.

        Raises:
            InputError: no placement is possible.
        """
        for framing in framings[:-1]:
            extents = [framing.extent(person) for person in people]
            try:
                return people, sample_placement(extents, framing.constraints, random.people)
            except InputError:
                people = [self._move_otherwise(person, random) for person in people]
        extents = [framings[-1].extent(person) for person in people]
        return people, sample_placement(extents, framings[-1].constraints, random.people)

    def _move_otherwise(self, person: SyntheticPerson, random: _Generators) -> SyntheticPerson:
        """Return the same person with another motion."""
        count = len(person.pelvis_heights)
        moved = self._sampler.sample_person(person.rest, count, random.people)
        return moved._replace(attire=person.attire)

    def _render(
        self, state: _SceneState, index: int, random: np.random.Generator
    ) -> SyntheticScene:
        posed = [
            self._sampler.pose_in_camera(person, index, state.placement, number)
            for number, person in enumerate(state.people)
        ]
        alone = [
            self._draw(*self._body_meshes(state, index, number, body))
            for number, body in enumerate(posed)
        ]
        image = self._measure(state, alone, random)
        labels, parts = split_codes(image.labels)
        joints = np.array([body.joints for body in posed]).reshape(-1, len(JOINT_NAMES), 3)
        seen = np.zeros(joints.shape[:2], np.uint8)
        for number, each in enumerate(alone):
            codes = pixel_codes(1 + number, _JOINT_PARTS)
            seen[number] = joint_visibility(
                joints[number], codes, each, image, self._camera, state.margins
            )
        frame = Frame(
            stamp=0,
            frame_id=FRAME_ID,
            depth=image.depth,
            labels=labels,
            camera=self._camera,
            ground_truth=_ground_truth(joints, seen),
        )
        return SyntheticScene(frame, parts, seen)

    def _measure(
        self, state: _SceneState, bodies: list[DepthImage], random: np.random.Generator
    ) -> DepthImage:
        """Return what the sensor measures of the room and of `bodies`, which are drawn alone."""
        image = self._draw(*state.furniture)
        for body in bodies:
            draw_over(image, body)
        if state.room is not None:
            render_room(image, state.room, state.placement.tilt, self._camera)
        image = apply_sensor(self._sensor.noise, image, self._camera, random)
        apply_loss(image, state.loss, random)
        round_to_millimetres(image.depth)
        clear_margins(image, state.margins)
        return image

    def _body_meshes(
        self, state: _SceneState, index: int, number: int, body: PosedBody
    ) -> Iterator[RenderMesh]:
        """Yield the surfaces of a person and of what the person wears and carries."""
        codes = pixel_codes(1 + number, self._parts)
        yield RenderMesh(body.vertices, self._sampler.body.triangles, codes)
        down = state.placement.tilt[:, 1]
        for mesh, parts in attire_meshes(state.people[number], index, body, down):
            codes = pixel_codes(1 + number, parts)
            yield RenderMesh(mesh.vertices, mesh.triangles.astype(np.uint16), codes)

    def _draw(self, *meshes: RenderMesh) -> DepthImage:
        return render_meshes(meshes, self._camera, self._sensor.width, self._sensor.height)


def _ground_truth(joints: NDArray[np.float64], visibility: NDArray[np.uint8]) -> Skeletons:
    """Return the skeletons of people numbered from 1.

    Args:
        joints: positions, shape (N, 20, 3).
        visibility: of each joint, shape (N, 20).
    """
    return Skeletons(
        np.arange(1, len(joints) + 1, dtype=np.uint16),
        np.arange(len(JOINT_NAMES), dtype=np.uint16),
        joints.astype(np.float32),
        np.ones(joints.shape[:2], np.float32),
        visibility,
    )


def _scenes(generator: _ClipGenerator) -> Iterator[SyntheticScene]:
    settings, length = generator.settings, generator.length
    for clip in range(-(-settings.frames // length)):
        for number, scene in enumerate(generator.clip(clip), start=clip * length):
            if number >= settings.frames:
                return
            stamp = _EPOCH + round(number * 1e9 / (settings.rate or _STILL_RATE))
            yield scene._replace(frame=scene.frame._replace(stamp=stamp))


@exact_kernel
def round_to_millimetres(depth: NDArray[np.float32]) -> None:
    """Round depth to whole millimetres, in place, as in a 16UC1 message."""
    height, width = depth.shape
    for row in range(height):
        for column in range(width):
            depth[row, column] = np.rint(float(depth[row, column]) * 1000.0) / 1000.0
