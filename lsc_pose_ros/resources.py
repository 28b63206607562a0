"""The files that come with the package: where an installation has put them."""

import os
import sys
from collections.abc import Iterator
from pathlib import Path

from lsc_pose_ros.errors import InputError

PACKAGE = 'lsc_pose_ros'


def resource(*parts: str) -> Path:
    """Return the path of a file of the package, e.g. `resource('config', 'pose_node.yaml')`.

    Looked for in the ROS workspaces that are sourced, then in this Python environment, then in
    the source tree.

    Raises:
        InputError: the file is in none of them.
    """
    for share in _shares():
        path = share.joinpath(*parts)
        if path.exists():
            return path
    msg = f'{"/".join(parts)} is not installed with {PACKAGE}; install the package again'
    raise InputError(msg)


def _shares() -> Iterator[Path]:
    # Read as ament_index_python does it, which is not there without ROS.
    for prefix in os.environ.get('AMENT_PREFIX_PATH', '').split(os.pathsep):
        if prefix:
            yield Path(prefix) / 'share' / PACKAGE
    yield Path(sys.prefix) / 'share' / PACKAGE
    yield Path(__file__).resolve().parent.parent


def default_model() -> Path:
    """Return the path of the model that comes with the package.

    Raises:
        InputError: none does.
    """
    try:
        return resource('models', 'default.npz')
    except InputError as error:
        msg = (
            f'no model comes with this {PACKAGE}; '
            'give the path of one that `lsc_pose train` has made'
        )
        raise InputError(msg) from error
