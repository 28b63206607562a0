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

"""Samples poses and motion from motion capture clips, for any body."""

import fnmatch
import os
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.synthetic.body.body_file import BodyModel
from lsc_pose_ros.synthetic.body.body_mesh import RestBody
from lsc_pose_ros.synthetic.body.collision_avoidance import resolve_collisions
from lsc_pose_ros.synthetic.geometry.rotations import from_quaternions
from lsc_pose_ros.synthetic.mocap.clip_library import CachedClip, ClipLibrary
from lsc_pose_ros.synthetic.mocap.clip_section import ClipSection, join, resample, within_yaw
from lsc_pose_ros.synthetic.mocap.distinct_poses import pose_distance, reference_joints
from lsc_pose_ros.synthetic.mocap.mocap_mapping import SEGMENTS, load_mapping
from lsc_pose_ros.synthetic.mocap.retarget import retarget_motion
from lsc_pose_ros.synthetic.motion.motion import Motion

_CANDIDATES = 2
"""Number of candidates per pose: the one that differs most from the previous poses is taken."""

_BLEND_SECONDS = 0.5
"""Duration of the transition between two clips, if a motion is longer than one clip."""

_SPREAD_SECONDS = 0.25
"""Time before and after a collision over which its correction is smoothed."""

_SHORTEST_SECONDS = 1.0
"""Shorter runs of valid frames are used only if longer ones are not found."""

_MAX_TRIES = 12
"""Number of tries to find a better candidate."""


class Mocap:
    """Samples motion from motion capture clips."""

    def __init__(self, library: ClipLibrary, clips: Sequence[str]) -> None:
        """Sample from the clips of `library` with the names `clips`; see `load_mocap`."""
        self._library = library
        self.clips = tuple(clips)
        """The clips' names: their paths below the folder, without `.bvh`."""

    def only(self, names: Sequence[str]) -> 'Mocap':
        """Return a selection with only the clips in `names`, which can be patterns such as `05_*`.

        Raises:
            InputError: a name matches no clip.
        """
        return Mocap(self._library, [clip for clip in self.clips if clip in self._named(names)])

    def without(self, names: Sequence[str]) -> 'Mocap':
        """Return a selection without the clips in `names`, which can be patterns such as `05_*`.

        Raises:
            InputError: a name matches no clip, or no clip is left.
        """
        named = self._named(names)
        rest = [clip for clip in self.clips if clip not in named]
        if not rest:
            msg = f'no clip of {self._library.folder} is left; exclude fewer clips'
            raise InputError(msg)
        return Mocap(self._library, rest)

    def _named(self, names: Sequence[str]) -> set[str]:
        named: set[str] = set()
        for name in names:
            found = fnmatch.filter(self.clips, name)
            if not found:
                msg = (
                    f'{name} matches none of the {len(self.clips)} clips in '
                    f'{self._library.folder}, such as {", ".join(self.clips[:5])}'
                )
                raise InputError(msg)
            named.update(found)
        return named

    @cached_property
    def _cumulative_probability(self) -> NDArray[np.float64]:
        """The cumulative probability of the clips.

        The probability is proportional to the square root of the file's size: a longer clip shows
        more, but less than proportionally. The size is known without reading the file.
        """
        sizes = [self._library.files[clip].stat().st_size for clip in self.clips]
        weights = np.cumsum(np.sqrt(np.array(sizes, np.float64)))
        return np.asarray(weights / weights[-1])

    def _choose_clip(self, uniform: float) -> CachedClip:
        number = int(np.searchsorted(self._cumulative_probability, uniform, side='right'))
        return self._library.clip(self.clips[min(number, len(self.clips) - 1)])

    def sample(
        self,
        body: BodyModel,
        rest: RestBody,
        count: int,
        rate: float | None,
        widest_yaw: float,
        random: np.random.Generator,
    ) -> Motion:
        """Sample a person's motion in `count` frames.

        Args:
            body: the body model.
            rest: the person in the rest pose.
            count: number of frames.
            rate: frames per second of a section of one clip, or of several joined ones; None
                samples independent poses from all clips.
            widest_yaw: largest absolute yaw, radians.
            random: the source of randomness.

        Raises:
            InputError: a clip that was sampled cannot be used.
        """
        if rate is None:
            section = self._sample_poses(count, random)
            spread = 0
            yaw = widest_yaw * (2 * random.random(count) - 1)
        else:
            section = self._sample_section(count, rate, random)
            spread = max(1, round(_SPREAD_SECONDS * rate))
            yaw = within_yaw(section.heading, widest_yaw, random)
        orientations = from_quaternions(section.orientations)
        rotations = retarget_motion(body, rest, orientations, shoulders=section.shoulders)
        return Motion(resolve_collisions(body, rest, rotations, spread=spread), yaw)

    def _sample_poses(self, count: int, random: np.random.Generator) -> ClipSection:
        """Sample poses, of two candidates each the one that differs more from the previous ones.

        This is best-candidate sampling (D. Mitchell, Spectrally optimal sampling for distribution
        ray tracing, 1991). The standing pose counts as a previous one.
        """
        taken = [reference_joints(np.broadcast_to(np.eye(3), (1, len(SEGMENTS), 3, 3)))[0]]
        orientations, shoulders = [], True
        for uniforms in random.random((count, _CANDIDATES, _MAX_TRIES, 2)):
            sampled, frames = zip(*(self._sample_pose(tries) for tries in uniforms), strict=True)
            poses = [
                cached.reference_joints[frame]
                for cached, frame in zip(sampled, frames, strict=True)
            ]
            differences = [pose_distance(pose, np.array(taken)) for pose in poses]
            best = int(np.argmax(np.round(differences, 6)))
            taken.append(poses[best])
            clip = sampled[best].clip
            orientations.append(clip.orientations[frames[best]])
            shoulders &= clip.shoulders
        return ClipSection(np.array(orientations, np.float64), np.zeros(count), shoulders)

    def _sample_pose(self, uniforms: NDArray[np.float64]) -> tuple[CachedClip, int]:
        """Sample a distinct frame of a clip; `uniforms` has shape (tries, 2).

        Clips with little movement have few distinct frames, so they are rarely chosen.
        """
        for uniform, position in uniforms:
            cached = self._choose_clip(uniform)
            frame = int(position * len(cached.clip.orientations))
            if frame in cached.distinct:
                return cached, frame
        return cached, int(cached.distinct[int(position * len(cached.distinct))])

    def _sample_section(self, count: int, rate: float, random: np.random.Generator) -> ClipSection:
        """Sample a section of a clip, and append others if it is too short."""
        blend = max(1, round(_BLEND_SECONDS * rate))
        sampled = self._sample_clip_part(count, rate, random)
        while len(sampled.orientations) < count:
            more = self._sample_clip_part(count - len(sampled.orientations) + blend, rate, random)
            sampled = join(
                sampled, more, min(blend, len(sampled.orientations), len(more.orientations))
            )
        return sampled._replace(
            orientations=sampled.orientations[:count], heading=sampled.heading[:count]
        )

    def _sample_clip_part(
        self, count: int, rate: float, random: np.random.Generator
    ) -> ClipSection:
        """Sample at most `count` successive valid frames of a clip."""
        enough = min((count - 1) / rate, _SHORTEST_SECONDS)
        for _ in range(_MAX_TRIES):
            uniforms = random.random(3)
            clip, runs = (cached := self._choose_clip(uniforms[0])).clip, cached.runs
            # The probability of a run is proportional to its length.
            lengths = np.array([last - first for first, last in runs])
            run = np.searchsorted(np.cumsum(lengths), uniforms[1] * lengths.sum(), side='right')
            first, last = runs[int(run)]
            seconds = (last - 1 - first) / clip.rate
            if seconds >= enough:
                break
        frames = min(count, 1 + int(seconds * rate + 1e-6))
        start = first / clip.rate + uniforms[2] * max(seconds - (frames - 1) / rate, 0.0)
        return resample(clip, start + np.arange(frames) / rate)


def load_mocap(
    directory: str | os.PathLike[str], mapping: str | os.PathLike[str] | None = None
) -> Mocap:
    """Return the BVH files in `directory` and its subfolders.

    Args:
        directory: the folder.
        mapping: the mapping file; None is the one for the CMU clips in B. Hahne's conversion.

    Raises:
        InputError: the folder has no BVH file or does not exist, or the mapping is not usable.
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
    return Mocap(ClipLibrary(folder, files, load_mapping(file)), sorted(files))
