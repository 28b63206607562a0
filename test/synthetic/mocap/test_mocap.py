"""Motion capture brought onto bodies: mapping, directions, repairs, draws."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from stick_figure import bvh_text, mapping_text

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.body.body_file import BodyModel, load_body
from lsc_pose_ros.synthetic.body.body_mesh import (
    BodyShape,
    RestBody,
    pose_body,
    shape_body,
    standing_orientations,
)
from lsc_pose_ros.synthetic.geometry.rotations import axis_rotation, from_quaternions
from lsc_pose_ros.synthetic.mocap.bvh import joint_poses, load_bvh
from lsc_pose_ros.synthetic.mocap.clip_section import resample, within_yaw
from lsc_pose_ros.synthetic.mocap.distinct_poses import (
    distinct_poses,
    pose_distance,
    reference_joints,
)
from lsc_pose_ros.synthetic.mocap.mocap import load_mocap
from lsc_pose_ros.synthetic.mocap.mocap_clip import read_clip
from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS, load_mapping
from lsc_pose_ros.synthetic.mocap.retarget import retarget_motion

# The person's left, up and forward in the file's axes, as the mapping names up and forward.
AXES = {
    ('y', 'z'): [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
    ('z', '-y'): [[1, 0, 0], [0, 0, 1], [0, -1, 0]],
    ('z', 'x'): [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
}
LIMBS = {
    'upper_arm': ('shoulder', 'elbow', 'arm', 'elbow'),
    'forearm': ('elbow', 'wrist', 'elbow', 'wrist'),
    'thigh': ('hip', 'knee', 'leg', 'knee'),
    'shank': ('knee', 'ankle', 'knee', 'ankle'),
}


@pytest.fixture(scope='module')
def body() -> BodyModel:
    return load_body()


@pytest.fixture(scope='module')
def rest(body: BodyModel) -> RestBody:
    return shape_body(body, BodyShape())


@pytest.fixture
def clip_of(tmp_path):
    def make(frames, up='y', forward='z', extra='', **how):
        (tmp_path / 'clip.bvh').write_text(
            bvh_text(frames, axes=AXES[up, forward], **how), encoding='ascii'
        )
        (tmp_path / 'map.yaml').write_text(mapping_text(up, forward, extra), encoding='ascii')
        return read_clip(tmp_path / 'clip.bvh', load_mapping(tmp_path / 'map.yaml'))

    return make


def turn(axis, degrees):
    return Rotation.from_rotvec(np.radians(degrees) * np.asarray(axis, float))


def stand():
    """Arms hang, from the T-pose."""
    return {'Leftarm': turn([0, 0, 1], -80), 'Rightarm': turn([0, 0, 1], 80)}


def possible_pose(random):
    """Anything that no joint forbids, elbows and knees bent the way they can."""
    pose = {
        'Hips': turn([0, 1, 0], random.uniform(-170, 170))
        * turn([1, 0, 0], random.uniform(0, 30)),
        'Spine': turn([1, 0, 0], random.uniform(-10, 30)),
        'Chest': turn([0, 1, 0], random.uniform(-30, 30)),
        'Head': turn([1, 0, 0], random.uniform(-30, 30)),
    }
    for side, sign in (('Left', 1), ('Right', -1)):
        pose[f'{side}arm'] = turn([0, 0, 1], -sign * random.uniform(-30, 80)) * turn(
            [0, sign, 0], -random.uniform(-20, 60)
        )
        # The palm looks down in the T-pose, so the forearm comes forward.
        pose[f'{side}elbow'] = turn([0, -sign, 0], random.uniform(0, 130))
        pose[f'{side}leg'] = turn([1, 0, 0], -random.uniform(-20, 80)) * turn(
            [0, 0, sign], random.uniform(0, 30)
        )
        pose[f'{side}knee'] = turn([1, 0, 0], random.uniform(0, 100))
    return pose


def angle(first, second):
    cosine = (first * second).sum(axis=-1)
    return np.degrees(
        np.arccos(
            np.clip(
                cosine / np.linalg.norm(first, axis=-1) / np.linalg.norm(second, axis=-1), -1, 1
            )
        )
    )


def posed_joints(body, rest, clip):
    """Return the joints of the body in each frame of `clip`, heading and all."""
    rotations = retarget_motion(body, rest, from_quaternions(clip.orientations.astype(float)))
    rotations[:, 0] = axis_rotation(1, clip.heading) @ rotations[:, 0]
    return np.array([pose_body(body, rest, pose, np.zeros(3)).joints for pose in rotations])


@pytest.mark.parametrize(('up', 'forward'), AXES)
@pytest.mark.parametrize('order', ['ZXY', 'YXZ'])
def test_directions_of_limbs_agree_with_the_file(
    tmp_path, clip_of, body, rest, up, forward, order
):
    random = np.random.default_rng(8)
    # A frame a second: that is no leap.
    poses = [possible_pose(random) for _ in range(60)]
    clip = clip_of(poses, up, forward, order=order, frame_time=1.0)
    joints = posed_joints(body, rest, clip)
    bvh = load_bvh(tmp_path / 'clip.bvh')
    places = joint_poses(bvh).positions @ np.array(AXES[up, forward], float).T
    for side, letter in (('Left', 'l'), ('Right', 'r')):
        for start, end, first, last in LIMBS.values():
            ours = [joints[:, JOINT_NUMBERS[f'{letter}_{name}']] for name in (start, end)]
            theirs = [places[:, bvh.names.index(side + name)] for name in (first, last)]
            assert angle(ours[1] - ours[0], theirs[1] - theirs[0]).max() < 2


def test_left_and_up_agree_with_the_axes_of_the_mapping(clip_of, body, rest):
    pose = stand() | {'Leftarm': turn([0, 0, 1], 80)}
    joints = posed_joints(body, rest, clip_of([pose], 'z', '-y'))[0]
    assert joints[JOINT_NUMBERS['l_hand'], 1] > joints[JOINT_NUMBERS['head'], 1] + 0.2
    assert joints[JOINT_NUMBERS['r_hand'], 1] < joints[JOINT_NUMBERS['torso'], 1]
    assert joints[JOINT_NUMBERS['l_shoulder'], 0] > 0.1 > joints[JOINT_NUMBERS['r_shoulder'], 0]
    assert joints[JOINT_NUMBERS['l_foot'], 2] > joints[JOINT_NUMBERS['l_ankle'], 2] + 0.03


def test_trunk_and_head_rotate_as_captured(clip_of, body, rest):
    bow = stand() | {'Spine': turn([1, 0, 0], 40), 'Head': turn([0, 1, 0], 50)}
    clip = clip_of([bow])
    orientations = from_quaternions(clip.orientations[0].astype(float))
    chest = orientations[SEGMENTS.index('chest')]
    np.testing.assert_allclose(chest, turn([1, 0, 0], 40).as_matrix(), atol=1e-5)
    expected = (turn([1, 0, 0], 40) * turn([0, 1, 0], 50)).as_matrix()
    np.testing.assert_allclose(orientations[SEGMENTS.index('head')], expected, atol=1e-5)
    joints = posed_joints(body, rest, clip)[0]
    assert joints[JOINT_NUMBERS['head'], 2] > 0.2


def test_palm_at_the_thigh_is_kept(clip_of):
    clip = clip_of([stand()])
    hand = from_quaternions(clip.orientations[0].astype(float))[SEGMENTS.index('l_hand')]
    # Straight but for the 10 degrees by which the arm does not hang.
    np.testing.assert_allclose(hand, turn([0, 0, 1], 10).as_matrix(), atol=1e-5)


def test_heading_is_separate_from_the_orientations(clip_of):
    degrees = np.arange(0, 400, 10)
    clip = clip_of([stand() | {'Hips': turn([0, 1, 0], value)} for value in degrees], 'z', 'x')
    np.testing.assert_allclose(np.degrees(clip.heading), degrees, atol=0.01)
    np.testing.assert_allclose(
        clip.orientations[1:], clip.orientations[:1].repeat(len(degrees) - 1, 0), atol=1e-5
    )


def test_wrong_axial_rotation_does_not_change_the_limb(clip_of):
    def bent(flip):
        # Half a turn about the upper arm, and back below: the joints stay where they are.
        elbow = turn([1, 0, 0], -flip) * turn([0, -1, 0], 60)
        return stand() | {
            'Leftarm': turn([0, 0, 1], -50) * turn([1, 0, 0], flip),
            'Leftelbow': elbow,
        }

    clip = clip_of([bent(0), bent(180), bent(90)], order='XYZ')
    arm = from_quaternions(clip.orientations.astype(float))[:, SEGMENTS.index('l_upper_arm')]
    np.testing.assert_allclose(arm[1:], arm[:1].repeat(2, 0), atol=1e-4)


@pytest.mark.parametrize('bent', ['', ', bent: 0'])
def test_clip_with_reversed_elbow_is_flipped(clip_of, body, rest, monkeypatch, bent):
    # With `bent`, in a figure whose forearms come forward by 20 degrees in the neutral pose.
    crooked = 20 if bent else 0
    monkeypatch.setattr('stick_figure.CROOKED', np.radians(crooked))
    monkeypatch.setattr('stick_figure.BENT', bent)
    right = [stand() | {'Leftelbow': turn([0, -1, 0], 50 + number)} for number in range(20)]
    wrong = [stand() | {'Leftelbow': turn([0, 1, 0], 50 + number)} for number in range(20)]
    expected = posed_joints(body, rest, clip_of(right))
    found = posed_joints(body, rest, clip_of(wrong))
    for name in ('l_elbow', 'l_wrist', 'l_hand'):
        number = JOINT_NUMBERS[name]
        np.testing.assert_allclose(found[:, number], expected[:, number], atol=0.01)


def test_constant_error_of_the_axial_rotation_is_removed_from_straight_arms(clip_of):
    def arm(error, elbow):
        # The error is undone at the elbow, so that joints are where they were.
        return stand() | {
            'Leftarm': turn([0, 0, 1], -50) * turn([1, 0, 0], error),
            'Leftelbow': turn([1, 0, 0], -error) * turn([0, -1, 0], elbow),
        }

    straight = [
        from_quaternions(
            clip_of([*[arm(error, 70)] * 20, arm(error, 0)]).orientations[-1].astype(float)
        )
        for error in (0, 40)
    ]
    number = SEGMENTS.index('l_upper_arm')
    np.testing.assert_allclose(straight[1][number], straight[0][number], atol=1e-3)


def test_bones_share_the_rotation_of_segments(clip_of, body, rest):
    random = np.random.default_rng(5)
    clip = clip_of([possible_pose(random) for _ in range(10)], frame_time=1.0)
    segments = from_quaternions(clip.orientations.astype(float))
    poses = retarget_motion(body, rest, segments)
    straight = standing_orientations(body, rest)
    orientations = np.array(
        [pose_body(body, rest, pose, np.zeros(3)).orientations for pose in poses]
    )
    numbers = {str(name): number for number, name in enumerate(body.bones)}
    whole = {
        'root': 'pelvis', 'spine01': 'chest', 'head': 'head', 'upperarm02.L': 'l_upper_arm',
        'wrist.R': 'r_hand', 'finger2-3.R': 'r_hand', 'upperleg01.R': 'r_thigh',
        'lowerleg02.L': 'l_shank', 'toes.L': 'l_foot',
    }  # fmt: skip
    for bone, segment in whole.items():
        expected = segments[:, SEGMENTS.index(segment)] @ straight[numbers[bone]]
        np.testing.assert_allclose(orientations[:, numbers[bone]], expected, atol=1e-6)
    # The bones of the trunk turn ever more, from the pelvis to the chest.
    spine = [orientations[:, numbers[f'spine0{number}']] for number in (5, 4, 3, 2, 1)]
    away = [
        Rotation.from_matrix(segments[:, 0].transpose(0, 2, 1) @ bone).magnitude()
        for bone in spine
    ]
    assert away[0].max() < 0.6 * away[-1].max()


def test_shoulder_rises_by_a_third_of_the_elevation_beyond_30_degrees(body, rest):
    segments = np.tile(np.eye(3), (3, len(SEGMENTS), 1, 1))
    for number, degrees in enumerate((20, 90, 150)):
        raised = turn([0, 0, 1], degrees).as_matrix()
        for name in ('l_upper_arm', 'l_forearm', 'l_hand'):
            segments[number, SEGMENTS.index(name)] = raised
    rotations = retarget_motion(body, rest, segments)
    orientations = np.array(
        [pose_body(body, rest, pose, np.zeros(3)).orientations for pose in rotations]
    )
    blade = orientations[:, list(body.bones).index('shoulder01.L')]
    found = np.degrees(Rotation.from_matrix(blade).as_rotvec()[:, 2])
    np.testing.assert_allclose(found, [0, 20, 40], atol=1e-6)
    other = orientations[:, list(body.bones).index('shoulder01.R')]
    np.testing.assert_allclose(other, np.tile(np.eye(3), (3, 1, 1)), atol=1e-9)


def test_impossible_frames_are_not_valid(clip_of):
    frames = [stand() for _ in range(30)]
    frames[10] = stand() | {'Leftknee': turn([1, 0, 0], -80)}
    valid = clip_of(frames).valid
    # From there to its neighbours is a leap.
    np.testing.assert_array_equal(np.flatnonzero(~valid), [9, 10, 11])


def test_file_without_valid_frames_is_refused(clip_of):
    with pytest.raises(InputError, match=r'clip.bvh: with the mapping .*map.yaml no frame'):
        clip_of([stand() | {'Leftknee': turn([1, 0, 0], -80)}])


@pytest.mark.parametrize(('bent', 'degrees'), [('', 20), (', bent: 0', 0), (', bent: 10', 10)])
def test_bent_removes_the_excess_flexion_of_the_file(clip_of, monkeypatch, bent, degrees):
    monkeypatch.setattr('stick_figure.CROOKED', np.radians(20))
    monkeypatch.setattr('stick_figure.BENT', bent)
    orientations = from_quaternions(clip_of([stand()]).orientations[0].astype(float))
    upper, lower = (orientations[SEGMENTS.index(name)] for name in ('l_upper_arm', 'l_forearm'))
    assert angle(upper[:, 1], lower[:, 1]) == pytest.approx(degrees, abs=0.01)


def test_neutral_frame_replaces_the_pose_without_rotations(clip_of):
    # The same figure, but its rotations are 0 with the person on the back.
    up = turn([1, 0, 0], 90)
    pose = stand() | {'Spine': turn([1, 0, 0], 20)}
    frames = [{'Hips': up}, pose | {'Hips': up}]
    expected = clip_of([pose]).orientations
    found = clip_of(frames, extra='neutral: 0\nskip: 1\n', order='YZX')
    # All lies in the neutral frame, so only what the trunk does from there is told.
    for name in ('pelvis', 'chest', 'head'):
        number = SEGMENTS.index(name)
        np.testing.assert_allclose(
            abs(found.orientations[0, number]), abs(expected[0, number]), atol=1e-5
        )


def test_files_with_high_rates_are_subsampled_to_at_least_30_hz(clip_of):
    assert clip_of([stand()] * 12, frame_time=1 / 120).rate == pytest.approx(30, rel=1e-3)
    assert len(clip_of([stand()] * 12, frame_time=1 / 120).orientations) == 3
    assert clip_of([stand()] * 12, frame_time=1 / 50).rate == pytest.approx(50, rel=1e-3)


@pytest.mark.parametrize(
    ('old', 'new', 'says'),
    [
        ('up: y', 'up: w', "up is 'w'"),
        ('forward: z', 'forward: -y', 'same axis'),
        ('axes: {up: y, forward: z}', 'axes: up', 'axes must be a table'),
        ('pelvis:', 'pelvic:', 'unknown keys: pelvic'),
        ('  chest: {turns: Chest}\n', '', 'has no chest'),
        ('turns: Chest', 'turn: Chest', 'unknown keys: turn;'),
        ('{turns: Chest}', '{turns: Chest, along: [Chest, Head]}', 'either turns'),
        ('{turns: Chest}', '{along: [Chest, Head]}', 'chest needs turns'),
        ('along: [Leftarm, Leftelbow]', 'turns: Leftarm', 'l_upper_arm needs along'),
        ('[Leftarm, Leftelbow]', '[Leftarm]', 'two joints'),
        ('[0, 0, 90]', '[0, 90]', 'three numbers'),
        ('{turns: Head}', '{turns: Head, bent: 3}', 'forearm and shank'),
        ('[Leftleg, Leftknee]}', '[Leftleg, [Leftknee]]}', 'not the name of a joint'),
        ('[Leftknee, Leftankle]', '[Leftknee, Leftankle], bent: -4', 'bent is -4'),
        ('segments:', 'skip: -1\nsegments:', 'skip is -1'),
        ('segments:', 'neutral: first\nsegments:', "neutral is 'first'"),
        ('segments:', 'segments: {', 'not valid YAML'),
    ],
)
def test_invalid_mapping_is_refused(tmp_path, old, new, says):
    text = mapping_text()
    assert old in text
    path = tmp_path / 'map.yaml'
    path.write_text(text.replace(old, new, 1), encoding='ascii')
    with pytest.raises(InputError, match=rf'map.yaml .*{says}'):
        load_mapping(path)


def test_missing_joints_and_frames_are_reported(clip_of):
    with pytest.raises(InputError, match=r'2 frames; the mapping .* needs 6'):
        clip_of([stand()] * 2, extra='skip: 5\n')
    with pytest.raises(InputError, match='no joint Nose, which the mapping'):
        clip_of([stand()], extra='  neck: {turns: Nose}\n')


def waving(frames, arm='Leftarm', speed=6):
    return [stand() | {arm: turn([0, 0, 1], -80 + speed * number)} for number in range(frames)]


@pytest.fixture
def folder(tmp_path):
    clips = {
        'a/left': waving(25),
        'a/right': [pose | {'Leftarm': turn([0, 0, 1], -80)} for pose in waving(25, 'Rightarm')],
        'still': [stand()] * 300,
        'turning': [stand() | {'Hips': turn([0, 1, 0], 3 * number)} for number in range(90)],
    }
    (tmp_path / 'a').mkdir()
    for name, frames in clips.items():
        (tmp_path / f'{name}.bvh').write_text(bvh_text(frames), encoding='ascii')
    (tmp_path / 'a' / 'left.bvh').rename(tmp_path / 'a' / 'left.BVH')
    (tmp_path / 'map.yaml').write_text(mapping_text(), encoding='ascii')
    return tmp_path


def test_clips_are_selected_by_name(folder):
    mocap = load_mocap(folder, folder / 'map.yaml')
    assert mocap.clips == ('a/left', 'a/right', 'still', 'turning')
    assert mocap.only(['a/*', 'still']).clips == ('a/left', 'a/right', 'still')
    assert mocap.without(['a/*']).clips == ('still', 'turning')
    with pytest.raises(InputError, match='b/\\* matches none of the 4 clips'):
        mocap.only(['still', 'b/*'])
    with pytest.raises(InputError, match='exclude fewer'):
        mocap.without(['*'])


def test_folder_without_clips_is_refused(tmp_path):
    with pytest.raises(InputError, match='no BVH file'):
        load_mocap(tmp_path)
    with pytest.raises(InputError, match='no BVH file'):
        load_mocap(tmp_path / 'nowhere')


def test_clips_are_read_only_when_needed(folder, body, rest):
    (folder / 'still.bvh').write_text('NONSENSE', encoding='ascii')
    mocap = load_mocap(folder, folder / 'map.yaml')
    mocap.without(['still']).sample(body, rest, 3, None, 1.0, np.random.default_rng(1))
    with pytest.raises(InputError, match=r'still.bvh, line 1'):
        mocap.only(['still']).sample(body, rest, 3, None, 1.0, np.random.default_rng(1))


@pytest.mark.parametrize('rate', [None, 24.0])
def test_motion_depends_only_on_the_seed(folder, body, rest, rate):
    def sample(seed):
        mocap = load_mocap(folder, folder / 'map.yaml').only(['a/*'])
        return mocap.sample(body, rest, 12, rate, 1.0, np.random.default_rng(seed))

    first, again, other = sample(4), sample(4), sample(5)
    assert first.rotations.shape == (12, len(body.bones), 3, 3)
    np.testing.assert_array_equal(first.rotations, again.rotations)
    np.testing.assert_array_equal(first.yaw, again.yaw)
    assert abs(first.rotations - other.rotations).max() > 0.01


def test_standing_still_does_not_dominate(folder, body, rest):
    mocap = load_mocap(folder, folder / 'map.yaml')
    motion = mocap.sample(body, rest, 60, None, 1.0, np.random.default_rng(2))
    still = abs(motion.rotations - motion.rotations[:, None]).max(axis=(2, 3, 4)) < 1e-3
    assert still.mean() < 0.2  # 300 of 440 frames, and in 90 the person only turns


def test_section_keeps_the_speed_of_the_clip(folder, body, rest):
    mocap = load_mocap(folder, folder / 'map.yaml').only(['a/left'])
    motion = mocap.sample(body, rest, 30, 60.0, np.pi, np.random.default_rng(6))
    bone = list(body.bones).index('upperarm02.L')
    speeds = []
    for before, after in zip(motion.rotations[:-1], motion.rotations[1:], strict=True):
        ours = [
            pose_body(body, rest, pose, np.zeros(3)).orientations[bone] for pose in (before, after)
        ]
        speeds.append(Rotation.from_matrix(ours[0].T @ ours[1]).magnitude())
    np.testing.assert_allclose(np.degrees(speeds), 3, atol=0.2)  # 6 degrees at 30 frames a second


def test_motion_longer_than_its_clips_has_no_jumps(folder, body, rest):
    mocap = load_mocap(folder, folder / 'map.yaml').only(['a/*'])
    motion = mocap.sample(body, rest, 300, 30.0, 1.0, np.random.default_rng(7))
    joints = np.array(
        [pose_body(body, rest, pose, np.zeros(3)).joints for pose in motion.rotations]
    )
    assert len(joints) == 300
    assert np.linalg.norm(np.diff(joints, axis=0), axis=-1).max() < 0.3
    assert abs(np.diff(motion.yaw)).max() < 0.05


def test_resampling_at_the_frames_returns_the_frames(clip_of):
    random = np.random.default_rng(9)
    clip = clip_of([possible_pose(random) for _ in range(5)], frame_time=1.0)
    section = resample(clip, np.arange(5) / clip.rate)
    same = abs((section.orientations * clip.orientations).sum(axis=-1))
    np.testing.assert_allclose(same, 1, atol=1e-6)
    np.testing.assert_allclose(section.heading, clip.heading, atol=1e-9)


@pytest.mark.parametrize('widest', [0.3, 1.0, np.pi])
def test_yaw_stays_within_the_limit(widest):
    random = np.random.default_rng(3)
    for heading in (np.zeros(5), np.linspace(2, 2.4, 9), np.linspace(-8, 5, 40)):
        yaws = np.array([within_yaw(heading, widest, random) for _ in range(50)])
        if widest < np.pi:
            assert abs(yaws).max() <= widest + 1e-9
        spare = np.ptp(heading) < 2 * widest
        if spare:
            np.testing.assert_allclose(np.diff(yaws, axis=1), np.diff(heading)[None].repeat(50, 0))
            assert np.ptp(yaws[:, 0]) > 0.5 * (2 * widest - np.ptp(heading))


def test_distinct_poses_cover_all_poses():
    random = np.random.default_rng(11)
    walk = np.cumsum(random.normal(0, 0.01, (200, 4, 3)), axis=0)
    frames = np.arange(20, 200)
    kept = distinct_poses(walk, frames, 0.05)
    difference = np.linalg.norm(walk[:, None] - walk[kept][None], axis=-1).max(axis=-1)
    among = difference[kept] + np.eye(len(kept))
    assert set(kept) <= set(frames)
    assert among.min() >= 0.05 - 1e-6
    assert difference[frames].min(axis=1).max() < 0.05


def test_reference_joints_of_the_standing_pose():
    joints = reference_joints(np.broadcast_to(np.eye(3), (1, len(SEGMENTS), 3, 3)))[0]
    assert joints[:, 1].max() == pytest.approx(0.71)  # head above, sole below the hips
    assert joints[:, 1].min() == pytest.approx(-0.895)
    left, right = joints[2:8], joints[8:]
    np.testing.assert_allclose(left, right * [-1, 1, 1])
    others = joints + np.array([[[0, 0, 0.3]], [[0.2, 0, 0]]])
    assert pose_distance(joints, others) == pytest.approx(0.2)


CLIPS = ('01_01', '05_11', '07_01', '09_10', '13_18', '13_30', '14_23')


@pytest.fixture(scope='module')
def cmu(shared):
    folder = shared / 'mocap_cmu'
    if not folder.is_dir():
        pytest.skip(f'no motion capture in {folder}')
    return load_mocap(folder).only(CLIPS)


@pytest.fixture(scope='module')
def cmu_clips(cmu, shared):
    mapping = cmu._library._mapping
    return {name: read_clip(shared / 'mocap_cmu' / f'{name}.bvh', mapping) for name in CLIPS}


def hinge_bend(clip, upper, lower):
    """Return by how much, and how far forward, the lower part bends, in the upper one's axes."""
    orientations = from_quaternions(clip.orientations[clip.valid].astype(float))
    along = np.einsum(
        'tji,tj->ti',
        orientations[:, SEGMENTS.index(upper)],
        -orientations[:, SEGMENTS.index(lower), :, 1],
    )
    return np.degrees(np.arctan2(along[:, 2], -along[:, 1]))


def test_elbows_of_the_cmu_clips_bend_forwards(cmu_clips):
    for clip in cmu_clips.values():
        assert clip.valid.mean() > 0.4
        for side in ('l', 'r'):
            # Arms that are held out straight may be bent back a little.
            elbow = hinge_bend(clip, f'{side}_upper_arm', f'{side}_forearm')
            assert elbow.min() > -20
            assert (elbow > -5).mean() > 0.75
            assert (hinge_bend(clip, f'{side}_thigh', f'{side}_shank') < 5).all()


def test_walking_people_of_the_cmu_clips_straighten_legs_and_arms(cmu_clips):
    walk = cmu_clips['07_01']
    for side in ('l', 'r'):
        knee = -hinge_bend(walk, f'{side}_thigh', f'{side}_shank')
        elbow = hinge_bend(walk, f'{side}_upper_arm', f'{side}_forearm')
        assert 0 <= knee.min() < 8
        assert 55 < knee.max() < 80
        assert 0 <= elbow.min() < 20


def test_directions_of_limbs_agree_with_the_cmu_files(cmu_clips, shared, body, rest):
    for name, clip in cmu_clips.items():
        joints = posed_joints(body, rest, clip)
        bvh = load_bvh(shared / 'mocap_cmu' / f'{name}.bvh')
        places = joint_poses(bvh).positions[1:]
        for letter in ('l', 'r'):
            for (start, end), (first, last) in (
                (('hip', 'knee'), ('Thigh', 'Shin')),
                (('shoulder', 'elbow'), ('Shldr', 'ForeArm')),
            ):
                ours = [joints[:, JOINT_NUMBERS[f'{letter}_{joint}']] for joint in (start, end)]
                theirs = [places[:, bvh.names.index(letter + joint)] for joint in (first, last)]
                assert angle(ours[1] - ours[0], theirs[1] - theirs[0]).max() < 2


@pytest.mark.parametrize('rate', [None, 30.0])
def test_motion_is_sampled_from_the_cmu_clips(cmu, body, rest, rate):
    motion = cmu.sample(body, rest, 40, rate, 0.5, np.random.default_rng(1))
    assert np.isfinite(motion.rotations).all()
    assert abs(motion.yaw).max() <= 0.5
    normalised = motion.rotations @ motion.rotations.swapaxes(-1, -2)
    np.testing.assert_allclose(normalised, np.broadcast_to(np.eye(3), normalised.shape), atol=1e-6)
    poses = [pose_body(body, rest, pose, np.zeros(3)).joints for pose in motion.rotations]
    body_yaw = (
        np.array(poses)[:, JOINT_NUMBERS['l_hip']] - np.array(poses)[:, JOINT_NUMBERS['r_hip']]
    )
    assert (body_yaw[:, 0] > 0).all()
