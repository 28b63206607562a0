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

"""The settings of the method that the paper leaves open; a model file contains its own."""

from typing import NamedTuple

FEATURES = ('3dlsc', '2dsc', 'dcf', 'mixed')
"""The paper's feature and its rivals; `features/point_features.py` describes them."""

SAMPLES = ('silhouette', 'body')
"""Where the points of a body are taken from."""

BINNINGS = ('shared', 'nearest')
"""How a point counts in the bins of 3dlsc: in the eight bins around it, or in one bin."""


class Settings(NamedTuple):
    """The parameters of silhouettes, descriptors, densities and graph.

    Attributes:
        fewest_neighbours: a pixel of the body with fewer of its eight neighbours at its own depth
            is a flying pixel and is removed; 0: none is.
        neighbour_distance: the largest difference in depth of such a neighbour, metres.
        fill_holes: a pixel without depth gets the median depth of its neighbours on the body if at
            least this many of the eight are on it; 0: it stays a hole.
        occluder_step: a surface beside the body that is nearer than the body by more than this
            fraction of its depth hides it and makes no outline; 0: all beside it is background.
        sloppy_outline: a mask is fitted to the depth if at least this fraction of its outline is
            no step in depth; 0: none is.
        noise_factor: sigma and t_d are at least this many times the noise of the body's own depth;
            0: they are the same for all bodies.
        smoothing_sigma: sigma of the Gaussian over 3-D distances, metres (eq. 1).
        edge_threshold: t_d, the depth step that makes an edge, metres (eq. 2).
        feature: the feature of a point, one of FEATURES.
        sample: whether the points are on the body's silhouette (eq. 2) or anywhere on the body,
            one of SAMPLES.
        points: N, how many points represent a body.
        query_points: how many of them vote; the others only count in the descriptors.
        fixed_scale: a length that replaces rho_bar for all bodies, metres; 0: none, rho_bar is
            each body's own.
        least_cut_scale: rho_bar of a body that is cut off, or hidden by something nearer, is at
            least this, metres; 0: it is that of the visible part.
        binning: for 3dlsc: how a point counts in the bins, one of BINNINGS.
        support_radius: the descriptor's reach, in units of rho_bar.
        inner_radius: the inner limit of the first radius bin, as a fraction of the reach.
        body_yaws: how many body yaws the search tries; 0: the trees do not split by the body yaw.
        joint_bandwidth: h_j of the joint densities, metres (eq. 14).
        heaviest_votes: M, how many votes make a density (eq. 14, 15).
        candidates: how many modes of a joint's density the graph can choose from (eq. 16).
        pair_weight: the power to which the pair densities are raised in eq. 16 and 17.
        legs_apart: the graph penalises the left and the right knee, or ankle, closer to each other
            than this, metres; 0: it does not, as in the paper.
        offset_pairs: for dcf: the number of pairs of offsets.
        offset_reach: for dcf: the largest offset in x and in y, metres.
        offset_seed: for dcf: the seed of the random offsets.
    """

    fewest_neighbours: int = 0
    neighbour_distance: float = 0.1
    fill_holes: int = 0
    occluder_step: float = 0.05
    sloppy_outline: float = 0.5
    noise_factor: float = 0.0
    smoothing_sigma: float = 0.02
    edge_threshold: float = 0.04
    feature: str = '3dlsc'
    sample: str = 'silhouette'
    points: int = 400
    query_points: int = 180
    fixed_scale: float = 0.0
    least_cut_scale: float = 0.0
    binning: str = 'shared'
    support_radius: float = 1.5
    inner_radius: float = 0.1
    body_yaws: int = 0
    joint_bandwidth: float = 0.07
    heaviest_votes: int = 200
    candidates: int = 2
    pair_weight: float = 1.0
    legs_apart: float = 0.12
    offset_pairs: int = 360
    offset_reach: float = 0.5
    offset_seed: int = 0


LARGEST: dict[str, float] = {
    'fewest_neighbours': 8,
    'neighbour_distance': 10.0,
    'fill_holes': 8,
    'occluder_step': 1.0,
    'sloppy_outline': 1.0,
    'noise_factor': 100.0,
    'smoothing_sigma': 1.0,
    'edge_threshold': 10.0,
    'points': 1000,
    'query_points': 1000,
    'fixed_scale': 10.0,
    'least_cut_scale': 10.0,
    'support_radius': 100.0,
    'inner_radius': 1.0,
    'body_yaws': 36,
    'joint_bandwidth': 10.0,
    'heaviest_votes': 1000,
    'candidates': 10,
    'pair_weight': 100.0,
    'legs_apart': 10.0,
    'offset_pairs': 2000,
    'offset_reach': 10.0,
    'offset_seed': 1 << 128,
}
"""The largest value of each setting that is a number. A frame with the largest counts, which is
what a model from a stranger can ask for, takes some ten times as long as one with the defaults."""
