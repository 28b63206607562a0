"""What is wrong with the stream of frames, told from counters; no ROS in here."""

from collections.abc import Mapping
from typing import NamedTuple

# A few frames are left out on any computer that has something else to do now and then.
TOLERATED_SHARE = 0.05


class TopicNames(NamedTuple):
    """The full names of the topics that are listened to, for the sentences in the log."""

    depth: str
    camera_info: str
    mask: str


class Counters(NamedTuple):
    """How much has come and gone since the node started.

    Attributes:
        depth: depth images that came.
        masks: masks that came.
        camera_infos: camera infos that came.
        pairs: depth images that found their mask.
        replaced: pairs that gave way to a newer one before they were worked on.
        lost: images that the middleware knows to have lost.
        rewinds: how often the depth images' stamps went back.
    """

    depth: int = 0
    masks: int = 0
    camera_infos: int = 0
    pairs: int = 0
    replaced: int = 0
    lost: int = 0
    rewinds: int = 0


class Situation(NamedTuple):
    """What is known besides the counters.

    Attributes:
        topics: what the node listens to.
        publishers: how many publishers each topic has.
        profile: the path of the Fast DDS profile.
    """

    topics: TopicNames
    publishers: Mapping[str, int]
    profile: str


def complaints(before: Counters, now: Counters, situation: Situation) -> dict[str, str]:
    """Return what has gone wrong between two readings of the counters.

    Returns:
        a sentence with the remedy for each kind of trouble; a kind keeps its name while it lasts.
    """
    gained = Counters(*(new - old for new, old in zip(now, before, strict=True)))
    topics = situation.topics
    found = {
        'silence': _silence(gained, now, situation),
        'no pairs': _no_pairs(gained, topics),
        'loss': _loss(gained, situation.profile),
        'rewind': _rewind(gained, topics),
        'overload': _overload(gained),
    }
    return {kind: text for kind, text in found.items() if text}


def _silence(gained: Counters, now: Counters, situation: Situation) -> str:
    """Name the topics on which nothing comes; of camera infos, one is enough."""
    topics = situation.topics
    came = {
        topics.depth: gained.depth,
        topics.camera_info: now.camera_infos,
        topics.mask: gained.masks,
    }
    silent = [
        f'{topic} ({situation.publishers.get(topic, 0)} publishers)'
        for topic, count in came.items()
        if not count
    ]
    if not silent:
        return ''
    return f'nothing comes on {", ".join(silent)}; remap the node to the topics that you have'


def _no_pairs(gained: Counters, topics: TopicNames) -> str:
    if gained.pairs or not (gained.depth and gained.masks):
        return ''
    return (
        f'no mask of {topics.mask} has the stamp of an image of {topics.depth}; publish masks '
        'with the stamp of their depth image, or set the parameters sync_slop and sync_queue'
    )


def _loss(gained: Counters, profile: str) -> str:
    if not gained.lost:
        return ''
    return (
        f'the middleware lost {gained.lost} images, with {gained.depth + gained.masks} received; '
        f'start their publishers with FASTRTPS_DEFAULT_PROFILES_FILE={profile}, or set the '
        'parameter reliability to reliable where the publishers are reliable'
    )


def _rewind(gained: Counters, topics: TopicNames) -> str:
    if not gained.rewinds:
        return ''
    return (
        f'the stamps of {topics.depth} went back, so pairing began anew: a recording was played '
        'again, or two publishers share the topic'
    )


def _overload(gained: Counters) -> str:
    if gained.replaced <= TOLERATED_SHARE * gained.pairs:
        return ''
    return (
        f'{gained.replaced} of {gained.pairs} frames were left out because newer ones came '
        'before they were worked on: they come faster than they can be estimated'
    )
