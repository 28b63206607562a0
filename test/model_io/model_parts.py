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

"""Model files with changed parts."""

import json

import numpy as np


def parts_of(path):
    """Return the arrays of a model file by name."""
    with np.load(path) as archive:
        return dict(archive)


def rewrite(path, target, **changes):
    """Write a model file with some parts changed, or left out if None, to `target`."""
    parts = {
        name: part for name, part in {**parts_of(path), **changes}.items() if part is not None
    }
    np.savez(target, **parts)
    return target


def change_header(path, **changes):
    """Return the header of a model file with other entries."""
    header = json.loads(parts_of(path)['header'].tobytes())
    return np.frombuffer(json.dumps(header | changes).encode(), np.uint8)


def with_settings(parts, **changes):
    """Return the header of a model file with other settings."""
    header = json.loads(parts['header'].tobytes())
    header['settings'] |= changes
    return np.frombuffer(json.dumps(header).encode(), np.uint8)


def edit(array, index, value):
    """Return a copy of `array` with one value changed."""
    changed = array.copy()
    changed[index] = value
    return changed
