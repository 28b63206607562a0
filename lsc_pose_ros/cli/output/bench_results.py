"""What `lsc_pose bench` has measured, for programs and for people."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from lsc_pose_ros.cli.output.machine import describe_machine, versions
from lsc_pose_ros.evaluation.benchmark import WHOLE, FrameTimes, summarise_times
from lsc_pose_ros.evaluation.encoded_frame import EncodedFrame
from lsc_pose_ros.pose.model import Model


def bench_results(
    model: Model, frames: Sequence[EncodedFrame], times: Sequence[FrameTimes]
) -> dict[str, Any]:
    """Return what `--json` writes.

    Args:
        model: the model that was timed.
        frames: the frames that it was timed on.
        times: theirs, with the plain kernels.
    """
    wholes = [frame.seconds[WHOLE] for frame in times]
    apart = 1000 * np.concatenate([frame.apart.ravel() for frame in times])
    return {
        'frames': len(times),
        'size': ', '.join(sorted({frame.size for frame in frames})),
        'bodies_per_frame': float(np.mean([len(frame.apart) for frame in times])),
        'points': model.settings.points,
        'query_points': model.settings.query_points,
        'trees': len(model.forest.roots),
        'joints': len(model.joints),
        'frames_per_second': 1 / float(np.mean(wholes)),
        'stages': {name: stage._asdict() for name, stage in summarise_times(times).items()},
        'apart_from_plain_mm': {
            # A joint that only one way has found is infinitely far, and not to be interpolated.
            'p95': float(np.nanpercentile(apart, 95, method='higher')),
            'max': float(np.nanmax(apart)),
        },
        'machine': describe_machine() | {'cores_used': 1},
        'versions': versions(),
    }


def bench_table(results: dict[str, Any]) -> str:
    """Return `bench_results` as lines to read."""
    lines = [f'{"stage":<20}{"median ms":>11}{"95 % ms":>10}{"plain ms":>10}{"ratio":>9}']
    for name, stage in results['stages'].items():
        compared = stage['ratio_to_plain'] is not None
        plain = f'{stage["plain_ms_p50"]:.2f}' if compared else '-'
        ratio = f'{stage["ratio_to_plain"]:.1f} x' if compared else '-'
        times = f'{stage["ms_p50"]:>11.2f}{stage["ms_p95"]:>10.2f}'
        lines.append(f'{name:<20}{times}{plain:>10}{ratio:>9}')
    return '\n'.join([*lines, *_facts(results)])


def _facts(results: dict[str, Any]) -> list[str]:
    apart, machine = results['apart_from_plain_mm'], results['machine']
    used = ', '.join(f'{name} {version}' for name, version in results['versions'].items())
    frames = f'{results["frames"]} frames of {results["size"]}'
    points = f'{results["points"]} points, {results["query_points"]} of them vote'
    forest = f'{results["trees"]} trees, {results["joints"]} joints, graph on'
    distances = f'95 % within {apart["p95"]:.2f} mm, all within {apart["max"]:.2f} mm'
    return [
        f'{results["frames_per_second"]:.0f} frames/s on one core of {machine["processor"]}',
        f'{frames}, bodies a frame: {results["bodies_per_frame"]:.3g}; {points}; {forest}',
        f'joints by fast and by plain kernels: {distances} of each other',
        used,
    ]
