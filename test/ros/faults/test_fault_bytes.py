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

"""Compressed images of random and of damaged bytes."""

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from fault_stream import MEGABYTE, FaultStream, camera_info, mask_of
from sensor_msgs.msg import CompressedImage
from std_msgs.msg import Header
from waiting import wait_until

from lsc_pose_ros.messages.codecs.compressed_depth import encode_compressed_depth
from lsc_pose_ros.messages.codecs.png import write_png

COMPRESSED = {'depth_transport': 'compressedDepth', 'mask_transport': 'compressed'}
RAW = {'depth_transport': 'raw', 'mask_transport': 'raw'}
PNG = '16UC1; compressedDepth png'
RVL = '16UC1; compressedDepth rvl'


class CompressedStreams:
    """The streams to a node that subscribes to compressed images."""

    def __init__(self, stream: FaultStream) -> None:
        self.stream = stream
        node = stream.node
        self.depth = node.create_publisher(CompressedImage, 'depth/image/compressedDepth', 10)
        self.mask = node.create_publisher(CompressedImage, 'mask/compressed', 10)
        publishers = (self.depth, self.mask, stream.info)
        assert wait_until(lambda: all(each.get_subscription_count() for each in publishers))
        stream.taken()
        stream.estimates.wait_for_node()

    def send(
        self, depth: tuple[str, bytes] | None = None, mask: tuple[str, bytes] | None = None
    ) -> Header:
        """Send a frame; each part that is not given is as it should be."""
        stream, frame = self.stream, self.stream.frame
        header = stream.next_header()
        stream.expect(header, frame.camera, frame.depth.shape)
        if depth is None:
            depth = encode_compressed_depth(np.rint(1000 * frame.depth).astype(np.uint16))
        if mask is None:
            mask = 'png', write_png(mask_of(frame.labels))
        for publisher, (text, data) in ((self.depth, depth), (self.mask, mask)):
            message = CompressedImage(header=header, format=text)
            message.data.frombytes(data)
            publisher.publish(message)
        stream.info.publish(camera_info(header, frame.camera, frame.depth.shape))
        return header

    def is_answered(self) -> None:
        """Check that a frame without faults is answered."""
        found = self.stream.wait_for_answer(self.send())
        assert np.isfinite(found.positions).any()


@pytest.fixture(scope='module')
def compressed(fault_stream: FaultStream) -> Iterator[CompressedStreams]:
    fault_stream.configure(**COMPRESSED)
    streams = CompressedStreams(fault_stream)
    yield streams
    for each in (streams.depth, streams.mask):
        fault_stream.node.destroy_publisher(each)
    fault_stream.configure(**RAW)
    fault_stream.connect()
    fault_stream.recovers()


@pytest.fixture
def sender(compressed: CompressedStreams) -> Iterator[CompressedStreams]:
    """After the test, a frame without faults must be answered."""
    compressed.stream.begin()
    yield compressed
    compressed.is_answered()
    compressed.stream.check_answers()


def test_random_bytes_are_refused(sender: CompressedStreams) -> None:
    random = np.random.default_rng(0)
    for number in range(60):
        data = random.bytes(int(random.integers(0, 3000)))
        if number % 2:
            sender.send(depth=((PNG, RVL)[number // 2 % 2], data))
        else:
            sender.send(mask=('png', data))
        sender.stream.taken()
    assert sender.stream.program.prints('PNG')


def test_damaged_images_are_refused_or_answered(sender: CompressedStreams) -> None:
    random = np.random.default_rng(1)
    pixels = np.rint(1000 * sender.stream.frame.depth).astype(np.uint16)
    for number in range(60):
        text, data = encode_compressed_depth(pixels, ('png', 'rvl')[number % 2])
        damaged = np.frombuffer(data, np.uint8).copy()
        places = random.integers(0, len(damaged), 5)
        damaged[places] = random.integers(0, 256, 5)
        cut = int(random.integers(0, len(damaged))) if number % 3 == 0 else len(damaged)
        sender.send(depth=(text, damaged[:cut].tobytes()))
        sender.stream.taken()


def png_header(width: int, height: int, bits: int = 16, colour: int = 0) -> bytes:
    """Return the beginning of a PNG file that claims a size."""
    chunks = [
        (b'IHDR', struct.pack('>IIBBBBB', width, height, bits, colour, 0, 0, 0)),
        (b'IDAT', zlib.compress(bytes(1000))),
        (b'IEND', b''),
    ]
    packed = (
        struct.pack('>I', len(data)) + kind + data + struct.pack('>I', zlib.crc32(kind + data))
        for kind, data in chunks
    )
    return b'\x89PNG\r\n\x1a\n' + b''.join(packed)


def peak(pid: int) -> int:
    """Return the most memory since `forget_peak`, bytes."""
    (line,) = (
        each
        for each in Path(f'/proc/{pid}/status').read_text().splitlines()
        if each.startswith('VmHWM')
    )
    return 1024 * int(line.split()[1])


def forget_peak(pid: int) -> int:
    Path(f'/proc/{pid}/clear_refs').write_text('5')
    return peak(pid)


@pytest.mark.parametrize(
    'size',
    [(10**9, 10**9), (2**31 - 1, 2**31 - 1), (20_000, 20_000), (10_000, 10_000), (1, 10**9)],
    ids=str,
)
def test_headers_that_claim_an_absurd_size_take_no_memory(
    sender: CompressedStreams, size: tuple[int, int]
) -> None:
    sender.is_answered()
    pid = sender.stream.program.pid
    before = forget_peak(pid)
    config = struct.pack('<iff', 1, 0.0, 0.0)
    sender.send(depth=(PNG, config + png_header(*size)))
    sender.send(depth=(PNG, config + png_header(*size, bits=8, colour=6)))
    sender.send(depth=(RVL, config + struct.pack('<II', *size) + bytes(64)))
    sender.send(mask=('png', png_header(*size)))
    sender.is_answered()
    assert peak(pid) - before < 50e6


def test_formats_of_a_megabyte_are_not_repeated(sender: CompressedStreams) -> None:
    pixels = np.rint(1000 * sender.stream.frame.depth).astype(np.uint16)
    _, data = encode_compressed_depth(pixels)
    for _ in range(3):
        for text in (MEGABYTE, f'16UC1; {MEGABYTE}', f'16UC1; compressedDepth {MEGABYTE}'):
            sender.send(depth=(text, data))
        sender.send(mask=(MEGABYTE, b''))
    sender.is_answered()
    assert 'xxxx' in sender.stream.program.output
    assert len(sender.stream.program.output) < 20_000
