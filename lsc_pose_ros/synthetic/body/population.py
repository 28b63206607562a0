"""What people are like: children to old, both sexes, thin to fat, weak to strong."""

from typing import NamedTuple

import numpy as np

from lsc_pose_ros.errors import InputError
from lsc_pose_ros.synthetic.body.body_file import Body
from lsc_pose_ros.synthetic.body.body_mesh import Figure, Rest, shape_body, with_stature

AGES = (4.0, 85.0)
"""Years, of the youngest and the oldest that are drawn unless told otherwise."""

_GROWN_UP = 18.0  # years
_CHILDREN = 0.3  # the share of those below, where any age may be drawn

# Medians of the CDC growth charts for the United States (Kuczmarski et al., 2000); from 40 years
# on people shrink as Sorkin, Muller and Andres measured (American J. of Epidemiology 150, 1999).
_YEARS = (2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 40, 80)
_MALE_METRES = (0.865, 1.025, 1.155, 1.28, 1.385, 1.49, 1.64, 1.735, 1.76, 1.77, 1.77, 1.72)
_FEMALE_METRES = (0.85, 1.01, 1.15, 1.28, 1.38, 1.515, 1.605, 1.625, 1.63, 1.635, 1.635, 1.555)

# The charts' standard deviation is about this share of the stature. Statures are drawn evenly from
# so many deviations to both sides: few people are very tall, but they want to be seen, too.
_DEVIATION = 0.045
_DEVIATIONS = 2.5

_TRIES = 1000

# The means of measures that are not average in a person of average build: MakeHuman's upper arm
# is short against anthropometry.
_MEAN_MEASURES = {'upper_arm_length': 0.4}
_MEASURE_SCATTER = 0.45


class Population(NamedTuple):
    """Whom to draw from.

    Attributes:
        age: of the youngest and the oldest, years.
        stature: of the smallest and the tallest, metres.
    """

    age: tuple[float, float] = AGES
    stature: tuple[float, float] = (0.8, 2.1)


class Tailor:
    """Draws people who have the stature of their age and sex."""

    def __init__(self, body: Body) -> None:
        """Draw people with `body`."""
        self._body = body
        self._ends = _ends(body)

    def draw(self, population: Population, random: np.random.Generator) -> Rest:
        """Draw a person at rest, without clothes.

        Raises:
            InputError: nobody of these ages has such a stature.
        """
        age, sex, metres = draw_stature(population, random)
        figure = draw_build(self._body, age, sex, random)
        return shape_body(self._body, with_stature(self._ends, figure, metres))


def draw_stature(
    population: Population, random: np.random.Generator
) -> tuple[float, float, float]:
    """Draw the age in years, the sex (0 female, 1 male) and the stature in metres.

    Raises:
        InputError: nobody of these ages has such a stature.
    """
    smallest, tallest = population.stature
    for chances in random.random((_TRIES, 4)):
        age = _age(population.age, *chances[:2])
        # Six of ten are as male or as female as MakeHuman's, the others in between.
        sex = float(np.clip(2.5 * chances[2] - 0.75, 0.0, 1.0))
        male = float(np.interp(age, _YEARS, _MALE_METRES))
        female = float(np.interp(age, _YEARS, _FEMALE_METRES))
        aside = _DEVIATION * _DEVIATIONS * (2 * chances[3] - 1)
        metres = float((female + sex * (male - female)) * (1 + aside))
        if smallest <= metres <= tallest:
            return age, sex, metres
    youngest, oldest = population.age
    msg = (
        f'hardly anybody aged {youngest:g} to {oldest:g} is {smallest:g} to {tallest:g} m tall; '
        f'give a wider range of ages or statures'
    )
    raise InputError(msg)


def draw_build(body: Body, age: float, sex: float, random: np.random.Generator) -> Figure:
    """Draw how a person of this age and sex is built, but for the stature."""
    weight, muscle, proportions, *rest = random.random(3 + len(body.measures))
    measures = _MEASURE_SCATTER * (2 * np.array(rest) - 1)
    names = [str(name) for name in body.measures]
    return Figure(
        age=age,
        sex=sex,
        # A thin and weak body is skin and bones.
        weight=max(0.1 + 0.85 * weight, 0.3 - 0.3 * muscle),
        muscle=0.2 + 0.7 * muscle,
        proportions=0.2 + 0.7 * proportions,
        measures={
            name: float(_MEAN_MEASURES.get(name, 0.0) + measure)
            for name, measure in zip(names, measures, strict=True)
        },
    )


def _age(ages: tuple[float, float], group: float, within: float) -> float:
    """Return an age: children have their share although they are few years of a life."""
    youngest, oldest = ages
    if youngest < _GROWN_UP < oldest:
        if group < _CHILDREN:
            oldest = _GROWN_UP
        else:
            youngest = _GROWN_UP
    return float(youngest + (oldest - youngest) * within)


def _ends(body: Body) -> Body:
    """Return the body with only those vertices that may be a person's highest or lowest."""
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
