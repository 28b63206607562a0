"""The numbers that the method leaves open; a model carries those it was trained with."""

from typing import NamedTuple

FEATURES = ('3dlsc', '2dsc', 'dcf', 'mixed')
"""The paper's feature, and its rivals; `core/features.py` says what they are."""

SAMPLES = ('silhouette', 'body')
"""Where the points of a body can be taken from."""

BINNINGS = ('shared', 'nearest')
"""How a point counts in the bins of the paper's feature: in the eight around it, or in one."""


class Settings(NamedTuple):
    """How silhouettes, descriptors and densities are computed.

    Attributes:
        fewest_neighbours: a pixel of the body with fewer than so many of its eight neighbours at
            its own depth is a flying pixel, on no surface, and is left out; 0 keeps all.
        neighbour_distance: up to which step in depth a neighbour is at the same, metres.
        fill_holes: a pixel without depth takes the median of its neighbours' on the body where so
            many of the eight are; 0: it stays a hole.
        noise_factor: sigma and t_d are at least so many times the noise that is found in the
            body's own depth; 0: they are what they are.
        smoothing_sigma: sigma of the Gaussian over 3-D distances, metres (eq. 1).
        edge_threshold: t_d, the depth step that makes an edge, metres (eq. 2).
        feature: what the forest sees of a point, one of FEATURES.
        sample: whether the points lie on the body's silhouette (eq. 2) or anywhere on it, one of
            SAMPLES.
        points: N, how many points stand for a body.
        query_points: how many of them vote; the others are only seen by their descriptors.
        fixed_scale: metres that take the place of rho_bar wherever it is the unit, for everybody
            alike; 0 for none: rho_bar is each body's own.
        binning: of the feature 3dlsc: how a point counts in the bins, one of BINNINGS.
        support_radius: the descriptor's reach, in units of rho_bar.
        inner_radius: the inner limit of the first radius bin, as a share of the support radius.
        body_yaws: how many body yaws are tried, each told to the forest; 0:
            the forest knows no facings.
        joint_bandwidth: h_j of the joint densities, metres (eq. 14).
        heaviest_votes: M, how many votes make a density (eq. 14, 15).
        candidates: how many modes of a joint's density the graph may choose from (eq. 16).
        pair_weight: the power to which the pair densities are raised in eq. 16 and 17.
        legs_apart: the graph avoids to put the left and the right knee, or ankle, closer to each
            other than this, metres; 0: it does not care, as in the paper.
        offset_pairs: of the feature dcf: how many pairs of offsets there are.
        offset_reach: likewise: how far an offset reaches in x and in y, metres.
        offset_seed: likewise: of the offsets.
    """

    fewest_neighbours: int = 0
    neighbour_distance: float = 0.1
    fill_holes: int = 0
    noise_factor: float = 0.0
    smoothing_sigma: float = 0.02
    edge_threshold: float = 0.04
    feature: str = '3dlsc'
    sample: str = 'silhouette'
    points: int = 400
    query_points: int = 180
    fixed_scale: float = 0.0
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
