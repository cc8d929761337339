"""Tensors that are those of a mesh once one slip is undone: of size, signs, order of axes, rotation, point.

Tensors are compared up to a factor, because links are hollow. Which slip it was is only asked where the inertial is
that of the mesh beside it: the center of mass is the same.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from graphdyn.layout import Array
from urdf.document.inertial_numbers import inertial_numbers
from urdf.geometry.mass_properties import Filled
from urdf.inspection.findings import Finding, about
from urdf.inspection.structure import LinkInertial
from urdf.reading.corrections import Correction, changes, shifted

MAX_DISTANCE, MIN_GAIN, MIN_DISTANCE = 0.1, 3.0, 0.12
"""A tensor is that of the mesh up to the first distance; another one is meant if it is so and nearer by the second
factor, where the written one is farther away than the last."""

SAME_SIZE = (0.75, 1.34)
"""Factors between a tensor and that of the mesh with the same mass that a body has which is nearly uniform."""

MAX_UNIFORM_DENSITY = 9000.0
"""Mass over volume up to which a link may be filled: that of steel with some copper [kg/m³]."""


def miswritten(own: LinkInertial, solid: Filled, what: str) -> Iterator[Finding]:
    """own: with the center of mass of the mesh; what: "visual mesh", for the message"""
    density = own.mass / solid.volume
    filled = solid.tensor * density
    apart, factor = distance(own.turned, filled)
    power = round(np.log10(factor)) if factor > 0 else 0
    where = f"that of the {what}, filled uniformly with {own.mass:.3g} kg ({density:.4g} kg/m³)"
    if apart < MAX_DISTANCE and power and SAME_SIZE[0] < factor / 10.0**power < SAME_SIZE[1]:
        yield about(
            "miswritten-inertia",
            own.element,
            f"the tensor is {factor:.3g} times {where}, and else the same up to {100 * apart:.1f} %: mass or tensor is "
            "off by a power of ten or by the density of another material",
        )
    elif density < MAX_UNIFORM_DENSITY and (found := meant(own, filled)):
        change, off = found
        yield about(
            "miswritten-inertia",
            own.element,
            f"the tensor differs by {100 * apart:.0f} % from {where}, whose center of mass it has; {change.what}, it "
            f"differs by {100 * off:.1f} %",
        )


def meant(own: LinkInertial, filled: Array) -> tuple[Correction, float] | None:
    """The change that makes it the tensor of the mesh, and the distance that is left; None where no change does.

    filled: the tensor of the mesh with the mass of the link, in link axes   (3, 3)
    """
    apart, _ = distance(own.turned, filled)
    if apart < MIN_DISTANCE:
        return None
    limit = min(MAX_DISTANCE, apart / MIN_GAIN)
    fitting = list[tuple[Correction, float]]()
    for change in (*(change for change in changes(own.element) if change.turns), *shifted(own.element)):
        new = inertial_numbers(change.applied(own.element))
        if new is not None and new.tensor.any():
            off, factor = distance(new.turned, filled)
            if off < limit and SAME_SIZE[0] < factor < SAME_SIZE[1]:
                fitting.append((change, off))
    best = min((off for _, off in fitting), default=0.0)
    return next((each for each in fitting if each[1] <= 1.2 * best), None)  # the usual one of equals


def distance(own: Array, other: Array) -> tuple[float, float]:
    """‖own - f other‖ / ‖own‖ with the factor f that makes it smallest, and f; tensors (3, 3)."""
    factor = float(np.sum(own * other) / np.sum(other * other))
    return float(np.linalg.norm(own - factor * other) / np.linalg.norm(own)), factor
