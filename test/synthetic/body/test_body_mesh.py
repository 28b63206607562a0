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

"""Tests the body model: shapes, poses and joints."""

import numpy as np
import pytest

from lsc_pose_ros.data_types.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.synthetic.body.body_file import BodyModel, load_body, save_body
from lsc_pose_ros.synthetic.body.body_mesh import (
    BodyShape,
    RestBody,
    blend_skin,
    forward_kinematics,
    mix_components,
    named_rotations,
    pose_body,
    relative_rotations,
    shape_body,
    standing_orientations,
    stature,
    with_stature,
)

PEOPLE = (
    (BodyShape(4, 0.5), 1.0),
    (BodyShape(9, 0.0, weight=0.7), 1.3),
    (BodyShape(25, 1.0, muscle=0.9, proportions=1.0), 2.0),
    (BodyShape(40, 0.0, weight=1.0, muscle=0.2), 1.65),
    (BodyShape(90, 1.0, weight=0.1, proportions=0.0), 1.6),
    (
        BodyShape(30, 1.0, measures={'upper_arm_length': 1, 'head_size': -1, 'thigh_length': -1}),
        1.7,
    ),
)


@pytest.fixture(scope='module')
def body() -> BodyModel:
    return load_body()


@pytest.fixture(scope='module')
def people(body: BodyModel) -> list[RestBody]:
    return [shape_body(body, with_stature(body, *person)) for person in PEOPLE]


def about(axis, degrees):
    """Return the rotation about an axis by Rodrigues' formula."""
    k = np.asarray(axis, float) / np.linalg.norm(axis)
    cross = np.array([[0, -k[2], k[1]], [k[2], 0, -k[0]], [-k[1], k[0], 0]])
    angle = np.radians(degrees)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def winding_number(points, vertices, triangles):
    """Return the winding number of the surface about each point (van Oosterom, Strackee, 1983)."""
    numbers = []
    for point in points:
        a, b, c = (vertices[triangles[:, corner]] - point for corner in range(3))
        la, lb, lc = (np.linalg.norm(side, axis=1) for side in (a, b, c))
        volume = np.einsum('ij,ij->i', a, np.cross(b, c))
        dots = [np.einsum('ij,ij->i', *pair) for pair in ((a, b), (b, c), (c, a))]
        below = la * lb * lc + dots[0] * lc + dots[1] * la + dots[2] * lb
        numbers.append(np.arctan2(volume, below).sum() * 2 / (4 * np.pi))
    return np.array(numbers)


def random_pose(body, random, most):
    axes = random.normal(size=(len(body.bones), 3))
    orientations = [about(axis, most * random.uniform(-1, 1)) for axis in axes]
    return named_rotations(body, dict(zip(map(str, body.bones), orientations, strict=True)))


def test_body_file_is_small_and_names_its_licence(body):
    assert resource('bodies', 'body.npz').stat().st_size < 8e6
    assert 'CC0' in body.provenance
    assert 'CC0 1.0 Universal' in resource('bodies', 'LICENSE.md').read_text(encoding='utf-8')


def test_body_file_round_trip(body, tmp_path):
    save_body(tmp_path / 'body.npz', body)
    again = load_body(tmp_path / 'body.npz')
    for name, array in body._asdict().items():
        np.testing.assert_array_equal(getattr(again, name), array)


def test_invalid_body_file_is_refused(body, tmp_path):
    with pytest.raises(InputError, match='there is no body file'):
        load_body(tmp_path / 'none.npz')
    (tmp_path / 'text.npz').write_text('hello')
    with pytest.raises(InputError, match='not a usable body file'):
        load_body(tmp_path / 'text.npz')
    for number, wrong in enumerate(
        (
            body._replace(triangles=body.triangles + np.uint16(len(body.skin_bones) - 5)),
            body._replace(parents=np.zeros_like(body.parents)),
            body._replace(joint_bones=body.joint_bones[:-1]),
            body._replace(mean=body.mean[:-1]),
            body._replace(steps=body.steps.astype(np.float32)),
        )
    ):
        save_body(tmp_path / f'{number}.npz', wrong)
        with pytest.raises(InputError, match='not a usable body file'):
            load_body(tmp_path / f'{number}.npz')


def test_skin_is_closed_and_faces_outwards(body, people):
    edges = np.concatenate([body.triangles[:, [a, b]] for a, b in ((0, 1), (1, 2), (2, 0))])
    forth = {tuple(edge) for edge in edges.tolist()}
    assert len(forth) == len(edges)
    assert all((b, a) in forth for a, b in forth)
    for rest in people:
        a, b, c = (rest.vertices[body.triangles[:, corner]] for corner in range(3))
        volume = np.einsum('ij,ij->i', a, np.cross(b, c)).sum() / 6
        litres = 1000 * volume
        # A person of 1.0 m has about 15 kg, one of 2.0 m about 100 kg; 1 litre is about 1 kg.
        assert 10 < litres < 160


def test_people_have_the_given_stature(body, people):
    wanted = [metres for _, metres in PEOPLE]
    np.testing.assert_allclose([stature(rest) for rest in people], wanted, atol=0.001)
    assert 1.55 < stature(shape_body(body, BodyShape(30, 0))) < 1.68
    assert 1.68 < stature(shape_body(body, BodyShape(30, 1))) < 1.82
    years = [stature(shape_body(body, BodyShape(age, 0.5))) for age in (3, 6, 10, 16, 25)]
    assert np.all(np.diff(years) > 0.05)
    with pytest.raises(InputError, match=r'stature 2\.5 m is out of range; .* give 0\.89 to'):
        with_stature(body, BodyShape(10, 0), 2.5)


def test_weight_muscle_and_sex_change_the_volume(body):
    def volume(**values):
        rest = shape_body(body, BodyShape(**values))
        a, b, c = (rest.vertices[body.triangles[:, corner]] for corner in range(3))
        return np.einsum('ij,ij->i', a, np.cross(b, c)).sum() / 6

    # In MakeHuman, weight adds fat mainly to weak people.
    weak = [volume(weight=weight, muscle=0.0) for weight in (0.0, 0.5, 1.0)]
    assert weak[2] > 1.4 * weak[1] > 1.9 * weak[0]
    assert volume(weight=1.0) > 1.05 * volume() > 1.1 * volume(weight=0.0)
    assert volume(sex=1.0) > 1.1 * volume(sex=0.0)
    assert volume(measures={'belly': 1.0}) > 1.02 * volume()


@pytest.mark.parametrize(
    ('body_shape', 'complaint'),
    [
        (BodyShape(age=0.5), 'age is 0.5 years; give 1 to 90'),
        (BodyShape(age=float('nan')), 'age is nan'),
        (BodyShape(weight=1.2), r'weight is 1\.2; give 0 to 1'),
        (BodyShape(measures={'nose_length': 1.0}), 'unknown measure nose_length'),
        (BodyShape(measures={'belly': 2.0}), 'belly is 2; give -1 to 1'),
    ],
)
def test_body_shape_out_of_range_is_refused(body, body_shape, complaint):
    with pytest.raises(InputError, match=complaint):
        shape_body(body, body_shape)


def test_measure_changes_the_length_that_it_names(body):
    def length(body_shape, first, second):
        joints = shape_body(body, body_shape).joints
        return np.linalg.norm(joints[JOINT_NUMBERS[first]] - joints[JOINT_NUMBERS[second]])

    for measure, ends in {
        'upper_arm_length': ('l_shoulder', 'l_elbow'),
        'forearm_length': ('r_elbow', 'r_wrist'),
        'thigh_length': ('r_hip', 'r_knee'),
        'shank_length': ('l_knee', 'l_ankle'),
        'shoulder_width': ('l_shoulder', 'r_shoulder'),
    }.items():
        less, same, more = (
            length(BodyShape(20, 0, measures={measure: value}), *ends)
            for value in (-0.5, 0.0, 0.5)
        )
        assert less + 0.008 < same < more - 0.008


def test_left_side_is_at_positive_x_and_the_person_faces_forward(people):
    for rest in people:
        joints = dict(zip(JOINT_NAMES, rest.joints, strict=True))
        for name in ('shoulder', 'elbow', 'wrist', 'hand', 'hip', 'knee', 'ankle', 'foot'):
            left, right = joints[f'l_{name}'], joints[f'r_{name}']
            assert left[0] > 0.03
            np.testing.assert_allclose(left, right * [-1, 1, 1], atol=0.003)
        for name in ('head', 'neck', 'torso', 'pelvis'):
            assert abs(joints[name][0]) < 0.003
        order = ('head', 'neck', 'torso', 'pelvis', 'l_knee', 'l_ankle')
        assert np.all(np.diff([joints[name][1] for name in order]) < 0)
        assert joints['l_foot'][2] > joints['l_ankle'][2] + 0.02
        np.testing.assert_allclose(
            joints['pelvis'], (joints['l_hip'] + joints['r_hip']) / 2, atol=1e-4
        )


def test_joints_are_inside_the_body(body, people):
    for rest in people:
        inside = winding_number(rest.joints, rest.vertices, body.triangles)
        assert inside.min() > 0.9, JOINT_NAMES[int(inside.argmin())]
        above = rest.joints[:1] + np.array([0, 0.5, 0])
        outside = winding_number(above, rest.vertices, body.triangles)
        assert abs(outside[0]) < 0.01


def test_joints_have_a_minimum_depth_below_the_skin(people):
    for rest in people:
        for name, joint in zip(JOINT_NAMES, rest.joints, strict=True):
            depth = np.linalg.norm(rest.vertices - joint, axis=1).min() / stature(rest)
            assert depth > (0.004 if name[2:] in ('hand', 'foot', 'wrist') else 0.012), name


def test_joints_of_a_posed_body_are_inside_it(body, people):
    random = np.random.default_rng(7)
    for rest in people[:3]:
        posed = pose_body(body, rest, random_pose(body, random, 25), np.array([0.2, 1.0, 3.0]))
        inside = winding_number(posed.joints, posed.vertices, body.triangles)
        assert inside.min() > 0.9, JOINT_NAMES[int(inside.argmin())]


def test_joints_are_carried_by_the_right_bones(body):
    bones = [str(body.bones[number]) for number in body.joint_bones]
    assert bones[JOINT_NUMBERS['l_knee']] == 'lowerleg01.L'
    assert bones[JOINT_NUMBERS['r_hand']] == 'wrist.R'
    parents = dict(zip(map(str, body.bones), body.parents, strict=True))
    for name, ancestors in {
        'l_wrist': ('lowerarm01.L', 'upperarm01.L', 'clavicle.L', 'spine02', 'root'),
        'head': ('neck01', 'spine01', 'root'),
        'r_foot': ('lowerleg01.R', 'upperleg01.R', 'pelvis.R', 'root'),
    }.items():
        bone, chain = bones[JOINT_NUMBERS[name]], []
        while parents[bone] >= 0:
            bone = str(body.bones[parents[bone]])
            chain.append(bone)
        assert [bone for bone in chain if bone in ancestors] == list(ancestors)


def test_mixed_components_agree_with_the_equation():
    random = np.random.default_rng(1)
    mean = random.normal(size=(50, 3)).astype(np.float32)
    table = random.integers(-32768, 32767, size=(7, 50, 3)).astype(np.int16)
    weights = random.normal(size=7) * 1e-4
    weights[3] = 0
    expected = mean + np.tensordot(weights, table.astype(float), 1)
    np.testing.assert_allclose(mix_components(mean, table, weights), expected, atol=1e-12)
    np.testing.assert_array_equal(mix_components(mean, table[:0], weights[:0]), mean)


def test_forward_kinematics_agrees_with_the_product_of_transforms(body, people):
    random = np.random.default_rng(2)
    rotations = random_pose(body, random, 180)
    heads = people[0].heads
    orientations, moved = forward_kinematics(rotations, body.parents, heads)
    for bone in range(len(body.bones)):
        transform, at = np.eye(4), bone
        while at >= 0:
            parent = body.parents[at]
            own = np.eye(4)
            own[:3, :3] = rotations[at]
            own[:3, 3] = heads[at] - heads[parent] if parent >= 0 else 0
            transform, at = own @ transform, parent
        np.testing.assert_allclose(orientations[bone], transform[:3, :3], atol=1e-12)
        np.testing.assert_allclose(moved[bone], transform[:3, 3], atol=1e-12)
    np.testing.assert_allclose(relative_rotations(body, orientations), rotations, atol=1e-12)


def test_skinning_agrees_with_the_equation():
    random = np.random.default_rng(3)
    rest = random.normal(size=(200, 3))
    bones = random.integers(0, 5, size=(200, 4)).astype(np.uint8)
    weights = -np.sort(-random.multinomial(65535, [0.25] * 4, size=200), axis=1)
    weights[:50] = [65535, 0, 0, 0]
    orientations, shifts = random.normal(size=(5, 3, 3)), random.normal(size=(5, 3))
    expected = np.zeros((200, 3))
    for influence in range(4):
        own = np.einsum('vij,vj->vi', orientations[bones[:, influence]], rest)
        expected += weights[:, influence, None] / 65535 * (own + shifts[bones[:, influence]])
    posed = blend_skin(rest, bones, weights.astype(np.uint16), orientations, shifts)
    np.testing.assert_allclose(posed, expected, atol=1e-12)
    assert blend_skin(
        rest[:0], bones[:0], weights[:0].astype(np.uint16), orientations, shifts
    ).shape == (0, 3)


def test_body_without_rotations_is_only_translated(body, people):
    position = np.array([1.0, 2.0, 3.0])
    rest = people[0]
    posed = pose_body(body, rest, named_rotations(body, {}), position)
    shift = position - rest.heads[0]
    np.testing.assert_allclose(posed.vertices, rest.vertices + shift, atol=1e-9)
    np.testing.assert_allclose(posed.joints, rest.joints + shift, atol=1e-9)
    np.testing.assert_allclose(posed.joints[JOINT_NUMBERS['pelvis']], position, atol=2e-4)


def test_rotation_of_the_root_rotates_the_whole_person(body, people):
    rest, turn = people[1], about([1, 2, 3], 70)
    posed = pose_body(body, rest, named_rotations(body, {'root': turn}), np.zeros(3))
    expected = (rest.vertices - rest.heads[0]) @ turn.T
    np.testing.assert_allclose(posed.vertices, expected, atol=1e-9)


def test_rotation_of_a_bone_moves_its_descendants(body, people):
    rest = people[2]
    still = pose_body(body, rest, named_rotations(body, {}), np.zeros(3))
    turn = about([0, 1, 0], -90)
    bent = pose_body(body, rest, named_rotations(body, {'lowerarm01.L': turn}), np.zeros(3))
    elbow = still.joints[JOINT_NUMBERS['l_elbow']]
    for name in ('l_wrist', 'l_hand'):
        number = JOINT_NUMBERS[name]
        expected = turn @ (still.joints[number] - elbow) + elbow
        np.testing.assert_allclose(bent.joints[number], expected, atol=2e-4)
    others = [n for name, n in JOINT_NUMBERS.items() if name not in ('l_wrist', 'l_hand')]
    np.testing.assert_allclose(bent.joints[others], still.joints[others], atol=1e-9)


def test_unknown_bone_is_refused(body):
    with pytest.raises(InputError, match='unknown bone tail; known bones are root, spine05'):
        named_rotations(body, {'tail': np.eye(3)})


def test_limbs_of_the_standing_pose_hang_straight(body, people):
    for rest in people:
        orientations = standing_orientations(body, rest)
        np.testing.assert_allclose(
            orientations @ orientations.transpose(0, 2, 1),
            np.tile(np.eye(3), (len(orientations), 1, 1)),
            atol=1e-9,
        )
        np.testing.assert_allclose(np.linalg.det(orientations), 1, atol=1e-9)
        posed = pose_body(body, rest, relative_rotations(body, orientations), np.zeros(3))
        bones = {str(name): number for number, name in enumerate(body.bones)}
        at = dict(zip(JOINT_NAMES, posed.joints, strict=True))
        for side in ('l', 'r'):
            for upper, lower in (('shoulder', 'elbow'), ('elbow', 'wrist'), ('hip', 'knee'),
                                 ('knee', 'ankle')):  # fmt: skip
                limb = at[f'{side}_{lower}'] - at[f'{side}_{upper}']
                assert limb[1] < -0.999 * np.linalg.norm(limb)
            assert abs((at[f'{side}_hand'] - at[f'{side}_wrist'])[0]) < 0.02
            heads = {name[:-2]: posed.heads[n] for name, n in bones.items()
                     if name.endswith(side.upper())}  # fmt: skip
            # Thumb and toes are in front.
            assert heads['finger2-1'][2] > heads['finger5-1'][2] + 0.02
            assert heads['finger1-2'][2] > heads['finger5-1'][2] + 0.02
            assert heads['toes'][2] > heads['foot'][2] + 0.05
            assert abs(heads['toes'][0] - heads['foot'][0]) < 0.02


def test_elbow_of_the_standing_pose_bends_forwards(body, people):
    rest, orientations = people[2], standing_orientations(body, people[2])
    flexed = orientations.copy()
    for number, name in enumerate(map(str, body.bones)):
        if name.endswith('.R') and name.startswith(('lowerarm', 'wrist', 'metacarpal', 'finger')):
            flexed[number] = about([1, 0, 0], -90) @ orientations[number]
    posed = pose_body(body, rest, relative_rotations(body, flexed), np.zeros(3))
    forearm = posed.joints[JOINT_NUMBERS['r_wrist']] - posed.joints[JOINT_NUMBERS['r_elbow']]
    assert forearm[2] > 0.999 * np.linalg.norm(forearm)
    # The skin inside the elbow does not penetrate that on the outside.
    inside = winding_number(posed.joints[[JOINT_NUMBERS['r_elbow']]], posed.vertices,
                            body.triangles)  # fmt: skip
    assert inside[0] > 0.9
