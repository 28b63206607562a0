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

"""Trains the rival Shotton et al. on labelled frames."""

import itertools
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.sampled_frames import SampledFrame, decode_frames
from lsc_pose_experiments.shotton.joint_proposals import ProposalSettings
from lsc_pose_experiments.shotton.part_estimator import PartModel
from lsc_pose_experiments.shotton.part_forest import PartForest
from lsc_pose_experiments.shotton.part_forest_training import train_part_forest
from lsc_pose_experiments.shotton.part_images import part_images
from lsc_pose_experiments.shotton.part_pixels import PartPixels, classify_body, part_cloud
from lsc_pose_experiments.shotton.part_samples import collect_samples
from lsc_pose_experiments.shotton.part_tree_growth import PartGrowth
from lsc_pose_experiments.shotton.proposal_training import choose_settings
from lsc_pose_ros.body_parts.depth_grid import FARTHEST
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.image_arguments import ImageArguments
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.training.samples import select_joints


class PartModelSettings(NamedTuple):
    """The settings of the training; trees and their depth are those of the paper.

    Attributes:
        trees: number of trees.
        growth: settings of each tree.
        pixels: number of pixels of each body that are learned from its parts.
        other_pixels: number of pixels of each body that are learned from between the parts.
        hold_out: the fraction of the frames on which the settings of the proposals are chosen.
        most_held_out: the largest number of these frames.
    """

    trees: int = 3
    growth: PartGrowth = PartGrowth()
    pixels: int = 700
    other_pixels: int = 300
    hold_out: float = 0.1
    most_held_out: int = 300


def train_part_model(
    frames: Sequence[SampledFrame],
    joints: NDArray[np.uint16],
    settings: PartModelSettings,
    seed: int,
) -> PartModel:
    """Return a model trained on the labelled people in `frames`.

    Args:
        frames: in random order; the last ones are held out from the forest.
        joints: the numbers of the joints to learn; those that are never labelled are left out.
        settings: the settings.
        seed: seed of all random numbers.

    Raises:
        InputError: there is nothing to learn from.
    """
    held_out = min(round(settings.hold_out * len(frames)), settings.most_held_out)
    learned = len(frames) - held_out
    images = (image for frame in decode_frames(frames[:learned]) for image in part_images(frame))
    first = next(images, None)
    if first is None:
        msg = 'no labelled person is visible; the body parts cannot be learned'
        raise InputError(msg)
    samples = collect_samples(
        itertools.chain((first,), images),
        settings.pixels,
        settings.other_pixels,
        float(FARTHEST),
        seed,
    )
    forest = train_part_forest(samples, settings.trees, settings.growth, seed)
    labelled = joints[np.isin(joints, samples.part.astype(int) - 1)]
    return PartModel(
        labelled, forest, _proposals(decode_frames(frames[learned:]), labelled, forest)
    )


def _proposals(
    frames: Iterable[Frame], joints: NDArray[np.uint16], forest: PartForest
) -> tuple[ProposalSettings, ...]:
    """Return the settings of the part of each joint."""
    people: list[PartPixels] = []
    positions: list[NDArray[np.float32]] = []
    for frame in frames:
        if frame.ground_truth is None:
            continue
        images = ImageArguments(frame.depth, frame.labels, frame.camera)
        labelled = select_joints(frame.ground_truth, joints)
        for row, body in enumerate(frame.ground_truth.bodies.tolist()):
            pixels = classify_body(images, body, forest)
            if pixels is not None:
                people.append(pixels)
                positions.append(labelled[row])
    known = np.array(positions, np.float32).reshape(-1, len(joints), 3)
    return tuple(
        choose_settings([part_cloud(each, 1 + int(joint)) for each in people], known[:, j])
        for j, joint in enumerate(joints)
    )
