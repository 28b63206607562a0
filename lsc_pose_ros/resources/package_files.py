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

"""Finds the files of the package: configuration, models and bodies."""

from importlib.resources import files
from pathlib import Path

from lsc_pose_ros.errors import InputError

PACKAGE = 'lsc_pose_ros'
RESOURCES = f'{PACKAGE}.resources'

DEFAULT_MODEL = 'default'
"""The model of the package that is used if none is named."""


def resource(*parts: str) -> Path:
    """Return the path of a file of the package, e.g. `resource('config', 'pose_node.yaml')`.

    Raises:
        InputError: the file does not exist.
    """
    path = _folder().joinpath(*parts)
    if path.exists():
        return path
    msg = f'{"/".join(parts)} is not installed with {PACKAGE}; install the package again'
    raise InputError(msg)


def _folder() -> Path:
    # The package is installed as files (zip_safe=False), so that this is a folder.
    return Path(str(files(RESOURCES)))


def default_model() -> Path:
    """Return the path of the default model of the package.

    Raises:
        InputError: the package has none.
    """
    try:
        return resource('models', f'{DEFAULT_MODEL}.npz')
    except InputError as error:
        msg = (
            f'no model comes with this {PACKAGE}; '
            'give the path of one that `lsc_pose train` has made'
        )
        raise InputError(msg) from error


def shipped_models() -> dict[str, Path]:
    """Return the paths of the models of the package, by the name of the file without suffix."""
    return {path.stem: path for path in sorted((_folder() / 'models').glob('*.npz'))}


def find_model(name: str | Path = '') -> Path:
    """Return the path of the model `name`.

    Args:
        name: a path, or the name of a model of the package such as 'default', or empty for the
            default model. An existing file takes precedence over a model of the package.

    Raises:
        InputError: the name is neither a file nor a model of the package, or the package has no
            default model.
    """
    word = str(name)
    if not word:
        return default_model()
    path = Path(word)
    # The reader of model files reports what is wrong with a path.
    if path.is_file() or path.suffix or len(path.parts) != 1:
        return path
    models = shipped_models()
    if word in models:
        return models[word]
    known = f'its models are {", ".join(models)}' if models else 'no model does'
    msg = f'there is no model file {word}, and no model {word} comes with {PACKAGE}: {known}'
    raise InputError(msg)
