"""The arguments of how a recording is answered: the node's parameters, by the same names."""

import argparse

from lsc_pose_ros.cli.options.model_option import add_model_argument
from lsc_pose_ros.cli.options.numbers import float_from_zero, positive_float, positive_int
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.estimation.temporal import Sequence, SequenceSettings
from lsc_pose_ros.messages.markers import LIFETIME_NS, MarkerStyle
from lsc_pose_ros.model_io.model_file import load_model
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.resources.package_files import find_model
from lsc_pose_ros.segmentation.segmenter import (
    MASK,
    SEGMENTATIONS,
    SegmentationSettings,
    Segmenter,
    make_segmenter,
)

_TRACKED = 'tracked'
_BODY_IDS = (MASK, _TRACKED)

_SECOND_NS = 1_000_000_000

# As the node's parameter query_points.
_FEWEST_QUERY_POINTS = 10


def add_answer_arguments(group: argparse._ArgumentGroup) -> None:
    """Add all arguments of the answers to `group`."""
    add_model_argument(group)
    group.add_argument(
        '--no-graph',
        dest='graph',
        action='store_false',
        help='take each joint by itself, without the pictorial structure',
    )
    group.add_argument(
        '--query-points',
        type=positive_int,
        metavar='N',
        help='how many silhouette points vote (default: as the model says)',
    )
    _add_segmentation_arguments(group)
    _add_sequence_arguments(group)
    _add_marker_arguments(group)


def sequence_of(arguments: argparse.Namespace) -> Sequence:
    """Return what answers the frames as `arguments` ask for it.

    Raises:
        InputError: the model cannot be used, or has fewer points than shall vote.
    """
    model = load_model(find_model(arguments.model))
    settings = model.settings
    if arguments.query_points is not None:
        if not _FEWEST_QUERY_POINTS <= arguments.query_points <= settings.points:
            msg = (
                f'--query-points: {arguments.query_points} cannot be used; it must be from '
                f'{_FEWEST_QUERY_POINTS} to {settings.points}, the points that the model was '
                'trained with'
            )
            raise InputError(msg)
        settings = settings._replace(query_points=arguments.query_points)
    return Sequence(
        Estimator(model._replace(settings=settings), graph=arguments.graph),
        SequenceSettings(
            smoothing=arguments.smoothing,
            smoothing_cutoff=arguments.smoothing_cutoff,
            smoothing_beta=arguments.smoothing_beta,
            tracked=arguments.body_ids == _TRACKED,
        ),
    )


def segmenter_of(arguments: argparse.Namespace) -> Segmenter | None:
    """Return what finds the bodies as `arguments` ask for it, None for the recording's masks.

    Raises:
        InputError: the range is empty.
    """
    return make_segmenter(
        SegmentationSettings(
            segmentation=arguments.segmentation,
            range_min=arguments.range_min,
            range_max=arguments.range_max,
            background_seconds=arguments.background_seconds,
            background_margin=arguments.background_margin,
        )
    )


def style_of(arguments: argparse.Namespace) -> MarkerStyle:
    """Return how skeletons are drawn as `arguments` ask for it."""
    return MarkerStyle(arguments.minimum_confidence, round(arguments.marker_lifetime * _SECOND_NS))


def _add_segmentation_arguments(group: argparse._ArgumentGroup) -> None:
    default = SegmentationSettings()
    group.add_argument(
        '--segmentation',
        choices=SEGMENTATIONS,
        default=default.segmentation,
        help='where bodies come from: the masks, what is nearer than the empty scene, or the '
        'nearest blob (default: %(default)s)',
    )
    for name, value, what in (
        ('--range-min', default.range_min, 'without masks, what is nearer is no body'),
        ('--range-max', default.range_max, 'without masks, what is farther is no body'),
        ('--background-margin', default.background_margin, 'nearer than the scene by so much'),
    ):
        group.add_argument(
            name,
            type=float_from_zero,
            default=value,
            metavar='METRES',
            help=f'{what} (default: %(default)s)',
        )
    group.add_argument(
        '--background-seconds',
        type=float_from_zero,
        default=default.background_seconds,
        metavar='SECONDS',
        help='how long the recording shows the empty scene first (default: %(default)s)',
    )


def _add_sequence_arguments(group: argparse._ArgumentGroup) -> None:
    default = SequenceSettings()
    group.add_argument(
        '--body-ids',
        choices=_BODY_IDS,
        default=MASK,
        help="a body's number: its mask's, or one that it keeps while masks renumber the bodies "
        '(default: %(default)s)',
    )
    group.add_argument(
        '--smoothing', action='store_true', help='smooth the joints over time (One-Euro filter)'
    )
    group.add_argument(
        '--smoothing-cutoff',
        type=positive_float,
        default=default.smoothing_cutoff,
        metavar='HZ',
        help="the filter's cutoff frequency for a joint at rest (default: %(default)s)",
    )
    group.add_argument(
        '--smoothing-beta',
        type=float_from_zero,
        default=default.smoothing_beta,
        metavar='PER_METRE',
        help="by how much the cutoff rises with a joint's speed (default: %(default)s)",
    )


def _add_marker_arguments(group: argparse._ArgumentGroup) -> None:
    group.add_argument(
        '--minimum-confidence',
        type=float_from_zero,
        default=MarkerStyle().minimum_confidence,
        metavar='SHARE',
        help='joints below it are left out of the markers (default: %(default)s)',
    )
    group.add_argument(
        '--marker-lifetime',
        type=float_from_zero,
        default=LIFETIME_NS / _SECOND_NS,
        metavar='SECONDS',
        help='how long a marker stays that is not renewed (default: %(default)s)',
    )
