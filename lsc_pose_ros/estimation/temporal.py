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

"""Frames that follow one another: bodies keep their numbers, and their joints are smoothed.

The live node and the replay of a recording both answer through this, so they answer alike.
"""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.stages import Observer
from lsc_pose_ros.settings.table import TemporalSettings
from lsc_pose_ros.tracking.one_euro import OneEuroBodies, OneEuroSettings
from lsc_pose_ros.tracking.tracker import Tracker

# Stamps that go back this far, nanoseconds: a recording has begun again.
REWIND_NS = 500_000_000


class Sequence:
    """Answers one frame after the other; from one thread at a time.

    Attributes:
        estimator: what estimates the joints; may be replaced at any time, from any thread, by
            one that estimates the same joints.
        settings: what is done with them; may be replaced at any time, from any thread.
    """

    def __init__(self, estimator: Estimator, settings: TemporalSettings) -> None:
        """Begin without a past.

        Args:
            estimator: what estimates the joints.
            settings: what is done with them.
        """
        self.estimator = estimator
        self.settings = settings
        self.reset()

    def reset(self) -> None:
        """Forget the frames so far."""
        self._newest: int | None = None
        self._tracker = Tracker()
        self._filter = OneEuroBodies()

    def answer(
        self,
        stamp: int,
        depth: NDArray[np.float32],
        labels: NDArray[np.int32],
        camera: Intrinsics,
        observer: Observer | None = None,
    ) -> Skeletons:
        """Return the joints of every body in a frame, in the order of the bodies' numbers.

        Args:
            stamp: nanoseconds; where it goes back by half a second, the sequence begins anew.
            depth: metres, 0 where the sensor saw nothing, shape (H, W).
            labels: the body number of each pixel, NO_BODY for none, shape (H, W).
            camera: the intrinsics.
            observer: called when a stage of the estimate has ended, for each body.
        """
        return self.follow(stamp, self.estimator.estimate(depth, labels, camera, observer))

    def follow(self, stamp: int, skeletons: Skeletons) -> Skeletons:
        """Return the estimator's answer to a frame with lasting numbers, smoothed, as is set.

        Args:
            stamp: nanoseconds.
            skeletons: the estimator's answer.
        """
        if self._newest is not None and stamp < self._newest - REWIND_NS:
            self.reset()
        self._newest = stamp if self._newest is None else max(stamp, self._newest)
        settings = self.settings
        if settings.tracked:
            skeletons = self._tracker.follow(stamp, skeletons)
        if settings.smoothing:
            smoothing = OneEuroSettings(settings.smoothing_cutoff, settings.smoothing_beta)
            skeletons = self._filter.filter(stamp, skeletons, smoothing)
        return skeletons
