"""The people of a clip: shaped, dressed and in motion, standing on the floor."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.synthetic.body.body_file import Body, load_body
from lsc_pose_ros.synthetic.body.body_mesh import Posed, Rest, pose_body
from lsc_pose_ros.synthetic.body.clothes import dress, open_wardrobe
from lsc_pose_ros.synthetic.body.population import Population, Tailor
from lsc_pose_ros.synthetic.mocap.mocap import Mocap, load_mocap
from lsc_pose_ros.synthetic.motion.motion import Motion, draw_motion
from lsc_pose_ros.synthetic.scene.placement import Actor, Stage
from lsc_pose_ros.synthetic.settings import SyntheticSettings

# Vertices that may be outermost, and so stand for all of the skin: of those that follow a bone
# most, those that lie farthest in each of these directions.
_DIRECTIONS = np.array(
    [(x, y, z) for x in (-1, 0, 1) for y in (-1, 0, 1) for z in (-1, 0, 1) if x or y or z]
)


class Person(NamedTuple):
    """One person in T frames.

    Attributes:
        rest: at rest, dressed.
        rotations: of the bones against their parents, the root's from the person's axes into a
            level frame, x right, y down, z away from the camera, shape (T, B, 3, 3).
        lifts: how high the pelvis is over the floor, metres, shape (T,).
        actor: the outermost points, over the floor under the pelvis.
    """

    rest: Rest
    rotations: NDArray[np.float64]
    lifts: NDArray[np.float64]
    actor: Actor

    def at(self, frame: int) -> 'Person':
        """Return the person in one frame alone."""
        one = slice(frame, frame + 1)
        return Person(
            self.rest,
            self.rotations[one],
            self.lifts[one],
            Actor(self.actor.points[one], self.actor.trunk[one]),
        )


class Cast:
    """Draws people for clips."""

    def __init__(self, settings: SyntheticSettings) -> None:
        """Draw people as `settings` say.

        Raises:
            InputError: the motion capture files cannot be used.
        """
        self.body = load_body()
        self._population = Population(settings.age, settings.stature)
        self._yaw = float(np.radians(settings.yaw))
        self._rate = settings.rate
        self._tailor = Tailor(self.body)
        self._wardrobe = open_wardrobe(self.body)
        self._outermost = outermost_vertices(self.body)
        self._outline = self.body._replace(
            skin_bones=self.body.skin_bones[self._outermost],
            skin_weights=self.body.skin_weights[self._outermost],
        )
        self._mocap = _mocap(settings)
        self._mocap_share = settings.mocap_share

    def draw(self, random: np.random.Generator) -> Rest:
        """Draw a person at rest, dressed.

        Raises:
            InputError: there is nobody of such an age and stature.
        """
        return dress(self._wardrobe, self._tailor.draw(self._population, random), random)

    def move(self, rest: Rest, count: int, random: np.random.Generator) -> Person:
        """Draw what a person does in `count` frames.

        Raises:
            InputError: a motion capture file cannot be used.
        """
        captured = random.random() < self._mocap_share
        draw = self._mocap.draw if captured and self._mocap else draw_motion
        motion = draw(self.body, rest, count, self._rate, self._yaw, random)
        return self.place(rest, motion)

    def place(self, rest: Rest, motion: Motion) -> Person:
        """Return a person in motion, on the floor."""
        rotations = motion.rotations.copy()
        rotations[:, 0] = _level_turns(motion.yaw) @ rotations[:, 0]
        seen = rest._replace(vertices=rest.vertices[self._outermost])
        posed = [pose_body(self._outline, seen, turns, np.zeros(3)) for turns in rotations]
        points = np.array([each.vertices for each in posed])
        lifts = points[:, :, 1].max(axis=1)
        points[..., 1] -= lifts[:, None]
        trunk = np.array([each.joints[JOINT_NUMBERS['torso']] for each in posed])
        trunk[:, 1] -= lifts
        return Person(rest, rotations, lifts, Actor(points, trunk))

    def before_camera(self, person: Person, frame: int, stage: Stage, number: int) -> Posed:
        """Return one frame of the person who stands at the stage's place `number`.

        The body is in the optical frame.
        """
        rotations = person.rotations[frame].copy()
        rotations[0] = stage.tilt @ rotations[0]
        offset = stage.offsets[number] - np.array([0.0, person.lifts[frame], 0.0])
        return pose_body(self.body, person.rest, rotations, stage.tilt @ offset)


def outermost_vertices(body: Body) -> NDArray[np.int64]:
    """Return the numbers of vertices, shape (P,), whose hull in any pose is about the skin's."""
    vertices = body.mean[: len(body.skin_bones)].astype(np.float64)
    # Rounded, so that the last bits, which differ between libraries, do not choose.
    along = np.round(vertices @ _DIRECTIONS.T, 9)
    bones = body.skin_bones[:, 0]
    chosen: set[int] = set()
    for bone in np.unique(bones):
        own = np.flatnonzero(bones == bone)
        chosen.update(own[along[own].argmax(axis=0)].tolist())
    return np.array(sorted(chosen))


def _level_turns(yaw: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the turns from people's axes (x left, y up, z forward) into the level frame.

    That is x right, y down, z away from the camera: who has yaw 0 faces the camera and has the
    left hand at image right.
    """
    turns = np.zeros((len(yaw), 3, 3))
    turns[:, 0, 0], turns[:, 0, 2] = np.cos(yaw), np.sin(yaw)
    turns[:, 1, 1] = -1.0
    turns[:, 2, 0], turns[:, 2, 2] = np.sin(yaw), -np.cos(yaw)
    return turns


def _mocap(settings: SyntheticSettings) -> Mocap | None:
    if settings.mocap is None:
        return None
    mocap = load_mocap(settings.mocap, settings.mocap_mapping)
    if settings.mocap_only:
        mocap = mocap.only(settings.mocap_only)
    if settings.mocap_without:
        mocap = mocap.without(settings.mocap_without)
    return mocap
