"""Teaches the forest that tells where a person faces, and the other one to listen to it."""

import itertools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.core.facing import (
    FACING_SIZE,
    SECTORS,
    STEP,
    FacingForest,
    are_witnesses,
    facing_levels,
    facing_of,
    sector_centres,
    sector_of,
)
from lsc_pose_ros.core.joints import names_of
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.learning.criterion import Evidence
from lsc_pose_ros.learning.growth import GrowthSettings, Tree, grow_tree, join_trees
from lsc_pose_ros.learning.samples import Samples

# Left and right of these lie across the trunk.
_ACROSS = ('shoulder', 'hip')


class FacingSettings(NamedTuple):
    """How the trees of facings are grown, and how the joints' forest learns from them.

    Attributes:
        trees: how many.
        growth: of each; its leaves are large, for they have to know shares, not places.
        points: about how many points of a person are learnt from.
        towards_camera: how much likelier than the average it is beforehand that people face the
            camera, nats a point: where a body tells nothing, people look at what looks at them.
        uncertainty: the standard deviation of what is told to the joints' forest in training:
            about as wrong as the facing is found later, radians.
        seed: of all that is drawn.
    """

    trees: int = 3
    growth: GrowthSettings = GrowthSettings(depth=18, leaf_samples=40, features=24)
    points: int = 100
    towards_camera: float = 0.1
    uncertainty: float = float(np.radians(12.0))
    seed: int = 0


def people_facing(joints: NDArray[np.float32], numbers: NDArray[np.uint16]) -> NDArray[np.float64]:
    """Return where people face, radians, as `facing_of`, NaN where it is not known, shape (P,).

    Args:
        joints: their places, NaN where not labelled, any unit, shape (P, J, 3).
        numbers: which joints these are, shape (J,).

    Raises:
        InputError: as `lines_across`.
    """
    across = np.zeros((len(joints), 3))
    for left, right in lines_across(numbers):
        line = joints[:, left] - joints[:, right]
        across += line / np.maximum(np.linalg.norm(line, axis=1, keepdims=True), 1e-9)
    return facing_of(across)


def lines_across(numbers: NDArray[np.uint16]) -> list[tuple[int, int]]:
    """Return the columns of the left and the right shoulder, and of the left and the right hip.

    Args:
        numbers: which joints there are, shape (J,).

    Raises:
        InputError: these four are not among them.
    """
    names = names_of(numbers)
    pairs = [(f'l_{name}', f'r_{name}') for name in _ACROSS]
    missing = [name for pair in pairs for name in pair if name not in names]
    if missing:
        msg = (
            'where people face is told by shoulders and hips; '
            f'also learn {", ".join(missing)}, or leave out --facing'
        )
        raise InputError(msg)
    return [(names.index(left), names.index(right)) for left, right in pairs]


def teach_facing(
    samples: Samples, numbers: NDArray[np.uint16], settings: FacingSettings
) -> FacingForest:
    """Return a forest that tells where people face, and write its answers into the samples.

    Args:
        samples: the last FACING_SIZE rows of their levels are free, and are filled with where each
            person faces, a little off, as it will be when the forest says so.
        numbers: which joints the samples have, shape (J,).
        settings: how to learn.

    Raises:
        InputError: as `people_facing`, or nobody's facing is known.
    """
    facing = people_facing(samples.joints, numbers)
    if not np.isfinite(facing).any():
        msg = 'nobody is labelled with both shoulders and both hips; leave out --facing'
        raise InputError(msg)
    forest = _grow(samples, facing, settings)
    random = np.random.default_rng((settings.seed, len(facing)))
    told = facing + settings.uncertainty * random.standard_normal(len(facing))
    unknown = np.isnan(facing)
    told[unknown] = 2 * np.pi * random.random(unknown.sum())
    samples.levels[-FACING_SIZE:] = facing_levels(told)[samples.person].T
    return forest


def _grow(samples: Samples, facing: NDArray[np.float64], settings: FacingSettings) -> FacingForest:
    asked = _witnesses(samples)
    asked = asked[:: max(1, len(asked) // (len(facing) * settings.points))]
    known = np.isfinite(facing)
    sectors = np.where(known, sector_of(np.where(known, facing, 0.0)), -1)
    sector = sectors[samples.person[asked]]
    levels = np.ascontiguousarray(samples.levels[:-FACING_SIZE, asked])
    trees = [
        grow_tree(
            levels,
            sector_evidence(sector),
            settings.growth,
            np.random.default_rng((settings.seed, SECTORS, number)),
        )
        for number in range(settings.trees)
    ]
    prior = settings.towards_camera * np.cos(sector_centres())
    evidence = np.concatenate([leaf_evidence(tree, sector, prior) for tree in trees])
    return FacingForest(*join_trees(trees), evidence)


def _witnesses(samples: Samples) -> NDArray[np.int64]:
    """Return which samples are asked where people face."""
    edges = np.searchsorted(samples.person, np.arange(len(samples.scale) + 1))
    return np.concatenate(
        [
            start + np.flatnonzero(are_witnesses(samples.points[start:end], 1.0))
            for start, end in itertools.pairwise(edges.tolist())
            if end > start
        ]
    )


def sector_evidence(sector: NDArray[np.int64]) -> Evidence:
    """Return the sectors that samples belong to, shape (S,), -1 for none, for the entropy."""
    known = sector >= 0
    start = np.concatenate([[0], np.cumsum(known, dtype=np.int64)])
    return Evidence(
        start,
        sector[known].astype(np.uint8),
        np.ones((int(start[-1]), 1), np.float32),
        np.zeros((SECTORS, 1), np.float32),
    )


def leaf_evidence(
    tree: Tree, sector: NDArray[np.int64], prior: NDArray[np.float64]
) -> NDArray[np.int8]:
    """Return log p(sector | leaf) - log p(sector) of a tree's leaves, (L, SECTORS), in STEPs.

    Args:
        tree: grown on the samples.
        sector: of each of them, -1 where it is not known, shape (S,).
        prior: is added, nats, shape (SECTORS,).

    A leaf begins with one sample of each sector that it has not seen. So no sector is impossible.
    """
    known = np.flatnonzero(sector >= 0)
    leaf = np.empty(len(sector), np.int64)
    leaf[tree.order] = np.repeat(np.arange(len(tree.leaf_start) - 1), np.diff(tree.leaf_start))
    counts = np.zeros((len(tree.leaf_start) - 1, SECTORS))
    np.add.at(counts, (leaf[known], sector[known]), 1.0)
    often = np.maximum(counts.sum(axis=0), 1.0)
    # As many of each sector as if all were seen equally often.
    even = counts * (often.mean() / often) + 1.0
    evidence = np.log(SECTORS * even / even.sum(axis=1, keepdims=True)) + prior
    steps: NDArray[np.int8] = np.clip(np.rint(evidence / STEP), -127, 127).astype(np.int8)
    return steps
