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

"""Draws the picture of time.md: `python draw_time.py RECORDING JOINT OUT.png`."""

import sys
from pathlib import Path

from lsc_pose_ros.bags import open_recording
from lsc_pose_ros.cli.output.video_results import (
    OVER_TIME,
    SINGLY,
    SingleFrames,
    estimate_over_time,
)
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.resources.package_files import find_model
from lsc_pose_ros.viz.drawing.canvas import house_style, save_png
from lsc_pose_ros.viz.drawing.legend import add_legend_entries
from lsc_pose_ros.viz.report.time_plot import joint_over_time, way_entries

WIDTH = 8.4  # inches

recording, joint, output = sys.argv[1:]
estimator = Estimator(load_model(find_model()))
reader = open_recording(recording)
single = SingleFrames(estimator)
for frame in reader:
    single.add(frame, estimator.estimate(frame.depth, frame.labels, frame.camera))
ways = {SINGLY: single.frames, OVER_TIME: estimate_over_time(estimator, [reader])}
figure = joint_over_time(ways, joint, WIDTH)
with house_style():
    add_legend_entries(figure, way_entries(ways))
save_png(figure, Path(output))
