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

"""The table of settings. Nothing else declares a name, default, range or description."""

from dataclasses import dataclass

from lsc_pose_ros.settings.setting import Change, Setting, setting, settings_of

MASK = 'mask'
PEOPLE = 'people'
BACKGROUND = 'background'
NEAREST = 'nearest'

TRACKED = 'tracked'

LOW_CONFIDENCE = 'low_confidence'
NO_POSITION = 'nan'

RAW = 'raw'
COMPRESSED = 'compressed'
COMPRESSED_DEPTH = 'compressedDepth'

AUTO = 'auto'

RECTIFIED = 'true'
NOT_RECTIFIED = 'false'

BEST_EFFORT = 'best_effort'
RELIABLE = 'reliable'


@dataclass(frozen=True)
class StartSettings:
    """What the node does when it starts."""

    autostart: bool = setting(
        default=True,
        description='Configure and activate the node when it starts.',
        change=Change.START,
        command_line=False,
        details='true: the node estimates as soon as it is started, and ends if it cannot use a '
        'parameter or the model. false: it waits for `ros2 lifecycle set /pose_node configure`, '
        'then `activate`.',
    )


@dataclass(frozen=True)
class ModelSettings:
    """Which model estimates the joints, and how."""

    model: str = setting(
        '',
        'Path of a model file, or the name of a model that comes with the package; empty for the '
        'default model.',
        details='`lsc_pose train` writes model files. The joints that the model estimates are in '
        'the read-only parameter joint_names while the node is configured.',
    )
    graph: bool = setting(
        default=True,
        description='Estimate the joints of a body together, connected by its limbs.',
        details="The graph is the paper's eq. 16 and 17. false: each joint is estimated alone, "
        'which is faster and a little less accurate.',
    )
    query_points: int = setting(
        0,
        'Number of silhouette points that vote, 10 or more; 0 for the number that the model '
        'names.',
        lowest=0,
        highest=10000,
        change=Change.ANY_TIME,
        details='Fewer points are faster and less accurate. The largest number is that of the '
        'points that the model was trained with.',
    )
    maximum_bodies: int = setting(
        20,
        'Largest number of bodies that are estimated in a frame, those with the most pixels.',
        lowest=1,
        highest=1000,
        change=Change.ANY_TIME,
        details='It bounds the time of a frame, whatever a mask shows. The log and /diagnostics '
        'say how many bodies were too many.',
    )


@dataclass(frozen=True)
class CameraSettings:
    """How the camera infos describe the camera."""

    rectified: str = setting(
        AUTO,
        'Whether the depth images are rectified.',
        choices={
            AUTO: 'rectified if a part of the topic of the depth images is rect, as in '
            'image_rect, or if D of the camera info is zero and P differs from K. Otherwise raw.',
            RECTIFIED: 'the matrix P of the camera info holds for the depth images.',
            NOT_RECTIFIED: 'the matrix K and the distortion D hold for them.',
        },
        details='The log and /diagnostics say which matrix was taken, and why. The distortion '
        'models are plumb_bob, rational_polynomial and equidistant.',
    )
    camera_roll: str = setting(
        AUTO,
        'By how many degrees the camera is turned clockwise, seen from behind it.',
        choices={
            '0': 'upright: heads point to the top of the image.',
            '90': 'heads point to the left.',
            '180': 'upside down.',
            '270': 'heads point to the right.',
            AUTO: 'from /tf and /tf_static, if they lead from the frame of the depth images to '
            'gravity_frame; otherwise 0.',
        },
        details='The joints are in the frame of the depth images, whatever the roll is.',
    )
    gravity_frame: str = setting(
        '',
        'Frame whose z axis points up, for camera_roll auto; empty for base_link, '
        'base_footprint, odom, map or world.',
    )

    @property
    def roll(self) -> int | None:
        """`camera_roll` in degrees, None for auto."""
        return None if self.camera_roll == AUTO else int(self.camera_roll)


@dataclass(frozen=True)
class SegmentationSettings:
    """How bodies are separated from what is behind them."""

    segmentation: str = setting(
        AUTO,
        'How a body is separated from what is behind it.',
        choices={
            AUTO: 'mask if masks are published, or recorded; otherwise people.',
            MASK: 'a mask image, which another program publishes, shows the bodies.',
            PEOPLE: 'no mask is needed. A network finds all people by the body parts that the '
            'pixels show.',
            BACKGROUND: 'no mask is needed. The camera stands still and sees the scene without '
            'people for background_seconds; a body is what appears in front of it later.',
            NEAREST: 'no mask is needed. A body is the nearest object of the size of a person.',
        },
    )
    range_min: float = setting(
        0.4,
        'Smallest depth of a body, without a mask.',
        unit='metres',
        lowest=0.0,
        highest=20.0,
        details='Not used with a mask. It must be below range_max.',
    )
    range_max: float = setting(
        5.0,
        'Largest depth of a body, without a mask.',
        unit='metres',
        lowest=0.0,
        highest=20.0,
        details='See range_min.',
    )
    background_seconds: float = setting(
        2.0,
        'How long the empty scene is learnt.',
        unit='seconds',
        lowest=0.1,
        highest=60.0,
        details='Used with segmentation background. The time starts when the node is activated.',
    )
    background_margin: float = setting(
        0.1,
        'By how much a body must be nearer than the empty scene.',
        unit='metres',
        lowest=0.01,
        highest=2.0,
        details="Used with segmentation background. Choose more than the noise of the camera's "
        'depth.',
    )

    @property
    def reads_masks(self) -> bool:
        """Whether masks are used if there are any."""
        return self.segmentation in (AUTO, MASK)


@dataclass(frozen=True)
class DepthSettings:
    """Which depths are measurements."""

    minimum_depth: float = setting(
        0.1,
        'Least depth that the camera measures; smaller values are read as no depth.',
        unit='metres',
        lowest=0.01,
        highest=10.0,
    )
    maximum_depth: float = setting(
        20.0,
        'Largest depth that the camera measures; larger values are read as no depth.',
        unit='metres',
        lowest=0.1,
        highest=100.0,
        details='Some drivers send the largest number for pixels without depth.',
    )


@dataclass(frozen=True)
class MaskSettings:
    """How masks are read."""

    mask_background: int = setting(
        0,
        'Pixel value of the mask that shows no body; 255 for Azure Kinect, -1 for some programs.',
        lowest=-1,
        highest=65535,
    )


@dataclass(frozen=True)
class TemporalSettings:
    """How the estimates of consecutive frames are connected."""

    body_ids: str = setting(
        AUTO,
        'Where the numbers of the bodies come from.',
        choices={
            AUTO: 'mask if the bodies are those of a mask image, otherwise tracked.',
            MASK: 'the number of a body is the value of its pixels in the mask.',
            TRACKED: 'the node tracks the bodies, and each keeps its number. For segmentations '
            'that number the bodies differently in each image.',
        },
    )
    minimum_body_confidence: float = setting(
        0.1,
        'Least confidence of a body: the mean confidence of the better half of its joints.',
        unit='probability',
        lowest=0.0,
        highest=1.0,
        change=Change.ANY_TIME,
        details='Other bodies are not published. People who are cut off or hidden have less than '
        'others, as has furniture that is taken for a person.',
    )
    minimum_stature: float = setting(
        0.8,
        'Least stature of a body, from the lengths of its trunk and its legs; 0 for any.',
        unit='metres',
        lowest=0.0,
        highest=2.0,
        change=Change.ANY_TIME,
        details='Smaller bodies are not published: they are things, or people of whom too little '
        'is visible. Children of four years are taller than 0.9 m. Bodies are not judged if the '
        'model does not estimate head, neck, torso, pelvis, hips, knees and ankles.',
    )
    hidden_joints: str = setting(
        LOW_CONFIDENCE,
        'How joints are published that something hides, or that are outside of the image.',
        choices={
            LOW_CONFIDENCE: 'at their most probable position, with a low confidence.',
            NO_POSITION: 'without a position (NaN), if their confidence is below 0.3.',
        },
        change=Change.ANY_TIME,
    )
    temporal: bool = setting(
        default=True,
        description='Estimate a person with what the frames before say of the person.',
        change=Change.ANY_TIME,
        details='Joints that a frame does not show clearly are chosen near where they were, and '
        'the direction in which a person faces is followed. A frame that clearly says otherwise '
        'wins, and nothing is expected after a gap of half a second.',
    )
    smoothing: bool = setting(
        default=False,
        description='Smooth the joints over time with a One-Euro filter.',
        change=Change.ANY_TIME,
    )
    smoothing_cutoff: float = setting(
        1.0,
        'Cutoff frequency of the filter for a joint at rest.',
        unit='hertz',
        lowest=0.01,
        highest=100.0,
        change=Change.ANY_TIME,
        details='Lower values remove more jitter; higher values reduce the delay.',
    )
    smoothing_beta: float = setting(
        8.0,
        'How much the cutoff frequency rises with the speed of a joint.',
        unit='per metre',
        lowest=0.0,
        highest=100.0,
        change=Change.ANY_TIME,
        details='Higher values reduce the delay of fast movements.',
    )

    def tracks(self, *, from_mask: bool) -> bool:
        """Return whether the bodies are tracked from frame to frame.

        Args:
            from_mask: whether the bodies are those of a mask image.
        """
        return self.body_ids == TRACKED or (self.body_ids == AUTO and not from_mask)


@dataclass(frozen=True)
class SynchronizationSettings:
    """Which messages depth images and masks are, and how they are joined."""

    depth_transport: str = setting(
        RAW,
        'Transport of the depth images.',
        choices={
            RAW: 'sensor_msgs/Image on depth/image.',
            COMPRESSED_DEPTH: 'sensor_msgs/CompressedImage on depth/image/compressedDepth, PNG '
            'or RVL.',
        },
    )
    mask_transport: str = setting(
        RAW,
        'Transport of the masks.',
        choices={
            RAW: 'sensor_msgs/Image on mask.',
            COMPRESSED: 'sensor_msgs/CompressedImage on mask/compressed, PNG. JPEG would change '
            'the numbers of the bodies.',
        },
    )
    sync_slop: float = setting(
        0.0,
        'Largest difference between the stamps of a depth image and its mask.',
        unit='seconds',
        lowest=0.0,
        highest=1.0,
        change=Change.ANY_TIME,
        details='0.0 if the mask has the stamp of its depth image, as it should. Keep it below '
        'half the time between two images.',
    )
    sync_queue: int = setting(
        30,
        'Number of depth images, and of masks, that wait for their partner.',
        lowest=1,
        highest=1000,
        details='If the masks come late, all depth images of that time must fit: one second at '
        '30 Hz is 30 images.',
    )


@dataclass(frozen=True)
class SubscriptionSettings:
    """How the node subscribes."""

    reliability: str = setting(
        AUTO,
        'Reliability of the subscriptions.',
        command_line=False,
        choices={
            AUTO: 'reliable if all publishers of a topic offer it, otherwise best_effort.',
            BEST_EFFORT: 'receives from every publisher and does not wait for lost images. With '
            'the default settings of Fast DDS most large images are lost; the profile '
            'config/fastdds_profile.xml prevents that.',
            RELIABLE: 'loses no image, but receives nothing from publishers that offer best '
            'effort only, as many camera drivers do.',
        },
    )


@dataclass(frozen=True)
class DrawingSettings:
    """Which joints are drawn as markers, and for how long."""

    minimum_confidence: float = setting(
        0.0,
        'Least confidence of the joints in markers and transforms.',
        unit='probability',
        lowest=0.0,
        highest=1.0,
        change=Change.ANY_TIME,
        details='~/skeletons has all joints. Confidence is the probability that a joint is within '
        '10 cm of its true position: 0.5 leaves out the joints that are more often wrong than '
        'right.',
    )
    marker_lifetime: float = setting(
        0.5,
        'Time after which RViz removes a marker that is not renewed; 0 for never.',
        unit='seconds',
        lowest=0.0,
        highest=3600.0,
        change=Change.ANY_TIME,
    )

    @property
    def marker_lifetime_ns(self) -> int:
        """`marker_lifetime` in nanoseconds."""
        return round(self.marker_lifetime * 1e9)


@dataclass(frozen=True)
class TransformSettings:
    """What else the node publishes."""

    publish_tf: bool = setting(
        default=False,
        description='Publish the joints on /tf, too.',
        command_line=False,
        details='REP-155 names the frames: head_1, l_elbow_1 and, midway between the hips, '
        'body_1 for the body number 1. It needs the package tf2_msgs.',
    )
    publish_ros4hri: bool = setting(
        default=False,
        description='Publish the bodies below /humans/bodies, too, for programs of ROS4HRI.',
        command_line=False,
        details='REP-155 names the topics: /humans/bodies/tracked lists the ids, and the body '
        'number 1 has the id b1 and the topics /humans/bodies/b1/roi, skeleton2d and '
        'joint_states. The frames of publish_tf then end in the id: body_b1. It needs the package '
        'hri_msgs.',
    )


SECTIONS: dict[str, tuple[type, ...]] = {
    'Start': (StartSettings,),
    'Model': (ModelSettings,),
    'Camera': (CameraSettings, DepthSettings),
    'Segmentation': (SegmentationSettings, MaskSettings),
    'Tracking and smoothing': (TemporalSettings,),
    'Topics': (SynchronizationSettings, SubscriptionSettings),
    'Markers, transforms and ROS4HRI': (DrawingSettings, TransformSettings),
}
"""The titles under which the documents list the groups of settings."""


# The fields of a dataclass are those of its last base first.
@dataclass(frozen=True)
class FrameSettings(
    SynchronizationSettings, MaskSettings, SegmentationSettings, DepthSettings, CameraSettings
):
    """How frames are made from messages, live and from recordings."""


@dataclass(frozen=True)
class NodeSettings(
    TransformSettings,
    DrawingSettings,
    SubscriptionSettings,
    TemporalSettings,
    FrameSettings,
    ModelSettings,
    StartSettings,
):
    """All settings: the parameters of `pose_node`."""


SETTINGS: dict[str, Setting] = {
    name: each
    for groups in SECTIONS.values()
    for group in groups
    for name, each in settings_of(group).items()
}
"""All settings by their names, in the order of the documents."""

SEGMENTATIONS = tuple(SETTINGS['segmentation'].choices)
