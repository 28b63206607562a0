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

"""The method as an ordered list of stages, from a depth image to the joints of one body.

    window       the body, cut out of the depth image
    silhouette   smoothed depth (eq. 1), silhouette points (eq. 2), N of them
    descriptors  the unit of length, one quantised descriptor for each point that votes (eq. 3, 4)
    leaves       the leaf of each descriptor in each tree (eq. 7); before it the body yaw,
                 if the trees split by it
    votes        votes for joints and for pairs of joints (eq. 11-13)
    modes        modes of the joints' densities (eq. 14)
    graph        the best combination of modes, and the ascent from there (eq. 15-17)
    confidence   the confidence in each joint; joints beyond a person's reach have no position

The estimator runs this list, training runs its beginning, the benchmark times each stage of it,
and `viz/stages` draws its results.
"""

from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.camera.rays import image_rays
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.joints import leg_pairs
from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.features.point_features import describe_points
from lsc_pose_ros.pose.features.unit_of_length import unit_of_length
from lsc_pose_ros.pose.forest.body_yaw import with_body_yaw
from lsc_pose_ros.pose.forest.body_yaw_tracking import follow_body_yaw
from lsc_pose_ros.pose.forest.forest import find_leaves
from lsc_pose_ros.pose.forest.votes import VoteSettings, gather_votes
from lsc_pose_ros.pose.inference.candidates import find_candidates, highest_modes, positions_of
from lsc_pose_ros.pose.inference.confidence import confidence_in
from lsc_pose_ros.pose.inference.past import contradicts, log_pasts
from lsc_pose_ros.pose.inference.pictorial_structure import Structure, ascend, best_candidates
from lsc_pose_ros.pose.inference.truncation import find_cuts, truncation_factor
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.reach import within_reach
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.body_window import body_window
from lsc_pose_ros.pose.silhouette.silhouette import choose_uniformly, find_silhouette

FEWEST_POINTS = 30
"""A body with fewer silhouette points is a speck, not a person."""

WINDOW = 'window'
SILHOUETTE = 'silhouette'
DESCRIPTORS = 'descriptors'
LEAVES = 'leaves'
VOTES = 'votes'
MODES = 'modes'
GRAPH = 'graph'
CONFIDENCE = 'confidence'

STAGE_NAMES = (WINDOW, SILHOUETTE, DESCRIPTORS, LEAVES, VOTES, MODES, GRAPH, CONFIDENCE)
"""The names of all stages in their order."""

Observer = Callable[[str], None]
"""Called with a stage's name when that stage has ended."""


class Stage(NamedTuple):
    """One step of the method.

    Attributes:
        name: one of STAGE_NAMES.
        run: computes the stage's results and sets them in the body. It raises
            TooLittleVisibleError if the body cannot be estimated.
    """

    name: str
    run: Callable[[BodyEstimate], None]


class TooLittleVisibleError(Exception):
    """Too little of a body is visible to estimate its joints."""


def run_stages(
    stages: Sequence[Stage], body: BodyEstimate, observer: Observer | None = None
) -> bool:
    """Run `stages` on `body`; return False if too little of it is visible.

    Args:
        stages: the stages in their order.
        body: the results are set in it.
        observer: called when a stage has ended, also after one that gives up.
    """
    name = ''
    try:
        for name, run in stages:
            run(body)
            if observer is not None:
                observer(name)
    except TooLittleVisibleError:
        if observer is not None:
            observer(name)
        return False
    return True


def description_stages(settings: Settings) -> tuple[Stage, ...]:
    """Return the stages up to the descriptors; they need no trained model."""
    return (
        Stage(WINDOW, partial(_cut_out_window, settings)),
        Stage(SILHOUETTE, partial(_find_silhouette, settings)),
        Stage(DESCRIPTORS, partial(_describe_points, settings)),
    )


def describe_body(
    depth: NDArray[np.float32],
    labels: NDArray[np.int32],
    camera: Intrinsics,
    number: int,
    settings: Settings,
) -> BodyEstimate | None:
    """Return one body with its descriptors, or None if too little of it is visible.

    Args:
        depth: metres, 0 if the sensor measured nothing, shape (H, W).
        labels: the body number of each pixel, NO_BODY for none, shape (H, W).
        camera: the intrinsics.
        number: the body's number in `labels`.
        settings: the parameters of silhouette and descriptors.
    """
    body = BodyEstimate.in_image(depth, labels, camera, number)
    return body if run_stages(description_stages(settings), body) else None


def joint_stages(model: Model, *, graph: bool = True) -> tuple[Stage, ...]:
    """Return the stages from the descriptors to the joints.

    Args:
        model: a trained model.
        graph: whether the pictorial structure joins the modes (eq. 16, 17).
    """
    stages = (
        Stage(LEAVES, partial(_find_leaves, model)),
        Stage(VOTES, partial(_gather_votes, model)),
        Stage(MODES, partial(_find_modes, model)),
    )
    return (*stages, Stage(GRAPH, partial(_solve_graph, structure_of(model)))) if graph else stages


def method_stages(model: Model, *, graph: bool = True) -> tuple[Stage, ...]:
    """Return all stages in the order of STAGE_NAMES; arguments as `joint_stages`."""
    return (
        *description_stages(model.settings),
        *joint_stages(model, graph=graph),
        Stage(CONFIDENCE, partial(_rate_joints, model)),
    )


def structure_of(model: Model) -> Structure:
    """Return the pictorial structure of a model (eq. 16, 17)."""
    settings = model.settings
    return Structure(
        model.edges,
        model.limb_lengths,
        float(settings.joint_bandwidth),
        float(settings.pair_weight),
        leg_pairs(model.joints),
        float(settings.legs_apart),
    )


def _cut_out_window(settings: Settings, body: BodyEstimate) -> None:
    window = body_window(body.depth, body.labels, body.camera, body.number, settings)
    if window is None:
        raise TooLittleVisibleError
    body.window = window
    body.cuts = find_cuts(window, image_rays(body.camera, *body.depth.shape))


def _find_silhouette(settings: Settings, body: BodyEstimate) -> None:
    rays = image_rays(body.camera, *body.depth.shape)
    body.silhouette = find_silhouette(body.window, rays, settings)
    if len(body.silhouette.points) < FEWEST_POINTS:
        raise TooLittleVisibleError


def _describe_points(settings: Settings, body: BodyEstimate) -> None:
    points = body.silhouette.points
    body.scale = unit_of_length(points, body.cuts, settings)
    if not 0 < body.scale < np.inf:  # not for NaN, either
        raise TooLittleVisibleError
    body.queries = choose_uniformly(len(points), settings.query_points)
    body.points = points[body.queries]
    body.quantised = describe_points(
        body.silhouette, body.queries, body.scale, body.camera, settings
    )


def _find_leaves(model: Model, body: BodyEstimate) -> None:
    quantised, body.body_yaw = body.quantised, None
    if model.settings.body_yaws:
        before = None if body.past is None else body.past.body_yaw
        all_round = body.past is None or body.past.all_round
        body.body_yaw = follow_body_yaw(
            model, body.points, quantised, body.scale, before, all_round=all_round
        )
        quantised = with_body_yaw(quantised, body.body_yaw.yaw)
    body.leaves = find_leaves(model.forest, quantised)


def _gather_votes(model: Model, body: BodyEstimate) -> None:
    forest, heaviest = model.forest, model.settings.heaviest_votes
    for_joints = VoteSettings(len(model.joints), heaviest, body.scale)
    body.joint_votes = gather_votes(forest.joint_votes, body.leaves, body.points, for_joints)
    for_pairs = VoteSettings(len(model.edges), heaviest, body.scale)
    origins = np.zeros_like(body.points)
    body.pair_votes = gather_votes(forest.pair_votes, body.leaves, origins, for_pairs)


def _find_modes(model: Model, body: BodyEstimate) -> None:
    settings = model.settings
    body.candidates = find_candidates(
        body.joint_votes, settings.joint_bandwidth, settings.candidates
    )
    body.unary = highest_modes(body.candidates)
    body.joints = body.unary
    if body.past is not None and contradicts(body.past, body.unary):
        body.past = None
        _find_leaves(model, body)
        _gather_votes(model, body)
        _find_modes(model, body)


def _solve_graph(structure: Structure, body: BodyEstimate) -> None:
    joint_votes, pair_votes = body.joint_votes, body.pair_votes
    priors = log_pasts(body.past, body.candidates)
    which = best_candidates(structure, joint_votes, pair_votes, body.candidates, priors)
    body.chosen = positions_of(body.candidates, which)
    body.joints = ascend(structure, joint_votes, pair_votes, body.chosen)


def _rate_joints(model: Model, body: BodyEstimate) -> None:
    bandwidth = float(model.settings.joint_bandwidth)
    body.confidence = confidence_in(model.calibration, body.joint_votes, body.joints, bandwidth)
    body.confidence *= truncation_factor(body.joints, body.cuts, model.joints)
    lost = ~within_reach(body.joints, body.silhouette.points)
    body.joints = np.where(lost[:, None], np.float32(np.nan), body.joints)
    body.confidence = np.where(lost, np.float32(0), body.confidence)
