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

"""What the node does while it is active: it listens, lets the worker estimate, publishes."""

import traceback

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.estimation.temporal import Sequence
from lsc_pose_ros.pose.stage_clock import StageClock
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.ros.health.diagnostics import Diagnostics
from lsc_pose_ros.ros.health.stream_warnings import Counters, Situation, complaints
from lsc_pose_ros.ros.health.throttled_log import Reports
from lsc_pose_ros.ros.io.frame_messages import FrameMessages, frame_of
from lsc_pose_ros.ros.io.inputs import Inputs
from lsc_pose_ros.ros.node.preparation import Prepared
from lsc_pose_ros.ros.node.worker import Worker
from lsc_pose_ros.segmentation.segmenter import make_segmenter
from lsc_pose_ros.settings.table import NodeSettings

WATCH_PERIOD = 5.0

# A standing trouble is told this often, seconds.
REMINDER_PERIOD = 30.0


class Activity:
    """From activation to deactivation: subscriptions, a worker, open publishers, a watch.

    The executor's thread receives and pairs the messages; one worker thread estimates and
    publishes. Between them waits at most one pair, the newest.

    Attributes:
        inputs: what is listened to.
    """

    def __init__(self, node: Node, parameters: NodeSettings, prepared: Prepared) -> None:
        """Begin.

        Args:
            node: the node.
            parameters: its parameters.
            prepared: what it made when it was configured.

        Raises:
            InputError: the parameters ask for what is not there.
        """
        self._node = node
        self._parameters = parameters
        self._prepared = prepared
        self._reports = Reports(node.get_logger())
        self._reminders = Reports(node.get_logger(), REMINDER_PERIOD)
        self._sequence = Sequence(prepared.estimator(parameters), parameters)
        self._segmenter = make_segmenter(parameters)
        self._ready = True
        self._tell_what_is_learnt()
        self._outputs = prepared.outputs
        self._outputs.parameters = parameters
        self._outputs.open()
        self._worker: Worker[FrameMessages] = Worker(self._answer, self._fail, 'estimation')
        self.inputs = Inputs(node, parameters, self._reports, self._worker.submit)
        self._seen = self._counters()
        self._diagnostics = Diagnostics(node, self._counters)
        # Trouble is real time's, whatever clock the recording brings.
        steady = Clock(clock_type=ClockType.STEADY_TIME)
        self._timer = node.create_timer(WATCH_PERIOD, self._watch, clock=steady)
        self._worker.start()

    def change(self, parameters: NodeSettings) -> None:
        """Go on with other values of the parameters that can be changed at any time."""
        before, self._parameters = self._parameters, parameters
        self._outputs.parameters = parameters
        self._sequence.settings = parameters
        if parameters.query_points != before.query_points:
            self._sequence.estimator = self._prepared.estimator(parameters)
        if parameters.sync_slop != before.sync_slop:
            self.inputs.set_sync_slop(parameters.sync_slop)

    def close(self, patience: float = 5.0) -> None:
        """Stop listening, and publish no more.

        Args:
            patience: seconds to wait for the answer that is being worked on.
        """
        self.inputs.close()
        self._worker.close(patience)
        self._node.destroy_timer(self._timer)
        self._diagnostics.close()
        self._outputs.close()

    def _answer(self, pair: FrameMessages) -> None:
        """Answer one depth image; in the worker's thread."""
        stage = self._diagnostics.measuring.stage
        with stage('decode'):
            frame = frame_of(
                pair, self.inputs.topics, self._parameters.mask_background, self._segmenter
            )
        self._tell_what_is_learnt()
        clock = StageClock()
        with stage('estimate'):
            skeletons = self._sequence.answer(
                frame.stamp, frame.depth, frame.labels, frame.camera, clock
            )
        self._diagnostics.measuring.add_stages(clock.seconds)
        with stage('publish'):
            self._outputs.publish(frame.stamp, frame.frame_id, skeletons)
        self._diagnostics.answered(frame.stamp, len(skeletons.bodies))

    def _tell_what_is_learnt(self) -> None:
        ready = self._segmenter is None or self._segmenter.ready
        if ready and not self._ready:
            self._node.get_logger().info('the empty scene is learnt')
        elif self._ready and not ready:
            self._node.get_logger().info('learning the empty scene: nobody should be in view')
        self._ready = ready

    def _fail(self, error: Exception) -> None:
        """Tell why a depth image stays unanswered; in the worker's thread."""
        if not self._node.context.ok():
            return  # publishing fails when the node is being shut down; that is no news
        self._diagnostics.measuring.failed()
        if isinstance(error, InputError):
            self._reports.error(str(error), str(error))
        else:
            text = ''.join(traceback.format_exception(error))
            self._reports.error(type(error).__name__, f'a frame was left out: {text}')

    def _watch(self) -> None:
        before, self._seen = self._seen, self._counters()
        situation = Situation(
            self.inputs.topics,
            self.inputs.publishers(),
            str(resource('config', 'fastdds_profile.xml')),
        )
        for kind, text in complaints(before, self._seen, situation).items():
            self._reminders.warning(kind, text)

    def _counters(self) -> Counters:
        return self.inputs.counters(self._worker.replaced)
