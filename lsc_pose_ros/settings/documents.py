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

"""Writes the table of settings as `pose_node.yaml` and as the table of `docs/parameters.md`."""

import textwrap
from collections.abc import Iterator

from lsc_pose_ros.settings.setting import Change, Setting, Value, settings_of
from lsc_pose_ros.settings.table import SECTIONS, SETTINGS

BEGIN_MARK = '<!-- settings: begin; made by `make settings` -->'
END_MARK = '<!-- settings: end -->'

_LINE_LENGTH = 99
_INDENT = '    '

_YAML_HEADER = """\
# Parameters of pose_node, with their defaults.
#
#     ros2 run lsc_pose_ros pose_node --ros-args --params-file pose_node.yaml
#
# A parameter that "can change at any time" can be set while the node runs:
# `ros2 param set /pose_node smoothing true`. All others except autostart can be set while the node
# is unconfigured: when it starts, or after `ros2 lifecycle set /pose_node deactivate` and
# `... cleanup`. The node refuses a value that it cannot use, and says why.
#
# `make settings` writes this file from lsc_pose_ros/settings/table.py.
/**:
  ros__parameters:
"""

_COLUMNS = ('parameter', 'default', 'values', 'unit', 'can change', 'option', 'meaning')


def yaml_file() -> str:
    """Return the text of `pose_node.yaml`: every parameter with its default, explained."""
    sections = []
    for title, groups in SECTIONS.items():
        entries = [_yaml_entry(each) for group in groups for each in settings_of(group).values()]
        sections.append('\n'.join([f'{_INDENT}# ---- {title}\n', *entries]))
    return _YAML_HEADER + '\n'.join(sections)


def markdown_table() -> str:
    """Return the Markdown table of all settings."""
    rows = [_COLUMNS, ('---',) * len(_COLUMNS), *map(_markdown_row, SETTINGS.values())]
    return ''.join(f'| {" | ".join(row)} |\n' for row in rows)


def with_table(page: str) -> str:
    """Return a Markdown page with the table between its two marks.

    Raises:
        ValueError: the page does not have the two marks, one after the other.
    """
    before, begin, rest = page.partition(BEGIN_MARK)
    _, end, after = rest.partition(END_MARK)
    if not (begin and end):
        msg = f'the page has no lines "{BEGIN_MARK}" and "{END_MARK}"'
        raise ValueError(msg)
    return f'{before}{begin}\n\n{markdown_table()}\n{end}{after}'


def _yaml_entry(each: Setting) -> str:
    lines = list(_wrapped(f'{each.description} {each.details}'.strip()))
    for choice, meaning in each.choices.items():
        lines += _wrapped(f'{choice}: {meaning}', hanging='  ')
    lines += _wrapped(' '.join(_facts(each)))
    comment = ''.join(f'{_INDENT}# {line}\n' for line in lines)
    return f'{comment}{_INDENT}{each.name}: {_yaml_value(each.default)}\n'


def _facts(each: Setting) -> Iterator[str]:
    """Yield unit, range and change, each as a sentence."""
    if each.unit:
        yield f'{each.unit.capitalize()}.'
    if each.lowest is not None:
        yield f'{each.lowest} to {each.highest}.'
    if each.change != Change.UNCONFIGURED:
        yield f'Can change {each.change.value}.'


def _wrapped(text: str, hanging: str = '') -> list[str]:
    width = _LINE_LENGTH - len(f'{_INDENT}# ')
    return textwrap.wrap(
        text, width, subsequent_indent=hanging, break_long_words=False, break_on_hyphens=False
    )


def _yaml_value(value: Value) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return str(value) or '""'


def _markdown_row(each: Setting) -> tuple[str, ...]:
    return (
        f'`{each.name}`',
        f'`{_yaml_value(each.default)}`',
        _markdown_values(each),
        each.unit,
        each.change.name.lower().replace('_', ' '),
        _markdown_option(each),
        each.description,
    )


def _markdown_values(each: Setting) -> str:
    if each.choices:
        return ', '.join(f'`{choice}`' for choice in each.choices)
    if each.lowest is not None:
        return f'{each.lowest} to {each.highest}'
    return '`true`, `false`' if isinstance(each.default, bool) else 'text'


def _markdown_option(each: Setting) -> str:
    if not each.command_line:
        return ''
    if isinstance(each.default, bool):
        return f'`{each.option}`, `--no-{each.option[2:]}`'
    return f'`{each.option}`'
