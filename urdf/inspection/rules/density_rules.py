"""How dense the body of an inertial is, without its mesh: that of the uniform ellipsoid of its mass and moments.

Among all bodies that are nowhere denser than ρ, the uniform ellipsoid of density ρ has the smallest determinant of
second moments Σ = ∫ r rᵀ dm: a map of determinant 1 makes Σ a multiple of the identity and changes no density, and
then a ball has the smallest trace. A body with given mass and Σ is thus somewhere at least as dense as the ellipsoid.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from graphdyn.errors import counted
from urdf.errors import shortened
from urdf.inspection.findings import Finding, about, of_file
from urdf.inspection.structure import LinkInertial, Structure

DENSEST, THINNEST = 22_590.0, 1.2
"""Densities of osmium and of air [kg/m³]. Sound links have 30 to 10,000."""

MIN_THICKNESS_SHARE = 0.02
"""Part of the largest moment by which the two others exceed it at least: less, as of thin plates, may be rounding."""


def density_findings(structure: Structure) -> Iterator[Finding]:
    """Moving links that are denser than any material, and in one line those that are thinner than air."""
    thin: list[tuple[float, LinkInertial]] = []
    for each in structure.inertials:
        if not structure.moving(each.link) or each.mass == 0 or each.moments[0] <= 0:
            continue
        density = ellipsoid_density(each)
        if density > DENSEST:
            yield about(
                "inertial-density",
                each.element,
                f"a body of {each.mass:.4g} kg with this tensor has {density:.3g} kg/m³ or more in some place, osmium "
                f"has {DENSEST:.0f}",
            )
        elif density < THINNEST:
            thin.append((density, each))
    if thin:
        density, thinnest = min(thin, key=lambda one: one[0])
        yield of_file(
            "inertial-density",
            f"{counted(len(thin), 'link is', 'links are')} thinner than air, as ellipsoids of their mass and tensor: "
            f"{thinnest.mass:.4g} kg of link '{shortened(thinnest.link)}' are one of {density:.2g} kg/m³",
            severity="note",
            at=thin[0][1].element,
        )


def ellipsoid_density(inertial: LinkInertial) -> float:
    """Mass over the volume of the uniform ellipsoid with this mass and these moments [kg/m³]."""
    moments = inertial.moments
    spread = np.maximum(moments.sum() - 2 * moments, MIN_THICKNESS_SHARE * moments[2])  # 2/5 m a², a: half an axis
    halves = np.sqrt(2.5 * spread / inertial.mass)
    return float(inertial.mass / (4 / 3 * np.pi * np.prod(halves)))
