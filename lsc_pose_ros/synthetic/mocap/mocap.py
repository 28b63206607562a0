"""People who move as others did: motion capture clips brought onto any body."""

import fnmatch
import os
from collections import OrderedDict
from collections.abc import Mapping, Sequence
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.synthetic.body.body_file import Body
from lsc_pose_ros.synthetic.body.body_mesh import Rest
from lsc_pose_ros.synthetic.body.collision_avoidance import push_out
from lsc_pose_ros.synthetic.mocap.mocap_clip import Clip, read_clip
from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS, MocapMapping, load_mapping
from lsc_pose_ros.synthetic.mocap.retarget import bone_rotations
from lsc_pose_ros.synthetic.motion.motion import Motion
from lsc_pose_ros.synthetic.motion.rotations import (
    arc,
    continuous,
    from_quaternions,
    slerp,
)

APART = 0.05
"""Metres by which some joint must differ between any two poses that are kept of a clip.

As in J. Shotton et al., Real-time human pose recognition in parts from single depth images, 2011.
"""

_CANDIDATES = 2
"""Poses that are drawn for each that is taken: the one more unlike those taken before."""

_BLEND_SECONDS = 0.5
"""How long one clip goes over into the next where a motion is longer than the clip."""

_SPREAD_SECONDS = 0.25
"""How long before and after it would go through the body a limb gives way."""

_SHORTEST_SECONDS = 1.0
"""Stretches shorter than this are taken only where there are no others."""

_TRIES = 12
"""How often something better is looked for before what was drawn is taken."""

_KEPT_CLIPS = 256
"""Clips that are kept in memory."""


class _Stretch(NamedTuple):
    """Frames of motion, as `Clip` has them; whether it has shoulders of its own."""

    turns: NDArray[np.float64]
    heading: NDArray[np.float64]
    shoulders: bool


class _Library:
    """The clips below a folder, read when they are needed."""

    def __init__(self, folder: Path, files: Mapping[str, Path], mapping: MocapMapping) -> None:
        self.folder = folder
        self.files = files
        self._mapping = mapping
        self._read: OrderedDict[str, _KeptClip] = OrderedDict()

    def clip(self, name: str) -> '_KeptClip':
        """Return a clip, read it first if need be."""
        if name not in self._read:
            self._read[name] = _KeptClip(read_clip(self.files[name], self._mapping))
            if len(self._read) > _KEPT_CLIPS:
                self._read.popitem(last=False)
        self._read.move_to_end(name)
        return self._read[name]


class _KeptClip:
    """A clip and what is worked out from it once."""

    def __init__(self, clip: Clip) -> None:
        self.clip = clip

    @cached_property
    def outlines(self) -> NDArray[np.float64]:
        """Where the joints of an average person are in each frame, shape (T, 14, 3)."""
        return outline(from_quaternions(self.clip.turns.astype(np.float64)))

    @cached_property
    def distinct(self) -> NDArray[np.intp]:
        """The sound frames in which poses differ by at least `APART`."""
        return distinct_poses(self.outlines, np.flatnonzero(self.clip.sound), APART)

    @cached_property
    def runs(self) -> list[tuple[int, int]]:
        """Sound frames without a break, first and past the last, the longest first."""
        edges = np.flatnonzero(np.diff(np.concatenate([[0], self.clip.sound, [0]])))
        runs = [(int(first), int(last)) for first, last in edges.reshape(-1, 2)]
        return sorted(runs, key=lambda run: run[0] - run[1])


class Mocap:
    """Motion capture clips, and motion drawn from them."""

    def __init__(self, library: _Library, clips: Sequence[str]) -> None:
        """Draw from those in `library` whose names are `clips`; see `load_mocap`."""
        self._library = library
        self.clips = tuple(clips)
        """The clips' names: their paths below the folder, without `.bvh`."""

    def only(self, names: Sequence[str]) -> 'Mocap':
        """Return the same with only the clips that `names` names; `05_*` names all of a kind.

        Raises:
            InputError: a name names no clip.
        """
        return Mocap(self._library, [clip for clip in self.clips if clip in self._named(names)])

    def without(self, names: Sequence[str]) -> 'Mocap':
        """Return the same without the clips that `names` names.

        Raises:
            InputError: a name names no clip, or all clips are named.
        """
        named = self._named(names)
        rest = [clip for clip in self.clips if clip not in named]
        if not rest:
            msg = f'no clip of {self._library.folder} is left; name fewer'
            raise InputError(msg)
        return Mocap(self._library, rest)

    def _named(self, names: Sequence[str]) -> set[str]:
        named: set[str] = set()
        for name in names:
            found = fnmatch.filter(self.clips, name)
            if not found:
                msg = (
                    f'{name} names none of the {len(self.clips)} clips in '
                    f'{self._library.folder}, which are {", ".join(self.clips[:5])} …'
                )
                raise InputError(msg)
            named.update(found)
        return named

    @cached_property
    def _chances(self) -> NDArray[np.float64]:
        """How likely each clip or one before it is drawn.

        By the root of the file's size: a long clip shows more than a short one, but seldom as
        much more as it is longer. Only the size, so that nothing needs to be read for it.
        """
        sizes = [self._library.files[clip].stat().st_size for clip in self.clips]
        chances = np.cumsum(np.sqrt(np.array(sizes, np.float64)))
        return np.asarray(chances / chances[-1])

    def _choose(self, chance: float) -> _KeptClip:
        number = int(np.searchsorted(self._chances, chance, side='right'))
        return self._library.clip(self.clips[min(number, len(self.clips) - 1)])

    def draw(
        self,
        body: Body,
        rest: Rest,
        count: int,
        rate: float | None,
        widest_yaw: float,
        random: np.random.Generator,
    ) -> Motion:
        """Draw what a person does in `count` frames.

        Args:
            body: the body.
            rest: the person at rest.
            count: frames.
            rate: frames a second, of a stretch of a clip, or of more than one where it is too
                short; None: poses from all clips, each on its own.
            widest_yaw: the person never faces further aside than this, radians.
            random: the source of chance.

        Raises:
            InputError: a clip that was drawn cannot be used.
        """
        if rate is None:
            stretch = self._draw_poses(count, random)
            spread = 0
            yaw = widest_yaw * (2 * random.random(count) - 1)
        else:
            stretch = self._draw_stretch(count, rate, random)
            spread = max(1, round(_SPREAD_SECONDS * rate))
            yaw = within_yaw(stretch.heading, widest_yaw, random)
        turns = from_quaternions(stretch.turns)
        rotations = bone_rotations(body, rest, turns, shoulders=stretch.shoulders)
        return Motion(push_out(body, rest, rotations, spread=spread), yaw)

    def _draw_poses(self, count: int, random: np.random.Generator) -> _Stretch:
        """Draw poses, of two each time the one that is more unlike standing and those before.

        (D. Mitchell, Spectrally optimal sampling for distribution ray tracing, 1991.)
        """
        taken = [outline(np.broadcast_to(np.eye(3), (1, len(SEGMENTS), 3, 3)))[0]]
        turns, shoulders = [], True
        for chances in random.random((count, _CANDIDATES, _TRIES, 2)):
            drawn, frames = zip(*(self._draw_pose(tries) for tries in chances), strict=True)
            outlines = [kept.outlines[frame] for kept, frame in zip(drawn, frames, strict=True)]
            differences = [nearest(pose, np.array(taken)) for pose in outlines]
            best = int(np.argmax(np.round(differences, 6)))
            taken.append(outlines[best])
            clip = drawn[best].clip
            turns.append(clip.turns[frames[best]])
            shoulders &= clip.shoulders
        return _Stretch(np.array(turns, np.float64), np.zeros(count), shoulders)

    def _draw_pose(self, chances: NDArray[np.float64]) -> tuple[_KeptClip, int]:
        """Draw a frame that is not like one before it in its clip; `chances` is (tries, 2).

        Clips in which little happens are so drawn seldom.
        """
        for chance, within in chances:
            kept = self._choose(chance)
            frame = int(within * len(kept.clip.turns))
            if frame in kept.distinct:
                return kept, frame
        return kept, int(kept.distinct[int(within * len(kept.distinct))])

    def _draw_stretch(self, count: int, rate: float, random: np.random.Generator) -> _Stretch:
        """Draw a stretch of a clip; where it is too short, others follow."""
        blend = max(1, round(_BLEND_SECONDS * rate))
        drawn = self._draw_part(count, rate, random)
        while len(drawn.turns) < count:
            more = self._draw_part(count - len(drawn.turns) + blend, rate, random)
            drawn = join(drawn, more, min(blend, len(drawn.turns), len(more.turns)))
        return drawn._replace(turns=drawn.turns[:count], heading=drawn.heading[:count])

    def _draw_part(self, count: int, rate: float, random: np.random.Generator) -> _Stretch:
        """Draw at most `count` frames of a clip, from where it is without a break."""
        enough = min((count - 1) / rate, _SHORTEST_SECONDS)
        for _ in range(_TRIES):
            chances = random.random(3)
            clip, runs = (kept := self._choose(chances[0])).clip, kept.runs
            # Long runs are as likely as they are long.
            lengths = np.array([last - first for first, last in runs])
            run = np.searchsorted(np.cumsum(lengths), chances[1] * lengths.sum(), side='right')
            first, last = runs[int(run)]
            seconds = (last - 1 - first) / clip.rate
            if seconds >= enough:
                break
        frames = min(count, 1 + int(seconds * rate + 1e-6))
        start = first / clip.rate + chances[2] * max(seconds - (frames - 1) / rate, 0.0)
        return resample(clip, start + np.arange(frames) / rate)


def load_mocap(
    directory: str | os.PathLike[str], mapping: str | os.PathLike[str] | None = None
) -> Mocap:
    """Return the BVH files in `directory` and the folders in it.

    Args:
        directory: the folder.
        mapping: the file that says what their joints stand for; None: that for the CMU clips in
            B. Hahne's conversion.

    Raises:
        InputError: there is no such folder, no BVH file in it, or no usable mapping.
    """
    folder = Path(directory)
    files = {
        path.relative_to(folder).with_suffix('').as_posix(): path
        for path in folder.rglob('*')
        if path.suffix.lower() == '.bvh'
    }
    if not files:
        msg = f'there is no BVH file in {folder}; give a folder of files *.bvh'
        raise InputError(msg)
    file = resource('config', 'mocap', 'cmu.yaml') if mapping is None else Path(mapping)
    return Mocap(_Library(folder, files, load_mapping(file)), sorted(files))


def resample(clip: Clip, times: NDArray[np.float64]) -> _Stretch:
    """Return the motion of `clip` at `times`, seconds from its first frame."""
    frames = np.clip(times * clip.rate, 0, len(clip.turns) - 1)
    before = np.minimum(frames.astype(np.intp), max(len(clip.turns) - 2, 0))
    after = np.minimum(before + 1, len(clip.turns) - 1)
    turns = clip.turns.astype(np.float64)
    share = frames - before
    return _Stretch(
        slerp(turns[before], turns[after], share[:, None]),
        np.asarray(np.interp(frames, np.arange(len(clip.turns)), clip.heading)),
        clip.shoulders,
    )


def join(first: _Stretch, second: _Stretch, blend: int) -> _Stretch:
    """Return `second` after `first`: over `blend` frames, the one goes over into the other."""
    u = (np.arange(blend) + 1) / (blend + 1)
    share = u * u * (3 - 2 * u)
    # The person goes on facing where the first one ends.
    heading = second.heading - second.heading[0] + first.heading[-blend]
    start = len(first.turns) - blend
    leaving, coming = continuous(first.turns[start:]), continuous(second.turns[:blend])
    # The shorter way is chosen once: on the way, the other may become the shorter one.
    opposite = (leaving[blend // 2] * coming[blend // 2]).sum(axis=-1, keepdims=True) < 0
    coming = np.where(opposite, -coming, coming)
    return _Stretch(
        np.concatenate(
            [first.turns[:start], arc(leaving, coming, share[:, None]), second.turns[blend:]]
        ),
        np.concatenate(
            [
                first.heading[:start],
                (1 - share) * first.heading[start:] + share * heading[:blend],
                heading[blend:],
            ]
        ),
        first.shoulders and second.shoulders,
    )


def within_yaw(
    heading: NDArray[np.float64], widest: float, random: np.random.Generator
) -> NDArray[np.float64]:
    """Return `heading`, radians, shape (T,), turned by chance so that it stays within ±`widest`.

    A person who turns further than that turns by as much less as is needed.
    """
    chance = random.random()
    middle = (heading.max() + heading.min()) / 2
    half = float(np.ptp(heading)) / 2
    spare = widest - half
    turned = (heading - middle) * (1.0 if spare >= 0 else widest / half)
    if widest >= np.pi:
        return np.asarray(heading - middle + np.pi * (2 * chance - 1))
    moved = turned + max(spare, 0.0) * (2 * chance - 1)
    return np.asarray(np.clip(moved, -widest, widest))


def distinct_poses(
    outlines: NDArray[np.float64], frames: NDArray[np.intp], apart: float
) -> NDArray[np.intp]:
    """Return those of `frames` whose poses all differ by at least `apart` metres, in order."""
    kept = [int(frames[0])]
    for frame in frames[1:]:
        if np.round(nearest(outlines[frame], outlines[kept]), 6) >= apart:
            kept.append(int(frame))
    return np.array(kept)


def nearest(pose: NDArray[np.float64], others: NDArray[np.float64]) -> float:
    """Return the least difference of `pose`, (J, 3), from others, (N, J, 3), metres.

    Poses differ by as far as that joint has moved which moved farthest.
    """
    moved = ((others - pose) ** 2).sum(axis=-1).max(axis=-1)
    return float(np.sqrt(moved.min()))


# Of a person of 1.70 m, by R. Drillis and R. Contini, Body segment parameters, 1966: where each
# segment begins on its parent, in its parent's frame, and where it ends in its own, metres.
_OUTLINE: tuple[tuple[str, str, tuple[float, float, float], tuple[float, float, float]], ...] = (
    ('chest', 'pelvis', (0.0, 0.16, 0.0), (0.0, 0.33, 0.0)),
    ('head', 'chest', (0.0, 0.33, 0.0), (0.0, 0.22, 0.0)),
    *(
        (f'{letter}_{name}', f'{letter}_{parent}' if parent not in ('chest', 'pelvis') else parent,
         start, (0.0, -length, ahead))
        for letter, side in (('l', 1.0), ('r', -1.0))
        for name, parent, start, length, ahead in (
            ('upper_arm', 'chest', (side * 0.22, 0.27, 0.0), 0.316, 0.0),
            ('forearm', 'upper_arm', (0.0, -0.316, 0.0), 0.248, 0.0),
            ('hand', 'forearm', (0.0, -0.248, 0.0), 0.184, 0.0),
            ('thigh', 'pelvis', (side * 0.09, 0.0, 0.0), 0.417, 0.0),
            ('shank', 'thigh', (0.0, -0.417, 0.0), 0.418, 0.0),
            ('foot', 'shank', (0.0, -0.418, 0.0), 0.06, 0.19),
        )
    ),
)  # fmt: skip


def outline(turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return where segments of an average person end, metres, shape (T, 14, 3).

    Args:
        turns: of all segments, shape (T, S, 3, 3).
    """
    starts: dict[str, NDArray[np.float64]] = {'pelvis': np.zeros((len(turns), 3))}
    ends = []
    for name, parent, start, end in _OUTLINE:
        turn = turns[:, SEGMENTS.index(parent)]
        starts[name] = starts[parent] + turn @ np.array(start)
        ends.append(starts[name] + turns[:, SEGMENTS.index(name)] @ np.array(end))
    return np.stack(ends, axis=1)
