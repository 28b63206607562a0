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


"""How steady the joints of a labelled video are: jitter, lag, direction, and body numbers."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.tracking.assignment import assign
from lsc_pose_ros.tracking.tracker import body_distance
from lsc_pose_ros.training.samples import select_joints

LARGEST_DISTANCE = 0.5
"""A body farther from a person is not that person, metres."""

REST_SPEED = 0.1
"""A slower joint is at rest, metres per second."""

LONGEST_STEP_NS = 150_000_000
"""Frames that are farther apart do not follow each other, nanoseconds."""

FASTEST_PERSON = 10.0
"""Nobody is faster: a larger movement is a cut, after which there are other people, metres per
second."""

SHORTEST_STEP = 0.01
"""Stamps that are closer are taken for so far apart, seconds."""

LONGEST_ABSENCE_NS = 1_000_000_000
"""After a longer absence a person may have another number, nanoseconds."""

MOST_LAG = 5
"""The largest lag that is looked for, frames."""


class VideoFrame(NamedTuple):
    """One frame of a labelled video.

    Attributes:
        stamp: nanoseconds.
        estimate: the estimated bodies.
        truth: the ground truth.
    """

    stamp: int
    estimate: Skeletons
    truth: Skeletons


class VideoScores(NamedTuple):
    """How steady a video's joints are.

    Attributes:
        people: the number of estimates of people, all frames together.
        mean_error_m: the mean error of all joints, metres.
        map: the fraction of the joints that are within the tolerance; people who are not found
            have none.
        jitter_at_rest_m: the 95th percentile of the movement between two frames of joints that
            are at rest, metres.
        jitter_m: the 95th percentile of the change of a joint's error between two frames, metres.
        lag_frames: by how many frames the estimates are late: where the speeds of estimate and
            ground truth correlate most, interpolated.
        turned_round: the fraction of the estimates with front and back exchanged.
        turns: how often an estimate changes between right and exchanged.
        id_switches_per_minute: how often a person gets another number, for one minute of video. A
            cut of the video, and an absence of more than a second, begin a new person.
    """

    people: int
    mean_error_m: float
    map: float
    jitter_at_rest_m: float
    jitter_m: float
    lag_frames: float
    turned_round: float
    turns: int
    id_switches_per_minute: float


class _Track(NamedTuple):
    """One person in n frames without a cut; the arrays have a row for each of them.

    Attributes:
        stamps: nanoseconds, shape (n,).
        numbers: of the body, -1 if the person was not found, shape (n,).
        estimate: metres, NaN if unknown, shape (n, J, 3).
        truth: likewise.
    """

    stamps: NDArray[np.int64]
    numbers: NDArray[np.int64]
    estimate: NDArray[np.float32]
    truth: NDArray[np.float32]


def score_video(frames: Sequence[VideoFrame], tolerance: float) -> VideoScores:
    """Return how steady the joints of successive frames are.

    People are compared with the bodies that are nearest to them, each body with one person.

    Args:
        frames: at least one with a person, in the order of time.
        tolerance: how far a joint may be off to count as found, metres.
    """
    joints = frames[0].estimate.joints
    tracks = _tracks(frames, joints)
    steps = [_follows(track) for track in tracks]
    moved = [np.diff(track.estimate, axis=0) for track in tracks]
    true = [np.diff(track.truth, axis=0) for track in tracks]
    errors = np.concatenate(
        [np.linalg.norm(track.estimate - track.truth, axis=2).ravel() for track in tracks]
    )
    exchanged = [_exchanged(track, joints) for track in tracks]
    seconds = max((frames[-1].stamp - frames[0].stamp) * 1e-9, 1e-9)
    return VideoScores(
        people=sum(len(track.stamps) for track in tracks),
        mean_error_m=float(np.nanmean(errors)),
        map=float((errors <= tolerance).mean()),
        jitter_at_rest_m=_percentile(
            [
                np.linalg.norm(each, axis=2)[follows][_at_rest(other, track)[follows]]
                for each, other, follows, track in zip(moved, true, steps, tracks, strict=True)
            ]
        ),
        jitter_m=_percentile(
            [
                np.linalg.norm(each - other, axis=2)[follows].ravel()
                for each, other, follows in zip(moved, true, steps, strict=True)
            ]
        ),
        lag_frames=_lag(tracks),
        turned_round=float(np.nanmean(np.concatenate(exchanged))),
        turns=sum(_changes(each) for each in exchanged),
        id_switches_per_minute=60 / seconds * sum(_switches(track) for track in tracks),
    )


def _tracks(frames: Sequence[VideoFrame], joints: NDArray[np.uint16]) -> list[_Track]:
    """Return each person of the ground truth with the nearest bodies."""
    rows: dict[int, list[tuple[int, int, NDArray[np.float32], NDArray[np.float32]]]] = {}
    for frame in frames:
        truths = select_joints(frame.truth, joints)
        rows_of = _nearest(frame.estimate.positions, truths)
        for n, (person, truth) in enumerate(zip(frame.truth.bodies.tolist(), truths, strict=True)):
            number, estimate = -1, np.full_like(truth, np.nan)
            if n in rows_of:
                number = int(frame.estimate.bodies[rows_of[n]])
                estimate = frame.estimate.positions[rows_of[n]]
            rows.setdefault(person, []).append((frame.stamp, number, estimate, truth))
    return [
        part
        for track in rows.values()
        for part in _parts(_Track(*(np.array(column) for column in zip(*track, strict=True))))
    ]


def _parts(track: _Track) -> list[_Track]:
    """Return the parts of a track between the cuts of the video."""
    seconds = np.diff(track.stamps) * 1e-9
    moved = np.linalg.norm(np.diff(track.truth, axis=0), axis=2)
    known = np.isfinite(moved).any(axis=1)
    typical = np.full(len(moved), np.nan)
    typical[known] = np.nanmedian(moved[known], axis=1)
    cuts = 1 + np.flatnonzero(
        (typical > FASTEST_PERSON * np.maximum(seconds, SHORTEST_STEP)) | (seconds < 0)
    )
    columns = [np.split(column, cuts) for column in track]
    return [_Track(*part) for part in zip(*columns, strict=True)]


def _nearest(estimates: NDArray[np.float32], truths: NDArray[np.float32]) -> dict[int, int]:
    """Return the estimate of each person of the ground truth that has one.

    Each estimate is one person's. The sum of the distances is least.

    Args:
        estimates: metres, shape (B, J, 3).
        truths: metres, shape (P, J, 3).
    """
    distances = np.array(
        [[body_distance(estimate, truth) for estimate in estimates] for truth in truths]
    ).reshape(len(truths), len(estimates))
    return dict(assign(distances, LARGEST_DISTANCE))


def _follows(track: _Track) -> NDArray[np.bool_]:
    """Return whether each frame but the first follows the one before, shape (n - 1,)."""
    follows: NDArray[np.bool_] = np.diff(track.stamps) <= LONGEST_STEP_NS
    return follows


def _at_rest(movement: NDArray[np.float32], track: _Track) -> NDArray[np.bool_]:
    seconds = np.maximum(np.diff(track.stamps) * 1e-9, 1e-9)
    slow: NDArray[np.bool_] = np.linalg.norm(movement, axis=2) < REST_SPEED * seconds[:, None]
    return slow


def _percentile(values: list[NDArray[np.floating]]) -> float:
    known = np.concatenate([each[np.isfinite(each)] for each in values])
    return float(np.percentile(known, 95)) if len(known) else float('nan')


def _lag(tracks: list[_Track]) -> float:
    """Return the lag at which the correlation of the speeds is largest, frames."""
    correlations = np.array([_correlation(tracks, lag) for lag in range(-1, MOST_LAG + 2)])
    if not np.isfinite(correlations).all():
        return float('nan')
    best = int(np.clip(np.argmax(correlations), 1, len(correlations) - 2))
    before, here, after = correlations[best - 1 : best + 2]
    bend = before - 2 * here + after
    return best - 1 + (0.5 * float((before - after) / bend) if bend < 0 else 0.0)


def _correlation(tracks: list[_Track], lag: int) -> float:
    """Return the correlation of the true speeds with the estimated ones `lag` frames later."""
    pairs = []
    for track in tracks:
        follows = _follows(track)[:, None]
        true, found = (
            np.where(follows, np.linalg.norm(np.diff(each, axis=0), axis=2), np.nan)
            for each in (track.truth, track.estimate)
        )
        first, last = max(lag, 0), len(true) + min(lag, 0)
        if last > first:
            pairs.append((true[first - lag : last - lag].ravel(), found[first:last].ravel()))
    if not pairs:
        return float('nan')
    true, found = (np.concatenate(each) for each in zip(*pairs, strict=True))
    known = np.isfinite(true) & np.isfinite(found)
    true, found = true[known], found[known]
    # At a constant speed there is nothing to compare.
    if len(true) <= 2 or not true.std() or not found.std():
        return float('nan')
    return float(np.corrcoef(true, found)[0, 1])


def _exchanged(track: _Track, joints: NDArray[np.uint16]) -> NDArray[np.float64]:
    """Return 1 where left and right shoulder are exchanged, NaN where they are unknown, (n,)."""
    numbers = joints.tolist()
    left, right = JOINT_NUMBERS['l_shoulder'], JOINT_NUMBERS['r_shoulder']
    if left not in numbers or right not in numbers:
        return np.full(len(track.stamps), np.nan)
    first, second = numbers.index(left), numbers.index(right)
    found, true = (
        each[:, first, ::2] - each[:, second, ::2] for each in (track.estimate, track.truth)
    )
    product = (found * true).sum(axis=1).astype(np.float64)
    return np.where(np.isfinite(product), (product < 0).astype(np.float64), np.nan)


def _changes(values: NDArray[np.floating]) -> int:
    known = values[np.isfinite(values)]
    return int((np.diff(known) != 0).sum())


def _switches(track: _Track) -> int:
    """Return how often the number changes, frames in which nobody was found left out."""
    found = track.numbers >= 0
    changed = np.diff(track.numbers[found]) != 0
    return int((changed & (np.diff(track.stamps[found]) <= LONGEST_ABSENCE_NS)).sum())
