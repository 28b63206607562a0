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

"""What the node says of a bad stream of frames."""

import pytest

from lsc_pose_ros.ros.health.stream_warnings import Counters, Situation, TopicNames, complaints

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


def test_silent_topics_are_named_with_their_publishers_and_the_remedy() -> None:
    found = told(Counters(), Counters())
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
    text = complaints(Counters(), Counters(), SITUATION._replace(publishers={}))['no depth']
    assert '(no publishers); start the camera, or remap depth/image' in text


def test_topic_that_falls_silent_is_named() -> None:
    assert set(told(GOOD, GOOD._replace(depth=300))) == {'no mask'}


def test_no_masks_are_missed_where_none_are_needed() -> None:
    situation = SITUATION._replace(topics=TopicNames('/cam/depth', '/cam/info'))
    assert complaints(Counters(), GOOD._replace(masks=0), situation) == {}
    assert situation.topics.listened == ('/cam/depth', '/cam/info')


def test_stamps_that_never_agree() -> None:
    text = told(Counters(), GOOD._replace(pairs=0))['no pairs']
    assert '/seg/mask' in text
    assert 'sync_slop' in text


def test_lost_images_and_the_remedy() -> None:
    text = told(GOOD, GOOD._replace(depth=160, masks=300, pairs=160, lost=140))['loss']
    assert 'lost 140 images' in text
    assert 'FASTRTPS_DEFAULT_PROFILES_FILE=/share/fastdds_profile.xml' in text
    assert 'reliably' in text


def test_missing_stamps_and_the_remedy() -> None:
    text = told(Counters(), GOOD._replace(missing=50))['loss']
    assert 'by the stamps of /cam/depth, 50 of 200 depth images are missing' in text
    assert 'FASTRTPS_DEFAULT_PROFILES_FILE=/share/fastdds_profile.xml' in text
    assert 'middleware' not in text


@pytest.mark.parametrize('name', ['missing', 'lost', 'duplicates', 'late'])
def test_little_trouble_is_no_complaint(name: str) -> None:
    assert told(Counters(), GOOD._replace(**{name: 5})) == {}


@pytest.mark.parametrize('name', ['duplicates', 'late'])
def test_disorder_is_told_with_the_topics(name: str) -> None:
    text = told(Counters(), GOOD._replace(**{name: 60}))['disorder']
    assert '/cam/depth and /seg/mask' in text
    assert '60' in text
    assert 'one publisher' in text


def test_depth_images_without_a_mask_are_ordinary() -> None:
    now = GOOD._replace(masks=50, pairs=50, unmatched_depth=100)
    assert told(Counters(), now) == {}


def test_stamps_that_went_back() -> None:
    assert '/cam/depth' in told(Counters(), GOOD._replace(rewinds=1))['rewind']


@pytest.mark.parametrize(('replaced', 'tells'), [(0, False), (7, False), (8, True), (149, True)])
def test_overload_is_told_beyond_one_frame_in_twenty(*, replaced: int, tells: bool) -> None:
    assert ('overload' in told(Counters(), GOOD._replace(replaced=replaced))) == tells


def test_only_what_is_new_counts() -> None:
    before = GOOD._replace(replaced=100, lost=100, rewinds=3)
    now = before._replace(depth=300, masks=300, pairs=300)
    assert told(before, now) == {}
