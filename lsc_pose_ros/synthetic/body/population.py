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

"""Samples body shapes: children to old people, both sexes, thin to fat, weak to strong."""

from typing import NamedTuple

import numpy as np

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.body.body_file import BodyModel
from lsc_pose_ros.synthetic.body.body_mesh import BodyShape, RestBody, shape_body, with_stature

AGES = (4.0, 85.0)
"""Default ages of the youngest and the oldest person, years."""

_ADULT_AGE = 18.0  # years
_CHILD_FRACTION = 0.3  # the fraction of younger people if the ages are not restricted

# Medians of the CDC growth charts for the United States (Kuczmarski et al., 2000). From 40 years
# on, people shrink (Sorkin, Muller and Andres, American J. of Epidemiology 150, 1999).
_YEARS = (2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 40, 80)
_MALE_METRES = (0.865, 1.025, 1.155, 1.28, 1.385, 1.49, 1.64, 1.735, 1.76, 1.77, 1.77, 1.72)
_FEMALE_METRES = (0.85, 1.01, 1.15, 1.28, 1.38, 1.515, 1.605, 1.625, 1.63, 1.635, 1.635, 1.555)

# The charts' standard deviation as a fraction of the stature. Statures are uniform within
# _DEVIATIONS of the median, so that very tall and very small people are not too rare.
_DEVIATION = 0.045
_DEVIATIONS = 2.5

_TRIES = 1000

# Measures whose mean is not 0: MakeHuman's upper arm is too short by anthropometry.
_MEAN_MEASURES = {'upper_arm_length': 0.4}
_MEASURE_SCATTER = 0.45


class Population(NamedTuple):
    """The population to sample from.

    Attributes:
        age: of the youngest and the oldest person, years.
        stature: of the smallest and the tallest person, metres.
    """

    age: tuple[float, float] = AGES
    stature: tuple[float, float] = (0.8, 2.1)


class BodySampler:
    """Samples people whose stature fits their age and sex."""

    def __init__(self, body: BodyModel) -> None:
        """Sample people with the body model `body`."""
        self._body = body
        self._stature_vertices = _stature_vertices(body)

    def sample(self, population: Population, random: np.random.Generator) -> RestBody:
        """Sample a person in the rest pose, without clothes.

        Raises:
            InputError: ages and statures of the population exclude each other.
        """
        age, sex, metres = sample_stature(population, random)
        body_shape = sample_build(self._body, age, sex, random)
        return shape_body(self._body, with_stature(self._stature_vertices, body_shape, metres))


def sample_stature(
    population: Population, random: np.random.Generator
) -> tuple[float, float, float]:
    """Sample the age in years, the sex (0 female, 1 male) and the stature in metres.

    Raises:
        InputError: ages and statures of the population exclude each other.
    """
    smallest, tallest = population.stature
    for uniforms in random.random((_TRIES, 4)):
        age = _sample_age(population.age, *uniforms[:2])
        # 60 % have one of MakeHuman's two sexes, the others are in between.
        sex = float(np.clip(2.5 * uniforms[2] - 0.75, 0.0, 1.0))
        male = float(np.interp(age, _YEARS, _MALE_METRES))
        female = float(np.interp(age, _YEARS, _FEMALE_METRES))
        deviation = _DEVIATION * _DEVIATIONS * (2 * uniforms[3] - 1)
        metres = float((female + sex * (male - female)) * (1 + deviation))
        if smallest <= metres <= tallest:
            return age, sex, metres
    youngest, oldest = population.age
    msg = (
        f'almost nobody aged {youngest:g} to {oldest:g} is {smallest:g} to {tallest:g} m tall; '
        f'give a wider range of ages or statures'
    )
    raise InputError(msg)


def sample_build(
    body: BodyModel, age: float, sex: float, random: np.random.Generator
) -> BodyShape:
    """Sample the body shape of a person of this age and sex, except for the stature."""
    weight, muscle, proportions, *rest = random.random(3 + len(body.measures))
    measures = _MEASURE_SCATTER * (2 * np.array(rest) - 1)
    names = [str(name) for name in body.measures]
    return BodyShape(
        age=age,
        sex=sex,
        # Excludes bodies that are extremely thin and weak.
        weight=max(0.1 + 0.85 * weight, 0.3 - 0.3 * muscle),
        muscle=0.2 + 0.7 * muscle,
        proportions=0.2 + 0.7 * proportions,
        measures={
            name: float(_MEAN_MEASURES.get(name, 0.0) + measure)
            for name, measure in zip(names, measures, strict=True)
        },
    )


def _sample_age(ages: tuple[float, float], group: float, within: float) -> float:
    """Return an age; children are sampled more often than their few years would give."""
    youngest, oldest = ages
    if youngest < _ADULT_AGE < oldest:
        if group < _CHILD_FRACTION:
            oldest = _ADULT_AGE
        else:
            youngest = _ADULT_AGE
    return float(youngest + (oldest - youngest) * within)


def _stature_vertices(body: BodyModel) -> BodyModel:
    """Return the body model with only those vertices that can be a person's highest or lowest."""
    heights = body.mean[: len(body.skin_bones), 1]
    crown, sole = heights.max(), heights.min()
    kept = np.flatnonzero((heights > crown - 0.06) | (heights < sole + 0.03))
    points = np.concatenate([kept, np.arange(len(body.skin_bones), len(body.mean))])
    return body._replace(
        mean=body.mean[points],
        components=np.ascontiguousarray(body.components[:, points]),
        skin_bones=body.skin_bones[kept],
        skin_weights=body.skin_weights[kept],
    )
