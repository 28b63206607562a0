"""The parameters as the layers below name them."""

from lsc_pose_ros.estimation.temporal import SequenceSettings
from lsc_pose_ros.ros.node.parameters import TRACKED, Parameters
from lsc_pose_ros.segmentation.segmenter import SegmentationSettings


def segmentation_settings(parameters: Parameters) -> SegmentationSettings:
    """Return how bodies are to be found."""
    return SegmentationSettings(
        parameters.segmentation,
        parameters.range_min,
        parameters.range_max,
        parameters.background_seconds,
        parameters.background_margin,
    )


def sequence_settings(parameters: Parameters) -> SequenceSettings:
    """Return what is to be done with the estimator's answers."""
    return SequenceSettings(
        smoothing=parameters.smoothing,
        smoothing_cutoff=parameters.smoothing_cutoff,
        smoothing_beta=parameters.smoothing_beta,
        tracked=parameters.body_ids == TRACKED,
    )
