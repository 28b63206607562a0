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

"""Estimates the joints of each body in a depth image with one model."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.conversion import LARGEST_BODY
from lsc_pose_ros.data_types.image_arguments import ImageArguments, check_images, thin_out
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.inference.past import Past
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.stages import Observer, Stage, method_stages, run_stages

FARTHEST = 100.0
"""No depth camera measures people at a larger distance, metres."""


class Memory(Protocol):
    """Knows the people of the frames before."""

    def recall(self, number: int) -> Past | None:
        """Return what is expected of a body of this frame; None if nothing is."""

    def remember(self, body: BodyEstimate) -> NDArray[np.float32]:
        """Keep the estimate of a body of this frame; return its joints, metres, shape (J, 3)."""


class Estimator:
    """Estimates joints with one model.

    Attributes:
        model: a trained model.
        graph: whether the pictorial structure joins the modes.
        maximum_bodies: how many bodies of a frame are estimated; None for all.
        stages: the stages of the method in their order.
    """

    def __init__(
        self,
        model: Model,
        *,
        graph: bool = True,
        maximum_bodies: int | None = None,
        stages: Sequence[Stage] | None = None,
    ) -> None:
        """Prepare the stages.

        Args:
            model: a trained model.
            graph: whether the pictorial structure joins the modes (eq. 16, 17); without it each
                joint is the highest mode of its own density (eq. 14).
            maximum_bodies: estimate only so many bodies of a frame, those with the most pixels;
                None for all.
            stages: stages to run instead of those of the method, with the same results.

        Raises:
            InputError: `model` is not a Model.
        """
        if not isinstance(model, Model):
            msg = (
                f'model is of type {type(model).__name__}, but must be a Model; '
                'lsc_pose_ros.load_model reads one from a file or by its name'
            )
            raise InputError(msg)
        self.model = model
        self.graph = graph
        self.maximum_bodies = maximum_bodies
        self.stages = tuple(stages or method_stages(model, graph=graph))

    @property
    def joints(self) -> NDArray[np.uint16]:
        """The numbers of the joints that are estimated, shape (J,)."""
        return self.model.joints

    def estimate(
        self,
        depth: NDArray[np.floating],
        labels: NDArray[np.signedinteger],
        camera: Intrinsics,
        observer: Observer | None = None,
    ) -> Skeletons:
        """Return the joints of each body in `labels`, in the order of the bodies' numbers.

        Of images with more than MOST_PIXELS only some pixels are used. If too little of a body is
        visible, its joints are NaN with confidence 0.

        Args:
            depth: metres, 0 if the sensor measured nothing, shape (H, W). float32 is the fastest;
                `metres_from_millimetres` converts millimetres.
            labels: the body number of each pixel, NO_BODY for none, shape (H, W). int32 is the
                fastest; `labels_from_mask` converts masks.
            camera: the intrinsics.
            observer: called when a stage has ended, for each body.

        Raises:
            InputError: an argument has another type, shape or unit.
        """
        return self.estimate_largest(depth, labels, camera, observer)[0]

    def estimate_largest(
        self,
        depth: NDArray[np.floating],
        labels: NDArray[np.signedinteger],
        camera: Intrinsics,
        observer: Observer | None = None,
        memory: Memory | None = None,
    ) -> tuple[Skeletons, int]:
        """Return what `estimate` returns, and how many bodies are beyond `maximum_bodies`.

        Arguments and exceptions as `estimate`; besides:

        Args:
            depth: as `estimate`.
            labels: as `estimate`.
            camera: as `estimate`.
            observer: as `estimate`.
            memory: what the frames before say of each body; None for nothing.
        """
        images = thin_out(check_images(depth, labels, camera))
        bodies, beyond = largest_bodies(images.labels, self.maximum_bodies)
        _check_background(images.labels, bodies)
        count = len(self.model.joints)
        positions = np.full((len(bodies), count, 3), np.nan, np.float32)
        confidence = np.zeros((len(bodies), count), np.float32)
        for row, number in enumerate(bodies):
            past = None if memory is None else memory.recall(int(number))
            body = self._estimate_body(images, int(number), observer, past)
            if body is not None:
                positions[row] = body.joints if memory is None else memory.remember(body)
                confidence[row] = body.confidence
        _check_unit(positions[..., 2])
        return Skeletons(bodies, self.model.joints, positions, confidence), beyond

    def estimate_body(
        self,
        depth: NDArray[np.floating],
        labels: NDArray[np.signedinteger],
        camera: Intrinsics,
        number: int,
        observer: Observer | None = None,
    ) -> BodyEstimate | None:
        """Return the results of all stages for one body, or None if too little of it is visible.

        Args:
            depth: as `estimate`.
            labels: as `estimate`.
            camera: as `estimate`.
            number: the body's number in `labels`.
            observer: as `estimate`.

        Raises:
            InputError: an argument has another type or shape.
        """
        return self._estimate_body(check_images(depth, labels, camera), number, observer)

    def _estimate_body(
        self,
        images: ImageArguments,
        number: int,
        observer: Observer | None,
        past: Past | None = None,
    ) -> BodyEstimate | None:
        body = BodyEstimate.in_image(*images, number, past)
        return body if run_stages(self.stages, body, observer) else None


def bodies_in(labels: NDArray[np.int32]) -> NDArray[np.uint16]:
    """Return the numbers of the bodies in `labels`, sorted, shape (B,).

    Raises:
        InputError: as `largest_bodies`.
    """
    return largest_bodies(labels)[0]


def largest_bodies(
    labels: NDArray[np.int32], most: int | None = None
) -> tuple[NDArray[np.uint16], int]:
    """Return the bodies with the most pixels, and how many others there are.

    Args:
        labels: the body number of each pixel, negative for none, shape (H, W).
        most: how many bodies are returned at most; None for all.

    Returns:
        The numbers of the bodies, sorted, shape (B,), and the number of the others. Of equally
        large bodies, those with the lower numbers are returned.

    Raises:
        InputError: a number is larger than LARGEST_BODY.
    """
    foreground = labels[labels >= 0]
    largest = foreground.max(initial=0)
    if largest > LARGEST_BODY:
        msg = f'labels has the body number {largest}; the largest possible is {LARGEST_BODY}'
        raise InputError(msg)
    sizes = np.bincount(foreground)
    bodies = np.flatnonzero(sizes)
    beyond = 0 if most is None else max(len(bodies) - most, 0)
    if beyond:
        order = np.argsort(-sizes[bodies], kind='stable')
        bodies = np.sort(bodies[order[:most]])
    return bodies.astype(np.uint16), beyond


def _check_background(labels: NDArray[np.int32], bodies: NDArray[np.uint16]) -> None:
    """Raise InputError if body 0 seems to be the background of a mask."""
    if len(bodies) and bodies[0] == 0 and labels.min() >= 0:
        msg = (
            'labels has no pixel without a body (NO_BODY, -1), but 0 as the number of a body; if '
            '0 is the background of the mask, set mask_background to 0, or convert the mask with '
            'lsc_pose_ros.labels_from_mask(mask, background=0)'
        )
        raise InputError(msg)


def _check_unit(distances: NDArray[np.float32]) -> None:
    """Raise InputError if all estimated joints are farther away than any camera measures.

    Args:
        distances: z of the joints, NaN if not estimated, shape (B, J).
    """
    if (distances <= FARTHEST).any() or not (distances > FARTHEST).any():
        return
    msg = (
        f'depth must be in metres, but its values on the bodies are above {FARTHEST:.0f}; '
        'convert millimetres with lsc_pose_ros.metres_from_millimetres(depth)'
    )
    raise InputError(msg)
