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

"""The topics that make up a frame."""

import pytest

from lsc_pose_ros.bags.storage.serialized_messages import TopicSummary
from lsc_pose_ros.bags.topics import RecordedTopics, Topics, find_topics
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.type_names import CAMERA_INFO, COMPRESSED_IMAGE, IMAGE, POINT_CLOUD

KINDS = {'i': IMAGE, 'z': COMPRESSED_IMAGE, 'c': CAMERA_INFO, 'p': POINT_CLOUD, 'o': 'std/msg/X'}


def recorded(encodings=None, empty=(), **topics):
    """Topics as kind='name name'; asking for encodings where there are none is an error."""
    summaries = {
        name: TopicSummary(KINDS[kind], 0 if name in empty else 5, '')
        for kind, names in topics.items()
        for name in names.split()
    }

    def ask(names):
        assert encodings is not None, f'the names {names} should have been enough'
        return {name: encodings[name] for name in names if name in encodings}

    return RecordedTopics('bag', summaries, ask)


def test_default_names_are_preferred():
    found = find_topics(
        Topics(),
        recorded(
            i='/depth/image /mask /other/depth/image /other/mask',
            c='/depth/camera_info /other/camera_info',
            p='/ground_truth/skeletons /other/truth',
        ),
    )
    assert found == Topics(
        '/depth/image', '/depth/camera_info', '/mask', '/ground_truth/skeletons'
    )


def test_realsense():
    found = find_topics(
        Topics(),
        recorded(
            i='/camera/color/image_raw /camera/depth/image_rect_raw /camera/infra1/image_rect_raw '
            '/people/segmentation',
            c='/camera/color/camera_info /camera/depth/camera_info /camera/infra1/camera_info',
            p='/camera/depth/color/points',
        ),
    )
    assert found == Topics(
        '/camera/depth/image_rect_raw', '/camera/depth/camera_info', '/people/segmentation', ''
    )


def test_azure_kinect():
    found = find_topics(
        Topics(),
        recorded(i='/depth/image_raw /body_index_map/image_raw /ir/image_raw',
                 c='/depth/camera_info /ir/camera_info'),
    )  # fmt: skip
    assert found[:3] == ('/depth/image_raw', '/depth/camera_info', '/body_index_map/image_raw')


def test_compressed_depth_only():
    found = find_topics(
        Topics(),
        recorded(z='/cam/depth/image_raw/compressedDepth /cam/mask/compressed',
                 c='/cam/depth/camera_info /cam/color/camera_info'),
    )  # fmt: skip
    assert found[:3] == (
        '/cam/depth/image_raw/compressedDepth',
        '/cam/depth/camera_info',
        '/cam/mask/compressed',
    )


def test_image_is_preferred_to_its_compressed_copy():
    found = find_topics(
        Topics(),
        recorded(i='/cam/depth /m/mask', z='/cam/depth/compressedDepth /m/mask/compressed',
                 c='/cam/camera_info'),
    )  # fmt: skip
    assert found[:3] == ('/cam/depth', '/cam/camera_info', '/m/mask')


def test_encoding_decides_if_the_names_do_not():
    offer = recorded(
        {'/a/depth': '16UC1', '/a/depth_colour': 'bgr8'},
        i='/a/depth /a/depth_colour /mask', c='/a/camera_info',
    )  # fmt: skip
    assert find_topics(Topics(), offer).depth == '/a/depth'
    offer = recorded({'/left': 'mono8', '/tof': '32FC1'}, i='/left /tof /mask', c='/camera_info')
    assert find_topics(Topics(), offer)[:2] == ('/tof', '/camera_info')


def test_topics_without_messages_do_not_count():
    offer = recorded(i='/a/depth /b/depth /mask', c='/a/camera_info', empty=['/b/depth'])
    assert find_topics(Topics(), offer).depth == '/a/depth'


def test_names_that_are_given_are_taken():
    offer = recorded(i='/a /b /depth/image', c='/c /d', p='/t')
    assert find_topics(Topics('/a', '/d', '/b', '/t'), offer) == ('/a', '/d', '/b', '/t')


@pytest.mark.parametrize(
    ('topics', 'offer', 'words'),
    [
        (
            Topics(),
            recorded({'/a/depth': '16UC1', '/b/depth': '16UC1'}, i='/a/depth /b/depth /mask'),
            'several topics could be the depth: /a/depth, /b/depth; choose with --depth-topic',
        ),
        (
            Topics(),
            recorded(i='/depth/image /m/label /m/mask', c='/depth/camera_info'),
            'several topics could be the mask: /m/label, /m/mask; choose with --mask-topic',
        ),
        (
            Topics(),
            recorded(i='/a/depth /mask', c='/b/camera_info /c/camera_info'),
            'the camera info: /b/camera_info, /c/camera_info; choose with --camera-info-topic',
        ),
        (
            Topics(),
            recorded(i='/depth/image /mask', c='/depth/camera_info', p='/a/truth /b/truth'),
            'choose with --ground-truth-topic',
        ),
        (Topics(), recorded({'/x': 'bgr8'}, i='/x', c='/camera_info'), 'no depth topic; choose'),
        (Topics(), recorded({}, o='/x'), 'no depth topic; the recording has no messages of'),
        (Topics(), recorded(i='/depth/image /mask'), 'no camera info'),
        (Topics(), recorded(i='/depth/image', c='/depth/camera_info'), 'no mask topic'),
        (
            Topics('/y'),
            recorded(i='/x', c='/c'),
            'no topic /y; choose with --depth-topic among /x',
        ),
        (Topics('/x'), recorded(o='/x', i='/y'), 'the topic /x is a std/msg/X'),
        (Topics(ground_truth='/t'), recorded(i='/depth/image /mask', c='/c'), 'no topic /t'),
    ],
)
def test_what_is_missing_or_ambiguous(topics, offer, words):
    with pytest.raises(InputError) as caught:
        find_topics(topics, offer)
    assert str(caught.value).startswith('bag: ')
    assert words in str(caught.value)


def test_mask_can_be_missing():
    offer = recorded(i='/depth/image', c='/depth/camera_info')
    assert find_topics(Topics(), offer, need_mask=False).mask == ''
