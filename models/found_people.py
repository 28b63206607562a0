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


# ruff: noqa: INP001, T201 - a program, not a package
"""Measure how many people `segmentation: people` finds in furnished rooms, and what else.

The rooms are synthetic, with other seeds than those of the training, and with the motion capture
that is held out.

    python models/found_people.py --mocap CLIPS
"""

import argparse
import json
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from people import MocapSplit, find_mocap, with_mocap

from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.segmentation.segmenter import make_segmenter, segment
from lsc_pose_ros.settings.table import SegmentationSettings
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames

SENSORS = 'kinect_v1', 'azure', 'realsense', 'zed', 'tof'
FRAMES_OF_PEOPLE = ((0, 15), (1, 30), (2, 30), (3, 15))
"""How many frames of each camera show how many people."""

LEAST_AREA = 0.12
"""People with a smaller visible area need not be found, square metres."""

LARGEST_DEPTH = 5.5
"""People at a larger median depth need not be found, metres."""

LEAST_OVERLAP = 0.5
"""A found person has at least this intersection over union with the body; a false body has less
than this fraction of its pixels on people."""


class Found(NamedTuple):
    """What was found in frames.

    Attributes:
        frames: the number of frames.
        people: the number of people who should be found.
        found: the number of these who were found.
        false: the number of bodies that are no people.
    """

    frames: int
    people: int
    found: int
    false: int


def compare(
    labels: NDArray[np.int32],
    truth: NDArray[np.int32],
    depth: NDArray[np.float32],
    camera: Intrinsics,
) -> Found:
    """Return what was found in one frame.

    Args:
        labels: the body number of each pixel, NO_BODY for none, shape (H, W).
        truth: the number of the person that each pixel shows, likewise.
        depth: metres, 0 if unknown, shape (H, W).
        camera: the intrinsics.
    """
    area = depth * depth / (camera.fx * camera.fy)
    people = found = false = 0
    for body in np.unique(labels[labels != NO_BODY]):
        false += float((truth[labels == body] != NO_BODY).mean()) < LEAST_OVERLAP
    for person in np.unique(truth[truth != NO_BODY]):
        shown = (truth == person) & (depth > 0)
        if area[shown].sum() < LEAST_AREA or np.median(depth[shown]) > LARGEST_DEPTH:
            continue
        people += 1
        found += any(
            _overlap(shown, labels == body) for body in np.unique(labels[shown]) if body != NO_BODY
        )
    return Found(1, people, found, false)


def _overlap(shown: NDArray[np.bool_], body: NDArray[np.bool_]) -> bool:
    return bool((shown & body).sum() >= LEAST_OVERLAP * (shown | body).sum())


def rooms(sensor: str, number: int, mocap: MocapSplit) -> Iterator[Frame]:
    """Yield the rooms before a camera, with the number of the camera in their seeds."""
    for kind, (people, frames) in enumerate(FRAMES_OF_PEOPLE):
        settings = SyntheticSettings(
            frames=frames,
            seed=990_000 + len(FRAMES_OF_PEOPLE) * number + kind,
            people=people,
            sensor=sensor,
            clip_length=1,
            yaw=180.0,
            camera_height=(0.3, 2.2),
            camera_tilt=(-20.0, 30.0),
            distance=(0.9, 5.0),
            furniture=True,
        )
        yield from synthetic_frames(with_mocap(settings, mocap, test=True))


def total(parts: Sequence[Found]) -> Found:
    """Return the sums."""
    return Found(*(int(sum(column)) for column in zip(*parts, strict=True)))


def main(words: Sequence[str] | None = None) -> int:
    """Measure, print a table and JSON, and return the exit status."""
    parser = argparse.ArgumentParser(prog='models/found_people.py', description=__doc__)
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument('--mocap', type=Path, help='folder of motion capture (BVH)')
    arguments = parser.parse_args(words)
    mocap = find_mocap(arguments.mocap, None) if arguments.mocap else MocapSplit()
    segmenter = make_segmenter(SegmentationSettings('people'))
    if segmenter is None:
        raise AssertionError
    results: dict[str, Found] = {}
    count = sum(frames for _, frames in FRAMES_OF_PEOPLE)
    for number, sensor in enumerate(SENSORS):
        parts = []
        for frame in progress(rooms(sensor, number, mocap), count, sensor):
            labels = segment(segmenter, frame.stamp, frame.depth, frame.camera)
            parts.append(compare(labels, frame.labels, frame.depth, frame.camera))
        results[sensor] = total(parts)
    results['all'] = total(list(results.values()))
    for name, (frames, people, found, false) in results.items():
        print(
            f'{name:10} {found} of {people} people found ({found / max(people, 1):.1%}), '
            f'{false} false bodies in {frames} frames ({false / max(frames, 1):.3f} a frame)'
        )
    print(json.dumps({name: each._asdict() for name, each in results.items()}))
    return 0


if __name__ == '__main__':
    sys.exit(main())
