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

"""All systems on the same frames, with one that the paper does not compare itself with."""

from lsc_pose_experiments import claims
from lsc_pose_experiments.defaults import (
    GIRSHICK,
    OURS,
    SHOTTON,
    WALKS,
    ExperimentDefaults,
    forest_trial,
    girshick_trial,
    shotton_trial,
    walks_trial,
)
from lsc_pose_experiments.experiment import Experiment, Variant


def systems(defaults: ExperimentDefaults) -> Experiment:
    """Compare all systems."""
    dcf, shape_context = 'DCF + graph', '2DSC + graph'
    return Experiment(
        'systems',
        'All systems side by side',
        'All learn from the same frames. Random Tree Walks (Jung et al., CVPR 2015) is not in the '
        'paper: one tree for each joint gives the direction from a point to the joint, and the '
        'joint is the mean of the steps of a walk, which starts at the joint before it, or at the '
        "body's centre.",
        (
            Variant(OURS, forest_trial(defaults)),
            Variant(dcf, forest_trial(defaults, feature='dcf')),
            Variant(shape_context, forest_trial(defaults, feature='2dsc')),
            Variant(GIRSHICK, girshick_trial(defaults)),
            Variant(SHOTTON, shotton_trial(defaults)),
            Variant(WALKS, walks_trial(defaults)),
        ),
        (
            claims.best(
                OURS, [dcf, shape_context, GIRSHICK, SHOTTON], 'Better than the other systems.'
            ),
            claims.better(OURS, WALKS, 'Better than Random Tree Walks (not in the paper).'),
        ),
    )
