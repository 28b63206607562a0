"""The tables of the documentation match what the node declares."""

import re
from pathlib import Path

import pytest
import yaml

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.resources.package_files import resource
from lsc_pose_ros.ros.node.parameters import (
    ALWAYS,
    DECLARATIONS,
    NEVER,
    UNCONFIGURED,
    Declaration,
)

ROOT = Path(__file__).resolve().parents[2]

# The table's words for when a parameter may be set.
CHANGES = {'any time': ALWAYS, 'unconfigured': UNCONFIGURED, 'start': NEVER}


def text_of(page: str) -> str:
    return (ROOT / 'docs' / f'{page}.md').read_text(encoding='utf-8')


def rows(page: str) -> list[list[str]]:
    """The cells of the rows of a page's tables."""
    lines = [line for line in text_of(page).splitlines() if line.startswith('|')]
    return [[cell.strip() for cell in line.strip('|').split('|')] for line in lines]


def parameter_rows() -> dict[str, list[str]]:
    table = {cells[0].strip('`'): cells[1:] for cells in rows('parameters')}
    return {
        name: cells for name, cells in table.items() if name.strip('-') and name != 'parameter'
    }


def described(declaration: Declaration) -> str:
    """What the column of values says."""
    if declaration.choices:
        return ', '.join(f'`{choice}`' for choice in declaration.choices)
    if declaration.lowest is not None:
        return f'{declaration.lowest} to {declaration.highest}'
    return 'path' if isinstance(declaration.default, str) else ''


def test_every_parameter_is_documented() -> None:
    assert sorted(parameter_rows()) == sorted(DECLARATIONS)


@pytest.mark.parametrize('name', DECLARATIONS)
def test_parameter_is_documented_as_it_is_declared(name: str) -> None:
    default, values, change, meaning = parameter_rows()[name]
    declaration = DECLARATIONS[name]
    value = yaml.safe_load(default.strip('`'))
    assert (value, type(value)) == (declaration.default, type(declaration.default))
    assert values == described(declaration)
    assert CHANGES[change] == declaration.change
    assert meaning


def test_joints_are_documented_with_their_numbers() -> None:
    named = re.findall(r'(\d+) `(\w+)`', text_of('joints'))
    assert {name: int(number) for number, name in named} == JOINT_NUMBERS


def test_topics_are_documented() -> None:
    topics = {cells[0].strip('`') for cells in rows('live')}
    assert topics >= {
        'depth/image', 'depth/camera_info', 'mask',
        '~/skeletons', '~/joint_markers', '/tf', '/diagnostics',
    }  # fmt: skip


def test_camera_presets_are_documented() -> None:
    cameras = set(re.findall(r'^\| \[`(\w+)`\]', text_of('cameras'), re.MULTILINE))
    presets = resource('config', 'cameras')
    assert cameras == {path.stem for path in presets.iterdir()}
