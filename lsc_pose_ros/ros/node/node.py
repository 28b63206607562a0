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

"""The live node: its states, and its parameters."""

import traceback
from collections.abc import Callable, Iterable

from rcl_interfaces.msg import ParameterDescriptor, SetParametersResult
from rclpy.executors import ExternalShutdownException
from rclpy.lifecycle import LifecycleNode, LifecycleState, TransitionCallbackReturn
from rclpy.parameter import Parameter

from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.ros.node.background_task import run_aside
from lsc_pose_ros.ros.node.parameter_rules import integers_as_doubles, refusal
from lsc_pose_ros.ros.node.parameters import declare_parameters, read_parameters
from lsc_pose_ros.ros.node.pipeline import Activity
from lsc_pose_ros.ros.node.preparation import Prepared, prepare

JOINT_NAMES = 'joint_names'

# A process that is told to stop waits so long for the answer that is being worked on, seconds.
PATIENCE_AT_THE_END = 0.5


class PoseNode(LifecycleNode):
    """Publishes the joints of everybody whom a depth image and its mask show.

    A managed node: the model is loaded and the kernels are compiled when it is configured, and
    released when it is cleaned up; it listens and publishes while it is active.

    Attributes:
        autostart: whether it is to be started as soon as it is there.
    """

    def __init__(self) -> None:
        """Declare the parameters.

        Raises:
            InputError: a parameter cannot be used.
        """
        super().__init__('pose_node')
        self.autostart = declare_parameters(self).autostart
        self._prepared: Prepared | None = None
        self._activity: Activity | None = None
        self._trouble: Exception | None = None
        self._starting = False
        self.add_pre_set_parameters_callback(integers_as_doubles)
        self.add_on_set_parameters_callback(self._judge)
        self.add_post_set_parameters_callback(self._adopt)

    def start(self) -> None:
        """Configure and activate.

        Raises:
            InputError: a parameter or the model cannot be used.
            ExternalShutdownException: the process is told to stop.
        """
        self._starting = True
        for trigger in (self.trigger_configure, self.trigger_activate):
            self._trouble = None
            trigger()
            if self._trouble is not None:
                raise self._trouble
        self._starting = False

    def close(self) -> None:
        """Stop listening; no more is published afterwards."""
        self._end_activity(PATIENCE_AT_THE_END)

    def on_configure(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Load the model, compile the kernels."""
        return self._attempt(self._configure)

    def on_activate(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Subscribe and advertise."""
        return self._attempt(self._activate)

    def on_deactivate(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Unsubscribe, and publish no more."""
        return self._attempt(self._end_activity)

    def on_cleanup(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Release the model and all else."""
        return self._attempt(self._release)

    def on_shutdown(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Release all, whatever the state."""
        return self._attempt(self._release)

    def on_error(self, _state: LifecycleState) -> TransitionCallbackReturn:
        """Release all after a transition that broke down, so that it can be tried anew."""
        return self._attempt(self._release)

    def _configure(self) -> None:
        parameters = read_parameters(self)
        self._prepared = run_aside(lambda: prepare(self, parameters), self.context)
        self.declare_parameter(
            JOINT_NAMES,
            names_of(self._prepared.model.joints),
            ParameterDescriptor(
                description="The model's joints, in the order of the skeletons' columns.",
                read_only=True,
            ),
            ignore_override=True,
        )

    def _activate(self) -> None:
        if self._prepared is None:
            msg = 'there is no model'
            raise RuntimeError(msg)
        self._activity = Activity(self, read_parameters(self), self._prepared)
        topics = ', '.join(self._activity.inputs.topics.listened)
        self.get_logger().info(f'ready: listening to {topics}')

    def _end_activity(self, patience: float = 5.0) -> None:
        activity, self._activity = self._activity, None
        if activity is not None:
            activity.close(patience)

    def _release(self) -> None:
        self._end_activity()
        prepared, self._prepared = self._prepared, None
        if prepared is not None:
            prepared.outputs.close()
        if self.has_parameter(JOINT_NAMES):
            self.describe_parameter(JOINT_NAMES).read_only = False  # else it stays for ever
            self.undeclare_parameter(JOINT_NAMES)

    def _attempt(self, step: Callable[[], None]) -> TransitionCallbackReturn:
        """Take a step from one state to the next, and tell why where that fails."""
        try:
            step()
        except (InputError, ExternalShutdownException) as error:
            self._trouble = error
            self._tell(str(error))
            return TransitionCallbackReturn.FAILURE
        except Exception as error:  # noqa: BLE001 - rclpy would say nothing of it
            self._trouble = error
            self._tell(''.join(traceback.format_exception(error)))
            return TransitionCallbackReturn.ERROR
        return TransitionCallbackReturn.SUCCESS

    def _tell(self, text: str) -> None:
        # At the start, the program tells it and ends.
        if not self._starting and self.context.ok():
            self.get_logger().error(text)

    def _judge(self, changes: Iterable[Parameter]) -> SetParametersResult:
        prepared = self._prepared
        reason = refusal(
            changes,
            configured=prepared is not None,
            points=prepared.model.settings.points if prepared is not None else 0,
        )
        return SetParametersResult(successful=not reason, reason=reason)

    def _adopt(self, _changes: Iterable[Parameter]) -> None:
        if self._activity is not None:
            self._activity.change(read_parameters(self))
