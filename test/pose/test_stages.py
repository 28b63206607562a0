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

"""The list of stages: observers, bodies that are given up, and the plain kernels in it."""

import numpy as np
import pytest
from plain import density, descriptor, silhouette
from plain import stages as plain_stages_module
from plain.stages import plain_stages, stages_with_plain_kernels

from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.pose.body_estimate import BodyEstimate
from lsc_pose_ros.pose.estimator import Estimator
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.stage_clock import StageClock
from lsc_pose_ros.pose.stages import (
    DESCRIPTORS,
    GRAPH,
    MODES,
    SILHOUETTE,
    STAGE_NAMES,
    WINDOW,
    describe_body,
    method_stages,
    run_stages,
)


def side_by_side(*frames: Frame) -> Frame:
    """Return one image of several frames, bodies numbered from 1, and a speck, body 9."""
    depth = np.concatenate([frame.depth for frame in frames], axis=1)
    labels = np.concatenate(
        [np.where(frame.labels >= 0, n, NO_BODY) for n, frame in enumerate(frames, start=1)],
        axis=1,
    ).astype(np.int32)
    depth[:3, :3], labels[:3, :3] = 2, 9
    return frames[0]._replace(depth=depth, labels=labels)


def test_method_has_all_stages_in_their_order(small_model):
    assert tuple(stage.name for stage in method_stages(small_model)) == STAGE_NAMES
    without_graph = tuple(stage.name for stage in method_stages(small_model, graph=False))
    assert without_graph == tuple(name for name in STAGE_NAMES if name != GRAPH)


def test_observer_is_called_after_each_stage_and_changes_nothing(small_model, people):
    frame, estimator = people[5], Estimator(small_model)
    called = []
    observed = estimator.estimate(frame.depth, frame.labels, frame.camera, called.append)
    expected = estimator.estimate(frame.depth, frame.labels, frame.camera)
    np.testing.assert_array_equal(observed.positions, expected.positions)
    np.testing.assert_array_equal(observed.confidence, expected.confidence)
    assert called == list(STAGE_NAMES)


def test_speck_is_given_up_at_its_silhouette(small_model, people):
    frame = side_by_side(people[5])
    called = []
    estimator = Estimator(small_model)
    body = estimator.estimate_body(frame.depth, frame.labels, frame.camera, 9, called.append)
    assert body is None
    assert called == [WINDOW, SILHOUETTE]
    labels = np.full_like(frame.labels, NO_BODY)
    called.clear()
    assert not estimator.estimate_body(frame.depth, labels, frame.camera, 1, called.append)
    assert called == [WINDOW]


def test_results_of_stages_that_have_not_run_are_not_set(people):
    frame = people[5]
    body = describe_body(frame.depth, frame.labels, frame.camera, 1, Settings())
    assert len(body.quantised) == len(body.points) == Settings().query_points
    with pytest.raises(AttributeError):
        _ = body.leaves


def test_description_does_not_depend_on_the_model(small_model, people):
    frame = people[5]
    body = Estimator(small_model).estimate_body(frame.depth, frame.labels, frame.camera, 1)
    described = describe_body(frame.depth, frame.labels, frame.camera, 1, small_model.settings)
    np.testing.assert_array_equal(described.quantised, body.quantised)
    assert described.scale == body.scale


def test_clock_charges_each_stage_with_the_time_since_the_one_before():
    ticks = iter([1.0, 1.5, 3.5, 4.0])
    clock = StageClock(('first', 'second'), lambda: next(ticks))
    clock('first')
    clock('second')
    clock('first')
    assert clock.seconds == {'first': 1.0, 'second': 2.0}


@pytest.mark.parametrize('queries', [150, 40])
def test_plain_kernels_give_the_same_joints(queries, small_model, people):
    settings = small_model.settings._replace(query_points=queries)
    model = small_model._replace(settings=settings)
    fast, plain = Estimator(model), Estimator(model, stages=plain_stages(model))
    distances = np.concatenate(
        [
            np.linalg.norm(
                plain.estimate(frame.depth, frame.labels, frame.camera).positions
                - fast.estimate(frame.depth, frame.labels, frame.camera).positions,
                axis=-1,
            ).ravel()
            for frame in people[10::30]
        ]
    )
    assert np.percentile(distances, 90) < 0.0005
    assert distances.max() < 0.005


def test_only_the_plain_stages_run_the_plain_kernels(small_model, people, monkeypatch):
    called = []
    frame = side_by_side(people[5], people[125])
    for module, name in (
        (silhouette, 'smooth'),
        (descriptor, 'describe'),
        (plain_stages_module, 'quantise'),
        (plain_stages_module, 'find_candidates'),
    ):
        kernel = getattr(module, name)

        def record(*words, kernel=kernel, name=name):
            called.append(name)
            return kernel(*words)

        monkeypatch.setattr(module, name, record)
    Estimator(small_model).estimate(frame.depth, frame.labels, frame.camera)
    assert called == []
    plain = Estimator(small_model, stages=plain_stages(small_model))
    plain.estimate(frame.depth, frame.labels, frame.camera)
    # Bodies 1 and 2, and body 9, whose silhouette has too few points.
    of_body = ['smooth', 'describe', 'quantise', 'find_candidates']
    assert called == [*of_body, *of_body, 'smooth']
    globals_of_kernel = plain_stages_module._find_modes.__globals__
    assert globals_of_kernel['density'] is density


def test_rivals_have_no_plain_descriptor():
    assert stages_with_plain_kernels(Settings()) == (SILHOUETTE, DESCRIPTORS, MODES)
    for rival in (Settings(feature='dcf'), Settings(binning='nearest')):
        assert stages_with_plain_kernels(rival) == (SILHOUETTE, MODES)


@pytest.mark.parametrize('settings', [{}, {'fill_holes': 5}, {'noise_factor': 30.0}])
def test_plain_stages_agree_with_a_body_yaw_model(settings, body_yaw_model, all_round_people):
    frame = side_by_side(all_round_people[5], all_round_people[125])
    with_holes = frame.depth.copy()
    with_holes[::4, ::4] = 0
    model = body_yaw_model._replace(settings=body_yaw_model.settings._replace(**settings))
    for number in (1, 2):
        fast = BodyEstimate.in_image(with_holes, frame.labels, frame.camera, number)
        assert run_stages(method_stages(model)[:3], fast)
        plain = BodyEstimate.in_image(with_holes, frame.labels, frame.camera, number)
        assert run_stages(plain_stages(model)[:3], plain)
        assert plain.scale == pytest.approx(fast.scale, rel=1e-5)
        differences = np.abs(plain.quantised.astype(int) - fast.quantised)
        assert np.percentile(differences, 99) <= 1
