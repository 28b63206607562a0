"""Checks that a model's parts fit together before a kernel follows them.

A file from a stranger may be wrong, but it must not make a kernel read outside of its arrays.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.pose.forest.forest import Forest, LeafVotes
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import BINNINGS, FEATURES, SAMPLES, Settings

_LARGEST_SETTING = 10_000
_LARGEST_SEED = 1 << 128

# What the settings that are words can be.
_WORDS = {'feature': FEATURES, 'sample': SAMPLES, 'binning': BINNINGS}

# Settings that older models lack; these do as the defaults say.
_LATER_SETTINGS = (
    'fewest_neighbours',
    'neighbour_distance',
    'fill_holes',
    'noise_factor',
    'feature',
    'sample',
    'fixed_scale',
    'binning',
    'body_yaws',
    'legs_apart',
    'offset_pairs',
    'offset_reach',
    'offset_seed',
)


# What settings were called in files of format 3.
_RENAMED_SETTINGS = {'facings': 'body_yaws'}


class UnusableModelError(ValueError):
    """A part of a model is wrong; the message says which, to be put in brackets."""


def read_provenance(given: object) -> dict[str, str]:
    """Return the provenance that a file's header gives.

    Raises:
        UnusableModelError: it is no table.
    """
    if not isinstance(given, dict):
        msg = 'its header lacks the provenance'
        raise UnusableModelError(msg)
    return {str(name): str(value) for name, value in given.items()}


def read_settings(given: object) -> Settings:
    """Return the settings that a file's header gives.

    Raises:
        UnusableModelError: they are not those of this version, or not within reason.
    """
    defaults = Settings()._asdict()
    if isinstance(given, dict):
        given = {_RENAMED_SETTINGS.get(name, name): value for name, value in given.items()}
        given = {name: defaults[name] for name in _LATER_SETTINGS} | given
    if not isinstance(given, dict) or set(given) != set(defaults):
        msg = 'its settings are not those of this version'
        raise UnusableModelError(msg)
    values: dict[str, Any] = {
        name: _read_word(name, given[name])
        if name in _WORDS
        else _read_number(name, given[name], type(default))
        for name, default in defaults.items()
    }
    settings = Settings(**values)
    if not (0 < settings.inner_radius < 1 and settings.joint_bandwidth > 0):
        msg = 'its radii or bandwidths are not positive'
        raise UnusableModelError(msg)
    if not settings.offset_reach > 0:
        msg = 'its offsets reach nowhere'
        raise UnusableModelError(msg)
    counts = settings.points, settings.query_points, settings.heaviest_votes, settings.candidates
    if min(*counts, settings.offset_pairs) < 1:
        msg = 'it asks for no points, votes, candidates or pairs of offsets'
        raise UnusableModelError(msg)
    return settings


def _read_word(name: str, value: object) -> str:
    if value not in _WORDS[name]:
        msg = f'its setting {name} is {value!r}'
        raise UnusableModelError(msg)
    return str(value)


def _read_number(name: str, value: Any, kind: type) -> Any:  # noqa: ANN401
    understood = isinstance(value, int if kind is int else int | float)
    largest = _LARGEST_SEED if name == 'offset_seed' else _LARGEST_SETTING
    if not understood or isinstance(value, bool) or not 0 <= value <= largest:
        msg = f'its setting {name} is {value!r}'
        raise UnusableModelError(msg)
    return kind(value)


def check_model(model: Model) -> None:
    """Check every index that a kernel follows, since kernels check none.

    Raises:
        UnusableModelError: the model's parts do not fit together.
    """
    count, edges = len(model.joints), model.edges
    numbers = model.joints.astype(np.int64)
    if not count or numbers[-1] >= len(JOINT_NAMES) or (np.diff(numbers) <= 0).any():
        msg = 'its joints are not sorted numbers of the vocabulary'
        raise UnusableModelError(msg)
    if edges.shape[1:] != (2,) or len(edges) >= count or not _is_forest(edges, count):
        msg = 'its edges are no trees over its joints'
        raise UnusableModelError(msg)
    if model.limb_lengths.shape != edges.shape[:1] or not (model.limb_lengths > 0).all():
        msg = 'its limb lengths do not fit its edges'
        raise UnusableModelError(msg)
    _check_calibration(model.calibration, count)
    leaves = len(model.forest.joint_votes.start) - 1
    _check_nodes(model.forest, model.feature_size, leaves)
    _check_votes(model.forest.joint_votes, leaves, count)
    _check_votes(model.forest.pair_votes, leaves, len(edges))


def _check_calibration(calibration: NDArray[np.float32], count: int) -> None:
    good = (
        len(calibration) in (0, count)
        and calibration.shape[1] > 1
        # Written so that what is not a number is not good.
        and bool(((calibration >= 0) & (calibration <= 1)).all())
        and bool((np.diff(calibration, axis=1) >= 0).all())
    )
    if not good:
        msg = 'its confidences do not rise from 0 to 1 at most, joint by joint'
        raise UnusableModelError(msg)


def _is_forest(edges: NDArray[np.int32], count: int) -> bool:
    """Tell whether each joint has one parent at most, which is listed before its children."""
    if edges.size and (edges.min() < 0 or edges.max() >= count):
        return False
    if len(set(edges[:, 1].tolist())) < len(edges):
        return False
    settled: set[int] = set()
    for parent, child in edges.tolist():
        if child in settled or parent == child:
            return False
        settled |= {parent, child}
    return True


def _check_nodes(forest: Forest, size: int, leaves: int) -> None:
    """Check that every way down the trees ends in one of the leaves."""
    nodes = len(forest.feature)
    if len(forest.threshold) != nodes or len(forest.left) != nodes or not len(forest.roots):
        msg = 'its trees are incomplete'
        raise UnusableModelError(msg)
    splits = forest.feature >= 0
    own = np.arange(nodes)
    good = (
        (forest.roots >= 0).all()
        and (forest.roots < nodes).all()
        and (forest.feature >= -1).all()
        and (forest.feature < size).all()
        # A child stands after its parent, so no way down can go round in circles.
        and (forest.left[splits] > own[splits]).all()
        and (forest.left[splits] < nodes - 1).all()
        and (forest.left[~splits] >= 0).all()
        and (forest.left[~splits] < leaves).all()
    )
    if not good:
        msg = 'its trees point to places that do not exist'
        raise UnusableModelError(msg)


def _check_votes(votes: LeafVotes, leaves: int, targets: int) -> None:
    count = len(votes.target)
    good = (
        len(votes.start) == leaves + 1
        and leaves > 0
        and votes.start[0] == 0
        and votes.start[-1] == count
        and (np.diff(votes.start) >= 0).all()
        and votes.offset.shape == (count, 3)
        and votes.weight.shape == (count,)
        and (votes.target < targets).all()
        and np.isfinite(votes.offset).all()
        and np.isfinite(votes.weight).all()
        and (votes.weight >= 0).all()
    )
    if not good:
        msg = 'its votes do not fit its leaves'
        raise UnusableModelError(msg)
