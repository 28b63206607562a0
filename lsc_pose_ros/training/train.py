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

"""Trains a model from labelled frames (paper, section 3.2)."""

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.joints import default_edges, names_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.model_check import check_counts
from lsc_pose_ros.model_io.model_header import read_settings
from lsc_pose_ros.model_io.unusable_model import UnusableModelError
from lsc_pose_ros.pose.features.point_features import feature_size
from lsc_pose_ros.pose.forest.body_yaw import BODY_YAW_SIZE
from lsc_pose_ros.pose.forest.forest import Forest, LeafVotes
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.training.body_yaw_labels import left_right_columns, write_body_yaws
from lsc_pose_ros.training.calibration import calibrate
from lsc_pose_ros.training.checkpoint import (
    Checkpoint,
    FinishedTree,
    Limits,
    training_key,
)
from lsc_pose_ros.training.criterion import (
    ENTROPY,
    SPREAD,
    JointStatistics,
    contributions,
    offset_moments,
)
from lsc_pose_ros.training.leaves import LeafSettings, fit_joint_votes, fit_pair_votes
from lsc_pose_ros.training.mirror import with_mirrored
from lsc_pose_ros.training.samples import (
    Samples,
    labelled_people,
    sample_limit,
    split_samples,
)
from lsc_pose_ros.training.tree_growth import GrowthSettings, grow_tree, join_trees

GIBIBYTE = 1 << 30


class TrainingSettings(NamedTuple):
    """The settings of a training.

    Attributes:
        joints: numbers of the joints to learn, shape (J,).
        settings: settings of silhouettes, descriptors and densities.
        trees: number of trees.
        growth: settings of each tree.
        leaves: settings of the leaf votes.
        seed: seed of all random numbers.
        memory: memory that training may use, bytes.
        hold_out: fraction of the people that calibrates the confidence instead of training.
        criterion: criterion of splits, one of CRITERIA.
        criterion_reach: the distance up to which a joint counts for the spread, in units of
            rho_bar.
        mirror: whether the mirror image of each frame is learnt, too.
    """

    joints: NDArray[np.uint16]
    settings: Settings = Settings()
    trees: int = 3
    growth: GrowthSettings = GrowthSettings()
    leaves: LeafSettings = LeafSettings()
    seed: int = 0
    memory: float = 8 * GIBIBYTE
    hold_out: float = 0.05
    criterion: str = SPREAD
    criterion_reach: float = 0.5
    mirror: bool = False


Progress = Callable[[str], None]


def train(
    frames: Iterable[Frame],
    training: TrainingSettings,
    provenance: dict[str, str],
    progress: Progress = lambda _step: None,
    checkpoint: Checkpoint | None = None,
) -> Model:
    """Return a model trained on all labelled people in `frames`.

    Args:
        frames: labelled frames; frames without ground truth are skipped.
        training: the settings.
        provenance: stored in the model, as information for its users.
        progress: called with a description of each step as it begins.
        checkpoint: keeps each finished tree, and may know some of an interrupted training;
            None to keep none.

    Raises:
        InputError: no labelled person is visible, a joint is never labelled, the joints that
            define the body yaw are missing, or no file can hold such a model.
    """
    check_bounds(training)
    if training.settings.body_yaws:
        left_right_columns(training.joints)  # fails now instead of after all frames are read
    progress('reading frames')
    if training.mirror:
        frames = with_mirrored(frames)
    people = labelled_people(frames, training.joints, training.settings)
    spare = BODY_YAW_SIZE if training.settings.body_yaws else 0
    size = feature_size(training.settings) + spare
    limit = sample_limit(training.memory, len(training.joints), size)
    samples, held_out = split_samples(people, limit, training.hold_out, spare)
    model = train_on(samples, training, provenance, progress, checkpoint)
    if held_out:
        progress(f'calibrating the confidence on {len(held_out)} held-out people')
    return calibrate(model, held_out)


def check_bounds(training: TrainingSettings) -> None:
    """Check that a file can hold a model that is trained with these settings.

    Raises:
        InputError: its readers would refuse it.
    """
    votes = training.leaves.clusters * len(training.joints)
    try:
        read_settings(training.settings._asdict())
        check_counts(training.trees, training.growth.depth, votes)
    except UnusableModelError as error:
        msg = f'no file can hold a model with these settings: {error}'
        raise InputError(msg) from error


def train_on(
    samples: Samples,
    training: TrainingSettings,
    provenance: dict[str, str],
    progress: Progress = lambda _step: None,
    checkpoint: Checkpoint | None = None,
) -> Model:
    """Return a model trained on `samples`.

    Args:
        samples: if the settings have body yaws, the last BODY_YAW_SIZE rows of `quantised` are
            spare, and are filled.
        training: the settings.
        provenance: as `train`.
        progress: as `train`.
        checkpoint: as `train`.

    Raises:
        InputError: as `train`.
    """
    check_bounds(training)
    _check_labels(samples, training)
    growth = training.growth
    if training.settings.body_yaws:
        write_body_yaws(samples, training.joints, training.seed)
        growth = growth._replace(always=BODY_YAW_SIZE)
    edges = default_edges(training.joints)
    training = training._replace(growth=growth)
    trees = _finish_trees(samples, training, edges, progress, checkpoint)
    return Model(
        training.joints,
        edges,
        limb_lengths(samples, edges),
        training.settings,
        Forest(
            *join_trees(trees),
            join_votes([tree.joint_votes for tree in trees]),
            join_votes([tree.pair_votes for tree in trees]),
        ),
        provenance | {'people': str(len(samples.scale)), 'samples': str(len(samples.points))},
    )


def _finish_trees(
    samples: Samples,
    training: TrainingSettings,
    edges: NDArray[np.int32],
    progress: Progress,
    checkpoint: Checkpoint | None,
) -> list[FinishedTree]:
    """Return all trees: those that the checkpoint has, and the others anew."""
    key, trees = '', list[FinishedTree]()
    if checkpoint is not None:
        key = training_key(samples, _all_that_shapes_a_tree(training))
        limits = Limits(len(samples.quantised), len(training.joints), len(edges))
        trees = checkpoint.load(key, limits, training.trees)
    statistics = joint_statistics(samples, training)
    for number in range(len(trees), training.trees):
        progress(f'growing tree {number + 1} of {training.trees}')
        rng = np.random.default_rng((training.seed, number))
        tree = grow_tree(samples.quantised, statistics, training.growth, rng)
        progress(f'fitting the {len(tree.leaf_start) - 1} leaves of tree {number + 1}')
        votes = (
            fit_joint_votes(samples, tree, training.leaves),
            fit_pair_votes(samples, tree, edges, training.leaves),
        )
        trees.append(FinishedTree(tree.feature, tree.threshold, tree.left, *votes))
        if checkpoint is not None:
            checkpoint.store(key, trees)
    return trees


def _all_that_shapes_a_tree(training: TrainingSettings) -> tuple[object, ...]:
    """Return the settings without those that only choose samples, or the number of trees."""
    used = training._replace(trees=0, memory=0.0, hold_out=0.0)
    return tuple(used._replace(joints=training.joints.tolist()))


def joint_statistics(samples: Samples, training: TrainingSettings) -> JointStatistics:
    """Return the statistics that the criterion of `training` needs."""
    positions = (samples.points, samples.person, samples.joints)
    if training.criterion == ENTROPY:
        return contributions(*positions)
    return offset_moments(*positions, training.criterion_reach)


def _check_labels(samples: Samples, training: TrainingSettings) -> None:
    labelled = ~np.isnan(samples.joints[..., 0])
    missing = training.joints[~labelled.any(axis=0)]
    if len(missing):
        msg = (
            f'no frame labels {", ".join(names_of(missing))}; leave these joints out with --joints'
        )
        raise InputError(msg)


def limb_lengths(samples: Samples, edges: NDArray[np.int32]) -> NDArray[np.float32]:
    """Return the mean length of each edge over all people, metres, shape (E,): h_ij of eq. 15.

    An edge without a person with both ends labelled gets the mean of the others, or 0.3 m.
    """
    positions = samples.joints * samples.scale[:, None, None]
    limbs = np.linalg.norm(positions[:, edges[:, 1]] - positions[:, edges[:, 0]], axis=-1)
    counts = (~np.isnan(limbs)).sum(axis=0)
    lengths: NDArray[np.float32] = np.nansum(limbs, axis=0, dtype=np.float32)
    lengths /= np.maximum(counts, 1).astype(np.float32)
    lengths[counts == 0] = lengths[counts > 0].mean() if (counts > 0).any() else 0.3
    return lengths


def join_votes(parts: list[LeafVotes]) -> LeafVotes:
    """Return the leaf votes of several trees as one, with leaves numbered consecutively."""
    offsets = np.cumsum([0, *(len(votes.target) for votes in parts)])
    starts = [votes.start[:-1] + offsets[t] for t, votes in enumerate(parts)]
    return LeafVotes(
        np.concatenate([*starts, offsets[-1:]]).astype(np.int32),
        np.concatenate([votes.target for votes in parts]),
        np.concatenate([votes.offset for votes in parts]),
        np.concatenate([votes.weight for votes in parts]),
    )
