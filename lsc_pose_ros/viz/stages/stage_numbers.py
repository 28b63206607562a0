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

"""The numbers that the figures of the stages show, for the texts beside them."""

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import names_of
from lsc_pose_ros.files.kinds import JSON
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.viz.stages.shown_body import ShownBody

NUMBERS_NAME = 'stages.json'


def stage_numbers(shown: ShownBody) -> dict[str, Any]:
    """Return the numbers of the figures by name; without a model, of the first four stages.

    Lengths are in metres. `error_m` has the mean error after each step of the graph, and
    `joint_error_m` that of each joint; they are empty without ground truth. `modes` has the number
    of modes of each joint's density, `votes` that of its votes.
    """
    frame, result = shown.frame, shown.result
    depth = frame.depth[(frame.labels == shown.number) & (frame.depth > 0)]
    near, far = np.percentile(depth, [1, 99])
    numbers: dict[str, Any] = {
        'frame': shown.label,
        'body': shown.number,
        'near_m': float(near),
        'far_m': float(far),
        'edge_pixels': len(result.silhouette.rows),
        'points': len(result.silhouette.points),
        'unit_of_length_m': float(result.scale),
        'reach_m': float(result.scale * shown.settings.support_radius),
    }
    if shown.model is not None:
        numbers |= _joint_numbers(shown, shown.model)
    return numbers


def write_numbers(directory: Path, shown: ShownBody) -> Path:
    """Write the numbers as a JSON file into `directory` and return its path.

    Raises:
        InputError: it cannot be written.
    """
    path = directory / NUMBERS_NAME
    text = json.dumps(stage_numbers(shown), indent=1, default=str) + '\n'
    write_output(path, JSON, text.encode())
    return path


def _joint_numbers(shown: ShownBody, model: Model) -> dict[str, Any]:
    result, names = shown.result, names_of(model.joints)
    steps = {
        'each joint by itself': result.unary,
        'best combination': result.chosen,
        'after ascent': result.joints,
    }
    truth = shown.ground_truth(model.joints)
    errors = {name: _joint_errors(joints, truth, names) for name, joints in steps.items()}
    return {
        'query_points': len(result.queries),
        'votes': dict(zip(names, np.diff(result.joint_votes.start).tolist(), strict=True)),
        'modes': dict(zip(names, result.candidates.counts.tolist(), strict=True)),
        'confidence': dict(zip(names, result.confidence.tolist(), strict=True)),
        'error_m': {name: sum(each.values()) / len(each) for name, each in errors.items() if each},
        'joint_error_m': {name: each for name, each in errors.items() if each},
    }


def _joint_errors(
    joints: NDArray[np.float32], truth: NDArray[np.float32], names: list[str]
) -> dict[str, float]:
    """Return the error of each joint that is labelled and estimated."""
    distances = np.linalg.norm(joints - truth, axis=-1).tolist()
    return {
        name: distance
        for name, distance in zip(names, distances, strict=True)
        if np.isfinite(distance)
    }
