"""Training samples: silhouette points with their descriptors and the joints around them."""

from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.descriptor import DESCRIPTOR_SIZE
from lsc_pose_ros.core.estimator import bodies_in, find_shape
from lsc_pose_ros.core.frame import Frame
from lsc_pose_ros.core.settings import Settings
from lsc_pose_ros.core.skeletons import Skeletons
from lsc_pose_ros.errors import InputError


class Samples(NamedTuple):
    """S silhouette points of P labelled people, one person after the other.

    Attributes:
        levels: quantised descriptors, shape (360, S): a split reads one bin of many points.
        points: metres, divided by the person's rho_bar, shape (S, 3).
        person: whose point it is, shape (S,).
        joints: the people's joints, divided by their rho_bar, NaN where not labelled, (P, J, 3).
        scale: rho_bar of each person, metres, shape (P,).
    """

    levels: NDArray[np.uint8]
    points: NDArray[np.float32]
    person: NDArray[np.int32]
    joints: NDArray[np.float32]
    scale: NDArray[np.float32]


class Person(NamedTuple):
    """What one labelled person gives to training: as in Samples, for one."""

    levels: NDArray[np.uint8]
    points: NDArray[np.float32]
    joints: NDArray[np.float32]
    scale: float


def select_joints(truth: Skeletons, joints: NDArray[np.uint16]) -> NDArray[np.float32]:
    """Return the true places of `joints`, NaN where `truth` has no such joint, shape (B, J, 3)."""
    selected = np.full((len(truth.bodies), len(joints), 3), np.nan, np.float32)
    columns = {int(number): column for column, number in enumerate(truth.joints)}
    for j, number in enumerate(joints):
        if int(number) in columns:
            selected[:, j] = truth.positions[:, columns[int(number)]]
    return selected


def people_in(frame: Frame, joints: NDArray[np.uint16], settings: Settings) -> Iterator[Person]:
    """Yield the labelled people of `frame` that can be seen.

    Args:
        frame: a frame with truth.
        joints: the joints to learn, shape (J,).
        settings: how silhouettes and descriptors are computed.
    """
    if frame.truth is None:
        return
    places = select_joints(frame.truth, joints)
    everyone = settings._replace(query_points=settings.points)
    visible = set(bodies_in(frame.labels).tolist())
    for row, body in enumerate(frame.truth.bodies.tolist()):
        if body not in visible or np.isnan(places[row]).all():
            continue
        shape = find_shape(frame.depth, frame.labels, body, (frame.camera, everyone))
        if shape is not None:
            scale = np.float32(shape.scale)
            yield Person(
                shape.levels,
                shape.points / scale,
                places[row] / scale,
                shape.scale,
            )


def gather_samples(people: Iterable[Person]) -> Samples:
    """Return the samples of all `people`.

    Raises:
        InputError: there is nobody to learn from.
    """
    kept = list(people)
    if not kept:
        msg = (
            'no labelled person was found; training needs a recording with ground truth '
            'whose body numbers are those of the mask'
        )
        raise InputError(msg)
    counts = np.array([len(person.points) for person in kept])
    levels = np.empty((DESCRIPTOR_SIZE, counts.sum()), np.uint8)
    ends = np.cumsum(counts)
    for person, end in zip(kept, ends, strict=True):
        levels[:, end - len(person.points) : end] = person.levels.T
    return Samples(
        levels,
        np.concatenate([person.points for person in kept]),
        np.repeat(np.arange(len(kept), dtype=np.int32), counts),
        np.stack([person.joints for person in kept]),
        np.array([person.scale for person in kept], np.float32),
    )
