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

"""What the node makes when it is configured: a model and publishers, checked and warmed up."""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from typing import NamedTuple

from rclpy.node import Node

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.estimation.model_settings import make_estimator
from lsc_pose_ros.estimation.warm_up import warm_up, warm_up_segmenter
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.numerics.kernel_cache import describe_cache
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.resources.package_files import find_model
from lsc_pose_ros.ros.io.outputs import Outputs
from lsc_pose_ros.segmentation.segmenter import make_segmenter
from lsc_pose_ros.settings.table import NodeSettings

# Kernels that are kept on disk are ready within this time, seconds.
QUICK_START = 3.0


class Prepared(NamedTuple):
    """What answers need, ready for the first of them.

    Attributes:
        model: as it was trained.
        outputs: the publishers, not yet open.
    """

    model: Model
    outputs: Outputs

    def estimator(self, parameters: NodeSettings) -> Estimator:
        """Return an estimator as `parameters` ask for it."""
        return make_estimator(self.model, parameters, 'parameter query_points')


def prepare(node: Node, parameters: NodeSettings) -> Prepared:
    """Load the model, and do once all that an answer takes: the first time takes far longer.

    Args:
        node: the node; it is not touched, so that any thread may prepare.
        parameters: the node's.

    Raises:
        InputError: the parameters do not go together, or the model cannot be used.
    """
    segmenter = make_segmenter(parameters)
    model = _load(parameters.model)
    prepared = Prepared(model, Outputs(node, parameters, model.edges))
    estimator = prepared.estimator(parameters)
    with _told_if_it_takes_long(node):
        prepared.outputs.rehearse(warm_up(estimator))
        if segmenter is not None:
            warm_up_segmenter(segmenter, parameters.background_seconds)
    return prepared


@contextmanager
def _told_if_it_takes_long(node: Node) -> Iterator[None]:
    begin = time.monotonic()
    notice = 'compiling the kernels, which takes about half a minute'
    patience = threading.Timer(QUICK_START, node.get_logger().info, [notice])
    patience.daemon = True
    patience.start()
    try:
        yield
    finally:
        patience.cancel()
    seconds = time.monotonic() - begin
    node.get_logger().info(f'kernels ready in {seconds:.1f} s ({describe_cache()})')


def _load(name: str) -> Model:
    try:
        file = find_model(name)
    except InputError as error:
        msg = f'parameter model: {error}'
        raise InputError(msg) from error
    return load_model(file)
