"""README's tables say what the node declares."""

import re
from pathlib import Path

import pytest
import yaml

pytest.importorskip('rclpy', reason='ROS 2 (rclpy) is not installed')

from lsc_pose_ros.data_types.joints import JOINT_NUMBERS
from lsc_pose_ros.ros.node.parameters import (
    ALWAYS,
    DECLARATIONS,
    NEVER,
    UNCONFIGURED,
    Declaration,
)

ROOT = Path(__file__).resolve().parents[2]

# README's words for when a parameter may be set.
CHANGES = {'any time': ALWAYS, 'unconfigured': UNCONFIGURED, 'start': NEVER}


def section(title: str) -> str:
    """The text below a heading, up to the next one."""
    readme = (ROOT / 'README.md').read_text(encoding='utf-8')
    found = re.search(rf'^### {title}\n(.*?)^##', readme, re.MULTILINE | re.DOTALL)
    assert found is not None, title
    return found.group(1)


def rows(title: str) -> list[list[str]]:
    """The cells of the rows of a section's tables."""
    lines = [line for line in section(title).splitlines() if line.startswith('|')]
    return [[cell.strip() for cell in line.strip('|').split('|')] for line in lines]


def parameter_rows() -> dict[str, list[str]]:
    table = {cells[0].strip('`'): cells[1:] for cells in rows('Parameters')}
    return {
        name: cells for name, cells in table.items() if name.strip('-') and name != 'parameter'
    }


def described(declaration: Declaration) -> str:
    """What README's column of values says."""
    if declaration.choices:
        return ', '.join(f'`{choice}`' for choice in declaration.choices)
    if declaration.lowest is not None:
        return f'{declaration.lowest} to {declaration.highest}'
    return 'path' if isinstance(declaration.default, str) else ''


def test_readme_has_every_parameter() -> None:
    assert sorted(parameter_rows()) == sorted(DECLARATIONS)


@pytest.mark.parametrize('name', DECLARATIONS)
def test_readme_describes_the_parameter_as_it_is_declared(name: str) -> None:
    default, values, change, meaning = parameter_rows()[name]
    declaration = DECLARATIONS[name]
    value = yaml.safe_load(default.strip('`'))
    assert (value, type(value)) == (declaration.default, type(declaration.default))
    assert values == described(declaration)
    assert CHANGES[change] == declaration.change
    assert meaning


def test_readme_numbers_the_joints() -> None:
    named = re.findall(r'(\d+) `(\w+)`', section('Joints'))
    assert {name: int(number) for number, name in named} == JOINT_NUMBERS


def test_readme_names_the_topics_and_the_cameras() -> None:
    topics = {cells[0].strip('`') for cells in rows('Topics')}
    assert topics >= {
        'depth/image', 'depth/camera_info', 'mask',
        '~/skeletons', '~/joint_markers', '/tf', '/diagnostics',
    }  # fmt: skip
    cameras = set(re.findall(r'^\| \[`(\w+)`\]', section('Cameras'), re.MULTILINE))
    assert cameras == {path.stem for path in (ROOT / 'config' / 'cameras').iterdir()}
