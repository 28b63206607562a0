"""The renderer and the sensor's noise, each against a plain twin written from the equations."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray

from lsc_pose_ros.core.camera import Intrinsics, back_project
from lsc_pose_ros.core.frame import NO_BODY
from lsc_pose_ros.data.synthetic.render import (
    Image,
    bounding_boxes,
    draw_cones,
    meet_cone,
    render,
)
from lsc_pose_ros.data.synthetic.sensor import (
    DISPARITY,
    DROPOUT,
    GRAZING,
    Chances,
    disturb,
    kinect_noise,
    slope,
)
from lsc_pose_ros.data.synthetic.solids import RoundCones, signed_distance

WIDTH, HEIGHT = 40, 30
CAMERA = Intrinsics(36.0, 34.0, 19.0, 15.5)


def random_cones(seed: int, count: int) -> RoundCones:
    """Cones of all kinds: tapered either way, cylinders, balls, one end within the other."""
    random = np.random.default_rng(seed)
    turns = np.linalg.qr(random.standard_normal((count, 3, 3)))[0]
    stretch = random.uniform(0.5, 2.0, (count, 3, 1))
    stretch[:, 1] = 1.0
    radii = random.uniform(0.05, 0.4, (count, 2))
    radii[::4, 1] = radii[::4, 0]
    length = random.uniform(0.0, 1.0, count)
    length[1::4] = 0.0
    length[2::5] = 0.5 * np.abs(radii[2::5, 0] - radii[2::5, 1])
    origins = random.uniform([-1.2, -0.9, 1.2], [1.2, 0.9, 4.0], (count, 3))
    return RoundCones(origins, turns / stretch, length, radii)


def quadratic_roots(a: float, b: float, c: float) -> list[float]:
    if b * b < 4 * a * c or a == 0:
        return []
    root = math.sqrt(b * b - 4 * a * c)
    return [(-b - root) / (2 * a), (-b + root) / (2 * a)]


def naive_meeting(cones: RoundCones, solid: int, ray: NDArray[np.float64]) -> float:
    """The nearest of where the ray enters either ball or meets the slanted side between them."""
    o = cones.inward[solid] @ -cones.origins[solid]
    d = cones.inward[solid] @ ray
    length = cones.length[solid]
    first, second = cones.radii[solid]
    hits = []
    for centre, radius in ((0.0, first), (length, second)):
        away = o - np.array([0.0, centre, 0.0])
        roots = quadratic_roots(d @ d, 2 * away @ d, away @ away - radius**2)
        hits += [min(roots)] if roots else []
    if length > abs(first - second):
        sine = (first - second) / length

        def side(t: float) -> float:
            x, y, z = o + t * d
            return float((x**2 + z**2) * (1 - sine**2) - (first - y * sine) ** 2)

        # A quadratic in t is known by three of its values.
        c = side(0.0)
        a, b = (side(1.0) + side(-1.0)) / 2 - c, (side(1.0) - side(-1.0)) / 2
        for t in quadratic_roots(a, b, c):
            if first * sine <= o[1] + t * d[1] <= length + second * sine:
                hits.append(t)
    return min([t for t in hits if t > 0], default=math.inf)


def naive_render(
    cones: RoundCones, bodies: NDArray[np.int32], camera: Intrinsics
) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    depth = np.zeros((HEIGHT, WIDTH))
    labels = np.full((HEIGHT, WIDTH), NO_BODY)
    for row in range(HEIGHT):
        for column in range(WIDTH):
            ray = np.array([(column - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, 1.0])
            meetings = [naive_meeting(cones, solid, ray) for solid in range(len(bodies))]
            nearest = int(np.argmin(meetings))
            if meetings[nearest] < math.inf:
                depth[row, column] = meetings[nearest]
                labels[row, column] = bodies[nearest]
    return depth, labels


@pytest.mark.parametrize('seed', [0, 1, 2])
def test_rendering_agrees_with_its_plain_twin(seed: int) -> None:
    cones = random_cones(seed, 10)
    bodies = np.arange(1, 11, dtype=np.int32)
    image = render(cones, bodies, CAMERA, WIDTH, HEIGHT)
    depth, labels = naive_render(cones, bodies, CAMERA)
    differ = image.labels != labels
    # A ray that only just touches a solid may go either way.
    assert differ.mean() < 0.003
    np.testing.assert_allclose(image.depth[~differ], depth[~differ], atol=1e-5)
    assert (labels != NO_BODY).mean() > 0.2


def test_what_is_drawn_lies_on_a_surface_and_nothing_before_it() -> None:
    cones = random_cones(5, 12)
    image = render(cones, np.ones(12, np.int32), CAMERA, WIDTH, HEIGHT)
    rows, columns = np.nonzero(image.depth)
    points = back_project(columns, rows, image.depth[rows, columns], CAMERA).astype(np.float64)
    posed = cones._replace(origins=cones.origins[None], inward=cones.inward[None])
    distance = signed_distance(points[None], posed)[0].min(axis=1)
    assert np.abs(distance).max() < 1e-4
    for share in (0.3, 0.7, 0.95):
        before = signed_distance(share * points[None], posed)[0].min(axis=1)
        assert before.min() > -1e-4


def test_boxes_hold_all_that_is_drawn_and_little_more() -> None:
    everywhere = np.array([[0, WIDTH - 1, 0, HEIGHT - 1]])
    drawn, whole = 0, 0
    for seed in range(200):
        cones = random_cones(seed, 1)
        depth = np.full((HEIGHT, WIDTH), np.inf)
        labels = np.full((HEIGHT, WIDTH), NO_BODY, np.int32)
        draw_cones(cones, everywhere, np.ones(1, np.int32), CAMERA, depth, labels)
        rows, columns = np.nonzero(labels == 1)
        if len(rows) == 0:
            continue
        drawn += 1
        ((left, right, top, bottom),) = bounding_boxes(cones, CAMERA, WIDTH, HEIGHT)
        assert left <= columns.min() <= columns.max() <= right
        assert top <= rows.min() <= rows.max() <= bottom
        # What is half out of the image may have its tips there.
        if left > 0 and right < WIDTH - 1 and top > 0 and bottom < HEIGHT - 1:
            whole += 1
            slack = [columns.min() - left, right - columns.max()]
            slack += [rows.min() - top, bottom - rows.max()]
            assert max(slack) <= 2
    assert drawn > 150
    assert whole > 80


def ball(x: float, y: float, z: float, radius: float) -> RoundCones:
    return RoundCones(np.array([[x, y, z]]), np.eye(3)[None], np.zeros(1), np.full((1, 2), radius))


@pytest.mark.parametrize(
    'cones',
    [
        ball(0, 0, -2, 0.5),  # behind the camera
        ball(50, 0, 2, 0.5),  # far aside
        ball(0, -50, 2, 0.5),
        ball(1e9, 0, 1, 0.5),
    ],
)
def test_what_is_out_of_sight_draws_nothing(cones: RoundCones) -> None:
    image = render(cones, np.ones(1, np.int32), CAMERA, WIDTH, HEIGHT)
    assert not image.depth.any()
    assert (image.labels == NO_BODY).all()


def test_a_ball_is_nearest_in_its_middle() -> None:
    camera = Intrinsics(36.0, 36.0, 20.0, 15.0)
    image = render(ball(0, 0, 2, 0.5), np.full(1, 7, np.int32), camera, WIDTH, HEIGHT)
    assert image.depth[15, 20] == np.float32(1.5)
    assert image.depth[image.depth > 0].min() == np.float32(1.5)
    assert set(np.unique(image.labels)) == {NO_BODY, 7}


def test_the_nearer_body_hides_the_farther_whatever_comes_first() -> None:
    near, far = ball(0, 0, 2, 0.3), ball(0, 0, 3, 0.6)
    for order in ((near, far), (far, near)):
        both = RoundCones(*(np.concatenate(fields) for fields in zip(*order, strict=True)))
        bodies = np.array([1, 2] if order[0] is near else [2, 1], np.int32)
        image = render(both, bodies, CAMERA, WIDTH, HEIGHT)
        assert image.labels[15, 19] == 1
        assert (image.labels == 2).any()


@pytest.mark.parametrize(
    ('ray', 'length', 'first', 'second', 'expected'),
    [
        ((0.0, 0.0, 1.0), 1.0, 0.2, 0.2, 1.8),  # straight at a cylinder
        ((0.0, 0.0, 1.0), 0.0, 0.3, 0.1, 1.7),  # a ball: the larger end
        ((0.0, 0.0, 1.0), 0.1, 0.3, 0.1, 1.7),  # one end within the other
        ((0.0, 0.0, -1.0), 1.0, 0.2, 0.2, math.inf),  # away from it
        ((0.0, 1.0, 0.0), 1.0, 0.2, 0.2, math.inf),  # past it, along the axis
        ((1.0, 0.0, 0.0), 1.0, 0.2, 0.2, math.inf),
        ((0.0, 0.0, 1.0), 0.5, 0.0, 0.0, 2.0),  # of no thickness
    ],
)
def test_degenerate_cones_are_met_where_they_should(
    ray: tuple[float, float, float], length: float, first: float, second: float, expected: float
) -> None:
    assert meet_cone((0.0, 0.0, -2.0), ray, length, first, second) == pytest.approx(expected)


def test_a_ray_along_the_axis_meets_the_end() -> None:
    assert meet_cone((0.0, -3.0, 0.0), (0.0, 1.0, 0.0), 1.0, 0.2, 0.1) == pytest.approx(2.8)
    assert meet_cone((0.0, 4.0, 0.0), (0.0, -1.0, 0.0), 1.0, 0.2, 0.1) == pytest.approx(2.9)


def naive_slope(depth: NDArray[np.float32], row: int, column: int, focal: float) -> float:
    steepest = []
    for down, right in ((1, 0), (0, 1)):
        changes = [0.0]
        for sign in (-1, 1):
            at = row + sign * down, column + sign * right
            if 0 <= at[0] < depth.shape[0] and 0 <= at[1] < depth.shape[1]:
                other = float(depth[at])
                changes.append(abs(other - float(depth[row, column])) if other > 0 else math.inf)
        steepest.append(max(changes))
    return math.hypot(*steepest) * focal / float(depth[row, column])


def naive_disturb(clean: Image, chances: Chances, focal: float) -> Image:
    height, width = clean.depth.shape
    depth = np.zeros((height, width))
    labels = np.full((height, width), NO_BODY)
    for row in range(height):
        for column in range(width):
            from_row = math.floor(row + chances.shifts[0, row, column] + 0.5)
            from_column = math.floor(column + chances.shifts[1, row, column] + 0.5)
            at = min(max(from_row, 0), height - 1), min(max(from_column, 0), width - 1)
            z = float(clean.depth[at])
            if z <= 0:
                continue
            if chances.drop[row, column] < DROPOUT and naive_slope(clean.depth, *at, focal) > (
                GRAZING
            ):
                continue
            disparity = math.floor(DISPARITY / z + float(chances.steps[row, column]) + 0.5)
            if disparity >= 1:
                depth[row, column] = DISPARITY / disparity
                labels[row, column] = clean.labels[at]
    return Image(depth.astype(np.float32), labels.astype(np.int32))


def random_image(seed: int) -> Image:
    random = np.random.default_rng(seed)
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    depth = 2 + 0.05 * rows + 0.3 * np.sin(columns / 3)
    depth[random.random(depth.shape) < 0.1] = 0.0
    depth[:, :8] = 0.0
    labels = np.where(depth > 0, 1 + (columns > 20), NO_BODY)
    return Image(depth.astype(np.float32), labels.astype(np.int32))


def random_chances(seed: int, scale: float = 1.0) -> Chances:
    random = np.random.default_rng(seed)
    shape = (HEIGHT, WIDTH)
    return Chances(
        (scale * random.standard_normal((2, *shape))).astype(np.float32),
        (scale * random.standard_normal(shape)).astype(np.float32),
        random.random(shape).astype(np.float32),
    )


def disturbed(clean: Image, chances: Chances, focal: float) -> Image:
    noisy = Image(
        np.zeros(clean.depth.shape, np.float32), np.full(clean.depth.shape, NO_BODY, np.int32)
    )
    disturb(clean, chances, focal, noisy)
    return noisy


@pytest.mark.parametrize('scale', [0.0, 0.5, 3.0, 500.0])
def test_noise_agrees_with_its_plain_twin(scale: float) -> None:
    clean, chances = random_image(1), random_chances(2, scale)
    found = disturbed(clean, chances, 36.0)
    expected = naive_disturb(clean, chances, 36.0)
    np.testing.assert_array_equal(found.labels, expected.labels)
    np.testing.assert_allclose(found.depth, expected.depth, atol=1e-6)


def test_slope_agrees_with_its_plain_twin() -> None:
    depth = random_image(3).depth
    for row, column in np.argwhere(depth > 0):
        found = slope(depth, row, column, 36.0)
        assert found == pytest.approx(naive_slope(depth, row, column, 36.0), rel=1e-5)


def test_noise_of_an_empty_image_is_empty() -> None:
    empty = Image(np.zeros((8, 9), np.float32), np.full((8, 9), NO_BODY, np.int32))
    noisy = kinect_noise(empty, CAMERA, np.random.default_rng(0))
    assert not noisy.depth.any()
    assert (noisy.labels == NO_BODY).all()


@pytest.mark.parametrize('distance', [1.0, 2.0, 3.5])
def test_noise_has_the_step_that_was_measured(distance: float) -> None:
    """Khoshelham and Elberink: 2.85 mm at 1 m, growing with the square of the distance."""
    wall = Image(np.full((120, 160), distance, np.float32), np.ones((120, 160), np.int32))
    noisy = kinect_noise(wall, CAMERA, np.random.default_rng(0)).depth
    levels = np.unique(noisy)
    assert len(levels) <= 4
    assert np.diff(levels).max() == pytest.approx(0.00285 * distance**2, rel=0.03)
    assert abs(float(noisy.mean()) - distance) < 0.00285 * distance**2


def test_only_rims_and_cliffs_drop_out() -> None:
    camera = Intrinsics(286.0, 286.0, 79.5, 59.5)
    clean = render(ball(0, 0, 2, 0.35), np.ones(1, np.int32), camera, 160, 120)
    noisy = kinect_noise(clean, camera, np.random.default_rng(0))
    away = np.hypot(*(np.mgrid[:120, :160] - np.array([59.5, 79.5])[:, None, None]))
    rim = away[clean.depth > 0].max()
    assert (noisy.depth[away < rim - 3] > 0).all()
    ring = (away > rim - 1) & (away < rim)
    assert 0.05 < (noisy.depth[ring] == 0).mean() < 0.4
    np.testing.assert_array_equal(noisy.labels == NO_BODY, noisy.depth == 0)
