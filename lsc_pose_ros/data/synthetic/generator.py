"""Synthetic frames: clip after clip, each with new people, a new motion and a new camera."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.camera import Intrinsics
from lsc_pose_ros.core.frame import Frame
from lsc_pose_ros.core.joints import JOINT_NAMES
from lsc_pose_ros.core.skeletons import Skeletons
from lsc_pose_ros.data.synthetic.body import CHILD_STATURE, draw_body
from lsc_pose_ros.data.synthetic.motion import draw_motion
from lsc_pose_ros.data.synthetic.pose import (
    Placement,
    joint_positions,
    place_segments,
    sole_height,
)
from lsc_pose_ros.data.synthetic.render import Image, render
from lsc_pose_ros.data.synthetic.sensor import kinect_noise
from lsc_pose_ros.data.synthetic.solids import RoundCones, pose_solids
from lsc_pose_ros.data.synthetic.stage import Spheres, Stage, View, holding_spheres, set_stage
from lsc_pose_ros.errors import InputError

FRAME_ID = 'camera_depth_optical_frame'
NOISES = ('kinect', 'none')
MOST_PEOPLE = 8

# Recordings start here (2023-11-14), so that the same seed gives the same file.
_EPOCH = 1_700_000_000_000_000_000


class SyntheticSettings(NamedTuple):
    """What to generate.

    Attributes:
        frames: how many.
        seed: of everything that is drawn.
        people: in every frame.
        width: of the image, pixels.
        height: of the image, pixels.
        field_of_view: horizontal, degrees; the default is a Kinect's.
        noise: 'kinect' or 'none'.
        yaw: people face at most so far aside of the camera, degrees; 180 is all round.
        distance: the nearest and the farthest that a person stands, metres.
        stature: the smallest and the tallest, metres.
        clip_length: new people come every so many frames.
        rate: frames a second.
        cropped: people may be cut off by the image's edge.
    """

    frames: int = 300
    seed: int = 0
    people: int = 1
    width: int = 320
    height: int = 240
    field_of_view: float = 58.5
    noise: str = 'kinect'
    yaw: float = 60.0
    distance: tuple[float, float] = (1.5, 4.0)
    stature: tuple[float, float] = (CHILD_STATURE, 1.95)
    clip_length: int = 30
    rate: float = 30.0
    cropped: bool = False


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
    return _frames(settings)


def camera_of(settings: SyntheticSettings) -> Intrinsics:
    """Return the camera: square pixels, the principal point in the middle of the image."""
    focal = 0.5 * settings.width / np.tan(np.radians(0.5 * settings.field_of_view))
    return Intrinsics(
        float(focal), float(focal), 0.5 * (settings.width - 1), 0.5 * (settings.height - 1)
    )


def check(settings: SyntheticSettings) -> None:
    """Check settings.

    Raises:
        InputError: one of them cannot be met.
    """
    near, far = settings.distance
    small, tall = settings.stature
    demands = (
        (settings.frames >= 1, f'frames is {settings.frames}; give 1 or more'),
        (settings.seed >= 0, f'seed is {settings.seed}; give 0 or more'),
        (
            1 <= settings.people <= MOST_PEOPLE,
            f'people is {settings.people}; give 1 to {MOST_PEOPLE}',
        ),
        (
            min(settings.width, settings.height) >= 16 and max(settings[3:5]) <= 4096,
            f'size is {settings.width}x{settings.height}; give 16x16 to 4096x4096 pixels',
        ),
        (
            10 <= settings.field_of_view <= 150,
            f'the field of view is {settings.field_of_view:g} degrees; give 10 to 150',
        ),
        (
            settings.noise in NOISES,
            f'noise is {settings.noise}; give one of {", ".join(NOISES)}',
        ),
        (0 <= settings.yaw <= 180, f'yaw is {settings.yaw:g} degrees; give 0 to 180'),
        (
            0.5 <= near <= far <= 20,
            f'distance is {near:g} to {far:g} m; give the nearer first, both within 0.5 to 20',
        ),
        (
            0.8 <= small <= tall <= 2.2,
            f'stature is {small:g} to {tall:g} m; give the smaller first, both within 0.8 to 2.2',
        ),
        (
            settings.clip_length >= 1,
            f'the clip length is {settings.clip_length} frames; give 1 or more',
        ),
        (
            1 <= settings.rate <= 1000,
            f'the rate is {settings.rate:g} frames a second; give 1 to 1000',
        ),
    )
    for met, complaint in demands:
        if not met:
            raise InputError(complaint)


class _Person(NamedTuple):
    """One person of a clip of T frames, in the level frame about where the person stands."""

    cones: RoundCones
    joints: NDArray[np.float64]
    spheres: Spheres


def _frames(settings: SyntheticSettings) -> Iterator[Frame]:
    clips = range(-(-settings.frames // settings.clip_length))
    for clip in clips:
        first = clip * settings.clip_length
        for index, frame in enumerate(_clip(settings, clip), start=first):
            if index >= settings.frames:
                return
            yield frame


def _clip(settings: SyntheticSettings, clip: int) -> Iterator[Frame]:
    """Generate all frames of one clip; they depend on the seed and the clip's number alone."""
    source = np.random.SeedSequence([settings.seed, clip])
    world, sensor = (np.random.Generator(np.random.PCG64(s)) for s in source.spawn(2))
    people = [_draw_person(settings, world) for _ in range(settings.people)]
    camera = camera_of(settings)
    view = View(camera, settings.width, settings.height, settings.distance, settings.cropped)
    stage = set_stage([person.spheres for person in people], view, world)
    numbers = np.arange(1, len(people) + 1)
    for index in range(settings.clip_length):
        cones, bodies, joints = _before_camera(people, stage, index)
        image = render(cones, bodies, camera, settings.width, settings.height)
        if settings.noise == 'kinect':
            image = kinect_noise(image, camera, sensor)
        image = _in_millimetres(image)
        number = clip * settings.clip_length + index
        yield Frame(
            stamp=_EPOCH + round(number * 1e9 / settings.rate),
            frame_id=FRAME_ID,
            depth=image.depth,
            labels=image.labels,
            camera=camera,
            truth=Skeletons(
                numbers.astype(np.uint16),
                np.arange(len(JOINT_NAMES), dtype=np.uint16),
                joints.astype(np.float32),
                np.ones(joints.shape[:2], np.float32),
            ),
        )


def _draw_person(settings: SyntheticSettings, random: np.random.Generator) -> _Person:
    small, tall = settings.stature
    body = draw_body(random, small + (tall - small) * float(random.random()))
    yaw = np.radians(settings.yaw)
    motion = draw_motion(body, settings.clip_length, settings.rate, yaw, random)
    upright = place_segments(body, motion.angles)
    level = _stand(upright, sole_height(body, upright), motion.yaw)
    cones = pose_solids(body.solids, level)
    return _Person(cones, joint_positions(body, level), holding_spheres(cones))


def _stand(
    placement: Placement, soles: NDArray[np.float64], yaw: NDArray[np.float64]
) -> Placement:
    """Turn a person (x left, y up, z forward) into a level frame and onto its floor.

    The level frame is x right, y down, z away from the camera, so a person with yaw 0 faces the
    camera and has the left hand at image right.
    """
    cosine, sine, zero = np.cos(yaw), np.sin(yaw), np.zeros_like(yaw)
    turn = np.stack(
        [
            np.stack([cosine, zero, sine], axis=1),
            np.stack([zero, zero - 1, zero], axis=1),
            np.stack([sine, zero, -cosine], axis=1),
        ],
        axis=1,
    )
    origins = placement.origins.copy()
    origins[..., 1] -= soles[:, None]
    return Placement(np.einsum('tkl,tsl->tsk', turn, origins), turn[:, None] @ placement.rotations)


def _before_camera(
    people: list[_Person], stage: Stage, index: int
) -> tuple[RoundCones, NDArray[np.int32], NDArray[np.float64]]:
    """Return one frame in the optical frame: all solids, whose each is, joints (N, 20, 3)."""
    parts, bodies, joints = [], [], []
    for number, (person, offset) in enumerate(zip(people, stage.offsets, strict=True), start=1):
        cones = person.cones
        parts.append(
            RoundCones(
                (cones.origins[index] + offset) @ stage.tilt.T,
                cones.inward[index] @ stage.tilt.T,
                cones.length,
                cones.radii,
            )
        )
        bodies.append(np.full(len(cones.length), number, np.int32))
        joints.append((person.joints[index] + offset) @ stage.tilt.T)
    together = RoundCones(*(np.concatenate(fields) for fields in zip(*parts, strict=True)))
    return together, np.concatenate(bodies), np.round(np.array(joints), 7)


def _in_millimetres(image: Image) -> Image:
    """Return `image` as a 16UC1 message can hold it."""
    whole = np.rint(image.depth.astype(np.float64) * 1000)
    return image._replace(depth=(whole / 1000).astype(np.float32))
