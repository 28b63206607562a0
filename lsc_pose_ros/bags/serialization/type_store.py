"""The ROS message types we read and write: how they are laid out, defined and fingerprinted."""

from functools import cache
from typing import Any

from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.base import TypesysError
from rosbags.typesys.store import Typestore

from lsc_pose_ros.errors import InputError


@cache
def typestore() -> Typestore:
    """Return ROS 2 Jazzy's message types."""
    return get_typestore(Stores.ROS2_JAZZY)


def message_class(type_name: str) -> Any:  # noqa: ANN401
    """Return the class of the messages of the type `type_name`; its fields are the message's."""
    return typestore().types[type_name]


@cache
def type_definition(type_name: str) -> str:
    """Return a type's definition with those of all types it is made of, as rosbag2 stores it.

    Raises:
        InputError: the type is not one of ROS 2 Jazzy's common messages.
    """
    try:
        return typestore().generate_msgdef(type_name, ros_version=2)[0]
    except (KeyError, TypesysError) as error:
        msg = (
            f'messages of the type {type_name!r} cannot be written: '
            'its definition is not among the common messages of ROS 2 Jazzy'
        )
        raise InputError(msg) from error


@cache
def type_hash(type_name: str) -> str:
    """Return a type's hash by REP-2016, for example 'RIHS01_d31d...'."""
    return typestore().hash_rihs01(type_name)
