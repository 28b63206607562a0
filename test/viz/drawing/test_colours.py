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

"""The colours of figures and pages."""

import itertools

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from numpy.typing import NDArray

from lsc_pose_ros.viz.drawing.colours import CURVES, PALETTE, curve_look

# The colours that mean something in the same picture as others.
MEANINGS = ('ink', 'left', 'right', 'truth', 'edge')
SERIES = ('ink', 'violet', 'rose', 'maroon', 'grey')
DISTANCE = 10  # of CIE 1976; a difference of about 2 can be seen side by side

# Machado, Oliveira and Fernandes (2009), full severity, for linear RGB.
DEFICIENCIES = {
    'none': np.eye(3),
    'protanopia': np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    'deuteranopia': np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
    'tritanopia': np.array(
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ]
    ),
}
# IEC 61966-2-1, and its white point.
XYZ = np.array([[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]])
WHITE = XYZ.sum(axis=1)


def linear(colour: str) -> NDArray[np.float64]:
    value = np.array(to_rgb(colour))
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


def lab(rgb: NDArray[np.float64]) -> NDArray[np.float64]:
    relative = XYZ @ rgb / WHITE
    x, y, z = np.where(relative > 0.008856, np.cbrt(relative), 7.787 * relative + 16 / 116)
    return np.array([116 * y - 16, 500 * (x - y), 200 * (y - z)])


def contrast(first: str, second: str) -> float:
    """The contrast of WCAG 2."""
    low, high = sorted(float(XYZ[1] @ linear(colour)) for colour in (first, second))
    return (high + 0.05) / (low + 0.05)


@pytest.mark.parametrize('scheme', ['light', 'dark'])
@pytest.mark.parametrize('deficiency', DEFICIENCIES)
@pytest.mark.parametrize('names', [MEANINGS, SERIES], ids=['meanings', 'series'])
def test_colour_blind_people_distinguish_them(
    names: tuple[str, ...], deficiency: str, scheme: str
) -> None:
    seen = {
        name: lab(np.clip(DEFICIENCIES[deficiency] @ linear(getattr(PALETTE[name], scheme)), 0, 1))
        for name in names
    }
    for first, second in itertools.combinations(names, 2):
        assert np.linalg.norm(seen[first] - seen[second]) > DISTANCE, (first, second)


@pytest.mark.parametrize('scheme', ['light', 'dark'])
def test_words_and_curves_stand_out_from_the_page(scheme: str) -> None:
    """By WCAG 2.1: 4.5 for text, 3 for graphics."""
    page = getattr(PALETTE['page'], scheme)
    for name in ('ink', 'faint', 'link'):
        assert contrast(getattr(PALETTE[name], scheme), page) >= 4.5, name
    for name in (*SERIES, 'left', 'right', 'edge'):
        assert contrast(getattr(PALETTE[name], scheme), page) >= 3, name


def test_each_colour_of_paper_has_one_name() -> None:
    light = [shades.light for shades in PALETTE.values()]
    assert len(light) == len(set(light))


def test_curves_are_the_series_and_repeat() -> None:
    assert tuple(PALETTE[name].light for name in SERIES) == CURVES
    looks = [curve_look(number) for number in range(len(CURVES) + 1)]
    assert looks[0] == looks[-1]
    assert len({look.dashes for look in looks}) == len(CURVES)
