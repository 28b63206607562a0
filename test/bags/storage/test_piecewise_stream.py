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

"""No length in a damaged file allocates more than the file holds."""

import io
import tracemalloc

import pytest

from lsc_pose_ros.bags import RecordingWriter, read_messages
from lsc_pose_ros.bags.storage.piecewise_stream import PiecewiseStream

DATA = bytes(range(256)) * 10_000


@pytest.mark.parametrize('size', [0, 1, 1000, 1 << 20, (1 << 20) + 1, 2_000_000, 1 << 40, -1])
def test_the_same_bytes_are_read(size):
    stream, plain = PiecewiseStream(io.BytesIO(DATA)), io.BytesIO(DATA)
    for _ in range(3):
        assert stream.read(size) == plain.read(min(size, len(DATA)))
        assert stream.tell() == plain.tell()
    stream.seek(5)
    assert stream.read(3) == DATA[5:8]
    assert stream.seekable()


def test_claimed_lengths_allocate_nothing(tmp_path, simple_frames):
    """A byte of a topic's name is missing in the summary, so the next length is read too early."""
    path = tmp_path / 'k.mcap'
    with RecordingWriter(path) as writer:
        for frame in simple_frames:
            writer.write_frame(frame)
    data = path.read_bytes()
    place = data.rindex(b'/ground_truth/skeletons')
    path.write_bytes(data[:place] + data[place + 1 :])
    tracemalloc.start()
    try:
        assert len(list(read_messages(path))) == 4 * len(simple_frames)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < 64 << 20
