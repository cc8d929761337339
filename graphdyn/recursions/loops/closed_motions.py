"""What steps of robots with loops need at a state: closed accelerations, and the nearest closed position and velocity.

Of J in the units of its rows and columns, F are the columns of the dependent joints. Where J has its usual rank, the
closed motions are the combinations of the columns of K = [-F⁺J_u; E], which have orthogonal ones, Z. The pseudoinverse
by which graphdyn.simulation.equations closes a state is then J⁺ = (E - Z Z⁺) [F⁺; 0].

F = Q R and K = Z S by modified Gram-Schmidt, whose errors grow with the condition of F and not with its square (Björck,
Numerical Methods for Least Squares Problems, 1996, section 2.4); without square roots, so that R has ones on its
diagonal.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions.inertia import inverted, mass_matrix
from graphdyn.recursions.inverse import Loads
from graphdyn.recursions.loops.chords import ChordRows, rows_of_chords
from graphdyn.recursions.loops.couplings import everywhere, projected, torques
from graphdyn.recursions.mechanism.mechanism import Links
from graphdyn.recursions.motion import Root
from graphdyn.scalars.expressions import Expression
from graphdyn.scalars.vectors import PerJoint, Scalars, is_known, scalars, zeros

DEPENDENT_PIVOT_SHARE = 1e-6
"""Least square of a column of Q, relative to that of F: below, rounding errors of what follows from F exceed 1e-12."""


class Orthogonal:
    """F (m, d) as Q R.

    columns: Q (m, d); squares: of these                    (d)
    inverse: R⁻¹                                            (d, d)
    relative: squares relative to those of the columns of F   (d)
    """

    def __init__(self, columns: Scalars) -> None:
        count = columns.shape[1]
        self.columns, upper, self.squares = columns.copy(), np.eye(count).astype(object), list[Any]()
        for k in range(count):
            self.squares.append(self.columns[:, k] @ self.columns[:, k])
            for j in range(k + 1, count):
                upper[k, j] = _divided(self.columns[:, k] @ self.columns[:, j], self.squares[k])
                self.columns[:, j] = self.columns[:, j] - upper[k, j] * self.columns[:, k]
        self.inverse = np.eye(count).astype(object)
        for k in reversed(range(count)):
            for j in range(k + 1, count):
                self.inverse[k, j] = -(upper[k, k + 1 : j + 1] @ self.inverse[k + 1 : j + 1, j])
        self.relative = [
            _divided(square, column @ column) for square, column in zip(self.squares, columns.T, strict=True)
        ]

    def solved(self, right: Scalars) -> Scalars:
        """The x (d) for which F x is nearest to right (m), which is reduced as a further column of F."""
        shares = list[Any]()
        for square, column in zip(self.squares, self.columns.T, strict=True):
            shares.append(_divided(column @ right, square))
            right = right - shares[-1] * column
        x: Scalars = self.inverse @ np.array(shares, dtype=object)
        return x


@dataclass(frozen=True, eq=False)
class ClosedMotions:
    """The motions that keep loops closed at a state, of the n joints that no others drive.

    rows: of all chords
    units: of q                                             (n)
    jacobian: J in units (m, n)
    dependent: numbers of the joints whose columns are F; factors: of F; motions: of K (n, n - d)
    """

    rows: Sequence[ChordRows]
    units: Scalars
    jacobian: Scalars
    dependent: list[int]
    factors: Orthogonal
    motions: Orthogonal

    def particular(self, wanted: Scalars) -> Scalars:
        """Rates (n) with J rates = wanted (m), those of the independent joints zero."""
        rates = zeros(len(self.units))
        rates[self.dependent] = self.factors.solved(wanted)
        particular: Scalars = self.units * rates
        return particular

    def nearest(self, rates: Scalars) -> Scalars:
        """The closed motion (n) that is nearest to rates in their units."""
        z, squares = self.motions.columns, self.motions.squares
        closest: Scalars = self.units * (z @ ((z.T @ (rates / self.units)) / squares))
        return closest

    def certain(self, least_distance: float) -> list[Any]:
        """Above zero where a singular pose is farther than this, and the dependent joints follow accurately."""
        pivots = [x - DEPENDENT_PIVOT_SHARE for x in self.factors.relative]
        certain = [1.0 - self._inverse_distance * least_distance**2, *pivots]
        return [x for x in certain if isinstance(x, Expression)]

    @property
    def _inverse_distance(self) -> Any:
        """Squares of all entries of J, times those of J⁺: at least 1/distance² from a singular pose."""
        inverse, z = self.factors.inverse, self.motions.columns[self.dependent]
        of_columns = (inverse / self.factors.squares) @ inverse.T  # (FᵀF)⁻¹
        across = np.eye(len(z)) - (z / self.motions.squares) @ z.T
        return (self.jacobian * self.jacobian).sum() * (across * of_columns).sum()


def closed_motions(model: RobotModel, links: Links, q: PerJoint, v: PerJoint) -> ClosedMotions:
    """The closed motions at q, v of all joints."""
    rows = rows_of_chords(model, links, q, v)
    units, of_free = scalars(model.loops.column_units), scalars(model.degrees_of_freedom.matrix)
    jacobian = (np.concatenate([row.jacobian for row in rows]) @ of_free) * units
    dependent = list(model.dependent_joints)
    independent = [j for j in range(model.nv) if j not in dependent]
    factors = Orthogonal(jacobian[:, dependent])
    motions = zeros(model.nv, len(independent))
    motions[independent, range(len(independent))] = 1.0
    for column, j in enumerate(independent):
        motions[dependent, column] = -factors.solved(jacobian[:, j])
    return ClosedMotions(rows, units, jacobian, dependent, factors, Orthogonal(motions))


def closed_accelerations(
    model: RobotModel,
    links: Links,
    root: Root,
    q: PerJoint,
    v: PerJoint,
    tau: PerJoint,
    external: Loads,
    rotor: Sequence[Any],
) -> tuple[Scalars, ClosedMotions]:
    """a (n) of the joints that no others drive, with rotors, under the torques on these.

    q, v: of all joints
    """
    held, freedom = closed_motions(model, links, q, v), model.degrees_of_freedom
    motions = held.motions.columns * held.units[:, None]
    start = held.particular(np.concatenate([row.bias for row in held.rows]))
    inertia = projected(mass_matrix(links, q), ("n", "n"), freedom)
    inertia[np.diag_indices(model.nv)] += np.array(rotor, dtype=object)
    needed = projected(torques(links, root, q, v, everywhere(start, freedom), external), ("n",), freedom)
    driving = np.array(tau, dtype=object) - needed - np.array(rotor, dtype=object) * start
    count = motions.shape[1]
    inverse, _ = inverted(motions.T @ inertia @ motions, [range(j)[::-1] for j in range(count)])
    return start + motions @ (inverse @ (motions.T @ driving)), held


def _divided(x: Any, y: Any) -> Any:
    """x / y; zero where x is known to be."""
    return 0.0 if is_known(x, 0.0) else x / y
