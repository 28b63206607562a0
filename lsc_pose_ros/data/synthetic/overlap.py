"""How far a person's limbs go through the rest of the body."""

import numpy as np
from numpy.typing import NDArray

from lsc_pose_ros.data.synthetic.body import SEGMENTS, Body
from lsc_pose_ros.data.synthetic.pose import place_segments
from lsc_pose_ros.data.synthetic.solids import pose_solids, signed_distance


def deepest_overlap(body: Body, angles: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how far limbs sink into other parts of the body in N poses, metres, shape (N,).

    Forearms and hands are held against trunk, head, legs and the other arm; shanks and feet
    against the other leg.
    """
    placement = place_segments(body, angles)
    cones = pose_solids(body.solids, placement)
    outward_y = np.linalg.inv(cones.inward)[..., 1]
    deepest = np.zeros(len(angles))
    carriers = [SEGMENTS[number] for number in body.solids.segment]
    for probing, against in _OVERLAPS:
        probes = [index for index, name in enumerate(carriers) if name in probing]
        solids = [index for index, name in enumerate(carriers) if name in against]
        start = cones.origins[:, probes]
        along = cones.length[probes][:, None] * outward_y[:, probes]
        obstacle = cones._replace(
            origins=cones.origins[:, solids],
            inward=cones.inward[:, solids],
            length=cones.length[solids],
            radii=cones.radii[solids],
        )
        for share in (0.5, 1.0):
            radius = (1 - share) * cones.radii[probes, 0] + share * cones.radii[probes, 1]
            thin = radius * np.minimum(body.solids.squeeze[probes].min(axis=1), 1.0)
            distance = signed_distance(start + share * along, obstacle) - thin[:, None]
            deepest = np.maximum(deepest, -distance.min(axis=(1, 2)))
    return deepest


_TRUNK = {'pelvis', 'abdomen', 'chest', 'head'}


def _overlaps() -> tuple[tuple[set[str], set[str]], ...]:
    """Return which segments are held against which others."""
    pairs: list[tuple[set[str], set[str]]] = []
    for one, other in (('l', 'r'), ('r', 'l')):
        legs = {f'{side}_{name}' for side in ('l', 'r') for name in ('thigh', 'shank')}
        arm = {f'{other}_{name}' for name in ('upper_arm', 'forearm', 'hand')}
        pairs.append(({f'{one}_forearm', f'{one}_hand'}, _TRUNK | legs | arm))
        leg = {f'{other}_{name}' for name in ('thigh', 'shank', 'foot')}
        pairs.append(({f'{one}_shank', f'{one}_foot'}, leg))
    return tuple(pairs)


_OVERLAPS = _overlaps()
