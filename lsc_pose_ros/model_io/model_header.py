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

"""The header of a model file: format, version, settings and provenance, as JSON."""

import json
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.model_io.unusable_model import UnusableModelError
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import BINNINGS, FEATURES, LARGEST, SAMPLES, Settings

FORMAT = 'lsc_pose model'
VERSION = 5
"""The version that is written. Versions 3 and 4 are read, too: some settings have other names, or
are missing."""

_NAMES_SINCE_VERSION_3 = {'facings': 'body_yaws'}
"""What settings were called in version 3, and what they are called now."""

_NEW_IN_VERSION_5: dict[str, float] = {
    name: Settings()._asdict()[name]
    for name in ('occluder_step', 'sloppy_outline', 'least_cut_scale')
}
"""Settings that older versions do not have, and the values that their models use."""

# The settings that are words, and which words are allowed.
_WORDS = {'feature': FEATURES, 'sample': SAMPLES, 'binning': BINNINGS}


class Header(NamedTuple):
    """What a model file says besides its arrays; the fields are those of `Model`."""

    settings: Settings
    provenance: dict[str, str]


def encode_header(model: Model) -> NDArray[np.uint8]:
    """Return the header of a file of `model` as the bytes of its JSON text."""
    header = {
        'format': FORMAT,
        'version': VERSION,
        'settings': model.settings._asdict(),
        'provenance': model.provenance,
    }
    return np.frombuffer(json.dumps(header, indent=1).encode(), np.uint8)


def decode_header(data: NDArray[Any]) -> Header:
    """Return the header in the bytes `data`.

    Raises:
        UnusableModelError: it is of another kind or version, or its settings are out of range.
        ValueError: it is no JSON text.
    """
    header = json.loads(data.astype(np.uint8).tobytes())
    if not isinstance(header, dict) or header.get('format') != FORMAT:
        msg = 'its header is of another kind'
        raise UnusableModelError(msg)
    version, settings = header.get('version'), header.get('settings')
    if version not in {3, 4, VERSION}:
        msg = f'it has version {version!r:.20}, but this program reads versions 3 to {VERSION}'
        raise UnusableModelError(msg)
    if isinstance(settings, dict):
        settings = _settings_of_this_version(settings, version)
    return Header(read_settings(settings), _read_provenance(header.get('provenance')))


def _settings_of_this_version(given: dict[str, Any], version: int) -> dict[str, Any]:
    settings = given
    if version == 3:
        settings = {_NAMES_SINCE_VERSION_3.get(name, name): settings[name] for name in settings}
    return settings if version == VERSION else settings | _NEW_IN_VERSION_5


def _read_provenance(given: object) -> dict[str, str]:
    if not isinstance(given, dict):
        msg = 'its header lacks the provenance'
        raise UnusableModelError(msg)
    return {str(name): str(value) for name, value in given.items()}


def read_settings(given: object) -> Settings:
    """Return the settings of a header.

    Raises:
        UnusableModelError: they are not those of this version, or one is out of range.
    """
    defaults = Settings()._asdict()
    if not isinstance(given, dict) or set(given) != set(defaults):
        msg = 'its settings are not those of this version'
        raise UnusableModelError(msg)
    values: dict[str, Any] = {
        name: _read_word(name, given[name])
        if name in _WORDS
        else _read_number(name, given[name], type(default))
        for name, default in defaults.items()
    }
    settings = Settings(**values)
    if not (0 < settings.inner_radius < 1 and settings.joint_bandwidth > 0):
        msg = 'its radii or bandwidths are not positive'
        raise UnusableModelError(msg)
    if not settings.offset_reach > 0:
        msg = 'its offsets reach nowhere'
        raise UnusableModelError(msg)
    counts = settings.points, settings.query_points, settings.heaviest_votes, settings.candidates
    if min(*counts, settings.offset_pairs) < 1:
        msg = 'it asks for no points, votes, candidates or pairs of offsets'
        raise UnusableModelError(msg)
    return settings


def _read_word(name: str, value: object) -> str:
    if value not in _WORDS[name]:
        msg = f'its setting {name} is {value!r:.40}'
        raise UnusableModelError(msg)
    return str(value)


def _read_number(name: str, value: Any, kind: type) -> Any:  # noqa: ANN401
    is_number = isinstance(value, int if kind is int else int | float)
    if not is_number or isinstance(value, bool) or not 0 <= value <= LARGEST[name]:
        msg = (
            f'its setting {name} is {value!r:.40}; it must be a number from 0 to {LARGEST[name]:g}'
        )
        raise UnusableModelError(msg)
    return kind(value)
