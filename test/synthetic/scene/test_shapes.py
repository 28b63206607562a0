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

"""Tests the shapes and pieces of furniture: closed surfaces within their blocks."""

from collections.abc import Callable

import numpy as np
import pytest

from lsc_pose_ros.synthetic.sampling import RandomStream
from lsc_pose_ros.synthetic.scene.clearance import hides, is_clear
from lsc_pose_ros.synthetic.scene.furniture import clothing, clutter, seating, storage, tables
from lsc_pose_ros.synthetic.scene.near_plane import cut_at_near_plane
from lsc_pose_ros.synthetic.scene.piece import Piece, PieceBuilder
from lsc_pose_ros.synthetic.scene.shapes import Mesh, bar_axes, loft, rounded

SEATS = tuple(make for _, make in seating.SEATS)
OTHERS = (
    seating.bed,
    storage.shelf,
    storage.cupboard,
    storage.curtain,
    storage.door,
    storage.hooks,
    storage.wall_things,
    clothing.coat_stand,
    clothing.dummy,
    clutter.boxes,
    clutter.plant,
    clutter.lamp,
    clutter.robot,
    clutter.round_things,
    clutter.ladder,
    clutter.poles,
    clutter.partition,
)
TABLES = (tables.table, tables.desk, tables.counter)


def stream_of(seed: int) -> RandomStream:
    return RandomStream(np.random.default_rng(seed))


def pieces(seed: int) -> list[Piece]:
    """Return one piece of each kind."""
    stream = stream_of(seed)
    made = [make(seating.sample_seat(stream), stream) for make in SEATS]
    made += [make(tables.sample_table(stream), stream) for make in TABLES]
    return made + [make(stream) for make in OTHERS]


def edges_of(mesh: Mesh) -> dict[tuple[int, int], int]:
    """Return how many triangles each edge has."""
    counts: dict[tuple[int, int], int] = {}
    for a, b, c in mesh.triangles.tolist():
        for edge in ((a, b), (b, c), (c, a)):
            key = (min(edge), max(edge))
            counts[key] = counts.get(key, 0) + 1
    return counts


def one_box() -> Mesh:
    builder = PieceBuilder()
    builder.box((0.0, 1.0, 0.0), (1.0, 2.0, 3.0))
    return builder.build().mesh


@pytest.mark.parametrize(
    'make', [one_box, lambda: loft((0, 1, 2), (1, 2, 1), (1, 1, 1)), lambda: rounded((1, 2, 3), 1)]
)
def test_shapes_are_closed(make: Callable[[], Mesh]) -> None:
    assert set(edges_of(make()).values()) == {2}


@pytest.mark.parametrize('seed', range(5))
def test_surface_of_a_piece_is_in_its_blocks(seed: int) -> None:
    for piece in pieces(seed):
        covered = np.zeros(len(piece.mesh.vertices), bool)
        for centre, axes, half in zip(*piece.blocks, strict=True):
            covered |= (np.abs((piece.mesh.vertices - centre) @ axes) <= half + 1e-9).all(axis=1)
        assert covered.all()


@pytest.mark.parametrize('seed', range(5))
def test_pieces_are_near_the_floor_and_have_plausible_sizes(seed: int) -> None:
    for piece in pieces(seed):
        low, high = piece.size()
        assert -0.25 < low[1] < 1.5  # heaps reach below the floor; pictures hang on a wall
        assert (high - low).max() < 4.0
        assert np.isfinite(piece.mesh.vertices).all()
        assert piece.mesh.triangles.max() < len(piece.mesh.vertices)


def test_seats_have_the_given_height_below_the_person() -> None:
    stream = stream_of(3)
    size = seating.SeatSize(0.45, 0.42, 0.47, 0.5)
    for make in SEATS:
        piece = make(size, stream)
        beside = np.abs(piece.mesh.vertices[:, [0, 2]]).max(axis=1) < 0.3
        under = piece.mesh.vertices[beside & (piece.mesh.vertices[:, 1] < 0.48), 1]
        assert under.max() == pytest.approx(0.47, abs=0.02)
        above = np.array([[0.0, 0.5, 0.0], [0.0, 0.8, 0.1]])
        assert is_clear(piece.blocks, above, 0.0)
        assert not is_clear(piece.blocks, np.array([[0.0, 0.46, 0.0]]), 0.0)


def test_bars_point_from_end_to_end() -> None:
    random = np.random.default_rng(0)
    for start, end in random.normal(size=(20, 2, 3)):
        axes = bar_axes(start, end)
        np.testing.assert_allclose(axes.T @ axes, np.eye(3), atol=1e-12)
        np.testing.assert_allclose(axes[:, 1], (end - start) / np.linalg.norm(end - start))


def test_placed_piece_faces_its_front() -> None:
    builder = PieceBuilder()
    builder.box((0.0, 0.5, 1.0), (0.2, 0.2, 0.2))
    position, front = np.array([1.0, 1.5, 3.0]), np.array([0.6, -0.8])
    placed = builder.build().placed(position, front)
    np.testing.assert_allclose(placed.blocks.centres[0], [1.6, 1.0, 2.2])
    np.testing.assert_allclose(placed.mesh.vertices.mean(axis=0), [1.6, 1.0, 2.2])
    assert not is_clear(placed.blocks, np.array([[1.6, 1.0, 2.2]]), 0.0)
    assert is_clear(placed.blocks, np.array([[1.6, 1.0, 2.5]]), 0.0)
    assert not is_clear(placed.blocks, np.array([[1.6, 1.0, 2.5]]), 0.2)


def test_block_hides_what_is_behind_it() -> None:
    builder = PieceBuilder()
    builder.box((0.0, 0.0, 2.0), (1.0, 1.0, 0.1))
    blocks = builder.build().blocks
    assert hides(blocks, np.array([0.0, 0.0, 3.0]))
    assert not hides(blocks, np.array([0.0, 0.0, 1.5]))
    assert not hides(blocks, np.array([1.5, 0.0, 3.0]))


def test_meshes_are_cut_in_front_of_the_camera() -> None:
    vertices = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0], [0.0, 1.0, -2.0]])
    mesh = Mesh(vertices, np.array([[0, 1, 2], [0, 3, 1], [1, 2, 3]]))
    cut = cut_at_near_plane(mesh)
    assert len(cut.triangles) == 2 + 1 + 2
    assert (cut.vertices[cut.triangles][..., 2] > 0.05).all()
    area = 0.5 * np.abs(np.cross(*np.diff(cut.vertices[cut.triangles[:2]], axis=1).swapaxes(0, 1)))
    # The triangle's width grows from 0 at z = -1 to 2 at z = 1.
    near = 1.01 * 0.05
    assert area.sum() == pytest.approx(0.5 * (2 + 1 + near) * (1 - near))
    far = mesh._replace(vertices=vertices + np.array([0.0, 0.0, 5.0]))
    assert len(cut_at_near_plane(far).triangles) == 3
