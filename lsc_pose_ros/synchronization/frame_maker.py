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

"""Makes labelled frames from synchronized messages, for the live node and for recordings."""

from collections import Counter

from lsc_pose_ros.camera.roll import upright
from lsc_pose_ros.camera.roll_finder import RollFinder
from lsc_pose_ros.data_types.conversion import DepthRange
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.frames import FrameTopics, make_frame
from lsc_pose_ros.messages.image_pixels import AnyImage
from lsc_pose_ros.messages.mask_check import MaskCheck
from lsc_pose_ros.messages.parse import StampedCamera
from lsc_pose_ros.segmentation.ground_truth_numbers import numbered_as_ground_truth
from lsc_pose_ros.segmentation.segmenter import make_segmenter, segment
from lsc_pose_ros.settings.table import AUTO, PEOPLE, FrameSettings

# A camera info can be wrong in another way with each frame; so many ways are told.
_MOST_OF_A_KIND = 3


class FrameMaker:
    """Makes the frames of one sequence, one after the other.

    Attributes:
        camera: how the last camera info was read: which matrix was taken, and why.
        roll_finder: finds the roll of the camera; add transforms to its tree as they come.
        bodies: how the bodies of the last frame were found.
        warnings: sentences on what is suspicious so far, each once, and few of one kind.
    """

    def __init__(self, topics: FrameTopics, settings: FrameSettings) -> None:
        """Start a sequence.

        Args:
            topics: the topics of the messages.
            settings: how frames are made.

        Raises:
            InputError: the segmentation is unknown, or a range is empty.
        """
        if not settings.minimum_depth < settings.maximum_depth:
            msg = (
                f'minimum_depth is {settings.minimum_depth:g} m and maximum_depth '
                f'{settings.maximum_depth:g} m; minimum_depth must be the smaller'
            )
            raise InputError(msg)
        self.camera = self.bodies = ''
        self.roll_finder = RollFinder(settings.roll, settings.gravity_frame)
        self.warnings: list[str] = []
        self._warned: Counter[str] = Counter()
        self._topics = topics
        self._settings = settings
        self._segmenter = make_segmenter(settings)
        self._mask_check = MaskCheck(topics.mask, settings.mask_background)

    @property
    def ready(self) -> bool:
        """Whether bodies can be found: the segmenter, if there is one, has learnt the scene."""
        return self._segmenter is None or self._segmenter.ready

    def make(
        self,
        depth: AnyImage,
        mask: AnyImage | None,
        camera: StampedCamera,
        ground_truth: Skeletons | None = None,
    ) -> Frame:
        """Return the next frame, upright; arguments as `make_frame`.

        Raises:
            InputError: a message cannot be used; the error names its topic.
        """
        self._note_camera(camera)
        settings = self._settings
        frame = make_frame(
            depth,
            mask,
            camera,
            ground_truth,
            topics=self._topics,
            mask_background=settings.mask_background,
            depth_range=DepthRange(settings.minimum_depth, settings.maximum_depth),
        )
        frame = upright(frame, self.roll_finder.find(frame.frame_id))
        self._warn('roll', self.roll_finder.warning)
        with_mask = mask is not None and self._settings.reads_masks
        self.bodies = self._describe_bodies(with_mask=with_mask)
        if self._segmenter is not None and not with_mask:
            labels = segment(self._segmenter, frame.stamp, frame.depth, frame.camera)
            if frame.ground_truth is not None:
                labels = numbered_as_ground_truth(labels, frame.ground_truth, frame.camera)
            frame = frame._replace(labels=labels, from_mask=False)
            self._warn('segmenter', self._segmenter.warning)
        elif with_mask:
            self._mask_check.add(frame.labels)
            self._warn('mask', self._mask_check.warning)
        return frame

    def _describe_bodies(self, *, with_mask: bool) -> str:
        if with_mask:
            return f'bodies are the masks of {self._topics.mask}'
        if self._segmenter is None:
            return 'bodies are not found: there is no mask'
        if self._settings.segmentation != AUTO:
            return f'bodies are found by segmentation {self._settings.segmentation}'
        return f'bodies are found by segmentation {PEOPLE}, because there is no mask'

    def _note_camera(self, camera: StampedCamera) -> None:
        self.camera = camera.choice
        self._warn('camera', camera.warning and f'{self._topics.camera_info}: {camera.warning}')

    def _warn(self, kind: str, warning: str) -> None:
        if not warning or warning in self.warnings or self._warned[kind] == _MOST_OF_A_KIND:
            return
        self._warned[kind] += 1
        self.warnings.append(warning)
