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

"""Labels from TF: a motion capture system or another tracker that publishes frames."""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.errors import InputError, excerpt
from lsc_pose_ros.labels.limits import FARTHEST, LARGEST_BODY
from lsc_pose_ros.labels.tracks import LabelSettings, finished, skeletons_of
from lsc_pose_ros.labels.transform_history import TransformHistory
from lsc_pose_ros.labels.vocabulary import Vocabulary
from lsc_pose_ros.resources.yaml_tables import read_yaml

_MOST_BODIES = 1000

# A warning names so many of the frames that are missing.
_SHOWN = 3


class JointFrame(NamedTuple):
    """The frame of one joint, and the joint's position in it, metres."""

    frame_id: str
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)


class FrameLabels:
    """Labels from the frames of TF, each interpolated along its chain of transforms."""

    def __init__(
        self,
        bodies: Mapping[int, Mapping[int, JointFrame]],
        transforms: TransformHistory,
        settings: LabelSettings,
    ) -> None:
        """Use the frames of `bodies`: body number, index of the joint, frame.

        Raises:
            InputError: none of the frames was ever published.
        """
        self._bodies = bodies
        self._transforms = transforms
        self._settings = settings
        self._missing: dict[tuple[int, str], int] = defaultdict(int)
        frames = {each.frame_id for joints in bodies.values() for each in joints.values()}
        if not frames & transforms.frames:
            known = ', '.join(sorted(transforms.frames)[:20]) or 'no frames at all'
            msg = f'TF has none of the frames {", ".join(sorted(frames)[:5])}; it has {known}'
            raise InputError(msg)

    @property
    def warnings(self) -> Sequence[str]:
        """A sentence for the frames of each body that are missing in as many depth images."""
        groups: dict[tuple[int, int], list[str]] = defaultdict(list)
        for (body, frame_id), count in self._missing.items():
            groups[body, count].append(frame_id)
        return [
            f'body {body}: {_listed(frames)} not known at the time of {count} depth images'
            for (body, count), frames in groups.items()
        ]

    def at(self, number: int, frame: Frame) -> Skeletons:  # noqa: ARG002 - stamps are enough
        """Return the labelled bodies of a frame; as `LabelSource.at`."""
        moment = frame.stamp - self._settings.time_offset
        vocabulary = self._settings.vocabulary
        found = {}
        for body, joints in self._bodies.items():
            theirs = np.full((len(vocabulary.names), 3), np.nan)
            for index, (frame_id, offset) in joints.items():
                pose = self._transforms.lookup(frame.frame_id, frame_id, moment)
                if pose is None:
                    self._missing[body, frame_id] += 1
                else:
                    theirs[index] = pose.apply(np.array(offset))
            found[body] = finished(vocabulary.ours(theirs), self._settings)
        return skeletons_of(found)

    def why_none(self, number: int, frame: Frame) -> str:  # noqa: ARG002
        """Return why a frame has no label; as `LabelSource.why_none`."""
        return 'at whose time TF knows too few frames for a joint'


def _listed(frames: Sequence[str]) -> str:
    if len(frames) == 1:
        return f'the TF frame {frames[0]} is'
    shown = ', '.join(frames[:_SHOWN]) + (', ...' if len(frames) > _SHOWN else '')
    return f'{len(frames)} TF frames ({shown}) are'


def load_joint_frames(path: Path, vocabulary: Vocabulary) -> dict[int, dict[int, JointFrame]]:
    """Return the frames that a YAML file names: body number, index of the joint, frame.

    Raises:
        InputError: the file cannot be read, or is not valid.
    """
    loaded = read_yaml(path, 'mapping of TF frames')
    try:
        return _bodies(loaded, vocabulary)
    except ValueError as error:
        msg = f'{path} is not a usable mapping of TF frames: {error}'
        raise InputError(msg) from error


def _bodies(loaded: object, vocabulary: Vocabulary) -> dict[int, dict[int, JointFrame]]:
    if not isinstance(loaded, dict) or not {'bodies'} <= set(loaded) <= {'bodies', 'pattern'}:
        msg = 'it needs bodies, and pattern if bodies is a list'
        raise ValueError(msg)
    if isinstance(loaded['bodies'], list):
        return _by_pattern(loaded.get('pattern'), loaded['bodies'], vocabulary)
    return _by_name(loaded['bodies'], vocabulary)


def _by_pattern(
    pattern: object, bodies: list[Any], vocabulary: Vocabulary
) -> dict[int, dict[int, JointFrame]]:
    if not isinstance(pattern, str) or '{joint}' not in pattern:
        msg = "pattern must be a text with {joint}, such as '{joint}_{body}'"
        raise ValueError(msg)
    numbers = [_body(body) for body in bodies]
    if not numbers or len(set(numbers)) < len(numbers) or len(numbers) > _MOST_BODIES:
        msg = f'bodies must be 1 to {_MOST_BODIES} different numbers'
        raise ValueError(msg)
    return {
        body: {
            index: JointFrame(pattern.replace('{joint}', name).replace('{body}', str(body)))
            for index, name in enumerate(vocabulary.names)
        }
        for body in numbers
    }


def _by_name(bodies: object, vocabulary: Vocabulary) -> dict[int, dict[int, JointFrame]]:
    if not isinstance(bodies, dict) or not bodies:
        msg = 'bodies must be a table of body numbers'
        raise ValueError(msg)
    found: dict[int, dict[int, JointFrame]] = {}
    for body, joints in bodies.items():
        if not isinstance(joints, dict):
            msg = f'body {excerpt(body)} must be a table of joints and their frames'
            raise ValueError(msg)  # noqa: TRY004 - the user's error, not the program's
        found[_body(body)] = {
            _joint(str(name), vocabulary): _frame(name, value) for name, value in joints.items()
        }
    return found


def _body(value: object) -> int:
    if type(value) is not int or not 0 <= value <= LARGEST_BODY:
        msg = f'{excerpt(repr(value))} is not a body number from 0 to {LARGEST_BODY}'
        raise ValueError(msg)
    return value


def _joint(name: str, vocabulary: Vocabulary) -> int:
    index = vocabulary.number_of(name)
    if index is None:
        msg = f'unknown joint {excerpt(name)}; the joints are {vocabulary.listed}'
        raise ValueError(msg)
    return index


def _frame(name: object, value: object) -> JointFrame:
    if isinstance(value, str):
        return JointFrame(value)
    if isinstance(value, dict) and isinstance(value.get('frame'), str):
        offset = value.get('offset', (0, 0, 0))
        if len(value) <= 2 and _is_offset(offset):
            x, y, z = map(float, offset)
            return JointFrame(value['frame'], (x, y, z))
    msg = f'{excerpt(name)} must be a frame, or {{frame: NAME, offset: [x, y, z]}} in metres'
    raise ValueError(msg)


def _is_offset(value: object) -> bool:
    """Return whether `value` is three numbers of metres."""
    return (
        isinstance(value, list | tuple)
        and len(value) == 3
        and all(isinstance(each, int | float) and abs(each) <= FARTHEST for each in value)
    )
