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

"""Compile all kernels in advance: `python -m lsc_pose_ros.compile`.

Otherwise, kernels are compiled on first use and cached on disk. Run this program after the
installation, as the user who will run the other programs and on the same computer.
"""

import argparse
import sys
import time
from collections.abc import Sequence

import numpy as np

from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.estimation.warm_up import warm_up, warm_up_segmenter
from lsc_pose_ros.messages.codecs.rvl import encode_rvl
from lsc_pose_ros.numerics.kernel_cache import describe_cache
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.features.shape_context_3d import DESCRIPTOR_SIZE
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import FEATURES, Settings
from lsc_pose_ros.segmentation.segmenter import make_segmenter
from lsc_pose_ros.settings.table import SEGMENTATIONS, SegmentationSettings
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.training.criterion import ENTROPY, SPREAD, contributions, offset_moments
from lsc_pose_ros.training.train import TrainingSettings, train
from lsc_pose_ros.training.tree_growth import BRANCH_SAMPLES, GrowthSettings, grow_tree


def main(words: Sequence[str] | None = None) -> int:
    """Compile all kernels, print the time and the folder of the cache, and return 0."""
    description, _, more = (__doc__ or '').partition('\n\n')
    argparse.ArgumentParser(
        prog='python -m lsc_pose_ros.compile', description=description, epilog=more
    ).parse_args(words)
    begin = time.monotonic()
    compile_kernels()
    seconds = time.monotonic() - begin
    sys.stdout.write(f'all kernels ready in {seconds:.1f} s ({describe_cache()})\n')
    return 0


def compile_kernels() -> None:
    """Call each kernel once: synthetic people, training, estimation, RVL images."""
    model = _train()
    for graph in (True, False):
        warm_up(Estimator(model, graph=graph))
    for segmentation in SEGMENTATIONS:
        settings = SegmentationSettings(segmentation)
        segmenter = make_segmenter(settings)
        if segmenter is not None:
            warm_up_segmenter(segmenter, settings.background_seconds)
    encode_rvl(np.zeros(1, np.uint16))
    scenes = [
        SyntheticSettings(frames=2, sensor=sensor, rate=30.0, background=True)
        for sensor in ('kinect_v1', 'tof')  # triangulation and time of flight
    ]
    for scene in (*scenes, SyntheticSettings(frames=1, furniture=True, sloppy_masks=True)):
        for _ in synthetic_frames(scene):
            pass


def _train() -> Model:
    """Train on two frames of two people with each feature, and grow the top of a larger tree.

    Returns:
        a model with the paper's feature and body yaw.
    """
    training = TrainingSettings(numbers_of(DEFAULT_JOINTS), trees=1)
    settings = SyntheticSettings(frames=2, people=2)
    choices = [(feature, SPREAD) for feature in FEATURES] + [(FEATURES[0], ENTROPY)]
    model, *_ = (
        train(
            synthetic_frames(settings),
            training._replace(
                settings=Settings(feature=feature, body_yaws=2, noise_factor=1.0, fill_holes=5),
                criterion=criterion,
            ),
            {},
        )
        for feature, criterion in choices
    )
    rng = np.random.default_rng(0)
    quantised = rng.integers(0, 256, (DESCRIPTOR_SIZE, BRANCH_SAMPLES), np.uint8)
    person = np.zeros(BRANCH_SAMPLES, np.int32)
    nowhere = (
        rng.random((BRANCH_SAMPLES, 3), np.float32),
        person,
        np.zeros((1, 1, 3), np.float32),
    )
    for statistics in (contributions(*nowhere), offset_moments(*nowhere, 1.0)):
        grow_tree(quantised, statistics, GrowthSettings(depth=1), rng)
    return model


if __name__ == '__main__':
    sys.exit(main())
