"""What the node says of a bad stream of frames."""

import pytest

from lsc_pose_ros.ros.watch import Counters, Situation, TopicNames, complaints

SITUATION = Situation(
    TopicNames('/cam/depth', '/cam/info', '/seg/mask'),
    {'/cam/depth': 1, '/seg/mask': 0},
    '/share/fastdds_profile.xml',
)
GOOD = Counters(depth=150, masks=150, camera_infos=150, pairs=150)


def told(before: Counters, now: Counters) -> dict[str, str]:
    return complaints(before, now, SITUATION)


def test_good_stream_gives_no_complaint() -> None:
    assert told(Counters(), GOOD) == {}


def test_mask_slower_than_depth_gives_no_complaint() -> None:
    assert told(Counters(), GOOD._replace(masks=50, pairs=50)) == {}


def test_camera_info_that_came_once_is_enough() -> None:
    later = Counters(depth=300, masks=300, camera_infos=150, pairs=300)
    assert told(GOOD, later) == {}


def test_silent_topics_are_named_with_their_publishers() -> None:
    text = told(Counters(), Counters())['silence']
    assert '/cam/depth (1 publishers)' in text
    assert '/cam/info (0 publishers)' in text
    assert '/seg/mask (0 publishers)' in text
    assert 'remap' in text


def test_topic_that_falls_silent_is_named() -> None:
    text = told(GOOD, GOOD._replace(depth=300))['silence']
    assert '/seg/mask' in text
    assert '/cam/depth' not in text


def test_stamps_that_never_agree() -> None:
    text = told(Counters(), GOOD._replace(pairs=0))['no pairs']
    assert '/seg/mask' in text
    assert 'sync_slop' in text


def test_lost_images_and_the_remedy() -> None:
    text = told(GOOD, GOOD._replace(depth=160, masks=300, pairs=160, lost=140))['loss']
    assert 'lost 140 images' in text
    assert 'FASTRTPS_DEFAULT_PROFILES_FILE=/share/fastdds_profile.xml' in text
    assert 'reliable' in text


def test_stamps_that_went_back() -> None:
    assert '/cam/depth' in told(Counters(), GOOD._replace(rewinds=1))['rewind']


@pytest.mark.parametrize(('replaced', 'tells'), [(0, False), (7, False), (8, True), (149, True)])
def test_overload_is_told_beyond_one_frame_in_twenty(*, replaced: int, tells: bool) -> None:
    assert ('overload' in told(Counters(), GOOD._replace(replaced=replaced))) == tells


def test_only_what_is_new_counts() -> None:
    before = GOOD._replace(replaced=100, lost=100, rewinds=3)
    now = before._replace(depth=300, masks=300, pairs=300)
    assert told(before, now) == {}
