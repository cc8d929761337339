"""Limits of bodies as linear inequalities of the parameters of a torque model."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn.identification.bodies.limits import BodyLimits
from graphdyn.identification.bodies.unknown_bodies import Bodies
from graphdyn.layout import Array

VIOLATION_TOLERANCE = 1e-6
"""Largest violation of an inequality, relative to the size of its terms."""


@dataclass(frozen=True, eq=False)
class Inequalities:
    """G x ≥ h of the parameters x of a torque model.

    matrix: G (m, p); right: h (m,); names: each as text    (m,)
    """

    matrix: Array
    right: Array
    names: tuple[str, ...]

    def violated(self, x: Array) -> tuple[str, ...]:
        """Names of the rows that x (p,) does not keep."""
        short = self.right - self.matrix @ x
        size = np.maximum(np.abs(self.right), np.abs(self.matrix) @ np.abs(x))
        return tuple(
            name for name, broken in zip(self.names, short > VIOLATION_TOLERANCE * size, strict=True) if broken
        )


def inequalities(limits: BodyLimits, bodies: Bodies, columns: Sequence[str]) -> Inequalities:
    """The limits as inequalities, with the columns that cannot be negative. columns: names of all p."""
    rows: list[tuple[dict[int, float], float, str]] = []

    def mass_between(masses: Sequence[int], bounds: Array, what: str) -> None:
        low, high = bounds
        if low > 0:  # the cone keeps a mass positive
            rows.append((dict.fromkeys(masses, 1.0), low, f"{what} ≥ {low:.4g} kg"))
        rows.append((dict.fromkeys(masses, -1.0), -high, f"{what} ≤ {high:.4g} kg"))

    for name, columns_of, mass, center, box, radius, about in zip(
        *(bodies.names, bodies.columns, limits.mass, limits.center, limits.box, limits.radius, limits.about),
        strict=True,
    ):
        first = columns_of.start
        mass_between([first], mass, f"mass of '{name}'")
        for axis in range(3):
            moment, along = first + 1 + axis, f"in {'xyz'[axis]}"
            low, high = center[:, axis]
            if np.isfinite(low):  # m c ≥ low m
                rows.append(({moment: 1.0, first: -low}, 0.0, f"center of mass of '{name}' {along} ≥ {low:g} m"))
            if np.isfinite(high):
                rows.append(({moment: -1.0, first: high}, 0.0, f"center of mass of '{name}' {along} ≤ {high:g} m"))
            low, high = box[:, axis]
            if np.isfinite(low) and np.isfinite(high):
                of_square = {first + k: -share for k, share in _SQUARES[axis].items()}
                rows.append(
                    (
                        {moment: low + high, first: -low * high, **of_square},
                        0.0,
                        f"matter of '{name}' {along} from {low:.3g} to {high:.3g} m",
                    )
                )
        if np.isfinite(radius):  # ∫ |x - about|² dm ≤ radius² m, which bounds moments about the center of mass too
            of_place = {first: radius**2 - float(about @ about)} | {first + 1 + k: 2 * about[k] for k in range(3)}
            of_squares = {first + k: -0.5 for k in (4, 6, 9)}
            rows.append((of_place | of_squares, 0.0, f"radius of gyration of '{name}' ≤ {radius:.3g} m"))
    counted = [part.start for part, counts in zip(bodies.columns, limits.counted, strict=True) if counts]
    mass_between(counted, limits.total_mass, "total mass")
    rows.extend(({columns.index(name): 1.0}, 0.0, f"{name} ≥ 0") for name in bodies.nonnegative)

    given = [row for row in rows if np.isfinite(row[1])]
    matrix = np.zeros((len(given), len(columns)))
    for line, (coefficients, _, _) in zip(matrix, given, strict=True):
        line[list(coefficients)] = list(coefficients.values())
    return Inequalities(matrix, np.array([right for _, right, _ in given]), tuple(name for _, _, name in given))


_SQUARES = ({4: -0.5, 6: 0.5, 9: 0.5}, {4: 0.5, 6: -0.5, 9: 0.5}, {4: 0.5, 6: 0.5, 9: -0.5})
"""∫ x² dm, ∫ y² dm and ∫ z² dm in the ten parameters: ∫ x² dm = (I_yy + I_zz - I_xx) / 2."""
