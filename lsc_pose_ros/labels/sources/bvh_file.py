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

"""Joints of BVH files."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.labels.limits import check_positions, regular_stamps
from lsc_pose_ros.labels.tracks import BodyTrack
from lsc_pose_ros.labels.vocabulary import Vocabulary
from lsc_pose_ros.synthetic.mocap.bvh import joint_poses, load_bvh


def bvh_tracks(
    paths: Sequence[Path], vocabulary: Vocabulary, frame_id: str, scale: float, start: int
) -> list[BodyTrack]:
    """Return the body of each file, numbered from 1.

    Args:
        paths: the files.
        vocabulary: the names of their joints.
        frame_id: the frame of the positions.
        scale: metres per unit of the files.
        start: the stamp of their first frames, nanoseconds.

    Raises:
        InputError: a file cannot be read, has none of the joints, or has absurd numbers.
    """
    tracks = []
    for body, path in enumerate(paths, start=1):
        bvh = load_bvh(path)
        known = [name for name in vocabulary.names if name in bvh.names]
        if not known:
            msg = (
                f'{path} has none of the joints {vocabulary.listed}, but '
                f'{excerpt(", ".join(bvh.names), 300)}; name the vocabulary with --joints'
            )
            raise InputError(msg)
        stamps = regular_stamps(path, start, len(bvh.values), bvh.frame_time)
        positions = joint_poses(bvh).positions * scale
        check_positions(path, positions)
        theirs = np.full((len(positions), len(vocabulary.names), 3), np.nan)
        for name in known:
            theirs[:, vocabulary.names.index(name)] = positions[:, bvh.names.index(name)]
        tracks.append(BodyTrack(body, frame_id, stamps, vocabulary.ours(theirs)))
    return tracks
