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

"""Isolates ROS programs from all others, for the demo and the tests."""

import os
import socket
from collections.abc import Iterator

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.package_files import resource

PROFILE_VARIABLE = 'FASTRTPS_DEFAULT_PROFILES_FILE'

# The ports of higher domains are in the range that the operating system assigns.
_LAST_DOMAIN = 101

# RTPS 2.2, section 9.6.1.1: the port of the first participant of a domain.
_FIRST_PORT = 7410
_PORTS_PER_DOMAIN = 250

# A process numbers its participants over all domains: that of the second context of a program is
# never the first one of its domain.
_PARTICIPANTS = 10


def isolated_environment() -> dict[str, str]:
    """Return environment variables for ROS programs that communicate only with each other.

    They select an unused domain, this computer, and the Fast DDS profile for images. They must be
    set before a program initialises ROS.

    Raises:
        InputError: all domains are in use.
    """
    return {
        'ROS_DOMAIN_ID': str(_free_domain()),
        'ROS_AUTOMATIC_DISCOVERY_RANGE': 'LOCALHOST',
        PROFILE_VARIABLE: str(resource('config', 'fastdds_profile.xml')),
    }


def _free_domain() -> int:
    for domain in _domains():
        first = _FIRST_PORT + _PORTS_PER_DOMAIN * domain
        if all(_is_free(first + 2 * number) for number in range(_PARTICIPANTS)):
            return domain
    msg = 'all ROS domains are in use on this computer; end some ROS programs'
    raise InputError(msg)


def _is_free(port: int) -> bool:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        try:
            probe.bind(('', port))
        except OSError:
            return False
    return True


def _domains() -> Iterator[int]:
    """Yield 1 to 101; the start depends on the process, so that two choose different domains."""
    first = os.getpid()
    for number in range(_LAST_DOMAIN):
        yield 1 + (first + number) % _LAST_DOMAIN
