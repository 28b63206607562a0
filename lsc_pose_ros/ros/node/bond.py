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

"""The bond with nav2's lifecycle manager, which notices by it that the node has ended."""

import importlib
from typing import Any

from rclpy.node import Node

# The name that nav2's lifecycle manager and its nodes use, below the node's namespace.
_TOPIC = 'bond'

# Seconds without a message after which the bond is broken, as in the nodes of nav2.
_TIMEOUT = 4.0


class ManagerBond:
    """A bond while the node is active; none if bondpy is not installed.

    As in nav2's own nodes, its id is the name of the node.
    """

    def __init__(self, node: Node) -> None:
        """Begin to publish on the topic of the bonds, if bondpy is installed."""
        self._node = node
        self._bond = _new_bond(node)
        if self._bond is not None:
            self._bond.heartbeat_timeout = _TIMEOUT
            self._bond.start()

    def close(self) -> None:
        """Tell the manager that the node has been deactivated."""
        bond, self._bond = self._bond, None
        if bond is None:
            return
        if self._node.context.ok():
            bond.shutdown()
        else:
            bond.is_shutdown = True  # its destructor cannot publish any more


def _new_bond(node: Node) -> Any:  # noqa: ANN401 - the package may be missing
    try:
        bondpy = importlib.import_module('bondpy.bondpy')
    except ImportError:
        return None
    return bondpy.Bond(_TOPIC, node.get_name(), node)
