"""The node's estimator: what the parameters ask for."""

from pathlib import Path

from lsc_pose_ros.core.estimator import Estimator
from lsc_pose_ros.data.model_file import load_model
from lsc_pose_ros.errors import InputError
from lsc_pose_ros.resources import default_model
from lsc_pose_ros.ros.parameters import Parameters


def load_estimator(parameters: Parameters) -> Estimator:
    """Return the estimator that `parameters` ask for.

    Raises:
        InputError: there is no such model, or it cannot be read.
    """
    try:
        path = Path(parameters.model) if parameters.model else default_model()
    except InputError as error:
        msg = f'parameter model: {error}'
        raise InputError(msg) from error
    return Estimator(load_model(path), graph=parameters.graph)
