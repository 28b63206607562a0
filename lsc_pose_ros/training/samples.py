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

"""Training samples: silhouette points with their descriptors and the joints around them."""

import itertools
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.pose.estimator import bodies_in
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.stages import describe_body


class Samples(NamedTuple):
    """S silhouette points of P labelled people, one person after the other.

    Attributes:
        quantised: quantised descriptors, shape (F, S): a split reads one bin of many points. Rows
            that are to be filled later may follow.
        points: metres, divided by the person's rho_bar, shape (S, 3).
        person: whose point it is, shape (S,).
        joints: the people's joints, divided by their rho_bar, NaN where not labelled, (P, J, 3).
        scale: rho_bar of each person, metres, shape (P,).
    """

    quantised: NDArray[np.uint8]
    points: NDArray[np.float32]
    person: NDArray[np.int32]
    joints: NDArray[np.float32]
    scale: NDArray[np.float32]


class Person(NamedTuple):
    """What one labelled person gives to training: as in Samples, for one."""

    quantised: NDArray[np.uint8]
    points: NDArray[np.float32]
    joints: NDArray[np.float32]
    scale: float


def select_joints(ground_truth: Skeletons, joints: NDArray[np.uint16]) -> NDArray[np.float32]:
    """Return the positions of `joints`, NaN where `ground_truth` has no such joint, (B, J, 3)."""
    selected = np.full((len(ground_truth.bodies), len(joints), 3), np.nan, np.float32)
    columns = {int(number): column for column, number in enumerate(ground_truth.joints)}
    for j, number in enumerate(joints):
        if int(number) in columns:
            selected[:, j] = ground_truth.positions[:, columns[int(number)]]
    return selected


def people_in(frame: Frame, joints: NDArray[np.uint16], settings: Settings) -> Iterator[Person]:
    """Yield the labelled people of `frame` that can be seen.

    Args:
        frame: a frame with truth.
        joints: the joints to learn, shape (J,).
        settings: how silhouettes and descriptors are computed.
    """
    if frame.ground_truth is None:
        return
    places = select_joints(frame.ground_truth, joints)
    everyone = settings._replace(query_points=settings.points)
    visible = set(bodies_in(frame.labels).tolist())
    for row, body in enumerate(frame.ground_truth.bodies.tolist()):
        if body not in visible or np.isnan(places[row]).all():
            continue
        described = describe_body(frame.depth, frame.labels, frame.camera, body, everyone)
        if described is not None:
            scale = np.float32(described.scale)
            yield Person(
                described.quantised,
                described.points / scale,
                places[row] / scale,
                described.scale,
            )


def labelled_people(
    frames: Iterable[Frame], joints: NDArray[np.uint16], settings: Settings
) -> Iterator[Person]:
    """Yield the labelled people of all `frames`; the other arguments as `people_in`."""
    for frame in frames:
        yield from people_in(frame, joints, settings)


def most_samples(memory: float, joints: int, size: int) -> int:
    """Return how many samples training can hold in `memory` bytes.

    Args:
        memory: bytes.
        joints: J, how many joints are learnt.
        size: F, how many numbers describe a point.

    A sample needs its descriptor, point and person, its evidence twice while a node is split, its
    place in the order twice, and its share of the leaves' votes; the interpreter and the compiled
    kernels need the rest.
    """
    evidence = 8 + _SHARE_IN_REACH * joints * (1 + 4 * 4)
    for_sample = size + 16 + 2 * evidence + 2 * 4 + 120
    return max(1, int((memory - _WITHOUT_SAMPLES) / for_sample))


# Of how many joints a point has evidence: a fifth, in all views.
_SHARE_IN_REACH = 0.25

# Bytes that a process takes which has imported everything and compiled all kernels.
_WITHOUT_SAMPLES = 600e6


def gather_samples(people: Iterable[Person], most: int | None = None) -> Samples:
    """Return the samples of all `people`, at most `most` of them.

    Where there are more, every person keeps an even half of the points, or a quarter, and so on:
    many people are worth more than many points of each.

    Raises:
        InputError: there is nobody to learn from.
    """
    return split_samples(people, most, 0.0)[0]


def split_samples(
    people: Iterable[Person], most: int | None, share: float, spare: int = 0
) -> tuple[Samples, list[Person]]:
    """Return the samples of most `people`, and the people that are held out.

    Args:
        people: as `gather_samples`.
        most: as `gather_samples`, of both together.
        share: which share of the people is held out.
        spare: how many rows of the samples' levels are left free.

    Raises:
        InputError: there is nobody to learn from.
    """
    kept = _within(people, most)
    held = hold_out(len(kept), share)
    aside = [person for person, out in zip(kept, held, strict=True) if out]
    kept = [person for person, out in zip(kept, held, strict=True) if not out]
    return _join(kept, spare), aside


def hold_out(count: int, share: float) -> NDArray[np.bool_]:
    """Tell which of `count` people, in the order of their recording, are held out, (count,).

    Neighbouring frames are nearly equal, so that only whole stretches tell what the forest makes
    of what it has not seen; one stretch would be one person or one action. So it is the end of
    each of ten equal parts. Of few people, none.
    """
    held = np.zeros(count, np.bool_)
    edges = np.linspace(0, count, _STRETCHES + 1).astype(np.int64)
    for start, end in itertools.pairwise(edges.tolist()):
        held[end - round(share * (end - start)) : end] = True
    return held


# Into how many stretches those who are held out are divided.
_STRETCHES = 10


def _join(kept: list[Person], spare: int) -> Samples:
    """Return the samples of `kept`, which is emptied."""
    if not kept:
        msg = (
            'no labelled person was found; training needs a recording with ground truth '
            'whose body numbers are those of the mask'
        )
        raise InputError(msg)
    counts = np.array([len(person.points) for person in kept])
    ends = np.cumsum(counts)
    points = np.concatenate([person.points for person in kept])
    joints = np.stack([person.joints for person in kept])
    scale = np.array([person.scale for person in kept], np.float32)
    size = kept[0].quantised.shape[1]
    quantised = np.zeros((size + spare, ends[-1]), np.uint8)
    # From the last to the first, each forgotten once it is copied: memory is not needed twice.
    for end in ends[::-1]:
        person = kept.pop()
        quantised[:size, end - len(person.points) : end] = person.quantised.T
    return Samples(
        quantised, points, np.repeat(np.arange(len(counts), dtype=np.int32), counts), joints, scale
    )


def _within(people: Iterable[Person], most: int | None) -> list[Person]:
    kept: list[Person] = []
    stride, count = 1, 0
    for person in people:
        kept.append(_thinned(person, stride))
        count += len(kept[-1].points)
        while most is not None and count > most and any(len(p.points) > 1 for p in kept):
            stride *= 2
            for n, each in enumerate(
                kept
            ):  # each forgotten at once, for there may be no more room
                kept[n] = _thinned(each, 2)
            count = sum(len(each.points) for each in kept)
    return kept


def _thinned(person: Person, stride: int) -> Person:
    if stride == 1:
        return person
    return person._replace(
        quantised=person.quantised[::stride].copy(), points=person.points[::stride].copy()
    )
