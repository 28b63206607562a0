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

"""The rivals that have an estimator of their own: how each is trained, and its program."""

from collections.abc import Callable, Sequence
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.sampled_frames import SampledFrame
from lsc_pose_experiments.shotton import (
    part_estimator,
    part_forest_training,
    part_model_training,
    part_samples,
)
from lsc_pose_experiments.shotton.part_estimator import PartEstimator
from lsc_pose_experiments.shotton.part_model_training import PartModelSettings, train_part_model
from lsc_pose_experiments.walks import walk_estimator, walk_training
from lsc_pose_experiments.walks.walk_estimator import WalkEstimator
from lsc_pose_experiments.walks.walk_training import WalkModelSettings, train_walk_model
from lsc_pose_ros.evaluation.evaluate import JointEstimator

RivalSettings = PartModelSettings | WalkModelSettings
"""The settings of a rival; their type says which one it is."""


class Rival(NamedTuple):
    """A rival.

    Attributes:
        name: its name.
        train: trains on frames to find joints, with its settings and a seed.
        make: makes an estimator of what `train` returns.
        program: the modules that, with those they use, determine its results.
    """

    name: str
    train: Callable[[Sequence[SampledFrame], NDArray[np.uint16], Any, int], Any]
    make: Callable[[Any], JointEstimator]
    program: tuple[ModuleType, ...]


RIVALS: dict[type, Rival] = {
    PartModelSettings: Rival(
        'Shotton et al.',
        train_part_model,
        PartEstimator,
        (part_estimator, part_model_training, part_samples, part_forest_training),
    ),
    WalkModelSettings: Rival(
        'Random Tree Walks', train_walk_model, WalkEstimator, (walk_estimator, walk_training)
    ),
}
"""All rivals by the type of their settings."""
