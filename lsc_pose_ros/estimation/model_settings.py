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

"""Makes an estimator from a model and the settings of a user."""

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.settings.table import ModelSettings

FEWEST_QUERY_POINTS = 10
"""With fewer voting points, a density has no clear mode."""


def make_estimator(model: Model, settings: ModelSettings, name: str) -> Estimator:
    """Return an estimator with `model` and `settings`.

    Args:
        model: the model that `settings` names.
        settings: settings of the estimation.
        name: the user's name of `query_points`, for the error message.

    Raises:
        InputError: the number of voting points is too low, or above that of the model.
    """
    changed = model.settings
    if settings.query_points:
        reason = query_points_refusal(settings.query_points, changed.points)
        if reason:
            msg = f'{name}: {reason}'
            raise InputError(msg)
        changed = changed._replace(query_points=settings.query_points)
    return Estimator(
        model._replace(settings=changed),
        graph=settings.graph,
        maximum_bodies=settings.maximum_bodies,
    )


def query_points_refusal(query_points: int, points: int) -> str:
    """Return why a number of voting points is invalid; empty if it is valid.

    Args:
        query_points: number of voting points, 0 for that of the model.
        points: number of points of a silhouette, 0 if no model is loaded.
    """
    if query_points == 0 or FEWEST_QUERY_POINTS <= query_points <= (points or query_points):
        return ''
    rule = f'it must be 0, or {FEWEST_QUERY_POINTS} or more'
    if points:
        rule = (
            f'it must be 0 or from {FEWEST_QUERY_POINTS} to {points}, the points that the model '
            'was trained with'
        )
    return f'{query_points} cannot be used; {rule}'
