"""The numbers that the method leaves open; a model carries those it was trained with."""

from typing import NamedTuple


class Settings(NamedTuple):
    """How silhouettes, descriptors and densities are computed.

    Attributes:
        smoothing_sigma: sigma of the Gaussian over 3-D distances, metres (eq. 1).
        edge_threshold: t_d, the depth step that makes an edge, metres (eq. 2).
        points: N, how many silhouette points stand for a body.
        query_points: how many of them vote; the others are only seen by their descriptors.
        support_radius: the descriptor's reach, in units of rho_bar.
        inner_radius: the inner limit of the first radius bin, as a share of the support radius.
        joint_bandwidth: h_j of the joint densities, metres (eq. 14).
        heaviest_votes: M, how many votes make a density (eq. 14, 15).
        candidates: how many modes of a joint's density the graph may choose from (eq. 16).
        pair_weight: the power to which the pair densities are raised in eq. 16 and 17.
    """

    smoothing_sigma: float = 0.02
    edge_threshold: float = 0.04
    points: int = 400
    query_points: int = 200
    support_radius: float = 1.0
    inner_radius: float = 0.1
    joint_bandwidth: float = 0.07
    heaviest_votes: int = 200
    candidates: int = 2
    pair_weight: float = 1.0
