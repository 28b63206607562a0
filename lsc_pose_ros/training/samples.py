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

"""Training samples: silhouette points, their descriptors, and the joints of their bodies."""

import itertools
from collections.abc import Iterable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.image_arguments import check_images
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.pose.estimator import bodies_in
from lsc_pose_ros.pose.inference.truncation import NO_CUTS, Cuts
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.stages import describe_body


class Samples(NamedTuple):
    """S silhouette points of P labelled people, ordered by person.

    Attributes:
        quantised: quantised descriptors, shape (F, S), so that a split reads one contiguous row.
            Spare rows may follow.
        points: positions in units of the person's rho_bar, shape (S, 3).
        person: index of the person of each point, shape (S,).
        joints: positions in units of the person's rho_bar, NaN if not labelled, shape (P, J, 3).
        scale: rho_bar of each person, metres, shape (P,).
    """

    quantised: NDArray[np.uint8]
    points: NDArray[np.float32]
    person: NDArray[np.int32]
    joints: NDArray[np.float32]
    scale: NDArray[np.float32]


class LabelledPerson(NamedTuple):
    """The training samples of one person.

    Attributes:
        quantised: quantised descriptors, shape (N, F).
        points: positions in units of rho_bar, shape (N, 3).
        joints: positions in units of rho_bar, NaN if not labelled, shape (J, 3).
        scale: rho_bar, metres.
        cuts: where the person is cut off, or hidden by something nearer.
    """

    quantised: NDArray[np.uint8]
    points: NDArray[np.float32]
    joints: NDArray[np.float32]
    scale: float
    cuts: Cuts = NO_CUTS


def select_joints(ground_truth: Skeletons, joints: NDArray[np.uint16]) -> NDArray[np.float32]:
    """Return the positions of some joints, metres, shape (B, J, 3).

    Args:
        ground_truth: the skeletons of B bodies.
        joints: joint numbers, shape (J,); those that `ground_truth` does not have become NaN.
    """
    selected = np.full((len(ground_truth.bodies), len(joints), 3), np.nan, np.float32)
    columns = {int(number): column for column, number in enumerate(ground_truth.joints)}
    for j, number in enumerate(joints):
        if int(number) in columns:
            selected[:, j] = ground_truth.positions[:, columns[int(number)]]
    return selected


def labelled_people_in(
    frame: Frame, joints: NDArray[np.uint16], settings: Settings
) -> Iterator[LabelledPerson]:
    """Yield the visible labelled people of `frame`.

    Args:
        frame: a frame; without ground truth it yields nobody.
        joints: numbers of the joints to learn, shape (J,).
        settings: the settings of silhouette and descriptor; all `points` become samples.

    Raises:
        InputError: depth, labels or camera have another type or shape.
    """
    if frame.ground_truth is None:
        return
    positions = select_joints(frame.ground_truth, joints)
    all_points = settings._replace(query_points=settings.points)
    images = check_images(frame.depth, frame.labels, frame.camera)
    visible = set(bodies_in(images.labels).tolist())
    for row, body in enumerate(frame.ground_truth.bodies.tolist()):
        if body not in visible or np.isnan(positions[row]).all():
            continue
        described = describe_body(*images, body, all_points)
        if described is not None:
            scale = np.float32(described.scale)
            yield LabelledPerson(
                described.quantised,
                described.points / scale,
                positions[row] / scale,
                described.scale,
                described.cuts,
            )


def labelled_people(
    frames: Iterable[Frame], joints: NDArray[np.uint16], settings: Settings
) -> Iterator[LabelledPerson]:
    """Yield the labelled people of all `frames`; other arguments as `labelled_people_in`."""
    for frame in frames:
        yield from labelled_people_in(frame, joints, settings)


def sample_limit(memory: float, joints: int, size: int) -> int:
    """Return the number of samples that fit into `memory`.

    A sample needs its descriptor, its point and person index, its joint statistics twice while a
    node is split, its index in the order of samples twice, and memory for leaf votes.

    Args:
        memory: memory of the process, bytes.
        joints: J, number of joints to learn.
        size: F, length of a descriptor.
    """
    statistics = 8 + _FRACTION_IN_REACH * joints * (1 + 4 * 4)
    sample_bytes = size + 16 + 2 * statistics + 2 * 4 + 120
    return max(1, int((memory - _BASE_BYTES) / sample_bytes))


# A point has statistics of this fraction of the joints; a fifth was measured, in all views.
_FRACTION_IN_REACH = 0.25

# Memory of a process after all imports and compilations, bytes.
_BASE_BYTES = 600e6


def gather_samples(people: Iterable[LabelledPerson], limit: int | None = None) -> Samples:
    """Return the samples of all `people`, at most `limit` of them.

    If there are more, each person keeps every second of the points, or every fourth, and so on:
    many people with few points train a better forest than few people with many points.

    Raises:
        InputError: `people` is empty.
    """
    return split_samples(people, limit, 0.0)[0]


def split_samples(
    people: Iterable[LabelledPerson], limit: int | None, fraction: float, spare_rows: int = 0
) -> tuple[Samples, list[LabelledPerson]]:
    """Return training samples, and the people that are held out from them.

    Args:
        people: the labelled people, in the order of the recording.
        limit: the largest number of samples, held-out people included; None for no limit.
        fraction: the fraction of the people that is held out.
        spare_rows: number of rows of zeros after the descriptors.

    Raises:
        InputError: nobody is left to train on.
    """
    kept = _thin_to_limit(people, limit)
    held_out = held_out_mask(len(kept), fraction)
    test = [person for person, out in zip(kept, held_out, strict=True) if out]
    kept = [person for person, out in zip(kept, held_out, strict=True) if not out]
    return _join(kept, spare_rows), test


def held_out_mask(count: int, fraction: float) -> NDArray[np.bool_]:
    """Return which of `count` people are held out, shape (count,).

    Neighbouring frames are nearly equal, so whole stretches of the recording are held out. A
    single stretch would show one person or one action, so the end of each tenth is taken. With
    few people none are held out.

    Args:
        count: number of people, in the order of the recording.
        fraction: the fraction to hold out.
    """
    held = np.zeros(count, np.bool_)
    edges = np.linspace(0, count, _HELD_OUT_STRETCHES + 1).astype(np.int64)
    for start, end in itertools.pairwise(edges.tolist()):
        held[end - round(fraction * (end - start)) : end] = True
    return held


# Number of stretches that are held out.
_HELD_OUT_STRETCHES = 10


def _join(kept: list[LabelledPerson], spare_rows: int) -> Samples:
    """Return the samples of `kept`, and empty that list."""
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
    quantised = np.zeros((size + spare_rows, ends[-1]), np.uint8)
    # Each person is released after copying, so that the samples are not in memory twice.
    for end in ends[::-1]:
        person = kept.pop()
        quantised[:size, end - len(person.points) : end] = person.quantised.T
    return Samples(
        quantised, points, np.repeat(np.arange(len(counts), dtype=np.int32), counts), joints, scale
    )


def _thin_to_limit(people: Iterable[LabelledPerson], limit: int | None) -> list[LabelledPerson]:
    """Return `people` with at most `limit` points, but at least one of each."""
    kept: list[LabelledPerson] = []
    stride, count = 1, 0
    for person in people:
        kept.append(_thinned(person, stride))
        count += len(kept[-1].points)
        while limit is not None and count > limit and any(len(p.points) > 1 for p in kept):
            stride *= 2
            for n, each in enumerate(kept):  # one by one, to release memory
                kept[n] = _thinned(each, 2)
            count = sum(len(each.points) for each in kept)
    return kept


def _thinned(person: LabelledPerson, stride: int) -> LabelledPerson:
    if stride == 1:
        return person
    return person._replace(
        quantised=person.quantised[::stride].copy(), points=person.points[::stride].copy()
    )
