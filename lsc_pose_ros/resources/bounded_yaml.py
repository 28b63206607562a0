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

"""Parses YAML text of strangers: the time is bounded by its length, and the result by its text.

An alias (`*name`) repeats what it names, so that a few lines stand for billions of values, and a
number may have as many digits as the text. No file that we read needs either.
"""

from typing import Any, NoReturn

import yaml

from lsc_pose_ros.errors import excerpt

_LONGEST_NUMBER = 40
_DEEPEST = 50
_MOST_NODES = 50_000

_NUMBERS = ('tag:yaml.org,2002:int', 'tag:yaml.org,2002:float')

# What constructors of PyYAML raise for values that do not fit their tags.
_UNSUITABLE = (ValueError, TypeError, LookupError, AttributeError, ArithmeticError)

_LONGEST_REASON = 200


def parse_yaml(text: str) -> Any:  # noqa: ANN401 - anything that YAML holds
    """Return what YAML text holds, without aliases, long numbers and keys that occur twice.

    Raises:
        ValueError: it is not such YAML; the message names the line.
    """
    try:
        return yaml.load(text, _BoundedLoader)  # noqa: S506 - a SafeLoader
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = '' if mark is None else f'line {mark.line + 1}: '
        msg = f'{line}{excerpt(error.problem or error.context, _LONGEST_REASON)}'
        raise ValueError(msg) from error
    except (yaml.YAMLError, *_UNSUITABLE) as error:
        raise ValueError(excerpt(str(error) or type(error).__name__, _LONGEST_REASON)) from error


class _BoundedLoader(yaml.SafeLoader):
    """Refuses text that stands for more than it shows."""

    def __init__(self, stream: str) -> None:
        super().__init__(stream)
        self._depth = 0
        self._nodes = 0

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:  # noqa: ANN401
        event = self.peek_event()  # type: ignore[no-untyped-call]
        if isinstance(event, yaml.AliasEvent) or event.anchor is not None:
            self._refuse(event, 'anchors (&) and aliases (*) are not allowed')
        self._nodes += 1
        if self._nodes > _MOST_NODES:
            self._refuse(event, f'more than {_MOST_NODES} values')
        if self._depth >= _DEEPEST:
            self._refuse(event, f'nested more than {_DEEPEST} deep')
        self._depth += 1
        node = super().compose_node(parent, index)
        self._depth -= 1
        if isinstance(node, yaml.ScalarNode):
            self._check_number(event, node)
        return node

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Any, Any]:  # noqa: FBT001, FBT002
        seen = set()
        for key, _ in node.value:
            if isinstance(key, yaml.ScalarNode):
                if (key.tag, key.value) in seen:
                    self._refuse(key, f'the key {excerpt(key.value)} occurs twice')
                seen.add((key.tag, key.value))
        return super().construct_mapping(node, deep)

    def _check_number(self, event: yaml.Event, node: yaml.ScalarNode) -> None:
        if node.tag in _NUMBERS and len(node.value) > _LONGEST_NUMBER:
            self._refuse(event, f'a number with {len(node.value)} digits')

    @staticmethod
    def _refuse(place: Any, why: str) -> NoReturn:  # noqa: ANN401 - an event or a node
        raise yaml.composer.ComposerError(None, None, why, place.start_mark)
