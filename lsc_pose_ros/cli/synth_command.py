"""`lsc_pose synth`: a labelled recording of synthetic people, to try and to test with."""

import argparse
from pathlib import Path

from lsc_pose_ros.cli.image_size import image_size
from lsc_pose_ros.cli.progress import progress
from lsc_pose_ros.data.recording import RecordingWriter
from lsc_pose_ros.data.synthetic.generator import NOISES, SyntheticSettings, synthetic_frames

HELP = 'generate a labelled recording of synthetic people'

_DEFAULTS = SyntheticSettings()


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the command's own arguments to `parser`."""
    parser.formatter_class = argparse.ArgumentDefaultsHelpFormatter
    parser.add_argument(
        'output', type=Path, metavar='OUT', help='the recording: OUT.mcap, or a bag folder'
    )
    _add_amount(parser)
    _add_people(parser)
    _add_camera(parser)


def run(arguments: argparse.Namespace) -> int:
    """Generate the recording that `arguments` describe; return the exit status.

    Raises:
        InputError: the settings or the output cannot be used.
    """
    settings = SyntheticSettings(
        frames=arguments.frames,
        seed=arguments.seed,
        people=arguments.people,
        width=arguments.size[0],
        height=arguments.size[1],
        field_of_view=arguments.fov,
        noise=arguments.noise,
        yaw=arguments.yaw,
        distance=(arguments.distance[0], arguments.distance[1]),
        stature=(arguments.stature[0], arguments.stature[1]),
        clip_length=arguments.clip_length,
        rate=arguments.fps,
        cropped=arguments.cropped,
    )
    frames = synthetic_frames(settings)
    with RecordingWriter(arguments.output) as writer:
        for frame in progress(frames, settings.frames, 'generating'):
            writer.write_frame(frame)
    clips = -(-settings.frames // settings.clip_length)
    print(f'{arguments.output}: {settings.frames} frames, {clips * settings.people} people')
    return 0


def _add_amount(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--frames', type=int, default=_DEFAULTS.frames, metavar='N', help='how many'
    )
    parser.add_argument(
        '--seed', type=int, default=_DEFAULTS.seed, metavar='N', help='the same, the same frames'
    )
    parser.add_argument(
        '--clip-length',
        type=int,
        default=_DEFAULTS.clip_length,
        metavar='N',
        help='every N frames new people come',
    )
    parser.add_argument(
        '--fps', type=float, default=_DEFAULTS.rate, metavar='HZ', help='frames a second'
    )


def _add_people(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--people', type=int, default=_DEFAULTS.people, metavar='N', help='in every frame'
    )
    parser.add_argument(
        '--stature',
        type=float,
        nargs=2,
        default=_DEFAULTS.stature,
        metavar=('SMALLEST', 'TALLEST'),
        help='metres',
    )
    parser.add_argument(
        '--distance',
        type=float,
        nargs=2,
        default=_DEFAULTS.distance,
        metavar=('NEAREST', 'FARTHEST'),
        help='from the camera, metres; who does not fit the image so near stands farther',
    )
    parser.add_argument(
        '--yaw',
        type=float,
        default=_DEFAULTS.yaw,
        metavar='DEGREES',
        help='people face so far aside of the camera at most',
    )
    parser.add_argument(
        '--cropped',
        action='store_true',
        help="people may be cut off by the image's edge; else they are in full view",
    )


def _add_camera(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        '--size',
        type=image_size,
        default=f'{_DEFAULTS.width}x{_DEFAULTS.height}',
        metavar='WIDTHxHEIGHT',
        help='of the image, pixels',
    )
    parser.add_argument(
        '--fov',
        type=float,
        default=_DEFAULTS.field_of_view,
        metavar='DEGREES',
        help='horizontal field of view',
    )
    parser.add_argument(
        '--noise', choices=NOISES, default=_DEFAULTS.noise, help="the sensor's noise"
    )
