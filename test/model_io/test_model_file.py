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

"""Model files: what is written and read back."""

import json
import resource
import zipfile

import numpy as np
import pytest
from model_parts import change_header, parts_of, rewrite

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.model_io.model_file import describe_model, load_model, save_model
from lsc_pose_ros.model_io.model_header import VERSION
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.forest.body_yaw import with_body_yaw
from lsc_pose_ros.pose.forest.forest import find_leaves
from lsc_pose_ros.pose.inference.confidence import uncalibrated, vote_fractions
from lsc_pose_ros.resources.package_files import resource as package_file
from lsc_pose_ros.training.samples import labelled_people

# The offsets of joints are rounded to 0.02 rho_bar; half of that in metres, with rho_bar at 0.5 m.
HALF_A_STEP = 0.01 * 0.5


def test_all_but_the_forest_is_read_back_exactly(small_model, small_model_file):
    again = load_model(small_model_file)
    assert again.settings == small_model.settings
    assert again.provenance == small_model.provenance
    for name in ('joints', 'edges', 'limb_lengths', 'calibration'):
        np.testing.assert_array_equal(getattr(again, name), getattr(small_model, name))


def test_saving_a_loaded_model_again_changes_nothing(small_model_file, tmp_path):
    once, twice = tmp_path / 'once.npz', tmp_path / 'twice.npz'
    save_model(once, load_model(small_model_file))
    save_model(twice, load_model(once))
    assert parts_of(once).keys() == parts_of(twice).keys()
    for name, part in parts_of(once).items():
        np.testing.assert_array_equal(part, parts_of(twice)[name])


def estimate(model, frames):
    """Return the positions of the people in `frames`."""
    estimator = Estimator(model)
    return np.array(
        [estimator.estimate(frame.depth, frame.labels, frame.camera).positions for frame in frames]
    )


def test_loaded_model_estimates_the_same_but_for_rounding(small_model, small_model_file, people):
    before, after = (
        estimate(model, people[::2]) for model in (small_model, load_model(small_model_file))
    )
    moved = np.linalg.norm(after - before, axis=-1)
    assert np.median(moved) < HALF_A_STEP
    # Now and then rounding selects another mode. With few joints, one more of these decides.
    assert np.percentile(moved, 99) < 0.02


def test_nothing_in_the_file_is_a_pickle(small_model_file):
    with zipfile.ZipFile(small_model_file) as archive:
        for name in archive.namelist():
            with archive.open(name) as part:
                array = np.lib.format.read_array(part, allow_pickle=False)
            assert array.dtype.kind in 'iuf'


def test_without_calibration_the_confidence_is_the_fraction_of_the_votes(
    small_model, people, tmp_path
):
    path = tmp_path / 'uncalibrated.npz'
    save_model(path, small_model._replace(calibration=uncalibrated()))
    assert 'calibration' not in parts_of(path)
    model = load_model(path)
    assert len(model.calibration) == 0
    assert describe_model(model)['confidence'] == 'the fraction of the votes'
    frame = people[30]
    stages = Estimator(model).estimate_body(frame.depth, frame.labels, frame.camera, 1)
    fractions = vote_fractions(stages.joint_votes, stages.joints, model.settings.joint_bandwidth)
    found = Estimator(model).estimate(frame.depth, frame.labels, frame.camera)
    np.testing.assert_array_equal(found.confidence[0], fractions)


def test_model_with_body_yaws_is_read_back(body_yaw_model, body_yaw_model_file, all_round_people):
    again = load_model(body_yaw_model_file)
    assert again.settings == body_yaw_model.settings
    assert again.settings.body_yaws == 8
    assert again.feature_size == body_yaw_model.feature_size == 362
    assert again.forest.feature.max() == 361
    assert describe_model(again)['body yaws'] == '8'
    before, after = (estimate(model, all_round_people[::40]) for model in (body_yaw_model, again))
    moved = np.linalg.norm(after - before, axis=-1)
    assert np.median(moved) < HALF_A_STEP
    # If two body yaws are equally good, rounding may select the other one.
    assert np.percentile(moved, 80) < 0.02


def test_each_body_yaw_reaches_the_same_leaves_after_reading(
    body_yaw_model, body_yaw_model_file, all_round_people
):
    again = load_model(body_yaw_model_file)
    (person, *_) = labelled_people(all_round_people[:1], again.joints, again.settings)
    reached = [
        [
            find_leaves(model.forest, with_body_yaw(person.quantised, body_yaw))
            for body_yaw in (-2, 0, 1, 3)
        ]
        for model in (body_yaw_model, again)
    ]
    starts = body_yaw_model.forest.joint_votes.start, again.forest.joint_votes.start
    # The file numbers leaves in another order; their numbers of votes identify them well enough.
    counts = [
        np.diff(start)[np.array(leaves)] for start, leaves in zip(starts, reached, strict=True)
    ]
    np.testing.assert_array_equal(*counts)
    assert not np.array_equal(counts[0][0], counts[0][1])


def test_model_without_body_yaws_has_none(small_model, small_model_file):
    assert small_model.settings.body_yaws == 0
    assert small_model.feature_size == load_model(small_model_file).feature_size == 360
    assert describe_model(small_model)['body yaws'] == '0'


def test_version_3_had_other_names_of_settings(body_yaw_model, body_yaw_model_file, tmp_path):
    header = json.loads(parts_of(body_yaw_model_file)['header'].tobytes())
    assert header['version'] == VERSION == 5
    settings = header['settings']
    settings['facings'] = settings.pop('body_yaws')
    for name in ('occluder_step', 'sloppy_outline', 'least_cut_scale'):
        del settings[name]
    path = tmp_path / 'older.npz'
    data = change_header(body_yaw_model_file, settings=settings, version=3)
    assert load_model(rewrite(body_yaw_model_file, path, header=data)).settings == (
        body_yaw_model.settings
    )
    data = change_header(body_yaw_model_file, settings=settings)
    with pytest.raises(InputError, match='settings are not those of this version'):
        load_model(rewrite(body_yaw_model_file, path, header=data))


@pytest.mark.parametrize('name', ['default', 'front'])
def test_models_of_the_package_can_be_read(name):
    model = load_model(name)
    assert len(model.joints) == 20
    assert len(model.calibration) == 20


def test_seed_of_the_offsets_may_be_large(small_model, small_model_file, tmp_path):
    settings = small_model.settings._asdict() | {'offset_seed': 2**64}
    header = change_header(small_model_file, settings=settings)
    path = rewrite(small_model_file, tmp_path / 'seeded.npz', header=header)
    assert load_model(path).settings.offset_seed == 2**64


@pytest.mark.parametrize('name', ['-', '/dev/stdout'])
def test_model_on_standard_output_is_read_back(small_model, tmp_path, capfdbinary, name):
    size = save_model(name, small_model)
    (tmp_path / 'model.npz').write_bytes(capfdbinary.readouterr().out)
    assert (tmp_path / 'model.npz').stat().st_size == size
    save_model(tmp_path / 'other.npz', load_model(tmp_path / 'model.npz'))
    save_model(tmp_path / 'same.npz', small_model)
    np.testing.assert_equal(parts_of(tmp_path / 'other.npz'), parts_of(tmp_path / 'same.npz'))


def test_full_disk_leaves_only_the_old_model(small_model, small_model_file, tmp_path):
    """A limit on the size of files stands for a full disk."""
    path = tmp_path / 'model.npz'
    path.write_bytes(small_model_file.read_bytes())
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, before[1]))
    try:
        with pytest.raises(InputError, match=r'model\.npz: cannot be written: File too large'):
            save_model(path, small_model)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
    assert path.read_bytes() == small_model_file.read_bytes()
    assert list(tmp_path.iterdir()) == [path]


def test_only_a_model_is_replaced(small_model, small_model_file, tmp_path):
    path = tmp_path / 'model.npz'
    for other in (b'\x89MCAP0\r\n', package_file('body_parts', 'body_parts.npz').read_bytes()):
        path.write_bytes(other)
        with pytest.raises(InputError, match='exists and is not a model'):
            save_model(path, small_model)
        assert path.read_bytes() == other
    path.write_bytes(small_model_file.read_bytes())
    assert save_model(path, small_model) == path.stat().st_size


def test_model_describes_itself(small_model):
    words = describe_model(small_model)
    assert words['joints'].startswith('head, neck, l_shoulder')
    assert words['trees'] == '2'
    assert words['points'] == '150'
    assert words['samples'] == str(230 * 150)
    assert words['confidence'] == 'calibrated'
    assert words['confidence learnt from'] == '10 people'
    assert words['recordings'] == 'synthetic'


def test_file_is_small(small_model, small_model_file):
    leaves = len(small_model.forest.joint_votes.start) - 1
    assert small_model_file.stat().st_size < 30 * leaves
    arrays = [*small_model.forest[:4], *small_model.forest.joint_votes]
    arrays += small_model.forest.pair_votes
    assert small_model_file.stat().st_size < 0.25 * sum(array.nbytes for array in arrays)
