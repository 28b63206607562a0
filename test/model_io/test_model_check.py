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

"""Models whose arrays would make a kernel read outside of them are refused."""

import numpy as np
import pytest
from model_parts import edit

from lsc_pose_ros.model_io.model_check import check_model
from lsc_pose_ros.model_io.unusable_model import UnusableModelError


def votes(forest, kind, **changes):
    """Return `forest` with other votes; a change is a function of the array before."""
    old = getattr(forest, kind)
    new = {name: change(getattr(old, name)) for name, change in changes.items()}
    return forest._replace(**{kind: old._replace(**new)})


WRONG = {
    'root out of range': lambda f: f._replace(roots=f.roots + 10**6),
    'negative root': lambda f: f._replace(roots=edit(f.roots, 0, -1)),
    'no trees': lambda f: f._replace(roots=f.roots[:0]),
    'child before its parent': lambda f: f._replace(left=edit(f.left, 0, 0)),
    'child out of range': lambda f: f._replace(left=edit(f.left, 0, len(f.left))),
    'leaf out of range': lambda f: f._replace(
        left=edit(f.left, np.flatnonzero(f.feature < 0)[-1], len(f.joint_votes.start))
    ),
    'feature out of range': lambda f: f._replace(feature=edit(f.feature, 0, 360)),
    'short thresholds': lambda f: f._replace(threshold=f.threshold[:-1]),
    'votes that run backwards': lambda f: votes(
        f, 'joint_votes', start=lambda s: edit(s, 1, 10**6)
    ),
    'votes that end too late': lambda f: votes(
        f, 'pair_votes', start=lambda s: edit(s, -1, 10**6)
    ),
    'votes that begin too late': lambda f: votes(f, 'pair_votes', start=lambda s: edit(s, 0, 1)),
    'a vote for no joint': lambda f: votes(f, 'joint_votes', target=lambda t: edit(t, 0, 8)),
    'a vote for no pair': lambda f: votes(f, 'pair_votes', target=lambda t: edit(t, 0, 200)),
    'missing offsets': lambda f: votes(f, 'joint_votes', offset=lambda o: o[:-1]),
    'flat offsets': lambda f: votes(f, 'joint_votes', offset=lambda o: o[:, :2]),
    'offsets that are NaN': lambda f: votes(f, 'joint_votes', offset=lambda o: edit(o, 0, np.nan)),
    'negative weights': lambda f: votes(f, 'pair_votes', weight=lambda w: edit(w, 0, -1)),
}


def test_trained_model_is_accepted(small_model):
    check_model(small_model)


@pytest.mark.parametrize('change', WRONG.values(), ids=WRONG.keys())
def test_forest_that_would_misdirect_a_kernel_is_refused(change, small_model):
    with pytest.raises(UnusableModelError):
        check_model(small_model._replace(forest=change(small_model.forest)))
