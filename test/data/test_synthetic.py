"""Synthetic frames as a whole, and the command that writes them."""

import argparse
import time
from pathlib import Path

import numpy as np
import pytest

from lsc_pose_ros.cli import synth_command
from lsc_pose_ros.core.camera import project
from lsc_pose_ros.core.frame import NO_BODY, Frame
from lsc_pose_ros.core.joints import JOINT_NAMES, JOINT_NUMBERS
from lsc_pose_ros.data.recording import open_frames
from lsc_pose_ros.data.synthetic.generator import (
    SyntheticSettings,
    camera_of,
    check,
    synthetic_frames,
)
from lsc_pose_ros.errors import InputError

CLEAN = SyntheticSettings(frames=12, clip_length=4, noise='none', seed=3)

NOTED_JOINTS = [0.7649, -0.2853, 2.3996, 1.0088, -0.3910, 2.0748, 0.8528, 0.8710, 2.4400]
NOTED_PIXELS = 4889
NOTED_DEPTH = 2.3197


def frames_of(settings: SyntheticSettings) -> list[Frame]:
    return list(synthetic_frames(settings))


def positions_of(frame: Frame) -> dict[str, np.ndarray]:
    assert frame.truth is not None
    return dict(zip(JOINT_NAMES, frame.truth.positions[0], strict=True))


def equal(one: Frame, other: Frame) -> bool:
    assert one.truth is not None
    assert other.truth is not None
    return (
        one.stamp == other.stamp
        and np.array_equal(one.depth, other.depth)
        and np.array_equal(one.labels, other.labels)
        and np.array_equal(one.truth.positions, other.truth.positions)
    )


@pytest.fixture(scope='module')
def clean_frames() -> list[Frame]:
    return frames_of(CLEAN)


@pytest.fixture(scope='module')
def noisy_frames() -> list[Frame]:
    return frames_of(CLEAN._replace(noise='kinect'))


def test_frames_are_what_the_method_expects(noisy_frames: list[Frame]) -> None:
    assert len(noisy_frames) == 12
    for frame in noisy_frames:
        assert frame.depth.shape == frame.labels.shape == (240, 320)
        assert frame.depth.dtype == np.float32
        assert frame.labels.dtype == np.int32
        assert set(np.unique(frame.labels)) == {NO_BODY, 1}
        np.testing.assert_array_equal(frame.depth > 0, frame.labels == 1)
        assert frame.frame_id == 'camera_depth_optical_frame'
        assert frame.truth is not None
        assert frame.truth.joints.tolist() == list(range(20))
        assert np.isfinite(frame.truth.positions).all()
        assert (frame.truth.confidence == 1).all()


def test_depth_is_in_whole_millimetres(noisy_frames: list[Frame]) -> None:
    for frame in noisy_frames:
        millimetres = frame.depth * np.float32(1000)
        np.testing.assert_allclose(millimetres, np.rint(millimetres), atol=1e-3)


def test_camera_is_a_kinect_unless_told_otherwise() -> None:
    camera = camera_of(SyntheticSettings())
    assert camera.fx == camera.fy == pytest.approx(286, abs=1)
    assert (camera.cx, camera.cy) == (159.5, 119.5)
    wide = camera_of(SyntheticSettings(width=640, height=480, field_of_view=90.0))
    assert wide.fx == pytest.approx(320)


def test_stamps_follow_the_rate() -> None:
    stamps = [frame.stamp for frame in frames_of(CLEAN._replace(rate=10.0))]
    assert stamps[0] == 1_700_000_000 * 10**9
    assert np.diff(stamps).tolist() == [10**8] * 11


@pytest.mark.parametrize('noise', ['none', 'kinect'])
def test_same_seed_same_frames_and_another_seed_others(noise: str) -> None:
    settings = CLEAN._replace(frames=6, noise=noise)
    first, again = frames_of(settings), frames_of(settings)
    assert all(equal(one, other) for one, other in zip(first, again, strict=True))
    others = frames_of(settings._replace(seed=4))
    assert not any(equal(one, other) for one, other in zip(first, others, strict=True))


def test_first_frames_do_not_depend_on_how_many_follow(noisy_frames: list[Frame]) -> None:
    few = frames_of(CLEAN._replace(noise='kinect', frames=6))
    assert all(equal(one, other) for one, other in zip(few, noisy_frames, strict=False))


def test_frames_stay_what_they_were(clean_frames: list[Frame]) -> None:
    """Numbers noted once: a seed means the same frames on every machine and in every version.

    Changing the generator on purpose changes them; take down the new ones then.
    """
    frame = clean_frames[5]
    joints = positions_of(frame)
    seen = np.concatenate([joints['head'], joints['l_hand'], joints['r_foot']])
    np.testing.assert_allclose(seen, NOTED_JOINTS, atol=2e-4)
    assert int((frame.labels == 1).sum()) == pytest.approx(NOTED_PIXELS, abs=3)
    assert float(frame.depth[frame.depth > 0].mean()) == pytest.approx(NOTED_DEPTH, abs=2e-4)


def test_clips_bring_new_people_and_motion_within_them_is_smooth(
    clean_frames: list[Frame],
) -> None:
    bones = []
    for frame in clean_frames:
        joints = positions_of(frame)
        bones.append(np.linalg.norm(joints['l_hip'] - joints['l_knee']))
    lengths = np.array(bones).reshape(3, 4)
    assert np.ptp(lengths, axis=1).max() < 1e-5
    assert np.ptp(lengths[:, 0]) > 0.01
    for first, second in ((0, 1), (1, 2), (5, 6)):
        before, after = clean_frames[first].truth, clean_frames[second].truth
        assert before is not None
        assert after is not None
        steps = np.linalg.norm(before.positions - after.positions, axis=2)
        assert 0 < steps.max() < 0.4


def test_joints_lie_behind_the_surface_that_hides_them() -> None:
    settings = SyntheticSettings(frames=40, clip_length=2, noise='none')
    inside = 0
    for frame in synthetic_frames(settings):
        assert frame.truth is not None
        positions = frame.truth.positions[0]
        columns, rows = np.rint(project(positions, frame.camera)).astype(int).T
        surface = frame.depth[rows, columns]
        inside += int((surface > 0).sum())
        seen = surface > 0
        assert (positions[seen, 2] > surface[seen] - 0.003).all()
        torso = JOINT_NUMBERS['torso']
        assert seen[torso]
    assert inside > 0.99 * 40 * 20


def test_people_who_face_the_camera_have_their_left_at_image_right() -> None:
    for frame in synthetic_frames(SyntheticSettings(frames=30, clip_length=1, yaw=0.0)):
        joints = positions_of(frame)
        assert joints['l_hip'][0] > joints['r_hip'][0]
        assert joints['head'][1] < joints['l_foot'][1]


def test_yaw_keeps_its_bounds() -> None:
    """The line through the hips tells where a person faces."""
    angles = []
    for frame in synthetic_frames(SyntheticSettings(frames=60, clip_length=1, yaw=40.0)):
        joints = positions_of(frame)
        across = joints['l_hip'] - joints['r_hip']
        angles.append(np.degrees(np.arctan2(across[2], across[0])))
    assert np.abs(angles).max() < 42
    assert np.std(angles) > 15


def test_people_are_in_full_view_within_the_distance() -> None:
    settings = SyntheticSettings(frames=60, clip_length=1, noise='none', distance=(2.0, 3.5))
    distances = []
    for frame in synthetic_frames(settings):
        edge = np.concatenate(
            [frame.depth[0], frame.depth[-1], frame.depth[:, 0], frame.depth[:, -1]]
        )
        assert not edge.any()
        distances.append(positions_of(frame)['pelvis'][2])
    assert min(distances) > 1.6
    assert max(distances) < 3.9
    assert np.std(distances) > 0.2


def test_cropped_people_meet_the_edge() -> None:
    settings = SyntheticSettings(
        frames=10, clip_length=1, distance=(1.0, 1.3), stature=(1.8, 1.9), cropped=True
    )
    cut = [frame.depth[0].any() or frame.depth[-1].any() for frame in synthetic_frames(settings)]
    assert all(cut)


def test_several_people_are_numbered_and_hide_one_another() -> None:
    settings = SyntheticSettings(frames=40, clip_length=2, people=3, noise='none')
    settings = settings._replace(distance=(1.5, 6.0))
    hidden = 0
    for frame in synthetic_frames(settings):
        assert frame.truth is not None
        assert frame.truth.bodies.tolist() == [1, 2, 3]
        assert frame.truth.positions.shape == (3, 20, 3)
        assert set(np.unique(frame.labels)) == {NO_BODY, 1, 2, 3}
        for number, positions in enumerate(frame.truth.positions, start=1):
            columns, rows = np.rint(project(positions, frame.camera)).astype(int).T
            others = (frame.labels[rows, columns] != number) & (frame.depth[rows, columns] > 0)
            # Whoever else is seen there stands before the joint.
            assert (frame.depth[rows, columns][others] < positions[others, 2]).all()
            hidden += int(others.sum())
    assert hidden > 0


def test_size_and_field_of_view_are_obeyed() -> None:
    settings = CLEAN._replace(frames=2, width=176, height=144, field_of_view=43.6)
    settings = settings._replace(distance=(3.0, 6.0))
    for frame in synthetic_frames(settings):
        assert frame.depth.shape == (144, 176)
        assert frame.camera.fx == pytest.approx(220, abs=1)


def test_fifty_frames_a_second() -> None:
    settings = SyntheticSettings(frames=60, seed=1)
    next(synthetic_frames(settings))  # compiles
    start = time.process_time()
    count = sum(1 for _ in synthetic_frames(settings))
    assert count / (time.process_time() - start) > 50


@pytest.mark.parametrize(
    ('change', 'words'),
    [
        ({'frames': 0}, 'frames is 0'),
        ({'seed': -1}, 'seed is -1'),
        ({'people': 0}, 'people is 0; give 1 to 8'),
        ({'people': 9}, 'people is 9'),
        ({'width': 8}, 'size is 8x240'),
        ({'height': 5000}, 'size is 320x5000'),
        ({'field_of_view': 180.0}, 'field of view is 180'),
        ({'noise': 'gauss'}, 'noise is gauss; give one of kinect, none'),
        ({'yaw': -5.0}, 'yaw is -5'),
        ({'distance': (3.0, 2.0)}, 'distance is 3 to 2 m'),
        ({'distance': (float('nan'), 2.0)}, 'distance is nan'),
        ({'stature': (0.1, 1.0)}, r'stature is 0\.1 to 1 m'),
        ({'clip_length': 0}, 'clip length is 0'),
        ({'rate': 0.0}, 'rate is 0'),
    ],
)
def test_settings_that_cannot_be_met_are_refused(change: dict[str, object], words: str) -> None:
    settings = SyntheticSettings()._replace(**change)
    with pytest.raises(InputError, match=words):
        check(settings)
    with pytest.raises(InputError, match=words):
        synthetic_frames(settings)  # at once, not at the first frame


def run_command(*words: object) -> int:
    parser = argparse.ArgumentParser()
    synth_command.add_arguments(parser)
    return synth_command.run(parser.parse_args([str(word) for word in words]))


def test_command_writes_what_is_generated(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / 'people.mcap'
    words = ('--frames', 4, '--people', 2, '--size', '160x120', '--clip-length', 2, '--seed', 5)
    assert run_command(output, *words) == 0
    assert '4 frames, 4 people' in capsys.readouterr().out
    settings = SyntheticSettings(frames=4, people=2, width=160, height=120, clip_length=2, seed=5)
    read = list(open_frames(output))
    for frame, original in zip(read, synthetic_frames(settings), strict=True):
        assert frame.truth is not None
        assert original.truth is not None
        assert frame.stamp == original.stamp
        assert frame.camera == pytest.approx(original.camera)
        np.testing.assert_array_equal(frame.labels, original.labels)
        np.testing.assert_allclose(frame.depth, original.depth, atol=1e-6)
        np.testing.assert_array_equal(frame.truth.positions, original.truth.positions)
        np.testing.assert_array_equal(frame.truth.bodies, original.truth.bodies)


def test_command_passes_every_argument_on(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    asked: list[SyntheticSettings] = []

    def remember(settings: SyntheticSettings) -> list[Frame]:
        asked.append(settings)
        return []

    monkeypatch.setattr(synth_command, 'synthetic_frames', remember)
    run_command(tmp_path / 'a.mcap')
    run_command(
        *(tmp_path / 'b.mcap', '--frames', 7, '--seed', 8, '--people', 2, '--size', '100x90'),
        *('--fov', 70, '--noise', 'none', '--yaw', 30, '--distance', 2, 3, '--stature', 1.2, 1.4),
        *('--clip-length', 9, '--fps', 15, '--cropped'),
    )
    assert asked[0] == SyntheticSettings()
    assert asked[1] == SyntheticSettings(
        frames=7,
        seed=8,
        people=2,
        width=100,
        height=90,
        field_of_view=70.0,
        noise='none',
        yaw=30.0,
        distance=(2.0, 3.0),
        stature=(1.2, 1.4),
        clip_length=9,
        rate=15.0,
        cropped=True,
    )


def test_command_leaves_no_file_when_it_fails(tmp_path: Path) -> None:
    output = tmp_path / 'people.mcap'
    with pytest.raises(InputError, match='no place found'):
        run_command(output, '--distance', 0.5, 0.6)
    with pytest.raises(InputError, match='frames is 0'):
        run_command(output, '--frames', 0)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize('size', ['320', '320x', 'x240', '3.5x2', '-3x4', '320x240x3'])
def test_command_refuses_a_size_that_is_none(
    tmp_path: Path, size: str, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit):
        run_command(tmp_path / 'a.mcap', f'--size={size}')
    assert 'is no size; write it as 320x240' in capsys.readouterr().err
