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

"""One body of one frame with all results of the stages of the method."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.pose.forest.body_yaw_tracking import BodyYawBelief
from lsc_pose_ros.pose.forest.votes import Votes
from lsc_pose_ros.pose.inference.candidates import Candidates
from lsc_pose_ros.pose.inference.past import Past
from lsc_pose_ros.pose.inference.truncation import Cuts
from lsc_pose_ros.pose.silhouette.preprocessing import Window
from lsc_pose_ros.pose.silhouette.silhouette import Silhouette


@dataclass(slots=True)
class BodyEstimate:
    """One body: the images that show it, and the results of the stages that have run.

    A stage reads the attributes that earlier stages have set, and sets its own. An attribute
    whose stage has not run is not set: reading it raises AttributeError.

    Attributes:
        depth: metres, 0 if the sensor measured nothing, shape (H, W).
        labels: the body number of each pixel, NO_BODY for none, shape (H, W).
        camera: the intrinsics.
        number: the body's number in `labels`.
        past: what the frames before say of the person; None for nothing.
        window: the body, cut out of the image.
        cuts: where the body is cut off, or hidden by something nearer.
        silhouette: its silhouette (eq. 1, 2).
        scale: the unit of length, rho_bar or as `unit_of_length`, metres.
        queries: the indices of the silhouette's points that vote, shape (Q,).
        points: the points that vote, metres, shape (Q, 3).
        quantised: their quantised descriptors, shape (Q, F) (eq. 3, 4).
        body_yaw: what is known of the body yaw after this frame; None if the trees do not split by
            it.
        leaves: the leaf that each of them reaches in each tree, shape (Q, T).
        joint_votes: the votes for each joint (eq. 13).
        pair_votes: the votes for each edge.
        candidates: the modes of each joint's density (eq. 14).
        unary: each joint's highest mode, metres, NaN for a joint without one, shape (J, 3).
        chosen: the best combination of modes over the trees, likewise (eq. 16).
        joints: the estimated joints, likewise (eq. 17); `unary` without the graph.
        confidence: the confidence in each joint, 0 to 1, shape (J,).
    """

    depth: NDArray[np.float32] = field(init=False)
    labels: NDArray[np.int32] = field(init=False)
    camera: Intrinsics = field(init=False)
    number: int = field(init=False)
    past: Past | None = field(init=False)
    window: Window = field(init=False)
    cuts: Cuts = field(init=False)
    silhouette: Silhouette = field(init=False)
    scale: float = field(init=False)
    queries: NDArray[np.int64] = field(init=False)
    points: NDArray[np.float32] = field(init=False)
    quantised: NDArray[np.uint8] = field(init=False)
    body_yaw: BodyYawBelief | None = field(init=False)
    leaves: NDArray[np.int32] = field(init=False)
    joint_votes: Votes = field(init=False)
    pair_votes: Votes = field(init=False)
    candidates: Candidates = field(init=False)
    unary: NDArray[np.float32] = field(init=False)
    chosen: NDArray[np.float32] = field(init=False)
    joints: NDArray[np.float32] = field(init=False)
    confidence: NDArray[np.float32] = field(init=False)

    @classmethod
    def in_image(
        cls,
        depth: NDArray[np.float32],
        labels: NDArray[np.int32],
        camera: Intrinsics,
        number: int,
        past: Past | None = None,
    ) -> 'BodyEstimate':
        """Return a body for the first stage; the attributes are the arguments."""
        body = cls()
        body.depth, body.labels, body.camera, body.number = depth, labels, camera, number
        body.past = past
        return body

    @classmethod
    def from_descriptors(
        cls, points: NDArray[np.float32], quantised: NDArray[np.uint8], scale: float
    ) -> 'BodyEstimate':
        """Return a body for `joint_stages`; the attributes are the arguments."""
        body = cls()
        body.points, body.quantised, body.scale = points, quantised, scale
        body.past = None
        return body
