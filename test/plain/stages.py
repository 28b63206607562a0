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

"""The stages of the method with the plain kernels in place of the fast ones."""

from functools import partial

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import ImageRays, image_rays
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.features.nearest_bin import quantise
from lsc_pose_ros.pose.features.point_features import describe_points
from lsc_pose_ros.pose.forest.votes import Votes, votes_of_target
from lsc_pose_ros.pose.inference.candidates import Candidates, highest_modes
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.preprocessing import (
    Window,
    fitted_to_noise,
    remove_flying_pixels,
)
from lsc_pose_ros.pose.silhouette.silhouette import (
    Silhouette,
    choose_uniformly,
    silhouette_in,
)
from lsc_pose_ros.pose.stages import (
    DESCRIPTORS,
    FEWEST_POINTS,
    MODES,
    SILHOUETTE,
    Stage,
    TooLittleVisibleError,
    method_stages,
)
from plain import density, descriptor, silhouette


def plain_stages(model: Model) -> tuple[Stage, ...]:
    """Return the stages of the method, with the plain kernel of each stage that has one.

    Descriptors have one for the paper's feature only.
    """
    plain = {
        SILHOUETTE: partial(_find_silhouette, model.settings),
        DESCRIPTORS: partial(_describe_points, model.settings),
        MODES: partial(_find_modes, model.settings),
    }
    return tuple(Stage(name, plain.get(name, run)) for name, run in method_stages(model))


def stages_with_plain_kernels(settings: Settings) -> tuple[str, ...]:
    """Return the names of the stages that have a plain kernel."""
    return (SILHOUETTE, DESCRIPTORS, MODES) if _paper(settings) else (SILHOUETTE, MODES)


def find_silhouette(window: Window, rays: ImageRays, settings: Settings) -> Silhouette:
    """Return the silhouette of the body in `window`, smoothed by the plain kernel."""
    solid = remove_flying_pixels(window, settings)
    fitted = fitted_to_noise(solid, settings)
    smoothed = silhouette.smooth(solid, rays, fitted.smoothing_sigma)
    return silhouette_in(solid._replace(depth=smoothed), rays, fitted)


def describe(
    points: NDArray[np.float32], queries: NDArray[np.int64], scale: float, settings: Settings
) -> NDArray[np.uint8]:
    """Return the quantised 3DLSC descriptors of some of the points, by the plain kernels."""
    radius = scale * settings.support_radius
    return quantise(descriptor.describe(points, queries, radius, settings.inner_radius))


@kernel
def find_candidates(votes: Votes, bandwidth: float, wanted: int) -> Candidates:
    """Return the modes of each joint's density, by the plain kernels."""
    joints = votes.start.shape[0] - 1
    positions = np.full((joints, wanted, 3), np.nan, np.float32)
    counts = np.zeros(joints, np.int64)
    for joint in range(joints):
        cloud = votes_of_target(votes, joint)
        together = np.column_stack((cloud.x, cloud.y, cloud.z))
        modes = density.find_modes(together, cloud.weight, bandwidth, wanted)
        counts[joint] = modes.shape[0]
        positions[joint, : modes.shape[0]] = modes
    return Candidates(positions, counts)


def _paper(settings: Settings) -> bool:
    return (settings.feature, settings.binning) == ('3dlsc', 'shared')


def _find_silhouette(settings: Settings, body: BodyEstimate) -> None:
    rays = image_rays(body.camera, *body.depth.shape)
    body.silhouette = find_silhouette(body.window, rays, settings)
    if len(body.silhouette.points) < FEWEST_POINTS:
        raise TooLittleVisibleError


def _describe_points(settings: Settings, body: BodyEstimate) -> None:
    points = body.silhouette.points
    body.scale = settings.fixed_scale or descriptor.mean_distance(points)
    if len(body.cuts.rays):
        body.scale = max(body.scale, settings.least_cut_scale)
    if body.scale <= 0:
        raise TooLittleVisibleError
    body.queries = choose_uniformly(len(points), settings.query_points)
    body.points = points[body.queries]
    if _paper(settings):
        body.quantised = describe(points, body.queries, body.scale, settings)
    else:
        body.quantised = describe_points(
            body.silhouette, body.queries, body.scale, body.camera, settings
        )


def _find_modes(settings: Settings, body: BodyEstimate) -> None:
    body.candidates = find_candidates(
        body.joint_votes, settings.joint_bandwidth, settings.candidates
    )
    body.unary = highest_modes(body.candidates)
    body.joints = body.unary
