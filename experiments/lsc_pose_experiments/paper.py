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

"""The paper's tables and figures, each a definition; its numbers are those that its text gives.

He, Wang, Liao, Xue: Depth-images-based pose estimation using regression forests and graphical
models, Neurocomputing 164 (2015), section 4. THU and Stanford are its two data sets; neither is
public.
"""

from collections.abc import Callable
from typing import NamedTuple

from lsc_pose_experiments import claims
from lsc_pose_experiments.experiment import (
    LIMB_ENDS,
    MEAN,
    SIZES,
    Axis,
    Experiment,
    Variant,
)
from lsc_pose_experiments.trial import Score, Trial
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.training.train import TrainingSettings
from lsc_pose_ros.training.tree_growth import GrowthSettings

_THU = Score(0.036, 0.952)
_STANFORD = Score(0.035, 0.982)

OURS = 'ours (3DLSC + graph)'
_GIRSHICK = 'Girshick et al.'


class Scope(NamedTuple):
    """How much is measured.

    Attributes:
        training: what is trained where nothing else is said.
        frames: how many frames are learnt from, where nothing else is said.
        points: N of Fig. 12; the middle one of the paper's claim is 400.
        few_points: from how many on the accuracy is said to be stable.
        votes: M of Fig. 14.
        few_votes: likewise.
    """

    training: TrainingSettings
    frames: int = 3600
    points: tuple[int, ...] = tuple(range(100, 901, 100))
    few_points: int = 400
    votes: tuple[int, ...] = (1, 2, 5, 10, 20, 50, 100, 200, 300, 500)
    few_votes: int = 100


def full_scope(seed: int) -> Scope:
    """Return what the paper measures."""
    settings = Settings(offset_seed=seed)
    return Scope(TrainingSettings(numbers_of(DEFAULT_JOINTS), settings, seed=seed))


def quick_scope(seed: int) -> Scope:
    """Return as little of it as still uses every part, for a minute on a small machine."""
    settings = Settings(points=80, query_points=80, offset_seed=seed)
    training = TrainingSettings(
        numbers_of(DEFAULT_JOINTS),
        settings,
        trees=2,
        growth=GrowthSettings(depth=9),
        seed=seed,
    )
    return Scope(
        training, frames=60, points=(40, 80, 160), few_points=80, votes=(1, 20, 200), few_votes=20
    )


def _trial(scope: Scope, *, graph: bool = True, **settings: float | str) -> Trial:
    changed = scope.training.settings._replace(**settings)  # type: ignore[arg-type]
    return Trial(scope.training._replace(settings=changed), scope.frames, graph)


def _girshick(scope: Scope) -> Trial:
    return _trial(scope, graph=False, feature='dcf', sample='body')


def table1(scope: Scope) -> Experiment:
    """Hand, head and foot within 0.2 m."""
    joints = numbers_of([*DEFAULT_JOINTS, 'l_foot', 'r_foot'])
    trial = Trial(scope.training._replace(joints=joints), scope.frames)
    reported = {'hands': 0.997, 'head': 1.0, 'feet': 0.997}
    others = {'hands': 0.870, 'head': 0.800, 'feet': 0.990}
    li = 'Li et al. (endpoints)'
    return Experiment(
        'table1',
        'Table 1: hand, head and foot within 0.2 m',
        'The feet are learnt besides the other joints. Paper: Stanford. The rival detects these '
        'three endpoints only; its numbers are those that it reports.',
        (
            Variant(li, None, {part: Score(None, share) for part, share in others.items()}),
            Variant(OURS, trial, {part: Score(None, share) for part, share in reported.items()}),
        ),
        (
            claims.part_reaches(
                OURS, others, 0.2, 'Hand, head and foot are found more often than by Li et al.'
            ),
            claims.part_reaches(
                OURS, reported, 0.2, 'As often as in the paper: 99.7, 100 and 99.7 %.'
            ),
        ),
        ('hands', 'head', 'feet'),
        tolerance=0.2,
    )


def table2(scope: Scope) -> Experiment:
    """The features."""
    labels = '3DLSC', 'DCF', '2DSC'
    features = zip(labels, ('3dlsc', 'dcf', '2dsc'), (0.982, 0.976, 0.876), strict=True)
    return Experiment(
        'table2',
        'Table 2: the feature',
        'What the forest sees of a point; all else, the graph too, stays. Paper: Stanford.',
        tuple(
            Variant(label, _trial(scope, feature=feature), {MEAN: Score(None, share)})
            for label, feature, share in features
        ),
        (
            claims.better('3DLSC', '2DSC', '3DLSC is better than 2DSC (paper: by 10.6 points).'),
            claims.better('3DLSC', 'DCF', '3DLSC is better than DCF (paper: by 0.6 points).'),
            claims.better('DCF', '2DSC', 'DCF is better than 2DSC (paper: by 10.0 points).'),
        ),
    )


def fig6(scope: Scope) -> Experiment:
    """Joint by joint against Girshick et al., THU."""
    return Experiment(
        'fig6',
        'Fig. 6: joint by joint, beside Girshick et al. (THU)',
        'Girshick et al. is DCF on points of the whole body and each joint by itself, in the same '
        "forest. Paper: THU; of its curves the text gives the mean of the paper's own method.",
        (
            Variant(OURS, _trial(scope), {MEAN: _THU}),
            Variant(_GIRSHICK, _girshick(scope)),
        ),
        (
            claims.better(OURS, _GIRSHICK, 'Better than Girshick et al.'),
            claims.more_at_limb_ends(
                OURS, _GIRSHICK, 'The gain is remarkable at limb ends: elbow, wrist and hand.'
            ),
            claims.reaches(OURS, 0.952, 0.036, "As good as the paper's: 95.2 % and 3.6 cm."),
        ),
    )


def fig7(scope: Scope) -> Experiment:
    """Joint by joint against Girshick et al., Stanford."""
    same = fig6(scope)
    first, second = same.variants
    return same._replace(
        name='fig7',
        title='Fig. 7: joint by joint, beside Girshick et al. (Stanford)',
        what="As Fig. 6, beside the paper's numbers on Stanford. Its caption is not in the text; "
        'section 4.4 names this comparison.',
        variants=(first._replace(paper={MEAN: _STANFORD}), second),
        claims=(
            *same.claims[:2],
            claims.reaches(OURS, 0.982, 0.035, "As good as the paper's: 98.2 % and 3.5 cm."),
        ),
    )


def fig8(scope: Scope) -> Experiment:
    """Joint by joint beside what others report."""
    return Experiment(
        'fig8',
        'Fig. 8: joint by joint, beside what others report (Stanford)',
        'The paper sets its own results beside those that Shotton et al. and Ganapathi et al. '
        'report on Stanford. Their numbers are not in the text, and their programs are not part '
        'of it, so that only our own method stands here.',
        (Variant(OURS, _trial(scope), {MEAN: _STANFORD}),),
        (claims.reaches(OURS, 0.982, 0.035, "As good as the paper's: 98.2 % and 3.5 cm."),),
    )


def fig9(scope: Scope) -> Experiment:
    """With and without the graph."""
    alone = 'without the graph'
    return Experiment(
        'fig9',
        'Fig. 9: with and without the graph',
        'The same forest; without the graph each joint is the highest mode of its own density. '
        'Paper: Stanford.',
        (
            Variant(OURS, _trial(scope), {MEAN: _STANFORD}),
            Variant(alone, _trial(scope, graph=False), {MEAN: Score(0.045, 0.942)}),
        ),
        (
            claims.better(OURS, alone, 'The graph helps (paper: 4.0 points, 1.0 cm).'),
            claims.more_at_limb_ends(OURS, alone, 'It helps most at elbow, wrist and hand.'),
        ),
    )


def fig11(scope: Scope) -> Experiment:
    """The two smoothings."""
    rough, single = 'without Gaussian filtering', 'without multi-binning'
    return Experiment(
        'fig11',
        'Fig. 11: Gaussian filtering and multi-binning',
        'Without filtering eq. 1 leaves the depth as it is; without multi-binning each point '
        "counts in one bin of the descriptor alone, not in eight (eq. 4). The figure's numbers "
        'are not in the text.',
        (
            Variant(OURS, _trial(scope)),
            Variant(rough, _trial(scope, smoothing_sigma=0.0)),
            Variant(single, _trial(scope, binning='nearest')),
        ),
        (
            claims.better(OURS, rough, 'Worse without Gaussian filtering.'),
            claims.better(OURS, single, 'Worse without multi-binning.'),
            claims.larger_drop(OURS, single, rough, 'Multi-binning matters more.'),
        ),
    )


def fig12(scope: Scope) -> Experiment:
    """The number of silhouette points."""
    reported = {100: Score(0.051, 0.928), 400: Score(0.036, 0.952)}
    labels = [str(count) for count in scope.points]
    few = str(scope.few_points)
    return Experiment(
        'fig12',
        'Fig. 12: the number N of silhouette points',
        'Forests are trained anew for each N, and all N points vote. Paper: THU.',
        tuple(
            Variant(
                label,
                _trial(scope, points=count, query_points=count),
                {MEAN: reported[count]} if count in reported else {},
                count,
            )
            for label, count in zip(labels, scope.points, strict=True)
        ),
        (
            claims.better(few, labels[0], f'{few} points are far better than {labels[0]}.'),
            claims.level(labels[labels.index(few) :], f'From {few} points on it is stable.'),
        ),
        axis=Axis('silhouette points N'),
    )


def fig13(scope: Scope) -> Experiment:
    """The unit of votes."""
    own = 'normalised (each body its own)'
    fixed = {f'{metres:g} m for all': metres for metres in (0.3, 0.5, 0.8)}
    return Experiment(
        'fig13',
        'Fig. 13: the normalisation factor',
        "A fixed distance takes the place of each body's mean point distance wherever that is "
        'the unit: of the votes, of the contributions (eq. 10) and of how far a descriptor '
        'reaches. People are divided by the mean length of their true limbs. Paper: THU; the '
        "figure's numbers are not in the text, but for the mean of the normalised method.",
        (
            Variant(own, _trial(scope), {MEAN: _THU}),
            *(
                Variant(label, _trial(scope, fixed_scale=metres))
                for label, metres in fixed.items()
            ),
        ),
        (claims.best(own, list(fixed), 'Better than every fixed distance.'),),
        (*SIZES, *LIMB_ENDS),
    )


def fig14(scope: Scope) -> Experiment:
    """The number of votes."""
    labels = [str(count) for count in scope.votes]
    few = str(scope.few_votes)
    return Experiment(
        'fig14',
        'Fig. 14: the size M of the subsets of votes',
        'The M heaviest votes make the density of a joint or a pair; the forest stays. Paper: '
        "Stanford; it uses 200, and of the figure's numbers the text gives that one.",
        tuple(
            Variant(
                label,
                _trial(scope, heaviest_votes=count),
                {MEAN: _STANFORD} if count == 200 else {},
                count,
            )
            for label, count in zip(labels, scope.votes, strict=True)
        ),
        (
            claims.better(few, labels[0], f'{few} votes are better than {labels[0]}.'),
            claims.level(labels[labels.index(few) :], f'From {few} votes on it is flat.'),
        ),
        axis=Axis('votes M', logarithmic=True),
    )


def fig15(scope: Scope) -> Experiment:
    """The number of training frames."""
    tenths = (1.25, 2.5, 5, 10, 20, 100 / 3.6)
    counts = [round(scope.frames * tenth / 10) for tenth in tenths]
    labels = [f'{count} frames' for count in counts]
    return Experiment(
        'fig15',
        'Fig. 15: the number of training frames',
        'The paper goes from 3,600 to 10,000 frames of its own recordings; where these have '
        "fewer, there is no point. The figure's numbers are not in the text.",
        tuple(
            Variant(label, Trial(scope.training, count), x=count)
            for label, count in zip(labels, counts, strict=True)
        ),
        (
            claims.grows(
                labels, labels[counts.index(scope.frames)], 'It improves with more frames.'
            ),
        ),
        axis=Axis('training frames', logarithmic=True, frames=True),
    )


EXPERIMENTS: dict[str, Callable[[Scope], Experiment]] = {
    make.__name__: make
    for make in (table1, table2, fig6, fig7, fig8, fig9, fig11, fig12, fig13, fig14, fig15)
}
"""All of them, by name, in the paper's order."""
