"""The node with an estimator that takes long, for the tests of overload.

slow_node.py SECONDS --ros-args ...
"""

import sys
import time

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.ros.node.main import main

SECONDS = float(sys.argv.pop(1))
estimate = Estimator.estimate


def estimate_slowly(
    self: Estimator, depth: object, labels: object, camera: Intrinsics, observer: object = None
) -> Skeletons:
    time.sleep(SECONDS)
    return estimate(self, depth, labels, camera, observer)


Estimator.estimate = estimate_slowly  # type: ignore[method-assign]

sys.exit(main())
