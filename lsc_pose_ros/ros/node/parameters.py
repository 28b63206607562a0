"""The node's parameters: their names, defaults, ranges and meaning, in one table.

`config/pose_node.yaml` explains the same parameters to the user; a test holds the two together.
"""

from typing import NamedTuple, TypeAlias

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node
from rclpy.parameter import Parameter

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.segmentation.segmenter import MASK, SEGMENTATIONS

Value: TypeAlias = str | bool | int | float

RAW = 'raw'
COMPRESSED_DEPTH = 'compressedDepth'
DEPTH_TRANSPORTS = (RAW, COMPRESSED_DEPTH)

COMPRESSED = 'compressed'
MASK_TRANSPORTS = (RAW, COMPRESSED)

AUTO = 'auto'
RELIABILITIES = (AUTO, 'best_effort', 'reliable')

TRACKED = 'tracked'
BODY_IDS = (MASK, TRACKED)

# When a parameter may be changed.
ALWAYS = 'at any time'
UNCONFIGURED = 'while the node is unconfigured'
NEVER = 'only where the node is started'


class Parameters(NamedTuple):
    """The values of the parameters, named as they are.

    Attributes:
        autostart: whether the node configures and activates itself.
        model: path of the model file, or the name of one that comes with the package; empty for
            its default.
        graph: whether the joints are estimated together, tied by limbs, or each alone.
        query_points: how many points of a silhouette vote; 0 for as many as in training.
        segmentation: how a body is told from what is behind it, one of SEGMENTATIONS.
        range_min: depth, metres, from which on something can be a body, without a mask.
        range_max: depth, metres, up to which something can be a body, without a mask.
        background_seconds: how long the empty scene is learnt.
        background_margin: metres by which a body is nearer than the empty scene.
        mask_background: the mask's pixel value that shows no body.
        depth_transport: how depth images come, one of DEPTH_TRANSPORTS.
        mask_transport: how masks come, one of MASK_TRANSPORTS.
        reliability: of the subscriptions, one of RELIABILITIES.
        sync_slop: seconds by which the stamps of a depth image and its mask may differ.
        sync_queue: how many depth images, and masks, wait for their partner.
        body_ids: where the bodies' numbers come from, one of BODY_IDS.
        smoothing: whether the joints are smoothed over time.
        smoothing_cutoff: One-Euro's cutoff frequency at rest, Hz.
        smoothing_beta: by how much the cutoff rises with speed, 1/m.
        minimum_confidence: joints below it are left out of markers and transforms.
        marker_lifetime: seconds after which RViz removes a marker that is not renewed.
        publish_tf: whether the joints are published as transforms, too.
    """

    autostart: bool
    model: str
    graph: bool
    query_points: int
    segmentation: str
    range_min: float
    range_max: float
    background_seconds: float
    background_margin: float
    mask_background: int
    depth_transport: str
    mask_transport: str
    reliability: str
    sync_slop: float
    sync_queue: int
    body_ids: str
    smoothing: bool
    smoothing_cutoff: float
    smoothing_beta: float
    minimum_confidence: float
    marker_lifetime: float
    publish_tf: bool


class Declaration(NamedTuple):
    """What a parameter may be.

    Attributes:
        default: its value where none is given; it also says the type.
        meaning: one line for people.
        lowest: the least value of a number.
        highest: the greatest value of a number.
        choices: all values that a text may have; none where any text will do.
        change: ALWAYS, UNCONFIGURED or NEVER.
    """

    default: Value
    meaning: str
    lowest: float | None = None
    highest: float | None = None
    choices: tuple[str, ...] = ()
    change: str = UNCONFIGURED

    @property
    def rule(self) -> str:
        """What a value must be, as the end of a sentence."""
        if self.choices:
            return f'it must be {" or ".join(self.choices)}'
        kind = Parameter.Type.from_parameter_value(self.default).name.lower()
        point = ', written with a decimal point' if kind == 'double' else ''
        if self.lowest is None:
            return f'it must be of type {kind}'
        return f'it must be of type {kind}{point}, from {self.lowest} to {self.highest}'

    @property
    def descriptor(self) -> ParameterDescriptor:
        """What `ros2 param describe` shows."""
        descriptor = ParameterDescriptor(
            description=self.meaning,
            additional_constraints='; '.join(
                filter(None, (' or '.join(self.choices), f'can be set {self.change}'))
            ),
            read_only=self.change == NEVER,
        )
        if self.lowest is None or self.highest is None:
            return descriptor
        if isinstance(self.default, float):
            descriptor.floating_point_range = [
                FloatingPointRange(from_value=self.lowest, to_value=self.highest)
            ]
        else:
            descriptor.integer_range = [
                IntegerRange(from_value=int(self.lowest), to_value=int(self.highest), step=1)
            ]
        return descriptor


DECLARATIONS: dict[str, Declaration] = {
    'autostart': Declaration(
        default=True, meaning='Configure and activate without being told to.', change=NEVER
    ),
    'model': Declaration(
        '', 'Path of the model file, or the name of one in the package; empty for its default.'
    ),
    'graph': Declaration(
        default=True, meaning='Estimate the joints together, tied by limbs (eq. 16).'
    ),
    'query_points': Declaration(
        0,
        'Points of a silhouette that vote, 10 or more; 0 for as many as in training.',
        lowest=0,
        highest=10000,
        change=ALWAYS,
    ),
    'segmentation': Declaration(
        MASK, 'How a body is told from what is behind it.', choices=SEGMENTATIONS
    ),
    'range_min': Declaration(
        0.4, 'Without a mask: depth in metres from which on something can be a body.', 0.0, 20.0
    ),
    'range_max': Declaration(
        5.0, 'Without a mask: depth in metres up to which something can be a body.', 0.0, 20.0
    ),
    'background_seconds': Declaration(
        2.0, 'Seconds in which the empty scene is learnt (segmentation background).', 0.1, 60.0
    ),
    'background_margin': Declaration(
        0.1, 'Metres by which a body is nearer than the empty scene.', 0.01, 2.0
    ),
    'mask_background': Declaration(0, 'Pixel value of the mask that shows no body.', 0, 65535),
    'depth_transport': Declaration(RAW, 'How depth images come.', choices=DEPTH_TRANSPORTS),
    'mask_transport': Declaration(RAW, 'How masks come.', choices=MASK_TRANSPORTS),
    'reliability': Declaration(
        AUTO,
        'Reliability of the subscriptions; auto takes what the publisher offers.',
        choices=RELIABILITIES,
    ),
    'sync_slop': Declaration(
        0.0,
        'Seconds by which the stamps of depth image and mask may differ.',
        lowest=0.0,
        highest=1.0,
        change=ALWAYS,
    ),
    'sync_queue': Declaration(30, 'Images that wait for their partner.', 1, 1000),
    'body_ids': Declaration(
        MASK, "Bodies' numbers: the mask's, or kept stable by tracking.", choices=BODY_IDS
    ),
    'smoothing': Declaration(
        default=False, meaning='Smooth the joints over time (One-Euro filter).', change=ALWAYS
    ),
    'smoothing_cutoff': Declaration(
        1.0, 'Cutoff frequency at rest, Hz; lower is smoother.', 0.01, 100.0, change=ALWAYS
    ),
    'smoothing_beta': Declaration(
        8.0,
        'How much the cutoff rises with speed, 1/m; higher follows faster.',
        lowest=0.0,
        highest=100.0,
        change=ALWAYS,
    ),
    'minimum_confidence': Declaration(
        0.0,
        'Joints below this confidence, a probability, are left out of markers and transforms.',
        lowest=0.0,
        highest=1.0,
        change=ALWAYS,
    ),
    'marker_lifetime': Declaration(
        0.5, 'Seconds that a marker lives unrenewed; 0 for ever.', 0.0, 3600.0, change=ALWAYS
    ),
    'publish_tf': Declaration(default=False, meaning='Publish the joints on /tf, too.'),
}

DEFAULTS = Parameters(
    **{name: each.default for name, each in DECLARATIONS.items()}  # type: ignore[arg-type]
)


def declare_parameters(node: Node) -> Parameters:
    """Declare the parameters on `node` and return their values.

    Raises:
        InputError: a value has the wrong type or is none of those that are allowed.
    """
    for name, declaration in DECLARATIONS.items():
        _declare(node, name, declaration)
    parameters = read_parameters(node)
    for name, value in parameters._asdict().items():
        objection = unknown_choice(name, value)
        if objection:
            raise InputError(objection)
    return parameters


def read_parameters(node: Node) -> Parameters:
    """Return the values that the declared parameters have now."""
    return Parameters(*(node.get_parameter(name).value for name in Parameters._fields))


def _declare(node: Node, name: str, declaration: Declaration) -> None:
    try:
        node.declare_parameter(name, declaration.default, declaration.descriptor)
    except (InvalidParameterTypeException, InvalidParameterValueException) as error:
        msg = f'parameter {name}: {declaration.rule}'
        raise InputError(msg) from error


def unknown_choice(name: str, value: object) -> str:
    """Say why `value` is none of a parameter's choices; empty where it is one."""
    declaration = DECLARATIONS[name]
    if not declaration.choices or value in declaration.choices:
        return ''
    return f'parameter {name}: {value!r} is not known; {declaration.rule}'
