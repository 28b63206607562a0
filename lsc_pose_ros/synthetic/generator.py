"""Synthetic frames: people before a depth camera, with exact masks and joints."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.people import Cast, Person
from lsc_pose_ros.synthetic.scene.image import Image
from lsc_pose_ros.synthetic.scene.mesh_render import Mesh, render_meshes
from lsc_pose_ros.synthetic.scene.placement import Stage, View, set_stage
from lsc_pose_ros.synthetic.scene.room import Scene, add_scene, draw_scene
from lsc_pose_ros.synthetic.sensors.sensors import sense
from lsc_pose_ros.synthetic.settings import (
    SyntheticSettings,
    camera_of,
    check,
    clip_length_of,
    sensor_of,
)

__all__ = ['FRAME_ID', 'SyntheticSettings', 'camera_of', 'synthetic_frames']

FRAME_ID = 'camera_depth_optical_frame'

# Recordings start here (2023-11-14), so that the same seed gives the same file.
_EPOCH = 1_700_000_000_000_000_000

_STILL_RATE = 30.0
"""Stamps of frames that have nothing to do with each other are so many a second."""

_REDRAWN = 10  # times that people who find no place do something else instead


def synthetic_frames(settings: SyntheticSettings) -> Iterator[Frame]:
    """Generate frames with exact joints, all 20, hidden ones too; the same for the same settings.

    The first frames do not depend on how many follow.

    Args:
        settings: what to generate.

    Returns:
        The frames; depth is in whole millimetres, people are numbered from 1.

    Raises:
        InputError: the settings contradict themselves.
    """
    check(settings)
    return _frames(_Studio(settings))


class _Studio:
    """What serves all clips."""

    def __init__(self, settings: SyntheticSettings) -> None:
        self.settings = settings
        self.sensor = sensor_of(settings)
        self.camera = camera_of(settings)
        self.cast = Cast(settings)
        up, down = np.radians(settings.camera_tilt)
        self.view = View(
            self.camera,
            self.sensor.width,
            self.sensor.height,
            settings.distance,
            settings.camera_height,
            (float(up), float(down)),
            settings.cropped,
        )


class _Take(NamedTuple):
    """One or more frames in a row with people and camera in place."""

    people: list[Person]
    stage: Stage
    scene: Scene | None


class _Chances(NamedTuple):
    """Sources of chance that do not disturb one another: a room changes nobody's pose."""

    world: np.random.Generator
    sensor: np.random.Generator
    scene: np.random.Generator


def _frames(studio: _Studio) -> Iterator[Frame]:
    settings = studio.settings
    length = clip_length_of(settings)
    for clip in range(-(-settings.frames // length)):
        for number, frame in enumerate(_clip(studio, clip), start=clip * length):
            if number >= settings.frames:
                return
            yield frame._replace(
                stamp=_EPOCH + round(number * 1e9 / (settings.rate or _STILL_RATE))
            )


def _clip(studio: _Studio, clip: int) -> Iterator[Frame]:
    """Generate all frames of one clip; they depend on the seed and the clip's number alone."""
    source = np.random.SeedSequence([studio.settings.seed, clip])
    chances = _Chances(*(np.random.Generator(np.random.PCG64(s)) for s in source.spawn(3)))
    length = clip_length_of(studio.settings)
    rests = [studio.cast.draw(chances.world) for _ in range(studio.settings.people)]
    people = [studio.cast.move(rest, length, chances.world) for rest in rests]
    if studio.settings.rate is not None:
        takes = [people]
    else:  # people and camera are elsewhere in every frame
        takes = [[person.at(frame) for person in people] for frame in range(length)]
    for actors in takes:
        take = _take(studio, actors, chances)
        for frame in range(length // len(takes)):
            yield _shoot(studio, take, frame, chances.sensor)


def _take(studio: _Studio, people: list[Person], chances: _Chances) -> _Take:
    """Draw where people are; where there is no place for what they do, they do something else."""
    count = len(people[0].lifts)
    for left in reversed(range(_REDRAWN)):
        actors = [person.actor for person in people]
        try:
            stage = set_stage(actors, studio.view, chances.world)
        except InputError:
            if not left:
                raise
            people = [studio.cast.move(each.rest, count, chances.world) for each in people]
            continue
        break
    scene = draw_scene(actors, stage, chances.scene) if studio.settings.background else None
    return _Take(people, stage, scene)


def _shoot(studio: _Studio, take: _Take, index: int, random: np.random.Generator) -> Frame:
    bodies = np.arange(1, len(take.people) + 1)
    posed = [
        studio.cast.before_camera(person, index, take.stage, number)
        for number, person in enumerate(take.people)
    ]
    meshes = [
        Mesh(body.vertices, studio.cast.body.triangles, int(number))
        for number, body in zip(bodies, posed, strict=True)
    ]
    image = render_meshes(meshes, studio.camera, studio.sensor.width, studio.sensor.height)
    if take.scene is not None:
        add_scene(image, take.scene, take.stage.tilt, studio.camera)
    image = _in_millimetres(sense(studio.sensor.noise, image, studio.camera, random))
    joints = np.array([body.joints for body in posed])
    return Frame(
        stamp=0,
        frame_id=FRAME_ID,
        depth=image.depth,
        labels=image.labels,
        camera=studio.camera,
        ground_truth=Skeletons(
            bodies.astype(np.uint16),
            np.arange(len(JOINT_NAMES), dtype=np.uint16),
            joints.astype(np.float32),
            np.ones(joints.shape[:2], np.float32),
        ),
    )


def _in_millimetres(image: Image) -> Image:
    """Return `image` as a 16UC1 message can hold it."""
    whole = np.rint(image.depth.astype(np.float64) * 1000)
    return image._replace(depth=(whole / 1000).astype(np.float32))
