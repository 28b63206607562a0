"""A recording as frames: what training, evaluation, replay and the pictures read."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from lsc_pose_ros.bags.serialization.deserialize import (
    DamagedMessageError,
    read_camera_info,
    read_compressed_image,
    read_image,
    read_skeletons,
)
from lsc_pose_ros.bags.storage.reader import RecordingReader
from lsc_pose_ros.bags.storage.serialized_messages import ReadStatistics, SerializedMessage
from lsc_pose_ros.bags.topics import RecordedTopics, Topics, find_topics
from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.messages.frames import make_frame
from lsc_pose_ros.messages.image_pixels import AnyImage
from lsc_pose_ros.messages.parse import StampedImage
from lsc_pose_ros.messages.type_names import IMAGE
from lsc_pose_ros.synchronization.frame_assembly import Assembled, Assembly

# How far a recording is read to learn the encodings of its images.
_MOST_PEEKED = 5000

_ALL_TO_FIND = Topics()


class FrameReader:
    """The frames of a recording; each iteration starts anew and needs little memory.

    Attributes:
        path: the file or the bag folder.
        topics: the topics that the frames are made of; '' where there is none.
        warnings: a sentence for each thing that is wrong with the recording; the list grows
            while it is read and starts anew with each iteration.
    """

    def __init__(self, raw: RecordingReader, topics: Topics, mask_background: int) -> None:
        """Read frames from `raw`; `open_recording` is the way to make one."""
        self._raw = raw
        self._background = mask_background
        self.path = raw.path
        self.topics = topics
        self.warnings = raw.warnings

    @property
    def count(self) -> int | None:
        """How many depth images the recording says it has, None where it does not say."""
        return self._raw.topics[self.topics.depth].count

    @property
    def statistics(self) -> ReadStatistics:
        """What the running or last iteration has read, of all topics."""
        return self._raw.statistics

    def __iter__(self) -> Iterator[Frame]:
        """Yield the frames in the order of their arrival.

        Raises:
            InputError: a message cannot be used, or there is no complete frame at all.
        """
        reading = _Reading(self._raw, self.topics)
        frames = 0
        for assembled in reading.assembled():
            frames += 1
            yield self._frame(assembled)
        self.warnings.extend(reading.warnings())
        if frames == 0:
            raise InputError(self._no_frame(reading))

    def _frame(self, assembled: Assembled[AnyImage]) -> Frame:
        if assembled.camera is None:
            msg = 'a frame without camera info must not be released'
            raise AssertionError(msg)
        try:
            return make_frame(
                assembled.depth,
                assembled.mask,
                assembled.camera,
                assembled.ground_truth,
                topics=self.topics,
                mask_background=self._background,
            )
        except InputError as error:
            msg = f'{self.path}: topic {error}'
            raise InputError(msg) from error

    def _no_frame(self, reading: '_Reading') -> str:
        """Say why there is no frame."""
        counts = reading.counts
        used = [topic for topic in self.topics[:3] if topic]
        empty = [topic for topic in used if not counts[topic]]
        if empty:
            why = f'there is no usable message of {", ".join(empty)}'
        elif reading.assembly.without_camera:
            why = f'no camera info of {self.topics.camera_info} came in time'
        else:
            why = f'no mask of {self.topics.mask} has the stamp of a depth image'
        return '; '.join([f'{self.path}: no frame could be read: {why}', *self.warnings])


class _Reading:
    """One pass through a recording."""

    def __init__(self, raw: RecordingReader, topics: Topics) -> None:
        self._raw = raw
        self._topics = topics
        self._damaged: Counter[str] = Counter()
        self.counts: Counter[str] = Counter()
        self.assembly: Assembly[AnyImage] = Assembly(
            with_mask=bool(topics.mask), with_ground_truth=bool(topics.ground_truth)
        )

    def assembled(self) -> Iterator[Assembled[AnyImage]]:
        wanted = frozenset(filter(None, self._topics))
        for message in self._raw:
            if message.topic in wanted:
                yield from self._add(message)
        yield from self.assembly.finish()

    def warnings(self) -> list[str]:
        """Return a sentence for each kind of thing that was left out."""
        pairing, topics = self.assembly.pairing, self._topics
        return [
            *(
                f'{count} damaged messages of {topic} were left out'
                for topic, count in self._damaged.items()
            ),
            *_left_out(pairing.dropped_depth, topics.depth, f'have no mask in {topics.mask}'),
            *_left_out(pairing.dropped_mask, topics.mask, f'have no image in {topics.depth}'),
            *_left_out(pairing.duplicates, 'the images', 'repeat the stamp of another'),
            *_left_out(
                self.assembly.without_camera,
                topics.depth,
                f'came long before the first camera info of {topics.camera_info}',
            ),
        ]

    def _add(self, message: SerializedMessage) -> list[Assembled[AnyImage]]:
        try:
            frames = self._dispatch(message)
        except DamagedMessageError:
            self._damaged[message.topic] += 1
            return []
        except InputError as error:
            msg = f'{self._raw.path}: topic {message.topic}: {error}'
            raise InputError(msg) from error
        self.counts[message.topic] += 1
        return frames

    def _dispatch(self, message: SerializedMessage) -> list[Assembled[AnyImage]]:
        topics = self._topics
        if message.topic == topics.depth:
            depth = _read(message)
            return self.assembly.add_depth(depth.stamp, depth)
        if message.topic == topics.mask:
            mask = _read(message)
            return self.assembly.add_mask(mask.stamp, mask)
        if message.topic == topics.camera_info:
            return self.assembly.add_camera(read_camera_info(message.data))
        ground_truth = read_skeletons(message.data)
        return self.assembly.add_ground_truth(ground_truth.stamp, ground_truth.skeletons)


def open_recording(
    path: Path | str,
    topics: Topics = _ALL_TO_FIND,
    *,
    mask_background: int = 0,
    need_mask: bool = True,
) -> FrameReader:
    """Open a recording for reading its frames.

    Args:
        path: an .mcap or .db3 file (compressed as .zstd or not), or a bag folder.
        topics: the topics' names; each '' is found by type and name.
        mask_background: the mask's pixel value that means no body.
        need_mask: if False, a recording without masks gives frames whose labels are all NO_BODY.

    Raises:
        InputError: there is no recording, or a topic is missing or ambiguous.
    """
    raw = RecordingReader(path)
    recorded = RecordedTopics(str(raw.path), raw.topics, lambda names: _encodings(raw, names))
    if not any(topic.count != 0 for topic in raw.topics.values()):
        list(raw)  # for what it warns of
        raise InputError('; '.join([f'{path}: the recording has no messages', *raw.warnings]))
    found = find_topics(topics, recorded, need_mask=need_mask)
    return FrameReader(raw, found, mask_background)


def _read(message: SerializedMessage) -> AnyImage:
    if message.type_name == IMAGE:
        return read_image(message.data)
    return read_compressed_image(message.data)


def _encodings(raw: RecordingReader, names: Sequence[str]) -> Mapping[str, str]:
    """Return the encoding of the first image of each topic in `names`."""
    encodings: dict[str, str] = {}
    for number, message in enumerate(raw):
        if number > _MOST_PEEKED or len(encodings) == len(names):
            break
        if message.topic in names and message.topic not in encodings:
            try:
                image = _read(message)
            except DamagedMessageError:
                continue
            encodings[message.topic] = (
                image.layout.encoding if isinstance(image, StampedImage) else image.format
            )
    return encodings


def _left_out(count: int, what: str, why: str) -> list[str]:
    return [f'{count} of {what} were left out: they {why}'] if count else []
