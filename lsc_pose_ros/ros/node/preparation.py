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

"""Loads the model and makes the publishers when the node is configured, and warms them up."""

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

QUICK_START = 3.0
"""Kernels from the cache on disk are ready within this time, seconds."""


class Resources(NamedTuple):
    """What the node holds while it is configured.

    Attributes:
        model: the model as it was trained.
        outputs: the publishers, not yet open.
    """

    model: Model
    outputs: Outputs

    def estimator(self, parameters: NodeSettings) -> Estimator:
        """Return the estimator that `parameters` ask for."""
        return make_estimator(self.model, parameters, 'parameter query_points')


def prepare_resources(node: Node, parameters: NodeSettings) -> Resources:
    """Load the model, and run everything once that an estimate needs.

    The first run takes much longer than the following ones.

    Args:
        node: the node; it is not changed, so any thread may prepare.
        parameters: its parameters.

    Raises:
        InputError: the parameters do not fit each other, or the model cannot be used.
    """
    segmenter = make_segmenter(parameters)
    model = _load(parameters.model)
    resources = Resources(model, Outputs(node, parameters, model.edges))
    estimator = resources.estimator(parameters)
    with _logged_duration(node):
        resources.outputs.warm_up(warm_up(estimator))
        if segmenter is not None:
            warm_up_segmenter(segmenter, parameters.background_seconds)
    return resources


@contextmanager
def _logged_duration(node: Node) -> Iterator[None]:
    """Log how long the kernels take, and log in advance if it takes long."""
    begin = time.monotonic()
    notice = 'compiling the kernels, which takes about 20 s, or minutes on a slow computer'
    timer = threading.Timer(QUICK_START, node.get_logger().info, [notice])
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
    seconds = time.monotonic() - begin
    node.get_logger().info(f'kernels ready in {seconds:.1f} s ({describe_cache()})')


def _load(name: str) -> Model:
    try:
        file = find_model(name)
    except InputError as error:
        msg = f'parameter model: {error}'
        raise InputError(msg) from error
    return load_model(file)
