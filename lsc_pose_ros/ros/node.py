"""The live node: listens, lets the worker estimate, publishes."""

import threading
import time
import traceback

from rclpy.clock import Clock, ClockType
from rclpy.node import Node

from lsc_pose_ros.core.kernel_cache import describe_cache
from lsc_pose_ros.core.warm_up import warm_up
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources import resource
from lsc_pose_ros.ros.estimation import load_estimator
from lsc_pose_ros.ros.inputs import Inputs
from lsc_pose_ros.ros.messages import Pair, frame_of
from lsc_pose_ros.ros.outputs import Outputs
from lsc_pose_ros.ros.parameters import declare_parameters
from lsc_pose_ros.ros.reports import Reports
from lsc_pose_ros.ros.watch import Counters, Situation, complaints
from lsc_pose_ros.ros.worker import Worker

WATCH_PERIOD = 5.0

# A standing trouble is told this often, seconds.
REMINDER_PERIOD = 30.0

# Kernels that are kept on disk are ready within this time, seconds.
QUICK_START = 3.0


class PoseNode(Node):
    """Publishes the joints of everybody whom a depth image and its mask show.

    The executor's thread receives and pairs the messages; one worker thread estimates and
    publishes. Between them waits at most one pair, the newest.
    """

    def __init__(self) -> None:
        """Read the parameters, load the model, compile the kernels, then subscribe.

        Raises:
            InputError: a parameter or the model cannot be used.
        """
        super().__init__('pose_node')
        self._settings = declare_parameters(self)
        self._reports = Reports(self.get_logger())
        self._reminders = Reports(self.get_logger(), REMINDER_PERIOD)
        self._estimator = load_estimator(self._settings)
        self._outputs = Outputs(self, self._settings, self._estimator.model.edges)
        self._warm_up()
        self._worker: Worker[Pair] = Worker(self._answer, self._fail, 'estimation')
        self._worker.start()
        self._inputs = Inputs(self, self._settings, self._reports, self._worker.submit)
        self._seen = self._counters()
        # Trouble is real time's, whatever clock the recording brings.
        self.create_timer(WATCH_PERIOD, self._watch, clock=Clock(clock_type=ClockType.STEADY_TIME))
        self.get_logger().info(f'ready: listening to {", ".join(self._inputs.topics)}')

    def close(self) -> None:
        """Stop listening and wait for the worker; no more is published afterwards."""
        self._inputs.close()
        self._worker.close()

    def _warm_up(self) -> None:
        """Do once all that an answer takes, for the first time takes far longer."""
        begin = time.monotonic()
        notice = 'compiling the kernels, which takes about half a minute'
        patience = threading.Timer(QUICK_START, self.get_logger().info, [notice])
        patience.start()
        try:
            self._outputs.rehearse(warm_up(self._estimator))
        finally:
            patience.cancel()
        seconds = time.monotonic() - begin
        self.get_logger().info(f'kernels ready in {seconds:.1f} s ({describe_cache()})')

    def _answer(self, pair: Pair) -> None:
        """Answer one depth image; in the worker's thread."""
        frame = frame_of(pair, self._inputs.topics, self._settings.mask_background)
        skeletons = self._estimator.estimate(frame.depth, frame.labels, frame.camera)
        self._outputs.publish(frame.stamp, frame.frame_id, skeletons)

    def _fail(self, error: Exception) -> None:
        """Tell why a depth image stays unanswered; in the worker's thread."""
        if not self.context.ok():
            return  # publishing fails when the node is being shut down; that is no news
        if isinstance(error, InputError):
            self._reports.error(str(error), str(error))
        else:
            text = ''.join(traceback.format_exception(error))
            self._reports.error(type(error).__name__, f'a frame was left out: {text}')

    def _watch(self) -> None:
        before, self._seen = self._seen, self._counters()
        situation = Situation(
            self._inputs.topics,
            self._inputs.publishers(),
            str(resource('config', 'fastdds_profile.xml')),
        )
        for kind, text in complaints(before, self._seen, situation).items():
            self._reminders.warning(kind, text)

    def _counters(self) -> Counters:
        gathering = self._inputs.gathering
        return Counters(
            depth=gathering.depth,
            masks=gathering.masks,
            camera_infos=gathering.camera_infos,
            pairs=gathering.pairs,
            replaced=self._worker.replaced,
            lost=sum(self._inputs.lost.values()),
            rewinds=gathering.rewinds,
        )
