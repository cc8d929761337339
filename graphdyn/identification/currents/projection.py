"""The fit of the gains, everything else eliminated: variable projection.

For given gains the currents are linear in all other unknowns. These are eliminated, and the gains alone are left: a
problem with as many unknowns as joints, whose squares have no curved valley. Golub and Pereyra, SIAM Journal on
Numerical Analysis 10(2), 1973; the derivative is that of Kaufman, BIT 15, 1975.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graphdyn.errors import EstimationFailed
from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.algebra.least_squares import orthonormal_basis
from graphdyn.identification.currents.equations import CurrentEquations
from graphdyn.identification.problem.torque_model import structure
from graphdyn.layout import Array

MAX_GAIN_EVALUATIONS = 200
"""Largest number of evaluations of the fit of the gains; from poor starting values it takes some twenty."""

CONVERGED = 1e-13
"""Relative change of the squares, of the gains and of their slope below which the fit has ended."""

POOR_FIT = 2.0
"""Squares that the joints leave together over those that each leaves alone, per parameter and in units of the noise,
above which other starting values and signs of the gains are tried: noise leaves 1 to 1.4, a reversed current 20."""

MIN_GAIN_OF_REVERSAL = 2.0
"""Factor by which a reversed current must lower the squares that the joints leave together."""

MAX_CHANGE = 10.0
"""Largest change of the logarithm of a gain from its starting value; it bounds the steps of gains that nothing
determines."""


class Point(NamedTuple):
    """Gains of a fit.

    signs, logarithms: of the gains (n,)
    squares: left over, in units of the noise
    settled: whether the squares are the least ones
    """

    signs: Array
    logarithms: Array
    squares: float
    settled: bool = False


@dataclass(frozen=True, eq=False)
class GainFit:
    """The least squares of the gains alone.

    known: rows and right side of what is known, for all unknowns; noise: of every recording and joint (k, n)
    """

    equations: CurrentEquations
    known: tuple[Array, Array]
    noise: Array

    def best(self) -> Point:
        """The gains with the least squares. Raises EstimationFailed where none are found."""
        starts = sorted(self._starts(), key=lambda point: point.squares)
        found = self._solved(starts[0])
        if not found.settled or self._excess(found) > POOR_FIT:
            found = min([found, *map(self._solved, starts[1:])], key=lambda point: point.squares)
            found = self._with_reversals(found)
        if not found.settled:
            raise EstimationFailed(
                f"gains and loads have not settled after {MAX_GAIN_EVALUATIONS} steps; a current may belong to another "
                "joint, or hardly change with the motion"
            )
        return found

    def _excess(self, point: Point) -> float:
        """Squares that the joints leave together beyond those that each leaves alone, per parameter."""
        alone, parameters = self._alone
        return max(point.squares - alone, 0.0) / max(parameters, 1)

    def _solved(self, start: Point) -> Point:
        """The gains with the least squares that have these signs."""
        gains, values = self._known_gains

        def equations(logarithms: Array) -> tuple[Array, Array]:
            per_torque = start.signs * np.exp(-logarithms)
            residual, slope = self._projected(per_torque, *self._known_torques)
            return (
                np.concatenate([residual, gains @ logarithms - values]),
                np.concatenate([slope * -per_torque, gains]),
            )

        logarithms, squares, settled = _least(equations, start.logarithms)
        return Point(start.signs, logarithms, squares, settled)

    def _with_reversals(self, found: Point) -> Point:
        """The fit with those currents reversed whose reversal lowers the squares most, one after the other."""
        for _ in range(self.equations.n_joints):
            signs = found.signs * (1 - 2 * np.eye(len(found.signs)))
            trials = [self._solved(found._replace(signs=row)) for row in signs]
            best = min(trials, key=lambda point: point.squares)
            if self._excess(best) > self._excess(found) / MIN_GAIN_OF_REVERSAL:
                break
            found = best
        return found

    def _projected(self, per_torque: Array, known: Array, values: Array) -> tuple[Array, Array]:
        """Residuals at the best links and loads for these currents per torque (n,), and their derivatives.

        known, values: further equations of links and loads
        """
        torques, currents = self._stacked
        matrix = np.concatenate([per_torque[self._joints][:, None] * torques, known])
        right = np.concatenate([currents, values])
        length = np.linalg.norm(matrix, axis=0)
        used = length > 0
        u, s, v_t = np.linalg.svd(matrix[:, used] / length[used], full_matrices=False)
        kept = s > RANK_TOLERANCE * s.max(initial=0.0)
        basis = u[:, kept]
        along = basis.T @ right
        x = v_t[kept].T @ (along / s[kept]) / length[used]
        rows = np.arange(len(currents))
        slope = np.zeros((len(right), self.equations.n_joints))
        slope[rows, self._joints] = torques[:, used] @ x
        return basis @ along - right, slope - basis @ (basis.T @ slope)

    def linear(self, point: Point) -> Array:
        """The links and loads with the least squares for these gains (r + 10 l,)."""
        per_torque = (point.signs * np.exp(-point.logarithms))[self._joints]
        (torques, currents), (known, values) = self._stacked, self._known_torques
        matrix = np.concatenate([per_torque[:, None] * torques, known])
        return least_squares_solution(matrix, np.concatenate([currents, values]))

    def _starts(self) -> Iterator[Point]:
        """Gains to begin with: those of the model's links, also without their signs, which a light wrist hardly shows,
        and those of a linear fit with currents as regressors."""
        of_model = self._gains_of_model()
        model = self._scaled(of_model)
        yield model
        if np.any(of_model < 0):
            yield self._scaled(np.abs(of_model))
        yield self._scaled(self._gains_as_unknowns(model))

    def _scaled(self, gains: Array) -> Point:
        """These gains (n,), with a factor for all that agrees with gains that are known, else with loads that are."""
        signs, logarithms = np.where(gains < 0, -1.0, 1.0), np.log(np.abs(gains))
        rows, right = self._known_gains
        common = rows @ np.ones(len(gains))
        if common @ common > 0:
            return self._point(signs, logarithms - common @ (rows @ logarithms - right) / (common @ common))
        torques, currents = self._stacked
        known, values = self._known_torques
        r = len(self.equations.links)
        free = least_squares_solution((1 / gains)[self._joints][:, None] * torques, currents)
        along = known[:, r:] @ free[r:]
        size = float(along @ values)
        if size:
            signs, logarithms = np.sign(size) * signs, logarithms + np.log(np.abs(size) / (along @ along))
        return self._point(signs, logarithms)

    def _point(self, signs: Array, logarithms: Array) -> Point:
        """These gains, and the squares that they leave."""
        rows, right = self._known_gains
        residual, _ = self._projected(signs * np.exp(-logarithms), *self._known_torques)
        return Point(signs, logarithms, float(residual @ residual + np.sum((rows @ logarithms - right) ** 2)))

    def _gains_of_model(self) -> Array:
        """Gains with which the links of the model explain most of the currents (n,)."""
        equations = self.equations
        links = structure(equations.torque_model).base.values(equations.torque_model.prior())[equations.links]
        torques = self._stacked[0][:, : len(links)] @ links
        per_torque = np.array(
            [
                torques[own] @ self._stacked[1][own] / max(torques[own] @ torques[own], np.finfo(float).tiny)
                for own in (self._joints == joint for joint in range(equations.n_joints))
            ]
        )
        return self._usable(np.divide(1, per_torque, out=np.zeros_like(per_torque), where=per_torque != 0))

    def _gains_as_unknowns(self, start: Point) -> Array:
        """Gains of a linear fit: torques by gains times currents, the errors on the side of the torques (n,).

        They are too small, and their signs are right. All together keep the size of the starting values.
        """
        n, size = self.equations.n_joints, np.exp(start.logarithms)
        torques, currents = self._stacked
        spread = np.zeros((len(currents), n))
        spread[np.arange(len(currents)), self._joints] = currents
        together = np.zeros(n + torques.shape[1])
        together[:n] = np.linalg.norm(currents) / n
        matrix = np.concatenate([spread, -torques / size[self._joints][:, None]], axis=1)
        right = np.append(np.zeros(len(currents)), np.linalg.norm(currents))
        return self._usable(least_squares_solution(np.concatenate([matrix, together[None]]), right)[:n] * size)

    def _usable(self, gains: Array) -> Array:
        """Gains that are numbers; those that are none take the median size of the others."""
        good = np.isfinite(gains) & (gains != 0)
        middle = float(np.median(np.abs(gains[good]))) if good.any() else 1.0
        return np.where(good, gains, middle)

    @cached_property
    def _joints(self) -> NDArray[np.int64]:
        """Joint of every equation of the currents (m,)."""
        rows = self.equations.without_friction[0].shape[1]
        return np.tile(np.repeat(np.arange(self.equations.n_joints), rows), len(self.equations.recordings))

    @cached_property
    def _stacked(self) -> tuple[Array, Array]:
        """Torques of links and loads (m, r + 10 l), and currents (m,), in units of the noise of the currents."""
        equations = self.equations
        r, torques, currents = len(equations.links), [], []
        for k, (rows, recording) in enumerate(zip(equations.without_friction, equations.recordings, strict=True)):
            weighted = (rows / self.noise[k][:, None, None]).reshape(-1, r + 1)
            wide = np.zeros((len(weighted), len(equations.torque_columns)))
            wide[:, :r] = weighted[:, :-1]
            if recording.load is not None:
                own = np.isin(equations.torque_columns, np.r_[equations.load_columns(recording.load)])
                wide[:, own] = weighted[:, :-1] @ equations.load_matrix
            torques.append(wide)
            currents.append(weighted[:, -1])
        return np.concatenate(torques), np.concatenate(currents)

    @cached_property
    def _alone(self) -> tuple[float, int]:
        """Squares that every joint of every recording leaves in a fit of its own, and the parameters of these fits."""
        torques, currents = self._stacked
        squares, parameters = 0.0, 0
        rows = self.equations.without_friction[0].shape[1]
        for start in range(0, len(currents), rows):
            own = slice(start, start + rows)
            basis = orthonormal_basis(torques[own, : len(self.equations.links)], RANK_TOLERANCE)
            squares += float(np.sum((currents[own] - basis @ (basis.T @ currents[own])) ** 2))
            parameters += basis.shape[1]
        return squares, parameters

    @cached_property
    def _known_gains(self) -> tuple[Array, Array]:
        rows, right = self.known
        of_gains = np.any(rows[:, self.equations.gain_columns] != 0, axis=1)
        return rows[of_gains][:, self.equations.gain_columns], right[of_gains]

    @cached_property
    def _known_torques(self) -> tuple[Array, Array]:
        """What is known of links and loads."""
        rows, right = self.known
        of_torques = np.any(rows[:, self.equations.torque_columns] != 0, axis=1)
        return rows[of_torques][:, self.equations.torque_columns], right[of_torques]


def _least(equations: Callable[[Array], tuple[Array, Array]], start: Array) -> tuple[Array, float, bool]:
    """Unknowns with the least squares, these squares, and whether the search has ended.

    equations: residuals of unknowns, and their derivatives
    """
    from scipy.optimize import least_squares  # imported where first used: import graphdyn stays light

    last: dict[bytes, tuple[Array, Array]] = {}

    def computed(x: Array) -> tuple[Array, Array]:
        """Residual and derivative, once for both."""
        if x.tobytes() not in last:
            last.clear()
            last[x.tobytes()] = equations(x)
        return last[x.tobytes()]

    ends = dict.fromkeys(("ftol", "xtol", "gtol"), CONVERGED)
    found = least_squares(
        lambda x: computed(x)[0],
        start,
        lambda x: computed(x)[1],
        bounds=(start - MAX_CHANGE, start + MAX_CHANGE),
        x_scale="jac",
        max_nfev=MAX_GAIN_EVALUATIONS,
        **ends,
    )
    return found.x, float(2 * found.cost), found.status > 0


def least_squares_solution(matrix: Array, right: Array) -> Array:
    """x that minimizes ‖A x - b‖, columns at unit length; the shortest where several do."""
    length = np.linalg.norm(matrix, axis=0)
    length = np.where(length > 0, length, 1.0)
    x: Array = np.linalg.lstsq(matrix / length, right, rcond=RANK_TOLERANCE)[0] / length
    return x
