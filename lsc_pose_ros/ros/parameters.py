"""The node's parameters: their names, defaults, ranges and meaning, in one table.

`config/pose_node.yaml` explains the same parameters to the user; a test holds the two together.
"""

from typing import NamedTuple, TypeAlias

from rcl_interfaces.msg import FloatingPointRange, IntegerRange, ParameterDescriptor
from rclpy.exceptions import InvalidParameterTypeException, InvalidParameterValueException
from rclpy.node import Node
from rclpy.parameter import Parameter

from lsc_pose_ros.errors import InputError

Value: TypeAlias = str | bool | int | float

RELIABILITIES = ('best_effort', 'reliable')

RAW_DEPTH = 'raw'
COMPRESSED_DEPTH = 'compressedDepth'
DEPTH_TRANSPORTS = (RAW_DEPTH, COMPRESSED_DEPTH)


class Parameters(NamedTuple):
    """The values of the parameters, named as they are.

    Attributes:
        model: path of the model file; empty for the one that comes with the package.
        graph: whether the joints are estimated together, tied by limbs, or each alone.
        depth_transport: how depth images come, one of DEPTH_TRANSPORTS.
        mask_background: the mask's pixel value that shows no body.
        sync_slop: seconds by which the stamps of a depth image and its mask may differ.
        sync_queue: how many depth images, and masks, wait for their partner.
        reliability: of the subscriptions, one of RELIABILITIES.
        minimum_confidence: joints below it are left out of the markers.
        marker_lifetime: seconds after which RViz removes a marker that is not renewed.
    """

    model: str
    graph: bool
    depth_transport: str
    mask_background: int
    sync_slop: float
    sync_queue: int
    reliability: str
    minimum_confidence: float
    marker_lifetime: float


class _Declaration(NamedTuple):
    default: Value
    meaning: str
    lowest: float | None = None
    highest: float | None = None
    choices: tuple[str, ...] = ()


DECLARATIONS: dict[str, _Declaration] = {
    'model': _Declaration('', 'Path of the model file; empty for the one in the package.'),
    'graph': _Declaration(
        default=True, meaning='Estimate the joints together, tied by limbs (eq. 16).'
    ),
    'depth_transport': _Declaration(RAW_DEPTH, 'How depth images come.', choices=DEPTH_TRANSPORTS),
    'mask_background': _Declaration(0, 'Pixel value of the mask that shows no body.', 0, 65535),
    'sync_slop': _Declaration(
        0.0, 'Seconds by which the stamps of depth image and mask may differ.', 0.0, 1.0
    ),
    'sync_queue': _Declaration(30, 'Images that wait for their partner.', 1, 1000),
    'reliability': _Declaration(
        'best_effort', 'Reliability of the subscriptions.', choices=RELIABILITIES
    ),
    'minimum_confidence': _Declaration(
        0.0, 'Joints below this confidence are left out of the markers.', 0.0, 1.0
    ),
    'marker_lifetime': _Declaration(0.5, 'Seconds that a marker lives unrenewed.', 0.0, 3600.0),
}


def declare_parameters(node: Node) -> Parameters:
    """Declare the parameters on `node` and return their values.

    Raises:
        InputError: a value has the wrong type or is none of those that are allowed.
    """
    values: dict[str, Value] = {}
    for name, declaration in DECLARATIONS.items():
        try:
            value = node.declare_parameter(
                name, declaration.default, _descriptor(declaration)
            ).value
        except (InvalidParameterTypeException, InvalidParameterValueException) as error:
            msg = f'parameter {name}: {_rule(declaration)}'
            raise InputError(msg) from error
        if declaration.choices and value not in declaration.choices:
            msg = f'parameter {name}: {value!r} is not known; {_rule(declaration)}'
            raise InputError(msg)
        values[name] = value
    return Parameters(**values)  # type: ignore[arg-type]  # declared with these types


def _descriptor(declaration: _Declaration) -> ParameterDescriptor:
    descriptor = ParameterDescriptor(
        description=declaration.meaning,
        additional_constraints=' or '.join(declaration.choices),
        read_only=True,
    )
    if declaration.lowest is None or declaration.highest is None:
        return descriptor
    if isinstance(declaration.default, float):
        descriptor.floating_point_range = [
            FloatingPointRange(from_value=declaration.lowest, to_value=declaration.highest)
        ]
    else:
        descriptor.integer_range = [
            IntegerRange(
                from_value=int(declaration.lowest), to_value=int(declaration.highest), step=1
            )
        ]
    return descriptor


def _rule(declaration: _Declaration) -> str:
    if declaration.choices:
        return f'it must be {" or ".join(declaration.choices)}'
    kind = Parameter.Type.from_parameter_value(declaration.default).name.lower()
    point = ', written with a decimal point' if kind == 'double' else ''
    if declaration.lowest is None:
        return f'it must be of type {kind}'
    return f'it must be of type {kind}{point}, from {declaration.lowest} to {declaration.highest}'
