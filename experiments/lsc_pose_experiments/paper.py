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

"""Definitions of the paper's tables and figures, with the numbers that its text gives.

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
from lsc_pose_experiments.shotton.part_model_training import PartModelSettings
from lsc_pose_experiments.shotton.part_tree_growth import PartGrowth
from lsc_pose_experiments.trial import Accuracy, Trial
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.training.train import TrainingSettings
from lsc_pose_ros.training.tree_growth import GrowthSettings

_THU = Accuracy(0.036, 0.952)
_STANFORD = Accuracy(0.035, 0.982)

OURS = 'ours (3DLSC + graph)'
_GIRSHICK = 'Girshick et al.'
_SHOTTON = 'Shotton et al.'


class ExperimentDefaults(NamedTuple):
    """The settings of variants that do not change them, and the values of N and M.

    Attributes:
        training: settings of the training.
        frames: number of training frames.
        body_parts: settings of the rival Shotton et al.
        points: values of N in Fig. 12.
        few_points: the N from which on the accuracy is stable according to the paper.
        votes: values of M in Fig. 14.
        few_votes: the M from which on the accuracy is stable according to the paper.
    """

    training: TrainingSettings
    frames: int = 3600
    body_parts: PartModelSettings = PartModelSettings()
    points: tuple[int, ...] = tuple(range(100, 901, 100))
    few_points: int = 400
    votes: tuple[int, ...] = (1, 2, 5, 10, 20, 50, 100, 200, 300, 500)
    few_votes: int = 100


def full_defaults(seed: int) -> ExperimentDefaults:
    """Return the defaults of the paper."""
    settings = Settings(offset_seed=seed)
    return ExperimentDefaults(TrainingSettings(numbers_of(DEFAULT_JOINTS), settings, seed=seed))


def quick_defaults(seed: int) -> ExperimentDefaults:
    """Return defaults that use all parts and take a minute on a small machine."""
    settings = Settings(points=80, query_points=80, offset_seed=seed)
    training = TrainingSettings(
        numbers_of(DEFAULT_JOINTS),
        settings,
        trees=2,
        growth=GrowthSettings(depth=9),
        seed=seed,
    )
    growth = PartGrowth(depth=12, features=50)
    body_parts = PartModelSettings(trees=2, growth=growth, pixels=300, other_pixels=100)
    return ExperimentDefaults(
        training,
        frames=60,
        body_parts=body_parts,
        points=(40, 80, 160),
        few_points=80,
        votes=(1, 20, 200),
        few_votes=20,
    )


def _trial(defaults: ExperimentDefaults, *, graph: bool = True, **settings: float | str) -> Trial:
    changed = defaults.training.settings._replace(**settings)  # type: ignore[arg-type]
    return Trial(defaults.training._replace(settings=changed), defaults.frames, graph)


def _girshick(defaults: ExperimentDefaults) -> Trial:
    return _trial(defaults, graph=False, feature='dcf', sample='body')


def _shotton(defaults: ExperimentDefaults) -> Trial:
    return Trial(defaults.training, defaults.frames, graph=False, body_parts=defaults.body_parts)


def table1(defaults: ExperimentDefaults) -> Experiment:
    """Measure hand, head and foot within 0.2 m."""
    joints = numbers_of([*DEFAULT_JOINTS, 'l_foot', 'r_foot'])
    trial = Trial(defaults.training._replace(joints=joints), defaults.frames)
    reported = {'hands': 0.997, 'head': 1.0, 'feet': 0.997}
    others = {'hands': 0.870, 'head': 0.800, 'feet': 0.990}
    li = 'Li et al. (endpoints)'
    return Experiment(
        'table1',
        'Table 1: hand, head and foot within 0.2 m',
        'The feet are learnt in addition to the other joints. Paper: Stanford. Li et al. detect '
        'only these three endpoints; their numbers are from their paper.',
        (
            Variant(
                li, None, {part: Accuracy(None, fraction) for part, fraction in others.items()}
            ),
            Variant(
                OURS,
                trial,
                {part: Accuracy(None, fraction) for part, fraction in reported.items()},
            ),
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


def table2(defaults: ExperimentDefaults) -> Experiment:
    """Compare the features."""
    labels = '3DLSC', 'DCF', '2DSC'
    features = zip(labels, ('3dlsc', 'dcf', '2dsc'), (0.982, 0.976, 0.876), strict=True)
    return Experiment(
        'table2',
        'Table 2: the feature',
        'The features of a point; forest and graph are the same. Paper: Stanford.',
        tuple(
            Variant(label, _trial(defaults, feature=feature), {MEAN: Accuracy(None, fraction)})
            for label, feature, fraction in features
        ),
        (
            claims.better('3DLSC', '2DSC', '3DLSC is better than 2DSC (paper: by 10.6 points).'),
            claims.better('3DLSC', 'DCF', '3DLSC is better than DCF (paper: by 0.6 points).'),
            claims.better('DCF', '2DSC', 'DCF is better than 2DSC (paper: by 10.0 points).'),
        ),
    )


def fig6(defaults: ExperimentDefaults) -> Experiment:
    """Compare each joint with Girshick et al., THU."""
    return Experiment(
        'fig6',
        'Fig. 6: joint by joint, against Girshick et al. (THU)',
        'Girshick et al. is DCF on points of the whole body, without the graph, in the same '
        "forest. Paper: THU; the text gives only the mean of the paper's own method.",
        (
            Variant(OURS, _trial(defaults), {MEAN: _THU}),
            Variant(_GIRSHICK, _girshick(defaults)),
        ),
        (
            claims.better(OURS, _GIRSHICK, 'Better than Girshick et al.'),
            claims.more_at_limb_ends(
                OURS, _GIRSHICK, 'The gain is largest at the limb ends: elbow, wrist and hand.'
            ),
            claims.reaches(OURS, 0.952, 0.036, "As good as the paper's: 95.2 % and 3.6 cm."),
        ),
    )


def fig7(defaults: ExperimentDefaults) -> Experiment:
    """Compare each joint with Girshick et al., Stanford."""
    same = fig6(defaults)
    first, second = same.variants
    return same._replace(
        name='fig7',
        title='Fig. 7: joint by joint, against Girshick et al. (Stanford)',
        what="As Fig. 6, with the paper's numbers on Stanford. Its caption is not in the text; "
        'section 4.4 names this comparison.',
        variants=(first._replace(paper={MEAN: _STANFORD}), second),
        claims=(
            *same.claims[:2],
            claims.reaches(OURS, 0.982, 0.035, "As good as the paper's: 98.2 % and 3.5 cm."),
        ),
    )


def fig8(defaults: ExperimentDefaults) -> Experiment:
    """Joint by joint, with the numbers of the paper."""
    return Experiment(
        'fig8',
        'Fig. 8: joint by joint, against published results (Stanford)',
        'The paper compares its results with those that Shotton et al. and Ganapathi et al. '
        'report on Stanford. Their numbers are not in the text. Shotton et al. is measured here: '
        'a forest classifies each pixel of the body into a body part, and mean-shift over the '
        'pixels of a part finds its joint. They trained on rendered people with painted parts. '
        'Here the part of a pixel is that of the nearest joint of the ground truth, along the '
        'bones, so that it learns from the same frames as the other methods.',
        (
            Variant(OURS, _trial(defaults), {MEAN: _STANFORD}),
            Variant(_SHOTTON, _shotton(defaults)),
        ),
        (
            claims.better(OURS, _SHOTTON, 'Better than Shotton et al.'),
            claims.reaches(OURS, 0.982, 0.035, "As good as the paper's: 98.2 % and 3.5 cm."),
        ),
    )


def fig9(defaults: ExperimentDefaults) -> Experiment:
    """Compare the method with and without the graph."""
    alone = 'without the graph'
    return Experiment(
        'fig9',
        'Fig. 9: with and without the graph',
        'The same forest; without the graph each joint is the highest mode of its own density. '
        'Paper: Stanford.',
        (
            Variant(OURS, _trial(defaults), {MEAN: _STANFORD}),
            Variant(alone, _trial(defaults, graph=False), {MEAN: Accuracy(0.045, 0.942)}),
        ),
        (
            claims.better(OURS, alone, 'The graph helps (paper: 4.0 points, 1.0 cm).'),
            claims.more_at_limb_ends(OURS, alone, 'It helps most at elbow, wrist and hand.'),
        ),
    )


def fig11(defaults: ExperimentDefaults) -> Experiment:
    """Leave out each of the two smoothings."""
    rough, single = 'without Gaussian filtering', 'without multi-binning'
    return Experiment(
        'fig11',
        'Fig. 11: Gaussian filtering and multi-binning',
        'Without filtering, eq. 1 does not change the depth; without multi-binning, each point '
        "counts in one bin of the descriptor instead of eight (eq. 4). The figure's numbers are "
        'not in the text.',
        (
            Variant(OURS, _trial(defaults)),
            Variant(rough, _trial(defaults, smoothing_sigma=0.0)),
            Variant(single, _trial(defaults, binning='nearest')),
        ),
        (
            claims.better(OURS, rough, 'Worse without Gaussian filtering.'),
            claims.better(OURS, single, 'Worse without multi-binning.'),
            claims.larger_drop(OURS, single, rough, 'Multi-binning matters more.'),
        ),
    )


def fig12(defaults: ExperimentDefaults) -> Experiment:
    """Vary the number of silhouette points."""
    reported = {100: Accuracy(0.051, 0.928), 400: Accuracy(0.036, 0.952)}
    labels = [str(count) for count in defaults.points]
    few = str(defaults.few_points)
    return Experiment(
        'fig12',
        'Fig. 12: the number N of silhouette points',
        'A forest is trained for each N, and all N points vote. Paper: THU.',
        tuple(
            Variant(
                label,
                _trial(defaults, points=count, query_points=count),
                {MEAN: reported[count]} if count in reported else {},
                count,
            )
            for label, count in zip(labels, defaults.points, strict=True)
        ),
        (
            claims.better(few, labels[0], f'{few} points are far better than {labels[0]}.'),
            claims.equal(labels[labels.index(few) :], f'From {few} points on it is stable.'),
        ),
        axis=Axis('silhouette points N'),
    )


def fig13(defaults: ExperimentDefaults) -> Experiment:
    """Compare units of the votes."""
    own = 'normalised (each body its own)'
    fixed = {f'{metres:g} m for all': metres for metres in (0.3, 0.5, 0.8)}
    return Experiment(
        'fig13',
        'Fig. 13: the normalisation factor',
        "A fixed distance replaces each body's mean point distance as the unit of the votes, of "
        'the contributions (eq. 10) and of the support radius of the descriptor. People are '
        'grouped by the mean length of their labelled limbs. Paper: THU; the text gives only the '
        'mean of the normalised method.',
        (
            Variant(own, _trial(defaults), {MEAN: _THU}),
            *(
                Variant(label, _trial(defaults, fixed_scale=metres))
                for label, metres in fixed.items()
            ),
        ),
        (claims.best(own, list(fixed), 'Better than every fixed distance.'),),
        (*SIZES, *LIMB_ENDS),
    )


def fig14(defaults: ExperimentDefaults) -> Experiment:
    """Vary the number of votes."""
    labels = [str(count) for count in defaults.votes]
    few = str(defaults.few_votes)
    return Experiment(
        'fig14',
        'Fig. 14: the size M of the subsets of votes',
        'The density of a joint or a pair has the M heaviest votes; the forest is the same. '
        'Paper: Stanford; it uses 200, and the text gives only that number.',
        tuple(
            Variant(
                label,
                _trial(defaults, heaviest_votes=count),
                {MEAN: _STANFORD} if count == 200 else {},
                count,
            )
            for label, count in zip(labels, defaults.votes, strict=True)
        ),
        (
            claims.better(few, labels[0], f'{few} votes are better than {labels[0]}.'),
            claims.equal(labels[labels.index(few) :], f'From {few} votes on it is flat.'),
        ),
        axis=Axis('votes M', logarithmic=True),
    )


def fig15(defaults: ExperimentDefaults) -> Experiment:
    """Vary the number of training frames."""
    tenths = (1.25, 2.5, 5, 10, 20, 100 / 3.6)
    counts = [round(defaults.frames * tenth / 10) for tenth in tenths]
    labels = [f'{count} frames' for count in counts]
    return Experiment(
        'fig15',
        'Fig. 15: the number of training frames',
        'The paper uses 3,600 to 10,000 frames of its own recordings; larger sets are missing if '
        "these recordings have fewer. The figure's numbers are not in the text.",
        tuple(
            Variant(label, Trial(defaults.training, count), x=count)
            for label, count in zip(labels, counts, strict=True)
        ),
        (
            claims.improves_with_frames(
                labels, labels[counts.index(defaults.frames)], 'It improves with more frames.'
            ),
        ),
        axis=Axis('training frames', logarithmic=True, frames=True),
    )


EXPERIMENTS: dict[str, Callable[[ExperimentDefaults], Experiment]] = {
    make.__name__: make
    for make in (table1, table2, fig6, fig7, fig8, fig9, fig11, fig12, fig13, fig14, fig15)
}
"""All experiments by name, in the order of the paper."""
