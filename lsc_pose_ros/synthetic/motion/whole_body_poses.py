"""Whole poses: trunk and legs, then what the arms do, clear of each other."""

import numpy as np

from lsc_pose_ros.synthetic.body.self_collision import DEEPEST, Mannequin, deepest_overlap
from lsc_pose_ros.synthetic.motion.arm_gestures import draw_arms
from lsc_pose_ros.synthetic.motion.joint_angles import ANGLE_NUMBERS, ARMS, mirrored, within_limits
from lsc_pose_ros.synthetic.motion.lower_body_poses import Stance, draw_stance, let_arms_hang
from lsc_pose_ros.synthetic.sampling import Chances

_TRIES = 3  # for the arms of one stance


def draw_pose(mannequin: Mannequin, chances: Chances) -> Stance:
    """Draw a pose within what joints allow.

    Limbs may still go through the body, now and then: see `deepest_overlap`.

    Args:
        mannequin: the person's bones and flesh.
        chances: the source of chance.
    """
    is_mirrored = chances.happens(0.5)
    pose = _with_arms(mannequin, draw_stance(mannequin.rig, chances), chances)
    return pose._replace(angles=mirrored(pose.angles)) if is_mirrored else pose


def draw_gesture(mannequin: Mannequin, before: Stance, chances: Chances) -> Stance:
    """Draw what the arms may do next; legs stay, the trunk moves little, half the time one arm.

    Args:
        mannequin: the person's bones and flesh.
        before: the pose before.
        chances: the source of chance.
    """
    angles = before.angles.copy()
    let_arms_hang(angles)
    for name in ('bend', 'side', 'twist', 'nod', 'tilt', 'turn'):
        angles[ANGLE_NUMBERS[name]] += np.radians(chances.near(0, 6))
    kept = chances.choose(((0.5, None), (0.25, 0), (0.25, 1)))
    kind = 'stand' if before.kind == 'walk' else before.kind
    pose = _with_arms(mannequin, Stance(kind, angles), chances)
    if kept is not None:
        pose.angles[ARMS[kept]] = before.angles[ARMS[kept]]
    return pose


def overlap(mannequin: Mannequin, pose: Stance) -> float:
    """Return how deep a pose's limbs go through the body, metres.

    It is rounded, so that the last bits, which differ between libraries, do not choose poses.
    """
    return round(float(deepest_overlap(mannequin, pose.angles[None])[0]), 6)


def _with_arms(mannequin: Mannequin, stance: Stance, chances: Chances) -> Stance:
    """Return `stance` with what the arms do; of several, the first that is clear of the body."""
    for _ in range(_TRIES):
        pose = stance._replace(angles=within_limits(stance.angles))
        draw_arms(mannequin, pose, chances)
        pose = pose._replace(angles=within_limits(pose.angles))
        if overlap(mannequin, pose) <= DEEPEST:
            break
    return pose
