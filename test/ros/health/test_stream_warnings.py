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

"""Warnings about the stream of frames."""

import pytest

from lsc_pose_ros.ros.health.stream_warnings import (
    Counters,
    Delivery,
    StreamContext,
    TopicNames,
    duration,
    stream_warnings,
)

CONTEXT = StreamContext(
    TopicNames('/cam/depth', '/cam/info', '/seg/mask'),
    {'/cam/depth': 1, '/seg/mask': 0},
    '/share/fastdds_profile.xml',
    {'/cam/depth': 5.0, '/cam/info': 5.0, '/seg/mask': 5.0},
    dict.fromkeys(('/cam/depth', '/cam/info', '/seg/mask'), Delivery.BEST_EFFORT),
)
GOOD = Counters(depth=150, masks=150, camera_infos=150, pairs=150)


def warnings(before: Counters, now: Counters) -> dict[str, str]:
    return stream_warnings(before, now, CONTEXT)


def test_no_warning_about_a_good_stream() -> None:
    assert warnings(Counters(), GOOD) == {}


def test_no_warning_about_masks_slower_than_depth() -> None:
    assert warnings(Counters(), GOOD._replace(masks=50, pairs=50)) == {}


def test_camera_info_that_came_once_is_enough() -> None:
    later = Counters(depth=300, masks=300, camera_infos=150, pairs=300)
    assert warnings(GOOD, later) == {}


def test_silent_topics_are_named_with_publishers_and_remedy() -> None:
    found = warnings(Counters(), Counters())
    assert set(found) == {'no depth', 'no mask', 'no camera info'}
    text = found['no depth']
    assert 'nothing received on /cam/depth for 5 s (1 publisher)' in text
    assert 'look at its log' in text
    text = found['no mask']
    assert 'nothing received on /seg/mask for 5 s (no publishers)' in text
    assert 'remap mask' in text
    assert 'segmentation' in text
    text = found['no camera info']
    assert 'no camera info received on /cam/info (no publishers)' in text
    assert 'remap depth/camera_info' in text


def test_without_publishers_the_depth_topic_can_be_remapped() -> None:
    text = stream_warnings(Counters(), Counters(), CONTEXT._replace(publishers={}))['no depth']
    assert '(no publishers); start the camera, or remap depth/image' in text


def test_topic_that_falls_silent_is_named() -> None:
    assert set(warnings(GOOD, GOOD._replace(depth=300))) == {'no mask'}


def test_no_masks_are_missed_if_none_are_needed() -> None:
    context = CONTEXT._replace(topics=TopicNames('/cam/depth', '/cam/info'))
    assert stream_warnings(Counters(), GOOD._replace(masks=0), context) == {}
    assert context.topics.subscribed == ('/cam/depth', '/cam/info')


def test_stamps_that_never_match() -> None:
    text = warnings(Counters(), GOOD._replace(pairs=0))['no pairs']
    assert '/seg/mask' in text
    assert 'sync_slop' in text


def test_lost_images_and_the_remedy() -> None:
    text = warnings(GOOD, GOOD._replace(depth=160, masks=300, pairs=160, lost=140))['loss']
    assert 'lost 140 images' in text
    assert 'FASTRTPS_DEFAULT_PROFILES_FILE=/share/fastdds_profile.xml' in text
    assert 'reliably' in text


def test_remedy_against_loss_fits_what_the_publishers_offer() -> None:
    lossy = GOOD._replace(missing=50, lost=50, lost_camera_infos=50)
    topics = CONTEXT.topics

    def remedies(depth: Delivery, mask: Delivery) -> str:
        delivery = {topics.depth: depth, topics.mask: mask, topics.camera_info: depth}
        return stream_warnings(Counters(), lossy, CONTEXT._replace(delivery=delivery))['loss']

    text = remedies(Delivery.RELIABLE, Delivery.RELIABLE)
    assert 'deliver reliably' in text
    assert 'longer queues' in text
    assert 'let them publish reliably' not in text
    text = remedies(Delivery.RELIABLE, Delivery.BEST_EFFORT)
    assert 'let them publish reliably' in text
    text = remedies(Delivery.RELIABLE_UNUSED, Delivery.RELIABLE)
    assert 'set the parameter reliability to auto' in text
    assert 'let them publish reliably' not in text


def test_lost_camera_infos_are_not_lost_images() -> None:
    found = warnings(Counters(), GOOD._replace(lost_camera_infos=50))
    assert set(found) == {'camera info loss'}
    text = found['camera info loss']
    assert 'lost 50 camera infos of /cam/info and received 150' in text
    assert 'let them publish reliably' in text
    reliable = CONTEXT._replace(delivery={'/cam/info': Delivery.RELIABLE})
    now = GOOD._replace(lost_camera_infos=50)
    text = stream_warnings(Counters(), now, reliable)['camera info loss']
    assert 'let them publish reliably' not in text


@pytest.mark.parametrize(
    ('seconds', 'text'),
    [(5.0, '5 s'), (65.2, '65 s'), (119.0, '119 s'), (120.0, '2 min'), (3600.0, '60 min')],
)
def test_silence_is_as_long_as_it_was(seconds: float, text: str) -> None:
    assert duration(seconds) == text
    context = CONTEXT._replace(silence=dict.fromkeys(CONTEXT.silence, seconds))
    found = stream_warnings(Counters(), Counters(), context)
    assert f'nothing received on /cam/depth for {text} (' in found['no depth']
    assert f'nothing received on /seg/mask for {text} (' in found['no mask']


def test_missing_stamps_and_the_remedy() -> None:
    text = warnings(Counters(), GOOD._replace(missing=50))['loss']
    assert 'according to the stamps of /cam/depth, 50 of 200 depth images are missing' in text
    assert 'FASTRTPS_DEFAULT_PROFILES_FILE=/share/fastdds_profile.xml' in text
    assert 'middleware' not in text


@pytest.mark.parametrize('name', ['missing', 'lost', 'lost_camera_infos', 'duplicates', 'late'])
def test_no_warning_about_few_problems(name: str) -> None:
    assert warnings(Counters(), GOOD._replace(**{name: 5})) == {}


@pytest.mark.parametrize('name', ['duplicates', 'late'])
def test_disorder_names_the_topics(name: str) -> None:
    text = warnings(Counters(), GOOD._replace(**{name: 60}))['disorder']
    assert '/cam/depth and /seg/mask' in text
    assert '60' in text
    assert 'one publisher' in text


def test_depth_images_without_a_mask_are_normal() -> None:
    now = GOOD._replace(masks=50, pairs=50, unmatched_depth=100)
    assert warnings(Counters(), now) == {}


def test_stamps_that_went_back() -> None:
    assert '/cam/depth' in warnings(Counters(), GOOD._replace(rewinds=1))['rewind']


@pytest.mark.parametrize(('replaced', 'warns'), [(0, False), (7, False), (8, True), (149, True)])
def test_overload_is_more_than_one_frame_in_twenty(*, replaced: int, warns: bool) -> None:
    assert ('overload' in warnings(Counters(), GOOD._replace(replaced=replaced))) == warns


def test_only_the_increase_counts() -> None:
    before = GOOD._replace(replaced=100, lost=100, rewinds=3)
    now = before._replace(depth=300, masks=300, pairs=300)
    assert warnings(before, now) == {}


# Counts whose fractions of all possible denominators differ: 400 depth images and 100 masks, 500
# images and 80 pairs.
UNEVEN = Counters(depth=400, masks=100, camera_infos=1, pairs=80)


@pytest.mark.parametrize(
    ('kind', 'name', 'tolerated'),
    [
        ('loss', 'missing', 21),  # 21 / (400 + 21) < 0.05 < 22 / (400 + 22)
        ('loss', 'lost', 26),  # 26 / (500 + 26) < 0.05 < 27 / (500 + 27)
        ('disorder', 'duplicates', 25),  # 25 / 500 = 0.05
        ('disorder', 'late', 25),
        ('overload', 'replaced', 4),  # 4 / 80 = 0.05
    ],
)
def test_warning_needs_more_than_a_twentieth_of_what_was_sent(
    kind: str, name: str, tolerated: int
) -> None:
    assert warnings(Counters(), UNEVEN._replace(**{name: tolerated})) == {}
    assert set(warnings(Counters(), UNEVEN._replace(**{name: tolerated + 1}))) == {kind}


def test_duplicates_and_late_images_count_together() -> None:
    assert warnings(Counters(), UNEVEN._replace(duplicates=13, late=12)) == {}
    assert set(warnings(Counters(), UNEVEN._replace(duplicates=13, late=13))) == {'disorder'}


def test_numbers_in_the_warnings() -> None:
    found = warnings(
        Counters(), UNEVEN._replace(missing=50, lost=60, duplicates=20, late=30, replaced=40)
    )
    assert '50 of 450 depth images are missing' in found['loss']
    assert 'the middleware lost 60 images and received 500' in found['loss']
    assert 'of 500 images' in found['disorder']
    assert '20 repeat the stamp of another and 30 came after newer ones' in found['disorder']
    assert '40 of 80 frames were left out' in found['overload']


def test_stamps_that_are_all_equal_are_told_once() -> None:
    found = warnings(Counters(), GOOD._replace(pairs=0, duplicates=GOOD.depth + GOOD.masks))
    assert set(found) == {'disorder'}
