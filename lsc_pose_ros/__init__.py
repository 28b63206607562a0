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

"""Human joints in 3-D from one depth image and a mask of the people in it.

The method is that of He, Wang, Liao and Xue (Neurocomputing 164, 2015).

The names in `__all__` are the public interface; `docs/python.md` explains them with examples.
All modules of this package are internal and may change in any release.

    from lsc_pose_ros import Estimator, load_model, open_recording

    estimator = Estimator(load_model('default'))
    for frame in open_recording('people.mcap'):
        skeletons = estimator.estimate(frame.depth, frame.labels, frame.camera)

A name is imported when it is first used (PEP 562), so that `import lsc_pose_ros` loads neither
numba nor a library that reads recordings.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from lsc_pose_ros.bags.frames import FrameReader, open_recording
    from lsc_pose_ros.bags.topics import Topics
    from lsc_pose_ros.camera.roll import in_camera_frame
    from lsc_pose_ros.data_types.camera import Intrinsics, Lens
    from lsc_pose_ros.data_types.conversion import labels_from_mask, metres_from_millimetres
    from lsc_pose_ros.data_types.frame import NO_BODY, Frame
    from lsc_pose_ros.data_types.joints import JOINT_NAMES
    from lsc_pose_ros.data_types.skeletons import Skeletons
    from lsc_pose_ros.errors import InputError
    from lsc_pose_ros.model_io.model_file import load_model
    from lsc_pose_ros.pose.estimator import Estimator
    from lsc_pose_ros.pose.model import Model
    from lsc_pose_ros.settings.table import FrameSettings

__version__ = '0.1.0'

__all__ = [
    'JOINT_NAMES',
    'NO_BODY',
    'Estimator',
    'Frame',
    'FrameReader',
    'FrameSettings',
    'InputError',
    'Intrinsics',
    'Lens',
    'Model',
    'Skeletons',
    'Topics',
    '__version__',
    'in_camera_frame',
    'labels_from_mask',
    'load_model',
    'metres_from_millimetres',
    'open_recording',
]

_MODULES = {
    'JOINT_NAMES': 'data_types.joints',
    'NO_BODY': 'data_types.frame',
    'Estimator': 'pose.estimator',
    'Frame': 'data_types.frame',
    'FrameReader': 'bags.frames',
    'FrameSettings': 'settings.table',
    'InputError': 'errors',
    'Intrinsics': 'data_types.camera',
    'Lens': 'data_types.camera',
    'Model': 'pose.model',
    'Skeletons': 'data_types.skeletons',
    'Topics': 'bags.topics',
    'in_camera_frame': 'camera.roll',
    'labels_from_mask': 'data_types.conversion',
    'load_model': 'model_io.model_file',
    'metres_from_millimetres': 'data_types.conversion',
    'open_recording': 'bags.frames',
}

# Type checkers read the imports above, and report a name that is not among them.
if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        """Import the public name `name` and keep it."""
        if name not in _MODULES:
            msg = f'module {__name__!r} has no attribute {name!r}'
            raise AttributeError(msg)
        value = getattr(import_module(f'{__name__}.{_MODULES[name]}'), name)
        globals()[name] = value
        return value


def __dir__() -> list[str]:
    """Return the names of the module, the public ones that are not imported yet included."""
    return sorted({*globals(), *__all__})
