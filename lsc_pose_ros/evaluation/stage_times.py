"""One frame on its way through the method, with a clock at every stage.

The way is that of `Estimator.estimate`. It can be gone with the kernels that the estimator uses,
or with the plain ones, which are written as their equations read.
"""

import time
from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.evaluation.encoded_frame import EncodedFrame, decode_frame
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.plain import density as plain_density
from lsc_pose_ros.plain import descriptor as plain_descriptor
from lsc_pose_ros.plain import silhouette as plain_silhouette
from lsc_pose_ros.pose.estimator import (
    FEWEST_POINTS,
    bodies_in,
    find_candidates,
    places_of,
    structure_of,
)
from lsc_pose_ros.pose.features.point_features import Seen, describe_points
from lsc_pose_ros.pose.features.shape_context_3d import mean_distance
from lsc_pose_ros.pose.forest.body_yaw_search import leaves_of
from lsc_pose_ros.pose.forest.votes import Votes, VoteSettings, gather_votes, votes_for
from lsc_pose_ros.pose.inference.confidence import confidence_in
from lsc_pose_ros.pose.inference.pictorial_structure import Candidates, ascend, best_candidates
from lsc_pose_ros.pose.inference.truncation import truncation_factor
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.preprocessing import Window, fitted_to_noise, on_surfaces
from lsc_pose_ros.pose.silhouette.silhouette import (
    Silhouette,
    choose_uniformly,
    cut_out,
    find_silhouette,
    silhouette_in,
)

DECODE = 'decode'
SILHOUETTE = 'smooth + silhouette'
DESCRIPTOR = 'descriptor'
FOREST = 'forest'
VOTES = 'votes'
DENSITIES = 'densities + graph'

STAGES = (DECODE, SILHOUETTE, DESCRIPTOR, FOREST, VOTES, DENSITIES)
"""The stages in their order."""

STAGES_WITH_PLAIN_KERNELS = (SILHOUETTE, DESCRIPTOR, DENSITIES)


class Kernels(NamedTuple):
    """The kernels of which there are two kinds; arguments and results as those of `core`."""

    find_silhouette: Callable[[Window, Intrinsics, Settings], Silhouette]
    mean_distance: Callable[[NDArray[np.float32]], float]
    describe: Callable[[Seen, NDArray[np.int64]], NDArray[np.uint8]]
    find_candidates: Callable[[Votes, float, int], Candidates]


class Walked(NamedTuple):
    """What came of one frame.

    Attributes:
        seconds: how long each stage took for all bodies together.
        positions: the joints of each body, metres, NaN where too little is seen, (B, J, 3).
        confidence: theirs, shape (B, J).
    """

    seconds: dict[str, float]
    positions: NDArray[np.float32]
    confidence: NDArray[np.float32]


def walk(model: Model, encoded: EncodedFrame, kernels: Kernels) -> Walked:
    """Estimate the joints of everybody in a frame, with the graph, and time the stages.

    Args:
        model: a trained model.
        encoded: the frame.
        kernels: FAST or PLAIN.
    """
    way = _Way(model, kernels)
    depth, labels = decode_frame(encoded)
    way.lap(DECODE)
    bodies = bodies_in(labels)
    positions = np.full((len(bodies), len(model.joints), 3), np.nan, np.float32)
    confidence = np.zeros((len(bodies), len(model.joints)), np.float32)
    for row, body in enumerate(bodies):
        window = cut_out(depth, labels, int(body), model.settings.fill_holes)
        quantised = None if window is None else way.describe(window, encoded.camera)
        if window is not None and quantised is not None:
            votes = way.vote(*quantised)
            positions[row], confidence[row] = way.place(*votes)
            confidence[row] *= truncation_factor(positions[row], window, encoded.camera)
    way.lap(SILHOUETTE)
    return Walked(way.seconds, positions, confidence)


class _Described(NamedTuple):
    """What the forest sees: query points (Q, 3), their levels (Q, F), and rho_bar."""

    points: NDArray[np.float32]
    quantised: NDArray[np.uint8]
    scale: float


class _Way:
    """The stages of one frame; `seconds` adds up what each of them takes."""

    def __init__(self, model: Model, kernels: Kernels) -> None:
        self._model = model
        self._kernels = kernels
        self._structure = structure_of(model)
        self.seconds = dict.fromkeys(STAGES, 0.0)
        self._last = time.perf_counter()

    def lap(self, stage: str) -> None:
        """Charge `stage` with the time since the last call."""
        now = time.perf_counter()
        self.seconds[stage] += now - self._last
        self._last = now

    def describe(self, window: Window, camera: Intrinsics) -> _Described | None:
        """Return what the forest sees of a body, or None where that is too little."""
        kernels, settings = self._kernels, self._model.settings
        silhouette = kernels.find_silhouette(window, camera, settings)
        points = silhouette.points
        self.lap(SILHOUETTE)
        if len(points) < FEWEST_POINTS:
            return None
        scale = self._model.settings.fixed_scale or kernels.mean_distance(points)
        if scale <= 0:
            return None
        queries = choose_uniformly(len(points), settings.query_points)
        quantised = kernels.describe(Seen(silhouette, scale, camera, settings), queries)
        self.lap(DESCRIPTOR)
        return _Described(points[queries], quantised, scale)

    def vote(
        self, points: NDArray[np.float32], quantised: NDArray[np.uint8], scale: float
    ) -> tuple[Votes, Votes]:
        """Return the votes for joints and for edges."""
        model, heaviest = self._model, self._model.settings.heaviest_votes
        leaves = leaves_of(model, points, quantised, scale)
        self.lap(FOREST)
        joint_vote_settings = VoteSettings(len(model.joints), heaviest, scale)
        joints = gather_votes(model.forest.joint_votes, leaves, points, joint_vote_settings)
        pair_vote_settings = VoteSettings(len(model.edges), heaviest, scale)
        pairs = gather_votes(
            model.forest.pair_votes, leaves, np.zeros_like(points), pair_vote_settings
        )
        self.lap(VOTES)
        return joints, pairs

    def place(
        self, joints: Votes, pairs: Votes
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Return a body's joints, shape (J, 3), and their confidence, shape (J,)."""
        settings, structure = self._model.settings, self._structure
        bandwidth = settings.joint_bandwidth
        candidates = self._kernels.find_candidates(joints, bandwidth, settings.candidates)
        which = best_candidates(structure, joints, pairs, candidates)
        places = ascend(structure, joints, pairs, places_of(candidates, which))
        confidence = confidence_in(
            self._model.calibration, joints, places, structure.joint_bandwidth
        )
        self.lap(DENSITIES)
        return places, confidence


def _find_silhouette_plainly(window: Window, camera: Intrinsics, settings: Settings) -> Silhouette:
    solid = on_surfaces(window, settings)
    settings = fitted_to_noise(solid, settings)
    smoothed = plain_silhouette.smooth(solid, camera, settings.smoothing_sigma)
    return silhouette_in(solid._replace(depth=smoothed), camera, settings)


def _describe_plainly(seen: Seen, queries: NDArray[np.int64]) -> NDArray[np.uint8]:
    settings = seen.settings
    if (settings.feature, settings.binning) != ('3dlsc', 'shared'):
        return describe_points(seen, queries)
    radius = seen.scale * settings.support_radius
    histograms = plain_descriptor.describe(
        seen.silhouette.points, queries, radius, settings.inner_radius
    )
    return plain_descriptor.quantise(histograms)


@kernel
def _find_candidates_plainly(votes: Votes, bandwidth: float, wanted: int) -> Candidates:
    joints = votes.start.shape[0] - 1
    places = np.full((joints, wanted, 3), np.nan, np.float32)
    counts = np.zeros(joints, np.int64)
    for joint in range(joints):
        cloud = votes_for(votes, joint)
        together = np.column_stack((cloud.x, cloud.y, cloud.z))
        modes = plain_density.find_modes(together, cloud.weight, bandwidth, wanted)
        counts[joint] = modes.shape[0]
        places[joint, : modes.shape[0]] = modes
    return Candidates(places, counts)


FAST = Kernels(find_silhouette, mean_distance, describe_points, find_candidates)
"""What `Estimator` uses."""

PLAIN = Kernels(
    _find_silhouette_plainly,
    plain_descriptor.mean_distance,
    _describe_plainly,
    _find_candidates_plainly,
)
"""Written as the equations read.

The rivals' features are written once, so that they have no plain kernels.
"""
