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

"""The settings of the variants, and the trials that several experiments share."""

from typing import NamedTuple

from lsc_pose_experiments.shotton.part_model_training import PartModelSettings
from lsc_pose_experiments.shotton.part_tree_growth import PartGrowth
from lsc_pose_experiments.trial import Trial
from lsc_pose_experiments.walks.direction_tree_growth import DirectionGrowth
from lsc_pose_experiments.walks.walk_training import WalkModelSettings
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.training.train import TrainingSettings
from lsc_pose_ros.training.tree_growth import GrowthSettings

OURS = 'ours (3DLSC + graph)'
GIRSHICK = 'Girshick et al.'
SHOTTON = 'Shotton et al.'
WALKS = 'Random Tree Walks'


class ExperimentDefaults(NamedTuple):
    """The settings of variants that do not change them, and the values of N and M.

    Attributes:
        training: settings of the training.
        frames: number of training frames.
        body_parts: settings of the rival Shotton et al.
        walks: settings of the rival Random Tree Walks.
        points: values of N in Fig. 12.
        few_points: the N from which on the accuracy is stable according to the paper.
        votes: values of M in Fig. 14.
        few_votes: the M from which on the accuracy is stable according to the paper.
    """

    training: TrainingSettings
    frames: int = 3600
    body_parts: PartModelSettings = PartModelSettings()
    walks: WalkModelSettings = WalkModelSettings()
    points: tuple[int, ...] = tuple(range(100, 901, 100))
    few_points: int = 400
    votes: tuple[int, ...] = (1, 2, 5, 10, 20, 50, 100, 200, 300, 500)
    few_votes: int = 100


def full_defaults(seed: int) -> ExperimentDefaults:
    """Return the defaults of the paper."""
    settings = Settings(offset_seed=seed)
    return ExperimentDefaults(TrainingSettings(numbers_of(DEFAULT_JOINTS), settings, seed=seed))


def quick_defaults(seed: int) -> ExperimentDefaults:
    """Return defaults that use all parts and take a minute on a small machine."""
    settings = Settings(points=80, query_points=80, offset_seed=seed)
    training = TrainingSettings(
        numbers_of(DEFAULT_JOINTS),
        settings,
        trees=2,
        growth=GrowthSettings(depth=9),
        seed=seed,
    )
    growth = PartGrowth(depth=12, features=50)
    body_parts = PartModelSettings(trees=2, growth=growth, pixels=300, other_pixels=100)
    return ExperimentDefaults(
        training,
        frames=60,
        body_parts=body_parts,
        walks=WalkModelSettings(points=30, growth=DirectionGrowth(depth=12)),
        points=(40, 80, 160),
        few_points=80,
        votes=(1, 20, 200),
        few_votes=20,
    )


def forest_trial(
    defaults: ExperimentDefaults, *, graph: bool = True, **settings: float | str
) -> Trial:
    """Return the trial of the paper's method with other settings of the estimation."""
    changed = defaults.training.settings._replace(**settings)  # type: ignore[arg-type]
    return Trial(defaults.training._replace(settings=changed), defaults.frames, graph)


def girshick_trial(defaults: ExperimentDefaults) -> Trial:
    """Return the trial of Girshick et al.: DCF on points of the whole body, without the graph."""
    return forest_trial(defaults, graph=False, feature='dcf', sample='body')


def shotton_trial(defaults: ExperimentDefaults) -> Trial:
    """Return the trial of Shotton et al."""
    return Trial(defaults.training, defaults.frames, graph=False, rival=defaults.body_parts)


def walks_trial(defaults: ExperimentDefaults) -> Trial:
    """Return the trial of Random Tree Walks."""
    return Trial(defaults.training, defaults.frames, graph=False, rival=defaults.walks)
