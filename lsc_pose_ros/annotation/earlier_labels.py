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
"""The labels of an earlier annotation of a recording, from which a new one goes on."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.annotation.frame_store import FrameStore
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons, known_bodies


def earlier_labels(annotated: Iterable[Frame], store: FrameStore) -> dict[int, Skeletons] | None:
    """Return the labels of an annotated copy of a recording, by stamp in nanoseconds.

    Frames without a labelled joint are left out: they are the same in the copy whether somebody
    has said that nobody is in them, or nobody has looked at them.

    Args:
        annotated: the frames of the copy.
        store: the frames of the recording.

    Returns:
        None if it is no copy: its frames have other stamps, or stored frames other depths.
    """
    labels: dict[int, Skeletons] = {}
    stored = {number: at for at, number in enumerate(store.numbers)}
    count = 0
    for number, frame in enumerate(annotated):
        count += 1
        if count > len(store.all_stamps) or frame.stamp != store.all_stamps[number]:
            return None
        if number in stored and not _is_same(frame.depth, store[stored[number]].depth):
            return None
        truth = frame.ground_truth
        if truth is not None and known_bodies(truth):
            labels[frame.stamp] = truth
    return labels if count == len(store.all_stamps) else None


def _is_same(one: NDArray[np.float32], other: NDArray[np.float32]) -> bool:
    return np.array_equal(one, other, equal_nan=True)
