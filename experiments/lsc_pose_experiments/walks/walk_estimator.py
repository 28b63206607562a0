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

"""Estimates joints as Random Tree Walks."""

from functools import partial
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_experiments.body_by_body import estimate_bodies
from lsc_pose_experiments.walks.body_grid import body_centre, body_grid, pinhole_images
from lsc_pose_experiments.walks.walk_order import walk_order
from lsc_pose_experiments.walks.walk_trees import DirectionTrees, WalkSettings, walk_body
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.image_arguments import ImageArguments, check_images
from lsc_pose_ros.data_types.skeletons import Skeletons


class WalkModel(NamedTuple):
    """What the training learns.

    Attributes:
        joints: the numbers of the joints, shape (J,).
        trees: of the J joints.
        walk: settings of the walks.
        seed: seed of the random numbers that choose the directions.
    """

    joints: NDArray[np.uint16]
    trees: DirectionTrees
    walk: WalkSettings
    seed: int


class WalkEstimator:
    """Estimates each joint by a walk that starts at the joint before it."""

    def __init__(self, model: WalkModel) -> None:
        """Prepare the estimation with a trained model.

        All bodies are walked with the same random numbers, so the same image gives the same
        joints.
        """
        self._model = model
        self._order = walk_order(model.joints)
        rng = np.random.default_rng(model.seed)
        self._draws = rng.random((len(model.joints), model.walk.steps), np.float32)

    @property
    def joints(self) -> NDArray[np.uint16]:
        """The numbers of the joints that are estimated, shape (J,)."""
        return self._model.joints

    def estimate(
        self,
        depth: NDArray[np.floating],
        labels: NDArray[np.signedinteger],
        camera: Intrinsics,
    ) -> Skeletons:
        """Return the joints of each body in `labels`, in the order of the bodies' numbers.

        Args:
            depth: metres, 0 if the sensor measured nothing, shape (H, W).
            labels: the body number of each pixel, NO_BODY for none, shape (H, W).
            camera: the intrinsics.

        Raises:
            InputError: an argument has another type, shape or unit.
        """
        images = check_images(depth, labels, camera)
        walk = partial(self._walk, pinhole_images(images))
        return estimate_bodies(images, self.joints, walk)

    def _walk(self, images: ImageArguments, body: int) -> NDArray[np.float32] | None:
        """Return position and confidence of each joint, shape (J, 4); None without depth."""
        grid = body_grid(images, body)
        if grid is None:
            return None
        model = self._model
        walked: NDArray[np.float32] = walk_body(
            grid, body_centre(grid), model.trees, self._order, self._draws, model.walk
        )
        return walked
