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

# ruff: noqa: INP001 - a program, not a package
"""Measures how the time of a frame grows with each number that a user can choose.

`python benchmarks/curves.py` measures for a few minutes and writes results.json, curves.png and
the tables of README.md, next to itself. With `--draw` it measures nothing and draws results.json.
"""

import argparse
import datetime as dt
import json
import math
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from page import draw_curves, write_tables
from plain_comparison import compare_with_plain

from lsc_pose_ros.cli.output.json_file import write_json
from lsc_pose_ros.cli.output.machine import describe_machine, versions
from lsc_pose_ros.cli.output.progress import progress
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.evaluation.benchmark import summarise_times, time_frames, warm_up
from lsc_pose_ros.evaluation.encoded_frame import EncodedFrame, decode_frame, encode_frame
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.synthetic.generator import SyntheticSettings, synthetic_frames
from lsc_pose_ros.synthetic.settings import sensor_of
from lsc_pose_ros.training.train import TrainingSettings, train

POINTS = range(100, 901, 100)
QUERY_POINTS = (25, 50, 100, 150, 180, 300, 400)
TREES = (1, 2, 3, 4, 5)
SIZES = ((160, 120), (320, 240), (640, 480), (1280, 720))
BODIES = (1, 2, 3, 4)
TRAINING_FRAMES = (250, 500, 1000, 2000, 3600)
MODEL_FRAMES = 1000
TIMED_FRAMES = 60

DEFAULT_TREES = 3

_HERE = Path(__file__).parent
_TRAINING = SyntheticSettings(frames=max(TRAINING_FRAMES), seed=1, clip_length=3)
_TIMED = SyntheticSettings(frames=TIMED_FRAMES, seed=2, clip_length=2)


class Labelled(NamedTuple):
    """A frame with its ground truth, in a third of a Frame's memory."""

    encoded: EncodedFrame
    ground_truth: Skeletons | None


class Setup(NamedTuple):
    """One point of a curve: an estimator and the frames that it is timed on."""

    estimator: Estimator
    frames: list[EncodedFrame]


def main() -> int:
    """Measure, or read earlier results, and write the page; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument('--draw', action='store_true', help='measure nothing')
    results_file = _HERE / 'results.json'
    if not parser.parse_args().draw:
        write_json(results_file, measure())
    results = json.loads(results_file.read_text(encoding='utf-8'))
    draw_curves(results, _HERE / 'curves.png')
    write_tables(results, _HERE / 'README.md')
    return 0


def measure() -> dict[str, object]:
    """Return all results, as `page` reads them."""
    begin = time.monotonic()
    labelled = [
        Labelled(encode_frame(frame), frame.ground_truth)
        for frame in progress(synthetic_frames(_TRAINING), _TRAINING.frames, 'generating')
    ]
    training = _time_training(labelled)
    tell('the model of all other measurements')
    model = _train(labelled[:MODEL_FRAMES], max(TREES))
    results: dict[str, object] = {
        'date': dt.datetime.now(tz=dt.timezone.utc).date().isoformat(),
        'machine': describe_machine(),
        'versions': versions(),
        'model': {
            'trained_on_frames': MODEL_FRAMES,
            'trees': DEFAULT_TREES,
            'query_points': model.settings.query_points,
        },
        'stages': _time_stages(with_trees(model, DEFAULT_TREES)),
        'curves': _time_curves(model),
        'training': training,
    }
    tell(f'{time.monotonic() - begin:.0f} s')
    return results


def _time_training(labelled: Sequence[Labelled]) -> dict[str, object]:
    """Return how long training takes, from encoded frames to the model in memory.

    The processor time, unlike the elapsed time, hardly depends on other load.
    """
    _train(labelled[:20], 1)  # compiles
    seconds, processor_seconds = [], []
    for count in TRAINING_FRAMES:
        tell(f'training on {count} frames')
        begin, begin_processor = time.perf_counter(), time.process_time()
        _train(labelled[:count], DEFAULT_TREES)
        seconds.append(time.perf_counter() - begin)
        processor_seconds.append(time.process_time() - begin_processor)
    return {
        'frames': list(TRAINING_FRAMES),
        'seconds': seconds,
        'processor_seconds': processor_seconds,
        'trees': DEFAULT_TREES,
    }


def _train(labelled: Sequence[Labelled], trees: int) -> Model:
    training = TrainingSettings(numbers_of(DEFAULT_JOINTS), trees=trees)
    return train(_frames(labelled), training, {'recordings': 'synthetic'})


def _frames(labelled: Sequence[Labelled]) -> Iterator[Frame]:
    for stamp, (encoded, ground_truth) in enumerate(labelled):
        yield Frame(stamp, 'camera', *decode_frame(encoded), encoded.camera, ground_truth)


def _time_stages(model: Model) -> list[dict[str, Any]]:
    """Return the times of the stages beside the plain kernels: three sizes and query points."""
    settings = model.settings
    results = []
    for (width, height), queries in (
        ((320, 240), settings.points),
        ((640, 480), settings.points),
        ((320, 240), settings.query_points),
    ):
        tell(f'stages at {width}x{height}, {queries} points vote')
        changed = with_settings(model, query_points=queries)
        results.append(compare_with_plain(changed, people(width, height)))
    return results


def _time_curves(model: Model) -> dict[str, object]:
    usual = with_trees(model, DEFAULT_TREES)
    frames, large = people(320, 240), people(640, 480)
    crowd = [list(_choose_bodies(640, 480, count)) for count in BODIES]
    return {
        # At 320x240 few silhouettes have 900 points.
        'points': time_together(
            POINTS,
            [(with_settings(usual, points=n, query_points=n), large) for n in POINTS],
        ),
        'query_points': time_together(
            QUERY_POINTS, [(with_settings(usual, query_points=q), frames) for q in QUERY_POINTS]
        ),
        'trees': time_together(TREES, [(with_trees(model, trees), frames) for trees in TREES]),
        'size': time_together(
            [f'{width}x{height}' for width, height in SIZES],
            [(usual, people(width, height)) for width, height in SIZES],
        ),
        'bodies': time_together(BODIES, [(usual, frames) for frames in crowd]),
    }


def time_together(
    values: Sequence[object], runs: Sequence[tuple[Model, list[EncodedFrame]]]
) -> dict[str, Any]:
    """Return a curve: the summaries of `runs`, one for each of `values`.

    The runs take turns, a block of frames each, so other load slows down all alike.
    """
    tell(f'{len(runs)} runs, for {", ".join(map(str, values))}')
    setups = []
    for model, frames in runs:
        estimator = Estimator(model)
        setups.append(Setup(estimator, warm_up(estimator, frames)))
    clocks = [time_frames(estimator, frames) for estimator, frames in setups]
    turns = list(zip(*clocks, strict=False))
    columns = [summarise_times(times) for times in zip(*turns, strict=True)]
    return {
        'values': list(values),
        'frames': len(turns),
        'stages': {
            stage: {
                'ms_p50': [column[stage].ms_p50 for column in columns],
                'ms_p95': [column[stage].ms_p95 for column in columns],
            }
            for stage in columns[0]
        },
    }


def people(width: int, height: int, number: int = 1) -> list[EncodedFrame]:
    """Return the frames that are timed: the same vertical field of view at every size."""
    vertical = math.tan(math.radians(0.5 * sensor_of(_TIMED).field_of_view)) * 0.75
    field_of_view = 2 * math.degrees(math.atan(vertical * width / height))
    settings = _TIMED._replace(
        width=width, height=height, people=number, field_of_view=field_of_view
    )
    return [encode_frame(frame) for frame in synthetic_frames(settings)]


def _choose_bodies(width: int, height: int, count: int) -> Iterator[EncodedFrame]:
    """Yield frames of four people with `count` of them in the mask, each equally often."""
    for number, encoded in enumerate(people(width, height, max(BODIES))):
        depth, labels = decode_frame(encoded)
        bodies = [1 + (number + k) % max(BODIES) for k in range(count)]
        labels[~np.isin(labels, bodies)] = NO_BODY
        yield encode_frame(Frame(number, 'camera', depth, labels, encoded.camera, None))


def with_settings(model: Model, **settings: Any) -> Model:  # noqa: ANN401 - of any type
    """Return `model` with some of its settings changed."""
    return model._replace(settings=model.settings._replace(**settings))


def with_trees(model: Model, trees: int) -> Model:
    """Return `model` with its first `trees` trees."""
    return model._replace(forest=model.forest._replace(roots=model.forest.roots[:trees]))


def tell(sentence: str) -> None:
    """Print on stderr what is being measured."""
    sys.stderr.write(f'curves: {sentence}\n')


if __name__ == '__main__':
    sys.exit(main())
