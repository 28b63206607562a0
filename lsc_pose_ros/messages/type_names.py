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

"""The names of the ROS message types that this package reads and writes."""

TIME = 'builtin_interfaces/msg/Time'
DURATION = 'builtin_interfaces/msg/Duration'
HEADER = 'std_msgs/msg/Header'
COLOR_RGBA = 'std_msgs/msg/ColorRGBA'

POINT = 'geometry_msgs/msg/Point'
VECTOR3 = 'geometry_msgs/msg/Vector3'
QUATERNION = 'geometry_msgs/msg/Quaternion'
POSE = 'geometry_msgs/msg/Pose'
TRANSFORM = 'geometry_msgs/msg/Transform'
TRANSFORM_STAMPED = 'geometry_msgs/msg/TransformStamped'

IMAGE = 'sensor_msgs/msg/Image'
COMPRESSED_IMAGE = 'sensor_msgs/msg/CompressedImage'
CAMERA_INFO = 'sensor_msgs/msg/CameraInfo'
REGION_OF_INTEREST = 'sensor_msgs/msg/RegionOfInterest'
POINT_CLOUD = 'sensor_msgs/msg/PointCloud2'
POINT_FIELD = 'sensor_msgs/msg/PointField'
JOINT_STATE = 'sensor_msgs/msg/JointState'

MARKER = 'visualization_msgs/msg/Marker'
MARKER_ARRAY = 'visualization_msgs/msg/MarkerArray'
MESH_FILE = 'visualization_msgs/msg/MeshFile'

TF_MESSAGE = 'tf2_msgs/msg/TFMessage'

IDS_LIST = 'hri_msgs/msg/IdsList'
NORMALIZED_POINT = 'hri_msgs/msg/NormalizedPointOfInterest2D'
NORMALIZED_REGION = 'hri_msgs/msg/NormalizedRegionOfInterest2D'
SKELETON_2D = 'hri_msgs/msg/Skeleton2D'


def full_type_name(name: str) -> str:
    """Return the name of a message type with its folder.

    Some programs write `sensor_msgs/Image`, as ROS 1 did, for `sensor_msgs/msg/Image`.
    """
    package, slash, rest = name.partition('/')
    return f'{package}/msg/{rest}' if slash and '/' not in rest else name
