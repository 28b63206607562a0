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

"""Tests the z-buffer against its equation: random, adjacent and degenerate triangles."""

import numpy as np
import pytest

from lsc_pose_ros.camera.projection import project
from lsc_pose_ros.data_types.camera import Intrinsics
from lsc_pose_ros.data_types.frame import NO_BODY
from lsc_pose_ros.data_types.joints import JOINT_NAMES
from lsc_pose_ros.synthetic.body.body_file import BodyModel, load_body
from lsc_pose_ros.synthetic.body.body_mesh import (
    BodyShape,
    named_rotations,
    pose_body,
    shape_body,
)
from lsc_pose_ros.synthetic.scene.mesh_render import NEAREST, SUBPIXELS, RenderMesh, render_meshes

WIDTH, HEIGHT = 64, 48
CAMERA = Intrinsics(60.0, 62.0, 31.3, 23.6)


@pytest.fixture(scope='module')
def body() -> BodyModel:
    return load_body()


def naive_render(meshes, camera, width, height):
    """Test each pixel against each triangle, with corners rounded to SUBPIXELS."""
    depth = np.full((height, width), np.inf)
    labels = np.full((height, width), NO_BODY, np.int32)
    rows, columns = np.mgrid[:height, :width]
    for mesh in meshes:
        for triangle in mesh.triangles:
            corners = mesh.vertices[triangle]
            if not (corners[:, 2] >= NEAREST).all():
                continue
            u = np.floor((camera.cx + camera.fx * corners[:, 0] / corners[:, 2]) * SUBPIXELS + 0.5)
            v = np.floor((camera.cy + camera.fy * corners[:, 1] / corners[:, 2]) * SUBPIXELS + 0.5)
            # Barycentric weights: w with sum w = 1 and sum w_i corner_i = pixel.
            system = np.stack([u, v, np.ones(3)])
            area = round(np.linalg.det(system))
            if area == 0:
                continue
            weights = [
                ((u[j] - x) * (v[k] - y) - (u[k] - x) * (v[j] - y)) / area
                for j, k in ((1, 2), (2, 0), (0, 1))
                for x, y in [(columns * SUBPIXELS, rows * SUBPIXELS)]
            ]
            inside = np.min(weights, axis=0) >= 0
            inverse = np.tensordot(1 / corners[:, 2], np.array(weights), 1)
            with np.errstate(divide='ignore'):
                z = np.where(inside, 1 / inverse, np.inf).astype(np.float32)
            nearer = z < depth
            depth[nearer] = z[nearer]
            labels[nearer] = mesh.labels
    depth[labels == NO_BODY] = 0
    return depth, labels


def compare(meshes, camera=CAMERA, width=WIDTH, height=HEIGHT):
    image = render_meshes(meshes, camera, width, height)
    depth, labels = naive_render(meshes, camera, width, height)
    assert image.depth.dtype == np.float32
    assert image.labels.dtype == np.int32
    # Two surfaces at the same depth can be exchanged.
    ties = (image.labels != labels) & (np.abs(image.depth - depth) < 1e-5)
    np.testing.assert_array_equal(image.labels[~ties], labels[~ties])
    assert ties.sum() < 3
    np.testing.assert_allclose(image.depth, depth, rtol=1e-6)
    return image


def soup(random, count, spread):
    """Return random triangles in front of and beside the camera."""
    centres = random.uniform([-1.5, -1.5, 0.3], [1.5, 1.5, 3], size=(count, 1, 3))
    vertices = (centres + random.normal(size=(count, 3, 3)) * spread).reshape(-1, 3)
    return vertices, np.arange(3 * count).reshape(-1, 3).astype(np.uint16)


@pytest.mark.parametrize('spread', [0.003, 0.05, 0.6])
def test_random_triangles_agree_with_the_equation(spread):
    random = np.random.default_rng(int(spread * 1000))
    meshes = [RenderMesh(*soup(random, 150, spread), body) for body in (1, 2, 7)]
    image = compare(meshes)
    assert (image.labels != NO_BODY).any()


def test_degenerate_triangles_draw_nothing():
    corners = np.array(
        [
            [0, 0, 1], [0, 0, 1], [0, 0, 1],  # a point
            [-1, -1, 2], [0, 0, 2], [1, 1, 2],  # a line
            [0, 0, 1], [1, 0, 1], [0, 1, -1],  # through the camera's plane
            [0, 0, -1], [1, 0, -1], [0, 1, -1],  # behind the camera
            [0, 0, np.nan], [1, 0, 1], [0, 1, 1],
            [0, 0, np.inf], [1, 0, np.inf], [0, 1, np.inf],
            [1e30, 0, 1], [1, 0, 1], [0, 1, 1],
            [0, 0, 0], [1, 0, 0], [0, 1, 0],
        ],
        dtype=float,
    )  # fmt: skip
    triangles = np.arange(len(corners)).reshape(-1, 3).astype(np.uint16)
    image = render_meshes([RenderMesh(corners, triangles, 1)], CAMERA, WIDTH, HEIGHT)
    assert not image.depth.any()
    assert (image.labels == NO_BODY).all()
    empty = render_meshes([RenderMesh(corners[:0], triangles[:0], 1)], CAMERA, WIDTH, HEIGHT)
    assert not empty.depth.any()
    assert not render_meshes([], CAMERA, WIDTH, HEIGHT).depth.any()


def test_triangle_larger_than_the_image_fills_it():
    corners = np.array([[-900.0, -900.0, 3.0], [900.0, -900.0, 3.0], [0.0, 1500.0, 3.0]])
    image = render_meshes(
        [RenderMesh(corners, np.array([[0, 1, 2]], np.uint16), 5)], CAMERA, 40, 30
    )
    np.testing.assert_array_equal(image.labels, 5)
    np.testing.assert_allclose(image.depth, 3.0, rtol=1e-6)


def test_depth_of_a_slanted_plane_agrees_with_the_equation():
    # z = 2 + 0.5 x - 0.3 y
    x, y = np.array([-3.0, 3.0, 3.0, -3.0]), np.array([-3.0, -3.0, 3.0, 3.0])
    vertices = np.stack([x, y, 2.0 + 0.5 * x - 0.3 * y], axis=1)
    vertices[:, 2] += 2
    triangles = np.array([[0, 1, 2], [0, 2, 3]], np.uint16)
    image = render_meshes([RenderMesh(vertices, triangles, 1)], CAMERA, WIDTH, HEIGHT)
    rows, columns = np.mgrid[:HEIGHT, :WIDTH]
    ray_x, ray_y = (columns - CAMERA.cx) / CAMERA.fx, (rows - CAMERA.cy) / CAMERA.fy
    expected = 4 / (1 - 0.5 * ray_x + 0.3 * ray_y)
    drawn = image.labels == 1
    assert drawn[8:-8, 8:-8].all()
    # The error of a corner is at most 1/512 pixel.
    np.testing.assert_allclose(image.depth[drawn], expected[drawn], rtol=2e-4)


def test_adjacent_triangles_leave_no_gap():
    random = np.random.default_rng(5)
    count = 24
    u, v = np.meshgrid(np.linspace(-1, 1, count), np.linspace(-1, 1, count))
    u[1:-1, 1:-1] += random.uniform(-0.03, 0.03, (count - 2, count - 2))
    v[1:-1, 1:-1] += random.uniform(-0.03, 0.03, (count - 2, count - 2))
    vertices = np.stack([u, v, 1.5 + 0.2 * np.sin(3 * u)], axis=-1).reshape(-1, 3)
    first = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    quads = np.stack([first, first + 1, first + count + 1, first + count], axis=1)
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]).astype(np.uint16)
    image = render_meshes([RenderMesh(vertices, triangles, 1)], CAMERA, WIDTH, HEIGHT)
    drawn = image.labels == 1
    rows, columns = np.nonzero(drawn)
    assert drawn[rows.min() + 2 : rows.max() - 1, columns.min() + 5 : columns.max() - 4].all()


def test_order_of_bodies_does_not_matter():
    random = np.random.default_rng(9)
    meshes = [RenderMesh(*soup(random, 60, 0.3), body) for body in (3, 4, 5)]
    one, other = (render_meshes(m, CAMERA, WIDTH, HEIGHT) for m in (meshes, meshes[::-1]))
    np.testing.assert_array_equal(one.depth, other.depth)
    np.testing.assert_array_equal(one.labels, other.labels)


def person_in_camera(body, body_shape, yaw, position):
    """Return a person in the rest pose in front of the camera."""
    cosine, sine = np.cos(yaw), np.sin(yaw)
    rotation = np.array([[cosine, 0, sine], [0, -1, 0], [sine, 0, -cosine]])
    rest = shape_body(body, body_shape)
    return pose_body(body, rest, named_rotations(body, {'root': rotation}), np.asarray(position))


def test_rendered_person_agrees_with_the_equation(body):
    camera = Intrinsics(40.0, 40.0, 23.5, 31.5)
    posed = person_in_camera(body, BodyShape(30, 0.5), 0.4, [0, 0, 1.6])
    some = body.triangles[::5]
    compare([RenderMesh(posed.vertices, some, 1)], camera, 48, 64)


def test_people_hide_each_other_and_joints_are_behind_the_skin(body):
    camera = Intrinsics(285.0, 285.0, 159.5, 119.5)
    places = [(-0.9, 0.1, 3.2), (0.4, 0.0, 2.6), (0.7, 0.0, 3.6)]
    figures = [BodyShape(6, 0.3), BodyShape(30, 1.0), BodyShape(60, 0.0)]
    people = [person_in_camera(body, f, 0.0, p) for f, p in zip(figures, places, strict=True)]
    meshes = [RenderMesh(person.vertices, body.triangles, n) for n, person in enumerate(people, 1)]
    image = render_meshes(meshes, camera, 320, 240)
    np.testing.assert_array_equal((image.depth > 0), image.labels != NO_BODY)
    for number, person in enumerate(people, 1):
        alone = render_meshes([meshes[number - 1]], camera, 320, 240)
        pixels = np.rint(project(person.joints, camera)).astype(int)
        on = alone.labels[pixels[:, 1], pixels[:, 0]] == number
        assert on.all(), [name for name, hit in zip(JOINT_NAMES, on, strict=True) if not hit]
        behind = person.joints[:, 2] - alone.depth[pixels[:, 1], pixels[:, 0]]
        assert (behind > 0.003).all()
        assert (behind < 0.35).all()
        # Pixels of a hidden person show another one who is nearer.
        visible = image.labels == number
        np.testing.assert_array_equal(image.depth[visible], alone.depth[visible])
        hidden = (alone.labels == number) & ~visible
        assert (image.depth[hidden] <= alone.depth[hidden]).all()
    # The second person's left hand is at image right.
    left, right = (project(people[1].joints, camera)[JOINT_NAMES.index(f'{s}_hand')] for s in 'lr')
    assert left[0] > right[0] + 40


def test_last_bits_of_the_vertices_do_not_matter(body):
    camera = Intrinsics(285.0, 285.0, 159.5, 119.5)
    posed = person_in_camera(body, BodyShape(30, 1.0), 0.7, [0, 0, 2.5])
    random = np.random.default_rng(4)
    shaken = posed.vertices + 1e-15 * random.normal(size=posed.vertices.shape)
    one, other = (
        render_meshes([RenderMesh(v, body.triangles, 1)], camera, 320, 240)
        for v in (posed.vertices, shaken)
    )
    np.testing.assert_array_equal(one.labels, other.labels)
    np.testing.assert_array_equal(np.rint(1000 * one.depth), np.rint(1000 * other.depth))
