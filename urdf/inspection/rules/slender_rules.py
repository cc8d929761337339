"""Slender links whose tensor lies across them: the axis of the smallest moment is that of the longest side."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from urdf.document.numbers import values
from urdf.inspection.findings import Finding, about
from urdf.inspection.structure import LinkInertial, Structure

SLENDER = 0.3
"""Smallest principal moment over the middle one, up to which a link is slender."""

MIN_REACH, MIN_REACH_RATIO = 0.1, 1.5
"""Distance of the next joint, in meters and in radii of gyration, from which a link extends towards it."""

ACROSS = 60.0
"""Between the axis of the smallest moment and the line to the next joint [°]: no slender link of 84 published robots
has 45°."""


def slender_findings(structure: Structure) -> Iterator[Finding]:
    """Moving links with one joint ahead whose smallest moment is not about the line to it."""
    for each in structure.inertials:
        angle = _angle(structure, each) if structure.moving(each.link) and each.mass > 0 else 0.0
        if angle > ACROSS:
            yield about(
                "inertia-across-link",
                each.element,
                f"the tensor is that of a slender body that lies at {angle:.0f}° to the line from this joint to the "
                "next",
            )


def _angle(structure: Structure, inertial: LinkInertial) -> float:
    """Between that axis and the line [°]; zero where the link is not slender or has no single joint ahead."""
    ahead = [joint for joint in structure.joints_from.get(inertial.link, ()) if joint.get("type") != "fixed"]
    low, middle, _ = inertial.moments
    if len(ahead) != 1 or not 0 < low < SLENDER * middle or not inertial.is_possible(0.0):
        return 0.0
    line = np.array(values(ahead[0].find("origin"), "xyz", 3) or (0.0, 0.0, 0.0))
    reach, gyration = float(np.linalg.norm(line)), float(np.sqrt(inertial.moments.sum() / 2 / inertial.mass))
    if not max(MIN_REACH, MIN_REACH_RATIO * gyration) < reach < np.inf:
        return 0.0
    axis = inertial.rotation @ np.linalg.eigh(inertial.tensor)[1][:, 0]
    return float(np.degrees(np.arccos(min(1.0, abs(axis @ line) / reach))))
