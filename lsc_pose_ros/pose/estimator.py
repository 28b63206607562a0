"""The whole way from one depth image to joints; `estimate` gives the joints, `stages` the way."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.joints import leg_pairs
from lsc_pose_ros.data_types.skeletons import Skeletons
from lsc_pose_ros.numerics.jit import kernel
from lsc_pose_ros.pose.features.point_features import Seen, describe_points
from lsc_pose_ros.pose.features.shape_context_3d import mean_distance
from lsc_pose_ros.pose.forest.body_yaw_search import leaves_of
from lsc_pose_ros.pose.forest.votes import Votes, VoteSettings, gather_votes, votes_for
from lsc_pose_ros.pose.inference.confidence import confidence_in
from lsc_pose_ros.pose.inference.density import find_modes
from lsc_pose_ros.pose.inference.pictorial_structure import (
    Candidates,
    Structure,
    ascend,
    best_candidates,
)
from lsc_pose_ros.pose.inference.truncation import truncation_factor
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.pose.silhouette.preprocessing import Window
from lsc_pose_ros.pose.silhouette.silhouette import (
    Silhouette,
    choose_uniformly,
    cut_out,
    find_silhouette,
)

# Fewer silhouette points than this are specks, not a person.
FEWEST_POINTS = 30


class Shape(NamedTuple):
    """What the forest sees of a body.

    Attributes:
        window: the body cut out of the image.
        silhouette: its silhouette.
        scale: rho_bar, or what the settings put in its place, metres.
        queries: which of the silhouette's points vote, shape (Q,).
        quantised: the descriptors of those, shape (Q, F).
    """

    window: Window
    silhouette: Silhouette
    scale: float
    queries: NDArray[np.int64]
    quantised: NDArray[np.uint8]

    @property
    def points(self) -> NDArray[np.float32]:
        """The points that vote, metres, shape (Q, 3)."""
        return self.silhouette.points[self.queries]


class Answer(NamedTuple):
    """What the forest and the graph make of what is seen; the attributes are those of Stages."""

    joint_votes: Votes
    pair_votes: Votes
    candidates: Candidates
    alone: NDArray[np.float32]
    chosen: NDArray[np.float32]
    joints: NDArray[np.float32]


class Stages(NamedTuple):
    """One body on its way through the method.

    Attributes:
        shape: the silhouette and its descriptors.
        joint_votes: eq. 13, for each joint.
        pair_votes: likewise for each edge.
        candidates: the modes of eq. 14.
        alone: each joint's best mode without the graph, metres, shape (J, 3).
        chosen: the best combination over the trees (eq. 16), metres, shape (J, 3).
        joints: the answer after ascent (eq. 17), metres, shape (J, 3).
    """

    shape: Shape
    joint_votes: Votes
    pair_votes: Votes
    candidates: Candidates
    alone: NDArray[np.float32]
    chosen: NDArray[np.float32]
    joints: NDArray[np.float32]


def find_shape(
    depth: NDArray[np.float32],
    labels: NDArray[np.int32],
    body: int,
    view: tuple[Intrinsics, Settings],
) -> Shape | None:
    """Return what can be seen of `body`, or None where that is too little to be a person.

    Args:
        depth: metres, 0 where the sensor saw nothing, shape (H, W).
        labels: the body number of each pixel, shape (H, W).
        body: the number of the body.
        view: the camera and the settings.
    """
    camera, settings = view
    window = cut_out(depth, labels, body, settings.fill_holes)
    if window is None:
        return None
    silhouette = find_silhouette(window, camera, settings)
    if len(silhouette.points) < FEWEST_POINTS:
        return None
    scale = settings.fixed_scale or mean_distance(silhouette.points)
    if scale <= 0:
        return None
    queries = choose_uniformly(len(silhouette.points), settings.query_points)
    quantised = describe_points(Seen(silhouette, scale, camera, settings), queries)
    return Shape(window, silhouette, scale, queries, quantised)


class Estimator:
    """Estimates joints with one model.

    Args:
        model: a trained model.
        graph: whether the pictorial structure ties the joints together (eq. 16, 17); without it
            each joint is the highest mode of its own density (eq. 14).
    """

    def __init__(self, model: Model, *, graph: bool = True) -> None:
        """Prepare the model's numbers for the kernels."""
        self.model = model
        self.graph = graph
        self._structure = structure_of(model)

    @property
    def joints(self) -> NDArray[np.uint16]:
        """The numbers of the joints that are estimated, shape (J,)."""
        return self.model.joints

    def estimate(
        self, depth: NDArray[np.float32], labels: NDArray[np.int32], camera: Intrinsics
    ) -> Skeletons:
        """Return the joints of every body in `labels`, in the order of the bodies' numbers.

        Args:
            depth: metres, 0 where the sensor saw nothing, shape (H, W).
            labels: the body number of each pixel, NO_BODY for none, shape (H, W).
            camera: the intrinsics.

        A body of which too little is seen has NaN joints with confidence 0.
        """
        bodies = bodies_in(labels)
        count = len(self.model.joints)
        positions = np.full((len(bodies), count, 3), np.nan, np.float32)
        confidence = np.zeros((len(bodies), count), np.float32)
        for row, body in enumerate(bodies):
            stages = self.stages(depth, labels, camera, int(body))
            if stages is not None:
                positions[row] = stages.joints if self.graph else stages.alone
                confidence[row] = confidence_in(
                    self.model.calibration,
                    stages.joint_votes,
                    positions[row],
                    self._structure.joint_bandwidth,
                )
                window = stages.shape.window
                confidence[row] *= truncation_factor(positions[row], window, camera)
        return Skeletons(bodies, self.model.joints, positions, confidence)

    def stages(
        self,
        depth: NDArray[np.float32],
        labels: NDArray[np.int32],
        camera: Intrinsics,
        body: int,
    ) -> Stages | None:
        """Return all that is computed on the way for one body, or None where too little is seen.

        Arguments as `estimate`; `body` is the body's number.
        """
        shape = find_shape(depth, labels, body, (camera, self.model.settings))
        if shape is None:
            return None
        return Stages(shape, *self.answer(shape.points, shape.quantised, shape.scale))

    def answer(
        self, points: NDArray[np.float32], quantised: NDArray[np.uint8], scale: float
    ) -> Answer:
        """Return the joints of a body of which the descriptors are known.

        Args:
            points: those that vote, metres, shape (Q, 3).
            quantised: their descriptors, shape (Q, F).
            scale: rho_bar, metres.
        """
        model, settings = self.model, self.model.settings
        leaves = leaves_of(model, points, quantised, scale)
        joint_vote_settings = VoteSettings(len(model.joints), settings.heaviest_votes, scale)
        joint_votes = gather_votes(model.forest.joint_votes, leaves, points, joint_vote_settings)
        pair_vote_settings = VoteSettings(len(model.edges), settings.heaviest_votes, scale)
        pair_votes = gather_votes(
            model.forest.pair_votes, leaves, np.zeros_like(points), pair_vote_settings
        )
        candidates = find_candidates(joint_votes, settings.joint_bandwidth, settings.candidates)
        alone = places_of(candidates, np.minimum(candidates.counts, 1) - 1)
        chosen, joints = alone, alone
        if self.graph:
            which = best_candidates(self._structure, joint_votes, pair_votes, candidates)
            chosen = places_of(candidates, which)
            joints = ascend(self._structure, joint_votes, pair_votes, chosen)
        return Answer(joint_votes, pair_votes, candidates, alone, chosen, joints)


def structure_of(model: Model) -> Structure:
    """Return what the graph needs of a model (eq. 16, 17)."""
    settings = model.settings
    return Structure(
        model.edges,
        model.limb_lengths,
        float(settings.joint_bandwidth),
        float(settings.pair_weight),
        leg_pairs(model.joints),
        float(settings.legs_apart),
    )


def bodies_in(labels: NDArray[np.int32]) -> NDArray[np.uint16]:
    """Return the numbers of the bodies in a mask, sorted, shape (B,)."""
    foreground = labels[labels >= 0]
    return np.flatnonzero(np.bincount(foreground)).astype(np.uint16)


@kernel
def find_candidates(votes: Votes, bandwidth: float, wanted: int) -> Candidates:
    """Return at most `wanted` modes of each joint's density; `bandwidth` in metres (eq. 14)."""
    joints = votes.start.shape[0] - 1
    places = np.full((joints, wanted, 3), np.nan, np.float32)
    counts = np.zeros(joints, np.int64)
    for joint in range(joints):
        modes = find_modes(votes_for(votes, joint), bandwidth, wanted)
        counts[joint] = modes.shape[0]
        places[joint, : modes.shape[0]] = modes
    return Candidates(places, counts)


def places_of(candidates: Candidates, which: NDArray[np.int64]) -> NDArray[np.float32]:
    """Return the chosen candidate of each joint, NaN where `which` is -1, shape (J, 3)."""
    places = candidates.places[np.arange(len(which)), np.maximum(which, 0)]
    return np.where(which[:, None] >= 0, places, np.float32(np.nan))
