"""The benchmark's arithmetic, and that what it times is what the estimator does."""

import time

import numpy as np
import pytest

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY, Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.evaluation import benchmark
from lsc_pose_ros.evaluation.benchmark import (
    WHOLE,
    FrameTimes,
    summarise_times,
    time_frames,
    warm_up,
)
from lsc_pose_ros.evaluation.encoded_frame import decode_frame, encode_frame
from lsc_pose_ros.evaluation.stage_times import (
    FAST,
    PLAIN,
    STAGES,
    STAGES_WITH_PLAIN_KERNELS,
    walk,
)
from lsc_pose_ros.plain import density as plain_density
from lsc_pose_ros.plain import descriptor as plain_descriptor
from lsc_pose_ros.plain import silhouette as plain_silhouette
from lsc_pose_ros.pose.estimator import Estimator


@pytest.fixture(scope='module')
def estimator(small_model):
    return Estimator(small_model)


@pytest.fixture(scope='module')
def encoded(people):
    """One frame of each of the eight people."""
    return [encode_frame(frame) for frame in people[10::30]]


def side_by_side(*frames: Frame) -> Frame:
    """Return one image of several frames, bodies numbered from 1, and a speck, body 9."""
    depth = np.concatenate([frame.depth for frame in frames], axis=1)
    labels = np.concatenate(
        [np.where(frame.labels >= 0, n, NO_BODY) for n, frame in enumerate(frames, start=1)],
        axis=1,
    ).astype(np.int32)
    depth[:3, :3], labels[:3, :3] = 2, 9
    return frames[0]._replace(depth=depth, labels=labels)


def frame_of(depth: np.ndarray, labels: np.ndarray) -> Frame:
    camera = Intrinsics(60.0, 60.0, 10.0, 10.0)
    return Frame(0, 'camera', depth.astype(np.float32), labels.astype(np.int32), camera, None)


@pytest.mark.parametrize(
    ('numbers', 'encoding', 'background'),
    [
        ((1, 2), 'mono8', 0),
        ((255,), 'mono8', 0),
        ((0, 7), 'mono8', 255),
        ((0, 255), '16UC1', 65535),
        ((300, 65535), '16UC1', 0),
        ((0, 65535), '32SC1', -1),
    ],
)
def test_a_mask_is_encoded_in_the_fewest_bytes_that_keep_it(numbers, encoding, background):
    rng = np.random.default_rng(0)
    labels = rng.choice([NO_BODY, *numbers], (6, 9))
    labels[0, : len(numbers)] = numbers
    frame = frame_of(np.ones(labels.shape), labels)
    encoded = encode_frame(frame)
    assert (encoded.mask_layout.encoding, encoded.background) == (encoding, background)
    np.testing.assert_array_equal(decode_frame(encoded)[1], labels)


def test_depth_in_whole_millimetres_is_16uc1_and_any_other_is_32fc1():
    rng = np.random.default_rng(1)
    whole = rng.integers(0, 5000, (5, 7))
    labels = np.zeros((5, 7))
    in_millimetres = encode_frame(frame_of(whole / 1000, labels))
    assert in_millimetres.depth_layout.encoding == '16UC1'
    np.testing.assert_array_equal(in_millimetres.depth.view('<u2').reshape(5, 7), whole)
    np.testing.assert_allclose(decode_frame(in_millimetres)[0], whole / 1000, atol=1e-6)
    assert in_millimetres.size == '7x5'
    for depth in (rng.random((5, 7)), np.full((5, 7), 66.0)):
        encoded = encode_frame(frame_of(depth, labels))
        assert encoded.depth_layout.encoding == '32FC1'
        np.testing.assert_array_equal(decode_frame(encoded)[0], depth.astype(np.float32))


@pytest.mark.parametrize('queries', [150, 40])
def test_the_fast_way_is_that_of_the_estimator(queries, small_model, people):
    settings = small_model.settings._replace(query_points=queries)
    model = small_model._replace(settings=settings)
    encoded = encode_frame(side_by_side(people[5], people[125]))
    depth, labels = decode_frame(encoded)
    expected = Estimator(model).estimate(depth, labels, encoded.camera)
    walked = walk(model, encoded, FAST)
    np.testing.assert_array_equal(walked.positions, expected.positions)
    np.testing.assert_array_equal(walked.confidence, expected.confidence)
    assert np.isfinite(walked.positions[:2]).all()
    assert np.isnan(walked.positions[2]).all()


@pytest.mark.parametrize('noisy', [{}, {'fill_holes': 5}, {'noise_factor': 30.0}])
def test_the_fast_way_is_that_of_the_estimator_where_body_yaws_are_found(
    noisy, body_yaw_model, all_round_people
):
    frame = side_by_side(all_round_people[5], all_round_people[125])
    seen = frame.depth.copy()
    seen[::4, ::4] = 0
    encoded = encode_frame(frame._replace(depth=seen))
    depth, labels = decode_frame(encoded)
    model = body_yaw_model._replace(settings=body_yaw_model.settings._replace(**noisy))
    expected = Estimator(model).estimate(depth, labels, encoded.camera)
    walked = walk(model, encoded, FAST)
    np.testing.assert_array_equal(walked.positions, expected.positions)
    np.testing.assert_array_equal(walked.confidence, expected.confidence)
    assert np.isfinite(walked.positions[:2]).all()
    other = Estimator(body_yaw_model).estimate(depth, labels, encoded.camera)
    assert np.array_equal(other.positions, expected.positions, equal_nan=True) == (not noisy)


@pytest.mark.parametrize('queries', [150, 40])
def test_the_plain_way_leads_to_the_same_joints(queries, small_model, encoded):
    settings = small_model.settings._replace(query_points=queries)
    model = small_model._replace(settings=settings)
    apart = np.concatenate(
        [
            np.linalg.norm(
                walk(model, frame, PLAIN).positions - walk(model, frame, FAST).positions, axis=-1
            ).ravel()
            for frame in encoded
        ]
    )
    assert np.percentile(apart, 90) < 0.0005
    assert apart.max() < 0.005


def test_only_the_plain_way_runs_the_plain_kernels(small_model, people, monkeypatch):
    model, called = small_model, []
    frame = encode_frame(side_by_side(people[5], people[125]))
    for module, name in (
        (plain_silhouette, 'smooth'),
        (plain_descriptor, 'describe'),
        (plain_descriptor, 'quantise'),
    ):
        kernel = getattr(module, name)
        monkeypatch.setattr(
            module, name, lambda *words, k=kernel, n=name: called.append(n) or k(*words)
        )
    walk(model, frame, FAST)
    assert called == []
    walk(model, frame, PLAIN)
    # Bodies 1 and 2, and the speck that is smoothed before it is known to be one.
    assert called == ['smooth', 'describe', 'quantise'] * 2 + ['smooth']
    assert PLAIN.mean_distance is plain_descriptor.mean_distance
    assert PLAIN.find_candidates.py_func.__globals__['plain_density'] is plain_density


def test_all_the_time_of_the_way_is_charged_to_a_stage(small_model, encoded):
    for kernels in (FAST, PLAIN):
        walk(small_model, encoded[0], kernels)
        begin = time.perf_counter()
        seconds = walk(small_model, encoded[0], kernels).seconds
        passed = time.perf_counter() - begin
        assert list(seconds) == list(STAGES)
        assert min(seconds.values()) > 0
        assert 0.5 * passed < sum(seconds.values()) <= passed


def test_frames_are_timed_as_a_whole_and_by_stages(estimator, encoded):
    frames = warm_up(estimator, encoded)
    assert frames == encoded
    times = list(time_frames(estimator, frames * 2))
    assert len(times) == 2 * len(encoded)
    for frame in times:
        assert list(frame.seconds) == list(frame.plain) == [*STAGES, WHOLE]
        assert frame.plain[WHOLE] == pytest.approx(sum(frame.plain[stage] for stage in STAGES))
        assert frame.apart.shape == (1, len(estimator.joints))
        assert frame.apart.max() < 0.005
    whole = np.median([frame.seconds[WHOLE] for frame in times])
    stages = np.median([sum(frame.seconds[stage] for stage in STAGES) for frame in times])
    assert 0.5 < stages / whole < 2


def test_without_comparison_no_plain_kernel_runs(estimator, encoded, monkeypatch):
    monkeypatch.setattr(benchmark, 'PLAIN', None)
    times = list(time_frames(estimator, encoded, compare=False))
    assert all(frame.plain == {} for frame in times)
    for summary in summarise_times(times).values():
        assert summary.ms_p50 > 0
        assert summary.plain_ms_p50 is None
        assert summary.ratio_to_plain is None


def test_frames_with_nobody_are_left_out_and_a_benchmark_of_nobody_is_refused(
    estimator, people, encoded
):
    empty = encode_frame(people[0]._replace(labels=np.full_like(people[0].labels, NO_BODY)))
    assert warm_up(estimator, [empty, *encoded[:2], empty]) == encoded[:2]
    with pytest.raises(InputError, match='nobody is seen well enough in any of 2 frames'):
        warm_up(estimator, [empty, empty])


def test_a_summary_is_of_medians_and_of_their_ratio():
    times = [
        FrameTimes(
            {stage: 0.001 * n * (k + 1) for k, stage in enumerate((*STAGES, WHOLE))},
            {stage: 0.004 * n * (k + 1) for k, stage in enumerate((*STAGES, WHOLE))},
            np.zeros((1, 1), np.float32),
        )
        for n in range(21)
    ]
    summaries = summarise_times(times)
    assert list(summaries) == [*STAGES, WHOLE]
    for k, (stage, summary) in enumerate(summaries.items()):
        assert summary.ms_p50 == pytest.approx(10 * (k + 1))
        assert summary.ms_p95 == pytest.approx(19 * (k + 1))
        if stage in (*STAGES_WITH_PLAIN_KERNELS, WHOLE):
            assert summary.plain_ms_p50 == pytest.approx(40 * (k + 1))
            assert summary.ratio_to_plain == pytest.approx(4)
        else:
            assert summary.plain_ms_p50 is summary.ratio_to_plain is None


def test_a_joint_that_only_one_way_has_found_is_infinitely_far():
    first = np.array([[[0, 0, 1], [0, 0, 1], [np.nan] * 3, [np.nan] * 3]], np.float32)
    second = np.array([[[0, 3, 5], [np.nan] * 3, [0, 0, 1], [np.nan] * 3]], np.float32)
    np.testing.assert_array_equal(benchmark._apart(first, second), [[5, np.inf, np.inf, np.nan]])
