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


"""Files of the network of body parts: what is saved is loaded, and nothing unusable is."""

import json
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.body_parts.part_network import INPUTS, OUTPUTS, Layer, PartNetwork
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.part_network_file import (
    FORMAT,
    VERSION,
    load_part_network,
    save_part_network,
)

MIXES = {'up_2', 'up_1', 'up_0', 'scores'}


def a_network() -> PartNetwork:
    """Return a network of two planes in each layer."""
    rng = np.random.default_rng(0)

    def layer(name: str) -> Layer:
        outputs = OUTPUTS if name == 'scores' else 2
        inputs = INPUTS if name == 'down_0' else 2
        shape = (outputs, inputs) if name in MIXES else (outputs, inputs, 9)
        return Layer(
            rng.normal(size=shape).astype(np.float32), rng.normal(size=outputs).astype(np.float32)
        )

    return PartNetwork(*(layer(name) for name in PartNetwork._fields))


def test_a_network_comes_back(tmp_path: Path) -> None:
    saved = a_network()
    save_part_network(tmp_path / 'parts.npz', saved, {'frames': '7'})
    network, provenance = load_part_network(tmp_path / 'parts.npz')
    assert provenance == {'frames': '7'}
    for layer, again in zip(saved, network, strict=True):
        np.testing.assert_array_equal(again.weights, layer.weights, strict=True)
        np.testing.assert_array_equal(again.bias, layer.bias, strict=True)
    assert [path.name for path in tmp_path.iterdir()] == ['parts.npz']


def test_a_network_on_standard_output_comes_back(
    tmp_path: Path, capfdbinary: pytest.CaptureFixture[bytes]
) -> None:
    given = load_part_network()
    save_part_network('-', *given)
    (tmp_path / 'network.npz').write_bytes(capfdbinary.readouterr().out)
    np.testing.assert_equal(load_part_network(tmp_path / 'network.npz'), given)


def test_the_network_of_the_package_is_usable() -> None:
    network, provenance = load_part_network()
    assert len(network.scores.bias) == OUTPUTS
    assert int(provenance['frames']) > 0


def with_weights(name: str, weights: np.ndarray) -> PartNetwork:
    network = a_network()
    return network._replace(**{name: getattr(network, name)._replace(weights=weights)})


def with_value(name: str, value: float) -> PartNetwork:
    weights = getattr(a_network(), name).weights.copy()
    weights.flat[1] = value
    return with_weights(name, weights)


def with_planes(name: str, count: int) -> PartNetwork:
    layer = getattr(a_network(), name)
    shape = (count, *layer.weights.shape[1:])
    wider = Layer(np.zeros(shape, np.float32), np.zeros(count, np.float32))
    return a_network()._replace(**{name: wider})


@pytest.mark.parametrize('name', PartNetwork._fields)
@pytest.mark.parametrize('value', [np.nan, np.inf, -1e9])
def test_a_weight_that_is_not_usable_is_refused(tmp_path: Path, name: str, value: float) -> None:
    save_part_network(tmp_path / 'parts.npz', with_value(name, value), {})
    with pytest.raises(InputError, match=f'a weight of its layer {name} is not within'):
        load_part_network(tmp_path / 'parts.npz')


@pytest.mark.parametrize('name', PartNetwork._fields)
def test_a_layer_of_another_shape_is_refused(tmp_path: Path, name: str) -> None:
    weights = getattr(a_network(), name).weights[:, :1].copy()
    save_part_network(tmp_path / 'parts.npz', with_weights(name, weights), {})
    with pytest.raises(InputError, match=f'its layer {name} does not fit'):
        load_part_network(tmp_path / 'parts.npz')


@pytest.mark.parametrize('name', PartNetwork._fields)
def test_a_layer_with_another_number_of_planes_is_refused(tmp_path: Path, name: str) -> None:
    save_part_network(tmp_path / 'parts.npz', with_planes(name, 3), {})
    with pytest.raises(InputError, match=r'fit|planes|outputs'):
        load_part_network(tmp_path / 'parts.npz')


@pytest.mark.parametrize('count', [0, 1000])
def test_too_many_or_no_planes_are_refused(tmp_path: Path, count: int) -> None:
    network = with_planes('refine_0', count)
    scores = network.scores._replace(weights=np.zeros((OUTPUTS, count), np.float32))
    save_part_network(tmp_path / 'parts.npz', network._replace(scores=scores), {})
    with pytest.raises(InputError, match=f'refine_0 has {count} planes'):
        load_part_network(tmp_path / 'parts.npz')


HEADER = {
    'format': FORMAT,
    'version': VERSION,
    'classes': ['no person', *JOINT_NAMES],
    'provenance': {},
}


def write(path: Path, header: object, **changes: np.ndarray) -> None:
    text = np.frombuffer(json.dumps(header).encode(), np.uint8)
    arrays = {
        f'{name}_{part}': array
        for name, layer in a_network()._asdict().items()
        for part, array in layer._asdict().items()
    }
    np.savez_compressed(path, **({'header': text} | arrays | changes))


@pytest.mark.parametrize(
    ('header', 'complaint'),
    [
        ([], 'another kind'),
        (HEADER | {'format': 'x'}, 'another kind'),
        (HEADER | {'version': 2}, 'it has version 2'),
        (HEADER | {'classes': ['no person']}, 'classes'),
        (HEADER | {'provenance': 3}, 'provenance'),
    ],
)
def test_another_header_is_refused(tmp_path: Path, header: object, complaint: str) -> None:
    write(tmp_path / 'parts.npz', header)
    with pytest.raises(InputError, match=complaint):
        load_part_network(tmp_path / 'parts.npz')


@pytest.mark.parametrize('name', ['down_0', 'up_1', 'scores'])
def test_an_array_of_another_type_is_refused(tmp_path: Path, name: str) -> None:
    weights = getattr(a_network(), name).weights.astype(np.float64)
    write(tmp_path / 'parts.npz', HEADER, **{f'{name}_weights': weights})
    with pytest.raises(InputError, match=f'its part {name}_weights is float64'):
        load_part_network(tmp_path / 'parts.npz')


def test_pickled_arrays_are_not_loaded(tmp_path: Path) -> None:
    write(tmp_path / 'parts.npz', HEADER, down_0_bias=np.array([{}], object))
    with pytest.raises(InputError, match='not a usable body-part network'):
        load_part_network(tmp_path / 'parts.npz')


def test_a_file_that_is_missing_or_damaged_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match='there is no file'):
        load_part_network(tmp_path / 'none.npz')
    (tmp_path / 'parts.npz').write_bytes(b'PK\x03\x04 nonsense')
    with pytest.raises(InputError, match='not a usable body-part network'):
        load_part_network(tmp_path / 'parts.npz')


def test_an_older_network_stays_if_the_new_one_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(InputError, match='does not exist; create it first'):
        save_part_network(tmp_path / 'missing' / 'parts.npz', a_network(), {})
