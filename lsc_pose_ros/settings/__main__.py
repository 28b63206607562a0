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

"""Write `pose_node.yaml` and the table of `docs/parameters.md`: `python -m lsc_pose_ros.settings`.

For maintainers, after a change of `table.py`; run it in the root of a checkout.
"""

import sys
from pathlib import Path

from lsc_pose_ros.settings.documents import with_table, yaml_file

YAML_PATH = Path('lsc_pose_ros/resources/config/pose_node.yaml')
PAGE_PATH = Path('docs/parameters.md')


def main() -> int:
    """Write both files and return 0."""
    YAML_PATH.write_text(yaml_file(), encoding='utf-8')
    PAGE_PATH.write_text(with_table(PAGE_PATH.read_text(encoding='utf-8')), encoding='utf-8')
    return 0


if __name__ == '__main__':
    sys.exit(main())
