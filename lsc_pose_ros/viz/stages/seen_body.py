"""One body of one frame with what the method computes of it: what the stage pictures draw."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data_types.frame import Frame
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.pose.estimator import Estimator, Shape, Stages, find_shape
from lsc_pose_ros.pose.model import Model
from lsc_pose_ros.pose.settings import Settings
from lsc_pose_ros.training.samples import select_joints
from lsc_pose_ros.viz.drawing.crop import Box, box_around

_ASPECT = 0.7  # narrower than a contact sheet's frame: a person upright fills it


class Estimated(NamedTuple):
    """What a model makes of a body."""

    model: Model
    stages: Stages


class SeenBody(NamedTuple):
    """One body on its way through the method.

    Attributes:
        label: what the frame is called, for example 'frame 12'.
        frame: the images, the camera and the truth if there is one.
        body: the body's number in the mask.
        settings: how silhouette and descriptors are computed.
        shape: silhouette and descriptors.
        estimated: votes, densities and joints; None without a model.
        box: the part of the image that is drawn.
    """

    label: str
    frame: Frame
    body: int
    settings: Settings
    shape: Shape
    estimated: Estimated | None
    box: Box

    def ground_truth(self, joints: NDArray[np.uint16]) -> NDArray[np.float32]:
        """Return the true places of `joints`, metres, NaN where not labelled, shape (J, 3)."""
        ground_truth = self.frame.ground_truth
        if ground_truth is not None and self.body in ground_truth.bodies:
            row = int(np.flatnonzero(ground_truth.bodies == self.body)[0])
            places: NDArray[np.float32] = select_joints(ground_truth, joints)[row]
            return places
        return np.full((len(joints), 3), np.nan, np.float32)


def see_body(
    label: str, frame: Frame, body: int | None = None, model: Model | None = None
) -> SeenBody:
    """Return one body of `frame` with all that is computed of it.

    Args:
        label: what to call the frame.
        frame: the images and the camera.
        body: the body's number; None for the one that covers the most pixels.
        model: None for what needs no model: silhouette and descriptors.

    Raises:
        InputError: there is no such body, or too little of it is seen.
    """
    number = _largest_body(frame, label) if body is None else body
    if not (frame.labels == number).any():
        present = ', '.join(map(str, np.unique(frame.labels[frame.labels >= 0]))) or 'none'
        msg = f'{label}: the mask has no body {number}; the bodies in it: {present}'
        raise InputError(msg)
    settings = model.settings if model is not None else Settings()
    shape: Shape | None
    estimated = None
    if model is None:
        shape = find_shape(frame.depth, frame.labels, number, (frame.camera, settings))
    else:
        stages = Estimator(model).stages(frame.depth, frame.labels, frame.camera, number)
        shape = stages.shape if stages is not None else None
        estimated = Estimated(model, stages) if stages is not None else None
    if shape is None:
        msg = f'{label}: too little of body {number} is seen to draw its stages'
        raise InputError(msg)
    box = box_around(frame, number, _ASPECT)
    return SeenBody(label, frame, number, settings, shape, estimated, box)


def _largest_body(frame: Frame, label: str) -> int:
    pixels = frame.labels[frame.labels >= 0]
    if len(pixels) == 0:
        msg = f'{label}: the mask shows nobody; choose another frame'
        raise InputError(msg)
    return int(np.bincount(pixels).argmax())
