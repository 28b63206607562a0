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

"""Checks the labels of a recording, and tells what was found and what to do."""

import argparse
from pathlib import Path

from lsc_pose_ros import __version__
from lsc_pose_ros.bags import FrameReader
from lsc_pose_ros.cli.options.numbers import number_between
from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation.distance_text import distance_text
from lsc_pose_ros.labels.checks.problems import KINDS, LabelLimits
from lsc_pose_ros.labels.checks.study import LabelReport, LabelStudy, UsualLengths
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.resources.package_files import find_model

_SHOWN = 12

_LARGEST_LIMIT = 100

# The model is run on so many stretches of so many successive frames.
_STRETCHES = 10
_STRETCH = 30

# From this fraction of the joints on, a kind of problem is worth a word.
_MANY = 0.02

# From this fraction on, what is left out would be the labels themselves.
_MOST = 0.5


def check_labels(reader: FrameReader, model: str, limits: LabelLimits) -> LabelReport:
    """Return what a check of the labels of a recording finds.

    Args:
        reader: the recording.
        model: the name of the model that the labels are compared with.
        limits: how far off a label may be.

    Raises:
        InputError: the recording or the model cannot be used, or nothing is labelled.
    """
    path = find_model(model)
    estimator = Estimator(load_model(path))
    usual = UsualLengths(progress(reader, reader.count, 'measuring limbs'))
    study = LabelStudy(estimator, limits, usual, _SHOWN)
    count = reader.count or 0
    for number, frame in enumerate(progress(reader, reader.count, 'checking')):
        study.add(number, frame, compare=_is_compared(number, count))
    report = study.report()
    report.model = path.name
    if not report.joints:
        msg = f'{reader.path}: no frame has a label; `lsc_pose label --help` says how to add some'
        raise InputError(msg)
    return report


def tell_report(
    recording: Path, report: LabelReport, page: Path | None, table: Path | None
) -> None:
    """Print `report`, and write it as a page and as a JSON file if their paths are given.

    Raises:
        InputError: a file cannot be written.
    """
    facts, advice = label_facts(report), label_advice(report)
    width = max(map(len, facts))
    for name, value in facts.items():
        print(f'{name:{width}}  {value}')
    for sentence in advice:
        print(f'advice: {sentence}')
    if table:
        write_json(table, label_results(recording, report))
    if page:
        # Matplotlib takes half a second to import.
        from lsc_pose_ros.viz.report.drawn_frame import DrawnFrame  # noqa: PLC0415
        from lsc_pose_ros.viz.report.label_page import write_label_page  # noqa: PLC0415
        from lsc_pose_ros.viz.report.page_parts import origin_of  # noqa: PLC0415

        worst = [
            DrawnFrame(
                f'frame {each.number}: {each.reasons}',
                each.frame,
                each.estimate,
                marked=each.marked,
                compared='from the model',
            )
            for each in report.worst
        ]
        title = f'Labels of {recording.name}'
        print(write_label_page(page, title, origin_of(__version__), facts, advice, worst))


def add_limit_options(container: argparse._ActionsContainer) -> None:
    """Add the options that say how far off a label may be."""
    defaults = LabelLimits()
    options = (
        ('mask-margin', int, defaults.margin, 'PIXELS', 'from the mask (outside)'),
        ('before-limit', float, defaults.before, 'METRES', 'before the surface (before)'),
        ('deep-limit', float, defaults.deep, 'METRES', 'behind the surface (deep)'),
        ('length-limit', float, defaults.length, 'FRACTION', 'from the usual length (length)'),
    )
    for name, kind, default, unit, text in options:
        container.add_argument(
            f'--{name}',
            type=number_between(kind, 0, _LARGEST_LIMIT),
            default=default,
            metavar=unit,
            help=f'how far a joint may be {text} (default: %(default)s)',
        )


def limits_from(arguments: argparse.Namespace) -> LabelLimits:
    """Return the limits that `arguments` set."""
    return LabelLimits(
        arguments.mask_margin, arguments.before_limit, arguments.deep_limit, arguments.length_limit
    )


def label_facts(report: LabelReport) -> dict[str, str]:
    """Return what was found, by name, for people."""
    facts = {
        'frames': f'{report.frames}, labelled {report.labelled_frames}',
        'joints': str(report.joints),
    }
    for kind, text in KINDS.items():
        count = report.problems[kind]
        facts[kind] = f'{100 * count / report.joints:.1f} % of the joints {text} ({count})'
    facts['time'] = _time_fact(report)
    sides = report.sides
    if sides.bodies:
        facts['sides'] = (
            f'{100 * sides.exchanged:.1f} % of {sides.bodies} bodies fit the model better with '
            f'left and right exchanged, {100 * sides.mirrored:.1f} % with x negated'
        )
        facts['model'] = (
            f'the median distance to the estimates of {report.model} is '
            f'{distance_text(report.difference)}'
        )
    if report.length_spread:
        joint = max(report.length_spread, key=lambda name: report.length_spread[name])
        facts['limbs'] = (
            f'the length of the limb to {joint} changes most, by '
            f'{100 * report.length_spread[joint]:.0f} %'
        )
    return facts


def _time_fact(report: LabelReport) -> str:
    lag = report.lag
    if lag is None:
        return 'too little moves to tell the lag between labels and depth'
    if not report.lag_found:
        return 'no lag between labels and depth was found'
    return (
        f'labels are {abs(lag.frames):.1f} frames ({abs(lag.seconds):.3f} s) '
        f'{"early" if lag.frames > 0 else "late"}; '
        f'without this, differences to the model are {100 * lag.gain:.0f} % smaller'
    )


def label_advice(report: LabelReport) -> list[str]:
    """Return a sentence for each thing that should be done.

    Labels in another place have only that one: what else is found follows from it.
    """
    if report.sides.all_mirrored:
        return ['the labels are mirrored against the images: label again with --mirror x']
    if report.elsewhere:
        far = f'the joints are {distance_text(report.difference)} from the estimates of the model'
        return [f'{far}: check --scale and --extrinsic']
    advice: list[str] = []
    if report.lag is not None and report.lag_found:
        advice.append(
            f'labels and depth are {abs(report.lag.frames):.1f} frames apart: label again with '
            f'--time-offset {report.lag.seconds:+.3f} more, or with --correct-lag'
        )
    if report.sides.all_exchanged:
        advice.append(
            'left and right are exchanged throughout: the recording is mirrored, or the names '
            'are those of the viewer; label again with --mirror names, or mirror the images'
        )
    elif report.sides.exchanged > _MANY:
        advice.append(
            f'left and right of {100 * report.sides.exchanged:.1f} % of the bodies are exchanged: '
            'look at the worst frames (--report)'
        )
    return advice + _problem_advice(report)


def _problem_advice(report: LabelReport) -> list[str]:
    advice = []
    for kind, count in report.problems.items():
        part = count / report.joints
        remedy = f'leave them out with --drop {kind}'
        if part > _MOST:
            remedy = 'check --extrinsic, --scale and --time-offset'
        if part > _MANY:
            advice.append(f'{100 * part:.1f} % of the joints are {KINDS[kind]}: {remedy}')
    return advice


def label_results(recording: Path, report: LabelReport) -> dict[str, object]:
    """Return what was found as a table for JSON."""
    lag = report.lag
    return {
        'recording': str(recording),
        'frames': report.frames,
        'labelled_frames': report.labelled_frames,
        'joints': report.joints,
        'problems': report.problems,
        'lag_frames': None if lag is None else lag.frames,
        'lag_seconds': None if lag is None else lag.seconds,
        'lag_found': report.lag_found,
        'exchanged': report.sides.exchanged,
        'mirrored': report.sides.mirrored,
        'compared_bodies': report.sides.bodies,
        'median_difference_m': report.difference,
        'length_spread': report.length_spread,
        'worst_frames': [each.number for each in report.worst],
        'advice': label_advice(report),
    }


def _is_compared(number: int, count: int) -> bool:
    """Return whether the model is run on a frame: in stretches that are spread evenly."""
    if count <= _STRETCHES * _STRETCH:
        return number < _STRETCHES * _STRETCH
    stretch = number * _STRETCHES // count
    first = stretch * count // _STRETCHES
    return number - first <= _STRETCH
