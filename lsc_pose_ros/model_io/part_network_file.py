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


"""Files of the network of body parts: an archive of numpy arrays, without anything executable."""

import os
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.body_parts.part_network import INPUTS, OUTPUTS, Layer, PartNetwork
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.files.kinds import archive
from lsc_pose_ros.files.output_file import write_output
from lsc_pose_ros.model_io.archive_header import header_array, read_header
from lsc_pose_ros.model_io.model_file import check_sizes, read_array
from lsc_pose_ros.model_io.unusable_model import UnusableModelError, why_unusable
from lsc_pose_ros.resources.package_files import resource

FORMAT = 'lsc_pose_ros body parts'
VERSION = 3

PART_NETWORK = archive('a network of body parts', 'header.npy', FORMAT.encode())

MOST_PLANES = 256
"""A layer with more planes would take too long."""

LARGEST_WEIGHT = 1e4
"""The largest absolute value of a weight; scores of larger ones may overflow."""

_SOURCES = {
    'down_0': None,
    'halve_1': 'down_0',
    'down_1': 'halve_1',
    'halve_2': 'halve_1',
    'down_2': 'halve_2',
    'halve_3': 'halve_2',
    'down_3a': 'halve_3',
    'down_3b': 'halve_3',
    'up_2': 'halve_3',
    'refine_2': 'halve_2',
    'up_1': 'halve_2',
    'refine_1': 'halve_1',
    'up_0': 'halve_1',
    'refine_0': 'down_0',
    'scores': 'refine_0',
}
"""The layer that makes the planes that each layer reads."""

_SUMS = {
    'down_1': 'halve_1',
    'down_2': 'halve_2',
    'down_3a': 'halve_3',
    'down_3b': 'halve_3',
    'up_2': 'halve_2',
    'refine_2': 'halve_2',
    'up_1': 'halve_1',
    'refine_1': 'halve_1',
    'up_0': 'down_0',
}
"""The layer to whose planes those of each of these layers are added."""

_MIXES = ('up_2', 'up_1', 'up_0', 'scores')
"""The layers that see one cell; the others see 3 x 3 cells."""


class PartNetworkFile(NamedTuple):
    """The content of a file.

    Attributes:
        network: the network.
        provenance: information for users, by name.
    """

    network: PartNetwork
    provenance: dict[str, str]


def save_part_network(
    path: str | os.PathLike[str], network: PartNetwork, provenance: dict[str, str]
) -> None:
    """Write a network to `path`.

    Raises:
        InputError: the file cannot be written, or another kind of file is there.
    """
    header = {
        'classes': ['no person', *JOINT_NAMES],
        'provenance': provenance,
    }
    arrays: dict[str, Any] = {'header': header_array(FORMAT, VERSION, header)}
    for name, layer in network._asdict().items():
        for part, value in layer._asdict().items():
            arrays[f'{name}_{part}'] = np.asarray(value, np.float32)
    write_output(Path(path), PART_NETWORK, lambda file: np.savez_compressed(file, **arrays))


def load_part_network(path: str | os.PathLike[str] | None = None) -> PartNetworkFile:
    """Return the network in a file, or that of the package.

    Args:
        path: the path of a file; None for the one that comes with the package.

    Raises:
        InputError: there is no such file, it is no body-part network, it has another version, or
            its layers do not fit together.
    """
    source = resource('body_parts', 'body_parts.npz') if path is None else Path(path)
    try:
        check_sizes(source)
        with np.load(source, allow_pickle=False) as archive:
            provenance = _read_header(archive)
            network = PartNetwork(*(_read_layer(archive, name) for name in PartNetwork._fields))
        check_part_network(network)
    except FileNotFoundError as error:
        msg = f'there is no file {source}'
        raise InputError(msg) from error
    except Exception as error:  # a damaged file makes numpy raise errors of many types
        msg = f'{source} is not a usable body-part network ({why_unusable(error)})'
        raise InputError(msg) from error
    return PartNetworkFile(network, provenance)


def _read_layer(archive: Any, name: str) -> Layer:  # noqa: ANN401
    dimensions = 2 if name in _MIXES else 3
    weights: Any = read_array(archive, f'{name}_weights', (np.float32, dimensions))
    bias: Any = read_array(archive, f'{name}_bias', (np.float32, 1))
    return Layer(weights, bias)


def _read_header(archive: Any) -> dict[str, str]:  # noqa: ANN401
    header = read_header(archive, FORMAT, VERSION)
    if header.get('classes') != ['no person', *JOINT_NAMES]:
        msg = 'its classes are not those of this package'
        raise UnusableModelError(msg)
    provenance = header.get('provenance')
    if not isinstance(provenance, dict):
        msg = 'its provenance is no table'
        raise UnusableModelError(msg)
    return {str(name): str(value) for name, value in provenance.items()}


def check_part_network(network: PartNetwork) -> None:
    """Check all shapes and numbers that kernels use, because kernels check none.

    Raises:
        UnusableModelError: the layers do not fit together, or a number is not usable.
    """
    layers: dict[str, Layer] = network._asdict()
    planes = {name: layer.weights.shape[0] for name, layer in layers.items()}
    for name, (weights, bias) in layers.items():
        source = _SOURCES[name]
        expected: tuple[int, ...] = (planes[name], INPUTS if source is None else planes[source])
        if name not in _MIXES:
            expected = (*expected, 9)
        if weights.shape != expected or bias.shape != expected[:1]:
            msg = f'its layer {name} does not fit to the others'
            raise UnusableModelError(msg)
        if not 1 <= planes[name] <= MOST_PLANES:
            msg = f'its layer {name} has {planes[name]} planes instead of 1 to {MOST_PLANES}'
            raise UnusableModelError(msg)
        # Written so that NaN is not good.
        if not (_within(weights) and _within(bias)):
            msg = f'a weight of its layer {name} is not within {LARGEST_WEIGHT:g}'
            raise UnusableModelError(msg)
    if any(planes[name] != planes[to] for name, to in _SUMS.items()):
        msg = 'its residuals have other numbers of planes than what they are added to'
        raise UnusableModelError(msg)
    if planes['scores'] != OUTPUTS:
        msg = f'it has {planes["scores"]} outputs instead of {OUTPUTS}'
        raise UnusableModelError(msg)


def _within(values: NDArray[np.float32]) -> bool:
    return bool((np.abs(values) <= LARGEST_WEIGHT).all())
