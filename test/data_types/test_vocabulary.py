"""Joints, camera and skeletons: what everything else is written in."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import Intrinsics, back_project, project
from lsc_pose_ros.data_types.joints import (
    DEFAULT_JOINTS,
    JOINT_NAMES,
    JOINT_NUMBERS,
    default_edges,
    leg_pairs,
    names_of,
    numbers_of,
)
from lsc_pose_ros.data_types.skeletons import POINT_DTYPE, Skeletons, no_skeletons, pack, unpack
from lsc_pose_ros.errors import InputError


def test_the_numbers_of_the_joints_are_those_that_are_published():
    assert [JOINT_NUMBERS[name] for name in ('head', 'neck', 'torso', 'pelvis')] == [0, 1, 2, 3]
    assert names_of(range(4, 12)) == [
        f'l_{part}'
        for part in ('shoulder', 'elbow', 'wrist', 'hand', 'hip', 'knee', 'ankle', 'foot')
    ]
    assert names_of(range(12, 20)) == [
        name.replace('l_', 'r_', 1) for name in names_of(range(4, 12))
    ]
    assert len(DEFAULT_JOINTS) == 17


def named_edges(names):
    numbers = numbers_of(names)
    return {tuple(names_of(numbers[edge])) for edge in default_edges(numbers)}


def test_all_joints_hang_on_two_trees():
    edges = default_edges(range(20))
    assert len(edges) == 18
    assert {0, 3, 1} - set(edges[:, 1].tolist()) == {1, 3}  # only neck and pelvis have no parent
    parents_first = [parent in {1, 3, *edges[:n, 1]} for n, (parent, _) in enumerate(edges)]
    assert all(parents_first)


def test_without_the_pelvis_the_hips_are_tied_to_each_other():
    edges = named_edges(DEFAULT_JOINTS)
    assert ('l_hip', 'r_hip') in edges
    assert ('l_hip', 'l_knee') in edges
    assert len(edges) == 15


def test_a_joint_left_out_is_bridged():
    assert ('l_shoulder', 'l_hand') in named_edges(['neck', 'l_shoulder', 'l_hand'])
    assert named_edges(['head', 'l_foot']) == set()
    assert named_edges(['l_hand', 'r_hand', 'head']) == {('head', 'l_hand'), ('head', 'r_hand')}


def test_numbers_are_sorted_and_unknown_names_refused():
    assert numbers_of(['r_foot', 'head', 'head']).tolist() == [0, 19]
    with pytest.raises(InputError, match='unknown joint elbow; the joints are head'):
        numbers_of(['head', 'elbow'])
    with pytest.raises(InputError, match='name at least one'):
        numbers_of([])
    assert names_of(numbers_of(JOINT_NAMES)) == list(JOINT_NAMES)


def test_projection_is_the_inverse_of_back_projection():
    camera = Intrinsics(500.0, 510.0, 320.0, 240.0)
    rng = np.random.default_rng(0)
    columns, rows = rng.uniform(0, 640, 50), rng.uniform(0, 480, 50)
    points = back_project(columns, rows, rng.uniform(0.5, 5, 50), camera)
    np.testing.assert_allclose(project(points, camera), np.stack([columns, rows], 1), atol=1e-2)


def test_x_is_right_and_y_is_down():
    camera = Intrinsics(500.0, 500.0, 320.0, 240.0)
    x, y, z = back_project(np.array(820.0), np.array(740.0), np.array(2.0), camera)
    assert (x, y, z) == (2.0, 2.0, 2.0)


def test_what_lies_behind_the_camera_has_no_pixel():
    points = np.array([[0, 0, -1], [0, 0, 0]], np.float32)
    assert np.isnan(project(points, Intrinsics(1.0, 1.0, 0.0, 0.0))).all()


def test_a_point_has_twenty_bytes_in_the_published_order():
    assert POINT_DTYPE.itemsize == 20
    offsets = {name: field[1] for name, field in POINT_DTYPE.fields.items()}
    assert offsets == {'x': 0, 'y': 4, 'z': 8, 'confidence': 12, 'body': 16, 'joint': 18}


@pytest.mark.parametrize('bodies', [0, 1, 3])
def test_unpack_is_the_inverse_of_pack(bodies):
    rng = np.random.default_rng(bodies)
    positions = rng.normal(0, 1, (bodies, 5, 3)).astype(np.float32)
    positions[:, 2] = np.nan
    skeletons = Skeletons(
        np.arange(7, 7 + bodies).astype(np.uint16),
        np.array([0, 2, 5, 7, 19], np.uint16),
        positions,
        rng.random((bodies, 5)).astype(np.float32),
    )
    again = unpack(np.frombuffer(pack(skeletons).tobytes(), POINT_DTYPE).reshape(bodies, 5))
    np.testing.assert_array_equal(again.positions, positions)
    np.testing.assert_array_equal(again.confidence, skeletons.confidence)
    np.testing.assert_array_equal(again.bodies, skeletons.bodies)
    if bodies:
        np.testing.assert_array_equal(again.joints, skeletons.joints)


def test_nobody_is_an_empty_cloud_with_the_models_width():
    assert pack(no_skeletons(np.arange(17, dtype=np.uint16))).shape == (0, 17)


def test_legs_are_paired_left_with_right_where_both_are_known():
    numbers = numbers_of(['head', 'l_hip', 'r_hip', 'l_knee', 'r_knee', 'l_ankle', 'r_foot'])
    names = names_of(numbers)
    assert [(names[left], names[right]) for left, right in leg_pairs(numbers)] == [
        ('l_knee', 'r_knee')
    ]
    assert leg_pairs(range(20)).tolist() == [[9, 17], [10, 18], [11, 19]]
    assert leg_pairs(numbers_of(['head'])).shape == (0, 2)
