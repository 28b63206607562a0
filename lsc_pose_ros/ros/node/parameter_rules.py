"""Which changes of the parameters the node takes, and what it says of the others."""

from collections.abc import Iterable

from rclpy.parameter import Parameter

from lsc_pose_ros.ros.node.parameters import DECLARATIONS, UNCONFIGURED, unknown_choice

# Fewer votes than this say nothing.
FEWEST_QUERY_POINTS = 10


def with_whole_numbers(parameters: Iterable[Parameter]) -> list[Parameter]:
    """Return `parameters` as they can be set: `1` is good for a number with a decimal point."""
    return [
        Parameter(each.name, Parameter.Type.DOUBLE, float(each.value))
        if each.type_ == Parameter.Type.INTEGER and _is_double(each.name)
        else each
        for each in parameters
    ]


def objection_to(changes: Iterable[Parameter], *, configured: bool, points: int) -> str:
    """Say why parameters cannot be changed so, beyond type and range; empty where they can.

    Args:
        changes: the new values.
        configured: whether the node is configured.
        points: how many points a silhouette has, 0 where no model is loaded.
    """
    for change in changes:
        declaration = DECLARATIONS.get(change.name)
        if declaration is None:
            continue  # rclpy's own
        if configured and declaration.change == UNCONFIGURED:
            return (
                f'parameter {change.name}: it can be set only {UNCONFIGURED}; deactivate and '
                'clean up the node first, or start it with the new value'
            )
        objection = unknown_choice(change.name, change.value)
        if not objection and change.name == 'query_points':
            objection = bad_query_points(change.value, points)
        if objection:
            return objection
    return ''


def bad_query_points(query_points: int, points: int) -> str:
    """Say why so many points cannot vote; empty where they can.

    Args:
        query_points: how many are asked for, 0 for as many as in training.
        points: how many a silhouette has, 0 where no model is loaded.
    """
    if query_points == 0 or FEWEST_QUERY_POINTS <= query_points <= (points or query_points):
        return ''
    most = f'{points}, the points that the model was trained with' if points else 'more'
    return (
        f'parameter query_points: {query_points} cannot be used; it must be 0 or from '
        f'{FEWEST_QUERY_POINTS} to {most}'
    )


def _is_double(name: str) -> bool:
    return name in DECLARATIONS and isinstance(DECLARATIONS[name].default, float)
