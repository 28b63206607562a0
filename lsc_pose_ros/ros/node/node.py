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

"""The lifecycle node: its states and its parameters."""

import traceback
from collections.abc import Callable, Iterable

from lifecycle_msgs.srv import ChangeState
from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.callback_groups import CallbackGroup, ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter

from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.ros.node.background_task import run_in_background
from lsc_pose_ros.ros.node.bond import ManagerBond
from lsc_pose_ros.ros.node.parameter_rules import integers_as_doubles, refusal
from lsc_pose_ros.ros.node.parameters import (
    JOINT_NAMES,
    declare_parameters,
    read_parameters,
    unknown_parameters,
)
from lsc_pose_ros.ros.node.pipeline import Pipeline
from lsc_pose_ros.ros.node.preparation import Resources, prepare_resources

SHUTDOWN_TIMEOUT = 0.5
"""Seconds for which a process that is told to stop waits for the current frame."""


class PoseNode(LifecycleNode):
    """Publishes the joints of the bodies that a depth image and its mask show.

    A managed node: it loads the model and compiles the kernels when it is configured, and
    releases the model when it is cleaned up. It subscribes and publishes while it is active.

    Attributes:
        autostart: whether the node shall be started as soon as it exists.
    """

    def __init__(self) -> None:
        """Declare the parameters.

        Raises:
            InputError: a parameter cannot be used.
        """
        # While a transition waits for its work, other services are answered.
        self._callback_group = ReentrantCallbackGroup()
        super().__init__('pose_node')
        self._change_state = self._service_change_state.callback
        self._service_change_state.callback = self._change_state_if_possible
        self.autostart = declare_parameters(self).autostart
        for text in unknown_parameters(self):
            self.get_logger().warning(text)
        self._resources: Resources | None = None
        self._pipeline: Pipeline | None = None
        self._bond: ManagerBond | None = None
        self._failure: Exception | None = None
        self._starting = False
        self._configuring = False
        self.add_on_set_parameters_callback(self._check_changes)
        self.add_post_set_parameters_callback(self._apply_changes)

    @property
    def default_callback_group(self) -> CallbackGroup:
        """The group of all callbacks of this node."""
        return self._callback_group

    def start(self) -> None:
        """Configure and activate.

        Raises:
            InputError: a parameter or the model cannot be used.
            ExternalShutdownException: the process is told to stop.
        """
        self._starting = True
        for trigger in (self.trigger_configure, self.trigger_activate):
            self._failure = None
            trigger()
            if self._failure is not None:
                raise self._failure
        self._starting = False

    def set_parameters_atomically(self, parameter_list: list[Parameter]) -> SetParametersResult:
        """Set parameters, for the services; those that stay the same are accepted in any state.

        So `ros2 param load` accepts a file that `ros2 param dump` wrote.

        Args:
            parameter_list: the new values; an integer is accepted for a double.

        Returns:
            Whether all could be set, and the reason if not.
        """
        changes = [
            each
            for each in integers_as_doubles(parameter_list)
            if not (self.has_parameter(each.name) and _same(self.get_parameter(each.name), each))
        ]
        if not changes:
            return SetParametersResult(successful=True)
        return super().set_parameters_atomically(changes)

    def close(self) -> None:
        """Unsubscribe and stop publishing."""
        self._close_pipeline(SHUTDOWN_TIMEOUT)

    def on_configure(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Load the model and compile the kernels."""
        return self._run_transition(self._configure)

    def on_activate(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Advertise and subscribe."""
        return self._run_transition(self._activate)

    def on_deactivate(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Unsubscribe and stop publishing."""
        return self._run_transition(self._close_pipeline)

    def on_cleanup(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Release the model and everything else."""
        return self._run_transition(self._release)

    def on_shutdown(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Release everything, in any state."""
        return self._run_transition(self._release)

    def on_error(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Release everything after a transition that failed, so that it can be tried again."""
        return self._run_transition(self._release)

    def _configure(self) -> None:
        parameters = read_parameters(self)
        self._configuring = True
        try:
            self._resources = run_in_background(lambda: prepare_resources(self, parameters), self)
        finally:
            self._configuring = False
        self.declare_parameter(
            JOINT_NAMES,
            names_of(self._resources.model.joints),
            ParameterDescriptor(
                description="The model's joints, in the order of the skeletons' columns.",
                read_only=True,
            ),
            ignore_override=True,
        )

    def _activate(self) -> None:
        if self._resources is None:
            msg = 'there is no model'
            raise RuntimeError(msg)
        self._pipeline = Pipeline(self, read_parameters(self), self._resources)
        if not self.autostart:  # otherwise there is no manager
            self._bond = ManagerBond(self)
        topics = ', '.join(self._pipeline.inputs.topics.subscribed)
        self.get_logger().info(f'ready: listening to {topics}')

    def _close_pipeline(self, timeout: float = 5.0) -> None:
        bond, self._bond = self._bond, None
        if bond is not None:
            bond.close()
        pipeline, self._pipeline = self._pipeline, None
        if pipeline is not None:
            pipeline.close(timeout)

    def _release(self) -> None:
        self._close_pipeline()
        resources, self._resources = self._resources, None
        if resources is not None:
            resources.outputs.close()
        if self.has_parameter(JOINT_NAMES):
            # A read-only parameter cannot be undeclared.
            self.describe_parameter(JOINT_NAMES).read_only = False
            self.undeclare_parameter(JOINT_NAMES)

    def _change_state_if_possible(
        self, request: ChangeState.Request, response: ChangeState.Response
    ) -> ChangeState.Response:
        """Answer a request to change the state; rclpy raises an error if the state forbids it."""
        try:
            return self._change_state(request, response)
        except RuntimeError as error:  # the base class of rclpy's own errors
            if not self.context.ok():
                raise
            self.get_logger().error(f'a transition was refused: {error}')
            response.success = False
            return response

    def _run_transition(self, transition: Callable[[], None]) -> TransitionCallbackReturn:
        """Run the work of a transition, and log the reason if it fails."""
        try:
            transition()
        except (InputError, ExternalShutdownException) as error:
            self._keep_or_log(error, str(error))
            return TransitionCallbackReturn.FAILURE
        except Exception as error:  # noqa: BLE001 - rclpy would not log it
            self._keep_or_log(error, ''.join(traceback.format_exception(error)))
            return TransitionCallbackReturn.ERROR
        return TransitionCallbackReturn.SUCCESS

    def _keep_or_log(self, error: Exception, text: str) -> None:
        if self._starting:
            self._failure = error  # `start` raises it, and the program reports it
        elif self.context.ok():
            self.get_logger().error(text)

    def _check_changes(self, changes: Iterable[Parameter]) -> SetParametersResult:
        resources = self._resources
        reason = refusal(
            changes,
            configured=self._configuring or resources is not None,
            points=resources.model.settings.points if resources is not None else 0,
        )
        return SetParametersResult(successful=not reason, reason=reason)

    def _apply_changes(self, _changes: Iterable[Parameter]) -> None:
        if self._pipeline is not None:
            self._pipeline.apply(read_parameters(self))


def _same(one: Parameter, other: Parameter) -> bool:
    return bool(one.to_parameter_msg() == other.to_parameter_msg())
