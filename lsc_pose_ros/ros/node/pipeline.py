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

"""The path of a frame through the active node: subscriptions, estimation, publishers."""

import traceback
from functools import partial
from typing import TYPE_CHECKING

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from lsc_pose_ros.camera.roll import in_camera_frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.estimation.temporal import TemporalEstimator
from lsc_pose_ros.messages.human_bodies import BodyImage
from lsc_pose_ros.pose.stage_clock import StageClock
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.ros.health.diagnostics import Diagnostics
from lsc_pose_ros.ros.health.state_log import StateLog
from lsc_pose_ros.ros.health.stream_monitor import StreamMonitor
from lsc_pose_ros.ros.health.stream_warnings import Counters
from lsc_pose_ros.ros.health.throttled_log import ThrottledLog, kind_of
from lsc_pose_ros.ros.io.frame_messages import FrameMessages, frame_of
from lsc_pose_ros.ros.io.inputs import Inputs
from lsc_pose_ros.ros.io.transform_listener import TransformListener
from lsc_pose_ros.ros.node.preparation import Resources
from lsc_pose_ros.ros.node.worker import Worker
from lsc_pose_ros.settings.table import NodeSettings
from lsc_pose_ros.synchronization.frame_maker import FrameMaker

if TYPE_CHECKING:
    from rclpy.timer import Timer

WARNING_PERIOD = 5.0
"""Seconds from one check of the stream to the next."""


class Pipeline:
    """Estimates frames from activation to deactivation.

    The executor's thread receives and synchronizes the messages; one worker thread estimates and
    publishes. At most one frame waits between them, the newest.

    Attributes:
        inputs: the subscriptions.
    """

    def __init__(self, node: Node, parameters: NodeSettings, resources: Resources) -> None:
        """Open the publishers, subscribe and start the worker.

        Args:
            node: the node.
            parameters: its parameters.
            resources: the model and the publishers.

        Raises:
            InputError: the parameters need a package that is not installed.
        """
        self._node = node
        self._parameters = parameters
        self._resources = resources
        self._log = ThrottledLog(node.get_logger())
        self._states = StateLog(node.get_logger())
        self._temporal_estimator = TemporalEstimator(resources.estimator(parameters), parameters)
        self._outputs = resources.outputs
        self._outputs.parameters = parameters
        self._outputs.open()
        self._worker: Worker[FrameMessages] = Worker(
            self._process, self._report_failure, 'estimation'
        )
        inputs = self.inputs = Inputs(node, parameters, self._log, self._worker.submit)
        self._maker = FrameMaker(inputs.topics, parameters)
        self._transform_listener = None
        if parameters.roll is None:
            self._transform_listener = TransformListener(node, self._maker.roll_finder)
        self._warned: set[str] = set()
        self._beyond = 0
        self._failed = 0
        self._was_ready = True
        self._log_learning()
        # A bound method would be a reference cycle, which keeps the model after `close`.
        counters = partial(_counters, inputs, self._worker)
        self._diagnostics = Diagnostics(node, counters)
        profile = str(resource('config', 'fastdds_profile.xml'))
        self._monitor = StreamMonitor(node.get_logger(), inputs.topics, profile, counters)
        # Problems occur in real time, whatever the clock of a recording shows.
        clock = Clock(clock_type=ClockType.STEADY_TIME)
        self._timer: Timer | None = node.create_timer(
            WARNING_PERIOD, self._log_warnings, clock=clock
        )
        self._worker.start()

    def apply(self, parameters: NodeSettings) -> None:
        """Use other values of the parameters that can change at any time."""
        before, self._parameters = self._parameters, parameters
        self._outputs.parameters = parameters
        self._temporal_estimator.settings = parameters
        if _estimation(parameters) != _estimation(before):
            self._temporal_estimator.estimator = self._resources.estimator(parameters)
        if parameters.sync_slop != before.sync_slop:
            self.inputs.set_sync_slop(parameters.sync_slop)

    def close(self, timeout: float = 5.0) -> None:
        """Unsubscribe and stop publishing.

        Args:
            timeout: seconds to wait for the frame that the worker processes.
        """
        self.inputs.close()
        if self._transform_listener is not None:
            self._transform_listener.close()
        self._worker.close(timeout)
        if self._timer is not None:
            self._node.destroy_timer(self._timer)
            self._timer = None
        self._diagnostics.close()
        self._outputs.close()

    def _process(self, messages: FrameMessages) -> None:
        """Estimate and publish one frame; called in the worker's thread."""
        stage = self._diagnostics.measurements.stage
        with stage('decode'):
            topics, rectified = self.inputs.topics, self._parameters.rectified
            frame = frame_of(messages, self._maker, topics, rectified)
        self._log_frames()
        self._log_learning()
        clock = StageClock()
        with stage('estimate'):
            skeletons = self._temporal_estimator.estimate(
                frame.stamp,
                frame.depth,
                frame.labels,
                frame.camera,
                clock,
                from_mask=frame.from_mask,
            )
        self._diagnostics.measurements.add_stages(clock.seconds)
        skeletons = in_camera_frame(skeletons, frame.roll)
        with stage('publish'):
            estimator = self._temporal_estimator
            found = frame._replace(labels=estimator.labels)
            image = BodyImage.of(found, estimator.labels_of)
            self._outputs.publish(frame.stamp, frame.frame_id, skeletons, image)
        self._diagnostics.count_estimate(frame.stamp, len(skeletons.bodies))
        self._count_bodies()

    def _count_bodies(self) -> None:
        """Say on /diagnostics how many bodies are not published; log when there are too many."""
        estimator, notes = self._temporal_estimator, self._diagnostics.notes
        notes['bodies left out'] = str(estimator.left_out)
        notes['bodies beyond maximum'] = str(estimator.beyond_maximum)
        beyond, self._beyond = estimator.beyond_maximum - self._beyond, estimator.beyond_maximum
        if beyond:
            most = estimator.estimator.maximum_bodies
            self._log.warning(
                'maximum_bodies',
                f'a frame shows {beyond} bodies more than the {most} of the parameter '
                'maximum_bodies; the smallest ones are not estimated',
            )

    def _log_frames(self) -> None:
        """Log how frames are made, when that changes, and what is suspicious."""
        states = {
            'camera': self._maker.camera,
            'camera roll': self._maker.roll_finder.choice,
            'bodies': self._maker.bodies,
        }
        self._diagnostics.notes.update(states)
        states['camera'] = f'{self.inputs.topics.camera_info}: {states["camera"]}'
        for name, text in states.items():
            self._states.update(name, text)
        for warning in self._maker.warnings:
            if warning not in self._warned:
                self._warned.add(warning)
                self._node.get_logger().warning(warning)

    def _log_learning(self) -> None:
        """Log when the segmenter starts and finishes to learn the empty scene."""
        ready = self._maker.ready
        if ready and not self._was_ready:
            self._node.get_logger().info('the empty scene is learnt')
        elif self._was_ready and not ready:
            self._node.get_logger().info('learning the empty scene: nobody should be in view')
        self._was_ready = ready

    def _report_failure(self, error: Exception) -> None:
        """Log why a frame could not be estimated; called in the worker's thread."""
        if not self._node.context.ok():
            return  # publishing fails while the node shuts down, which is no problem
        self._diagnostics.measurements.count_failure()
        self._failed += 1
        self._diagnostics.notes['failed'] = str(self._failed)
        if isinstance(error, InputError):
            self._log.error(kind_of(error), str(error))
        else:
            text = ''.join(traceback.format_exception(error))
            self._log.error(kind_of(error), f'a frame was left out: {text}')

    def _log_warnings(self) -> None:
        inputs = self.inputs
        self._monitor.check(inputs.needed_topics, inputs.publishers(), inputs.delivery())


def _estimation(parameters: NodeSettings) -> tuple[int, int]:
    """Return the parameters of which the estimator is made and that can change at any time."""
    return parameters.query_points, parameters.maximum_bodies


def _counters(inputs: Inputs, worker: Worker[FrameMessages]) -> Counters:
    return inputs.counters(worker.replaced)
