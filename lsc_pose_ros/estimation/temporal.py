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

"""Estimates a sequence of frames: bodies are tracked, and their joints are smoothed.

The live node and the replay of a recording both use this, so their results are equal.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.image_arguments import ImageArguments, check_images
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.estimation.person_history import PersonHistory
from lsc_pose_ros.pose.estimator import Estimator, largest_bodies
from lsc_pose_ros.pose.inference.confidence import body_confidence
from lsc_pose_ros.pose.inference.stature import statures
from lsc_pose_ros.pose.stages import Observer
from lsc_pose_ros.settings.table import NO_POSITION, TemporalSettings
from lsc_pose_ros.tracking.one_euro import OneEuroBodies, OneEuroSettings
from lsc_pose_ros.tracking.surfaces import Surface, surfaces_of
from lsc_pose_ros.tracking.tracker import Tracker

# A stamp that goes back by more than this restarts the sequence, nanoseconds.
REWIND_NS = 500_000_000

HIDDEN_CONFIDENCE = 0.3
"""Joints with less confidence have no position if `hidden_joints` is nan."""


class TemporalEstimator:
    """Estimates the frames of one sequence; not reentrant.

    Attributes:
        estimator: estimates the joints of a frame. It can be replaced at any time, from any
            thread, by an estimator of the same joints.
        settings: settings of tracking and smoothing. They can be replaced at any time, from any
            thread.
        left_out: the number of bodies that were left out because of their low confidence or their
            small stature.
        beyond_maximum: the number of bodies that were not estimated because there were larger
            ones, as many as `Estimator.maximum_bodies`.
        labels: the label of each pixel of the last frame, after fragments of bodies were joined,
            shape (H, W).
        labels_of: the label of each body of the last frame, by its number.
    """

    def __init__(self, estimator: Estimator, settings: TemporalSettings) -> None:
        """Start without history.

        Args:
            estimator: estimates the joints of a frame.
            settings: settings of tracking and smoothing.
        """
        self.estimator = estimator
        self.settings = settings
        self.left_out = 0
        self.beyond_maximum = 0
        self.labels: NDArray[np.int32] = np.zeros((0, 0), np.int32)
        self.labels_of: dict[int, int] = {}
        self.reset()

    def reset(self) -> None:
        """Delete the history."""
        self._newest: int | None = None
        self._tracker = Tracker()
        self._filter = OneEuroBodies()
        self._history = PersonHistory()

    def estimate(
        self,
        stamp: int,
        depth: NDArray[np.floating],
        labels: NDArray[np.signedinteger],
        camera: Intrinsics,
        observer: Observer | None = None,
        *,
        from_mask: bool = True,
    ) -> Skeletons:
        """Return the joints of all bodies in a frame, ascending by body number.

        Bodies below the minimum confidence or stature are left out.

        Args:
            stamp: nanoseconds; if it goes back by more than REWIND_NS, the sequence restarts.
            depth: metres, 0 if unknown, shape (H, W).
            labels: the body number of each pixel, NO_BODY for none, shape (H, W).
            camera: the intrinsics.
            observer: called when a stage of the estimate has ended, for each body.
            from_mask: whether the labels are those of a mask image.

        Raises:
            InputError: as `Estimator.estimate`.
        """
        if self._is_earlier(stamp):
            self.reset()
        images = check_images(depth, labels, camera)
        settings = self.settings
        if settings.tracks(from_mask=from_mask):
            images = images._replace(labels=self._tracker.join_fragments(stamp, images))
        self.labels = images.labels
        surfaces = self._surfaces_of(images)
        memory = None
        if settings.temporal:
            memory = self._history
            memory.begin(stamp, surfaces)
        skeletons, beyond = self.estimator.estimate_largest(*images, observer, memory)
        self.beyond_maximum += beyond
        return self.follow(stamp, skeletons, surfaces, from_mask=from_mask)

    def follow(
        self,
        stamp: int,
        skeletons: Skeletons,
        surfaces: Mapping[int, Surface],
        *,
        from_mask: bool = True,
    ) -> Skeletons:
        """Return `skeletons` with persistent body numbers, smoothed, depending on the settings.

        Bodies below the minimum confidence or stature are left out.

        Args:
            stamp: nanoseconds.
            skeletons: the estimate of a frame.
            surfaces: of the bodies, by number.
            from_mask: whether the numbers of the bodies are those of a mask image.
        """
        if self._is_earlier(stamp):
            self.reset()
        self._newest = stamp if self._newest is None else max(stamp, self._newest)
        settings = self.settings
        skeletons = self._without_doubtful(skeletons)
        self.labels_of = {number: number for number in skeletons.bodies.tolist()}
        if settings.tracks(from_mask=from_mask):
            skeletons = self._tracker.follow(stamp, skeletons, surfaces)
            self.labels_of = self._tracker.labels_of(stamp)
        if settings.smoothing:
            smoothing = OneEuroSettings(settings.smoothing_cutoff, settings.smoothing_beta)
            skeletons = self._filter.filter(stamp, skeletons, smoothing)
        return without_hidden(skeletons) if settings.hidden_joints == NO_POSITION else skeletons

    def _surfaces_of(self, images: ImageArguments) -> Mapping[int, Surface]:
        """Return the surfaces of the bodies that are estimated, by number."""
        surfaces = surfaces_of(images)
        most = self.estimator.maximum_bodies
        if most is None or len(surfaces) <= most:
            return surfaces
        estimated, _ = largest_bodies(images.labels, most)
        return {number: surfaces[number] for number in estimated.tolist() if number in surfaces}

    def _is_earlier(self, stamp: int) -> bool:
        """Return whether the stamps have gone back."""
        return self._newest is not None and stamp < self._newest - REWIND_NS

    def _without_doubtful(self, skeletons: Skeletons) -> Skeletons:
        certain = body_confidence(skeletons.confidence) >= self.settings.minimum_body_confidence
        # Written so that an unknown stature, NaN, is not too small.
        stature = statures(skeletons.positions, skeletons.joints)
        certain &= ~(stature < self.settings.minimum_stature)
        # A body without any estimated joint may still be one: too little of it is visible.
        certain |= np.isnan(skeletons.positions).all(axis=(1, 2))
        if certain.all():
            return skeletons
        self.left_out += int((~certain).sum())
        return skeletons._replace(
            bodies=skeletons.bodies[certain],
            positions=skeletons.positions[certain],
            confidence=skeletons.confidence[certain],
        )


def without_hidden(skeletons: Skeletons) -> Skeletons:
    """Return `skeletons` without the positions of joints below HIDDEN_CONFIDENCE."""
    hidden = skeletons.confidence < HIDDEN_CONFIDENCE
    return skeletons._replace(
        positions=np.where(hidden[..., None], np.float32(np.nan), skeletons.positions),
        confidence=np.where(hidden, np.float32(0), skeletons.confidence),
    )
