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

"""Writes the page, and a table and a figure for each experiment."""

from collections.abc import Collection, Sequence
from pathlib import Path

from lsc_pose_experiments.drawing import draw_experiment
from lsc_pose_experiments.experiment import Experiment, TrialResults, csv_of, rows_of
from lsc_pose_experiments.page import PAGE_NAME, Page, Section, write_page
from lsc_pose_experiments.running import TrialContext, result_of
from lsc_pose_ros.files.kinds import HTML, TEXT
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.viz.drawing.canvas import save_png


class Publisher:
    """Writes each experiment into a folder when all its trials are finished."""

    def __init__(
        self, folder: Path, page: Page, experiments: Sequence[Experiment], wanted: Collection[str]
    ) -> None:
        """Prepare the page.

        Args:
            folder: the files are written into it.
            page: has no sections yet.
            experiments: all experiments; each has a section.
            wanted: names of experiments to write. Others are written again if `folder` has their
                files, since they may share trials with these.
        """
        self._folder = folder
        self._page = page
        self._experiments = experiments
        self._shown = {
            each.name for each in experiments if each.name in wanted or self._csv(each).exists()
        }
        self._done: dict[str, Section] = {}

    def publish(self, context: TrialContext) -> Page:
        """Write the page, and the experiments that are newly finished; return the page.

        Raises:
            InputError: a file cannot be written.
        """
        for experiment in self._experiments:
            if experiment.name in self._shown - self._done.keys():
                results = results_of(context, experiment)
                if results is not None:
                    self._done[experiment.name] = self._write(experiment, results)
        nothing = {e.name: Section(e, [], []) for e in self._experiments}
        page = self._page._replace(sections=list((nothing | self._done).values()))
        write_output(self._folder / PAGE_NAME, HTML, write_page(page).encode())
        return page

    def _write(self, experiment: Experiment, results: TrialResults) -> Section:
        rows = rows_of(experiment, results)
        path = self._csv(experiment)
        write_output(path, TEXT, csv_of(rows).encode())
        figure = draw_experiment(experiment, rows)
        save_png(figure, path.with_suffix('.png'))
        return Section(experiment, rows, [claim.judge(results) for claim in experiment.claims])

    def _csv(self, experiment: Experiment) -> Path:
        return self._folder / f'{experiment.name}.csv'


def results_of(context: TrialContext, experiment: Experiment) -> TrialResults | None:
    """Return the results of all variants by label, or None if one is not finished."""
    results = {
        variant.label: result_of(context, variant.trial)
        for variant in experiment.variants
        if variant.trial
    }
    finished = {label: result for label, result in results.items() if result}
    return finished if len(finished) == len(results) else None
