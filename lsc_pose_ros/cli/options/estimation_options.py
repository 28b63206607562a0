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

"""The options for estimating a recording: the node's parameters, with the same names."""

import argparse
from pathlib import Path

from lsc_pose_ros.cli.options.setting_options import (
    add_group_options,
    settings_from,
)
from lsc_pose_ros.estimation.model_settings import make_estimator
from lsc_pose_ros.estimation.temporal import TemporalEstimator
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.resources.package_files import find_model
from lsc_pose_ros.settings.table import (
    SETTINGS,
    DrawingSettings,
    ModelSettings,
    TemporalSettings,
)


def add_estimation_options(group: argparse._ArgumentGroup) -> None:
    """Add the options of all settings that decide how a recording is estimated."""
    add_group_options(group, ModelSettings)
    add_group_options(group, TemporalSettings)
    add_group_options(group, DrawingSettings)


def estimator_from(arguments: argparse.Namespace, path: Path) -> Estimator:
    """Return the estimator that `arguments` ask for.

    Args:
        arguments: the command line.
        path: the model file.

    Raises:
        InputError: the model cannot be used, or has fewer points than shall vote.
    """
    settings = settings_from(arguments, ModelSettings)
    return make_estimator(load_model(path), settings, SETTINGS['query_points'].option)


def temporal_estimator_from(arguments: argparse.Namespace) -> TemporalEstimator:
    """Return the estimation of consecutive frames that `arguments` ask for.

    Raises:
        InputError: as `estimator_from`.
    """
    estimator = estimator_from(arguments, find_model(arguments.model))
    return TemporalEstimator(estimator, settings_from(arguments, TemporalSettings))
