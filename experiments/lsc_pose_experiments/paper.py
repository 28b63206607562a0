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

from lsc_pose_experiments import claims
from lsc_pose_experiments.defaults import (
    GIRSHICK,
    OURS,
    SHOTTON,
    ExperimentDefaults,
    forest_trial,
    girshick_trial,
    shotton_trial,
)
from lsc_pose_experiments.experiment import (
    LIMB_ENDS,
    MEAN,
    SIZES,
    Axis,
    Experiment,
    Variant,
)
from lsc_pose_experiments.systems import systems
from lsc_pose_experiments.trial import Accuracy, Trial
from lsc_pose_ros.data_types.joints import DEFAULT_JOINTS, numbers_of

_THU = Accuracy(0.036, 0.952)
_STANFORD = Accuracy(0.035, 0.982)


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
            Variant(
                label, forest_trial(defaults, feature=feature), {MEAN: Accuracy(None, fraction)}
            )
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
            Variant(OURS, forest_trial(defaults), {MEAN: _THU}),
            Variant(GIRSHICK, girshick_trial(defaults)),
        ),
        (
            claims.better(OURS, GIRSHICK, 'Better than Girshick et al.'),
            claims.more_at_limb_ends(
                OURS, GIRSHICK, 'The gain is largest at the limb ends: elbow, wrist and hand.'
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
            Variant(OURS, forest_trial(defaults), {MEAN: _STANFORD}),
            Variant(SHOTTON, shotton_trial(defaults)),
        ),
        (
            claims.better(OURS, SHOTTON, 'Better than Shotton et al.'),
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
            Variant(OURS, forest_trial(defaults), {MEAN: _STANFORD}),
            Variant(alone, forest_trial(defaults, graph=False), {MEAN: Accuracy(0.045, 0.942)}),
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
            Variant(OURS, forest_trial(defaults)),
            Variant(rough, forest_trial(defaults, smoothing_sigma=0.0)),
            Variant(single, forest_trial(defaults, binning='nearest')),
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
                forest_trial(defaults, points=count, query_points=count),
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
            Variant(own, forest_trial(defaults), {MEAN: _THU}),
            *(
                Variant(label, forest_trial(defaults, fixed_scale=metres))
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
                forest_trial(defaults, heaviest_votes=count),
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
    for make in (
        table1, table2, fig6, fig7, fig8, fig9, fig11, fig12, fig13, fig14, fig15, systems,
    )
}  # fmt: skip
"""All experiments by name: those of the paper in its order, then all systems side by side."""
