"""The fit of gains, links, friction and loads to currents, and its covariance.

Least squares by the method of Levenberg and Marquardt on compressed equations. Each joint of each recording is
weighted by the noise that its own linear fit has left over in the sums of its time blocks, so that what is correlated
in time counts less. The covariance of the data is a jackknife over the time blocks of all recordings; what was stated
beforehand (gains, links, loads) adds its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from graphdyn.errors import EstimationFailed, InvalidInput
from graphdyn.identification.algebra.base_parameters import RANK_TOLERANCE
from graphdyn.identification.algebra.compressed import EPS
from graphdyn.identification.currents.equations import CurrentEquations, LoadedRecording
from graphdyn.identification.currents.gains import JointGains
from graphdyn.identification.currents.loads import IdentifiedLoad, KnownLoad
from graphdyn.identification.currents.trusted_gravity import TrustedGravity
from graphdyn.identification.problem.torque_model import TorqueModel, structure
from graphdyn.layout import Array

MAX_STEPS = 200
"""Largest number of steps; from poor starting values a fit takes some thirty."""

CONVERGED = 1e-10
"""Relative decrease of the squares below which the fit has ended: far below what a standard deviation notices."""

MAX_RESCALINGS = 20
"""Largest number of steps towards the common factor of gains, links and loads; some five are taken."""

LEAST_NOISE = 1e-5
"""Noise of a current, relative to its root mean square, that every recording is taken to have: that of 16 bits. Exact,
simulated recordings would else outweigh all that is known, to the last digit."""

FIRST_DAMPING = 1e-3
"""Damping of the first step, relative to the columns at unit length."""

UNDETERMINED = 1e-7
"""Singular value of the equations, columns at unit length, relative to the largest, below which a combination is
undetermined: gains without anything known have 1e-10, the weakest gain of a moving joint 1e-4."""

MAX_RELATIVE_DEVIATION = 1.0
"""Relative standard deviation of a gain from which it counts as undetermined."""


@dataclass(frozen=True, eq=False)
class CurrentFit:
    """Gains, links and loads that fit recorded currents best.

    gains: of the joints
    loads: by name
    links: base parameters of the structure that belong to links (r,)
    currents: linear parameters of every recording and joint, c_j = W_j u_j   (k, n, b)
    noise: of the currents of every recording and joint, with its correlation in time (k, n)
    """

    gains: JointGains
    loads: Mapping[str, IdentifiedLoad]
    links: Array
    currents: Array
    noise: Array


def fit_currents(
    torque_model: TorqueModel,
    recordings: Sequence[LoadedRecording],
    *,
    carrier: str | None = None,
    gains: JointGains | None = None,
    known_loads: Mapping[str, KnownLoad] | None = None,
    gravity: TrustedGravity | None = None,
) -> CurrentFit:
    """Fit gains, links and loads to the currents of recordings.

    carrier: link that carries the loads, the last one if None
    gains, known_loads, gravity: what is known; at least one of them, because gains, links and loads scale together

    Raises InvalidInput where nothing is known, for a load that no recording carries, for a recording without two time
    blocks; EstimationFailed where the fit does not end.
    """
    equations = CurrentEquations(torque_model, recordings, carrier)
    known_loads = known_loads or {}
    if gains is None and gravity is None and not known_loads:
        raise InvalidInput(
            "currents alone determine no gain: gains, links and loads scale together; give a known load, gains, or "
            "links whose gravity is trusted"
        )
    if gains is not None and len(gains.values) != equations.n_joints:
        raise InvalidInput(f"there are {len(gains.values)} gains for {equations.n_joints} joints; give one per joint")
    missing = [load for load in known_loads if load not in equations.loads]
    if missing:
        raise InvalidInput(f"no recording carries the load '{missing[0]}'; those carried: {', '.join(equations.loads)}")
    if min(len(recording.blocks) for recording in recordings) < 2:
        raise InvalidInput("standard deviations need two time blocks or more of every recording; record longer")
    fit = _CurrentFitting(equations, _known(equations, gains, known_loads, gravity), _noise(equations))
    x = fit.solve(fit.start(gains, gravity))
    covariance = fit.covariance(x)
    return CurrentFit(
        _gains(x[equations.gain_columns], covariance[equations.gain_columns, equations.gain_columns]),
        {
            load: IdentifiedLoad(x[columns], covariance[columns, columns])
            for load in equations.loads
            for columns in [equations.load_columns(load)]
        },
        x[equations.link_columns],
        np.array([equations.currents(k, x) for k in range(len(recordings))]),
        fit.noise,
    )


def _gains(logarithms: Array, covariance: Array) -> JointGains:
    """The gains; those that are hardly known, and their covariances, are undetermined."""
    lost = ~(np.diagonal(covariance) < MAX_RELATIVE_DEVIATION**2)
    covariance = covariance.copy()
    covariance[lost, :] = covariance[:, lost] = 0.0
    covariance[lost, lost] = np.inf
    return JointGains(np.where(lost, np.nan, np.exp(logarithms)), covariance)


def _known(
    equations: CurrentEquations,
    gains: JointGains | None,
    loads: Mapping[str, KnownLoad],
    gravity: TrustedGravity | None,
) -> tuple[Array, Array]:
    """Rows (m, size) and right side (m,) of what is known, in units of its deviations."""
    rows, right = equations.known_loads({name: load.equations() for name, load in loads.items()})
    if gains is not None:
        some = np.flatnonzero(gains.determined)
        variances, axes = np.linalg.eigh(gains.covariance[np.ix_(some, some)])
        floor = max(float(variances.max(initial=0.0)) * RANK_TOLERANCE, EPS)
        whiten = np.zeros((len(some), equations.size))
        whiten[:, some] = axes.T / np.sqrt(np.maximum(variances, floor))[:, None]
        rows = np.concatenate([rows, whiten])
        right = np.concatenate([right, whiten[:, some] @ np.log(gains.values[some])])
    if gravity is not None:
        a, b = gravity.equations(equations.torque_model)
        spread = np.zeros((len(b), equations.size))
        spread[:, equations.link_columns] = a[:, equations.links]
        rows, right = np.concatenate([rows, spread]), np.concatenate([right, b])
    return rows, right


def _noise(equations: CurrentEquations) -> Array:
    """Noise of the currents of every recording and joint (k, n), with its correlation in time.

    The scores s_b = W_bᵀ e_b of the time blocks of a linear fit have the covariance W_bᵀ W_b σ² for white noise; what
    is correlated makes them larger.
    """
    found = np.zeros((len(equations.recordings), equations.n_joints))
    for k, (recording, total) in enumerate(zip(equations.recordings, equations.totals, strict=True)):
        for joint, factor in enumerate(total.factors):
            length = np.linalg.norm(factor[:, :-1], axis=0)
            used = length > RANK_TOLERANCE * length.max(initial=0.0)
            unit = factor[:, :-1][:, used] / length[used]
            u, s, v_t = np.linalg.svd(unit, full_matrices=False)
            kept = s > RANK_TOLERANCE * s.max(initial=0.0)
            inverse = v_t[kept].T / s[kept]  # of the factor, so that scores of white noise have unit size
            solution = inverse @ (u[:, kept].T @ factor[:, -1])
            squares = 0.0
            for block in recording.blocks:
                w = block.factors[joint][:, :-1][:, used] / length[used]
                squares += float(np.sum((inverse.T @ (w.T @ (block.factors[joint][:, -1] - w @ solution))) ** 2))
            least = LEAST_NOISE * np.sqrt(total.measured_squares[joint] / max(int(total.counts[joint]), 1))
            found[k, joint] = max(np.sqrt(squares / max(int(kept.sum()), 1)), least, np.finfo(float).tiny)
    return found


@dataclass(frozen=True, eq=False)
class _CurrentFitting:
    """The weighted equations of a fit.

    known: rows and right side of what is known; noise: of every recording and joint (k, n)
    """

    equations: CurrentEquations
    known: tuple[Array, Array]
    noise: Array

    def residual(self, x: Array) -> Array:
        """Residuals of all recordings and of what is known."""
        parts = [self._weighted(k, total.factors, x)[0].ravel() for k, total in enumerate(self.equations.totals)]
        return np.concatenate([*parts, self.known[0] @ x - self.known[1]])

    def jacobian(self, x: Array) -> Array:
        parts = [
            self._weighted(k, total.factors, x, derivatives=True)[1].reshape(-1, len(x))
            for k, total in enumerate(self.equations.totals)
        ]
        return np.concatenate([*parts, self.known[0]])

    def _weighted(self, k: int, factors: Array, x: Array, *, derivatives: bool = False) -> tuple[Array, Array]:
        """Residuals (n, rows) of factors of recording k in units of the noise, and their derivatives."""
        weight = 1 / self.noise[k][:, None]
        values = self.equations.currents(k, x)
        residual = weight * (np.einsum("jrb,jb->jr", factors[..., :-1], values) - factors[..., -1])
        if not derivatives:
            return residual, np.zeros(0)
        steps = factors[..., :-1] @ self.equations.derivatives(k, x)
        return residual, weight[..., None] * steps

    def start(self, gains: JointGains | None, gravity: TrustedGravity | None) -> Array:
        """Unknowns to begin with: gains as given or from the links of the model, all else by linear least squares.

        Where a load alone is known, the gains are scaled to it.
        """
        logarithms = self._gains_of_model()
        if gains is not None:
            logarithms = np.where(gains.determined, np.log(np.where(gains.determined, gains.values, 1)), logarithms)
        free = _CurrentFitting(self.equations, (self.known[0][:0], self.known[1][:0]), self.noise)
        x = free.linear(logarithms)
        if gains is None and gravity is None:
            masses = [x[self.equations.load_columns(load)][0] for load in self.equations.loads]
            rows = [self.known[0][:, self.equations.load_columns(load).start] for load in self.equations.loads]
            ratios = [
                self.known[1][0] / row[0] / mass for row, mass in zip(rows, masses, strict=True) if row[0] > 0 < mass
            ]
            if ratios:
                logarithms = logarithms + np.log(ratios[0])
        return self.linear(logarithms)

    def linear(self, logarithms: Array) -> Array:
        """The unknowns with these gains that fit best."""
        x = np.zeros(self.equations.size)
        x[self.equations.gain_columns] = logarithms
        rest = slice(self.equations.gain_columns.stop, None)
        x[rest] = _least_squares(self.jacobian(x)[:, rest], -self.residual(x), 0.0)
        return x

    def _gains_of_model(self) -> Array:
        """Logarithms of gains with which the links of the model explain most of the currents (n,)."""
        equations = self.equations
        links = structure(equations.torque_model).base.values(equations.torque_model.prior())[equations.links]
        found = np.full((len(equations.recordings), equations.n_joints), np.nan)
        for k, total in enumerate(equations.totals):
            for joint, factor in enumerate(total.factors):
                own, _ = equations.friction_columns(k, joint)
                columns = np.column_stack([factor[:, equations.links] @ links, factor[:, own]])
                per_torque = _least_squares(columns, factor[:, -1], 0.0)[0]
                if per_torque > 0:
                    found[k, joint] = -np.log(per_torque)
        known = found[np.isfinite(found)]
        middle = float(np.median(known)) if known.size else 0.0
        of_joints = [column[np.isfinite(column)] for column in found.T]
        return np.array([np.mean(column) if column.size else middle for column in of_joints])

    def solve(self, x: Array) -> Array:
        """The unknowns with the least squares. Raises EstimationFailed where that takes too many steps."""
        damping, squares = FIRST_DAMPING, float(np.sum(self.residual(x) ** 2))
        for _ in range(MAX_STEPS):
            residual, jacobian = self.residual(x), self.jacobian(x)
            while True:
                trial = x - _least_squares(jacobian, residual, damping)
                found = float(np.sum(self.residual(trial) ** 2))
                if found <= squares:
                    break
                damping *= 4
                if damping > 1 / EPS:
                    return x
            trial = self._rescaled(trial)
            found = float(np.sum(self.residual(trial) ** 2))
            done = squares - found <= CONVERGED * max(squares, 1.0) and damping <= FIRST_DAMPING
            x, squares, damping = trial, found, damping / 10
            if done:
                return x
        raise EstimationFailed(
            f"gains and loads have not settled after {MAX_STEPS} steps; a current may belong to another joint, have "
            "the wrong sign, or hardly change with the motion"
        )

    def _rescaled(self, x: Array) -> Array:
        """The unknowns with gains, links and loads larger by one factor that agrees best with what is known.

        No current notices the factor: along it the squares have a curved valley, which steps follow slowly.
        """
        rows, right = self.known
        torques = [self.equations.link_columns, *map(self.equations.load_columns, self.equations.loads)]
        found = x.copy()
        for _ in range(MAX_RESCALINGS):
            slope = np.zeros_like(found)
            slope[self.equations.gain_columns] = 1.0
            for columns in torques:
                slope[columns] = found[columns]
            change = rows @ slope
            length = max(float(change @ change), float(np.finfo(float).tiny))
            step = float(np.clip(-float(change @ (rows @ found - right)) / length, -1.0, 1.0))
            found[self.equations.gain_columns] += step
            for columns in torques:
                found[columns] *= np.exp(step)
            if abs(step) <= CONVERGED:
                break
        return found if np.sum((rows @ found - right) ** 2) <= np.sum((rows @ x - right) ** 2) else x

    def covariance(self, x: Array) -> Array:
        """Covariance of the unknowns (size, size); infinite variances of what nothing determines."""
        jacobian = self.jacobian(x)
        scale = np.linalg.norm(jacobian, axis=0)
        scale = np.where(scale > 0, scale, 1.0)
        _, s, v_t = np.linalg.svd(jacobian / scale, full_matrices=True)
        s = np.append(s, np.zeros(len(x) - len(s)))
        kept = s > UNDETERMINED * s[0]
        axes = v_t[kept].T  # combinations that are determined (size, m)
        known = (self.known[0] / scale) @ axes
        information = np.diag(s[kept] ** 2)
        changes = []
        for k, recording in enumerate(self.equations.recordings):
            steps = self.equations.derivatives(k, x) / scale @ axes
            values = self.equations.currents(k, x)
            for block in recording.blocks:
                w = block.factors / self.noise[k][:, None, None]
                j = (w[..., :-1] @ steps).reshape(-1, len(information))
                residual = (np.einsum("jrb,jb->jr", w[..., :-1], values) - w[..., -1]).ravel()
                changes.append(np.linalg.lstsq(information - j.T @ j, j.T @ residual, rcond=EPS)[0])
        s_b = np.array(changes)
        inverse = known / s[kept] ** 2
        inside = s_b.T @ s_b * (len(s_b) - 1) / len(s_b) + inverse.T @ inverse
        covariance: Array = axes @ inside @ axes.T / scale / scale[:, None]
        lost = np.sum(v_t[~kept] ** 2, axis=0) > UNDETERMINED
        covariance[lost, :] = covariance[:, lost] = 0.0
        covariance[lost, lost] = np.inf
        return covariance


def _least_squares(matrix: Array, right: Array, damping: float) -> Array:
    """x that minimizes ‖A x - b‖² + damping ‖x‖², columns at unit length; the shortest where several do."""
    scale = np.linalg.norm(matrix, axis=0)
    scale = np.where(scale > 0, scale, 1.0)
    unit = matrix / scale
    if damping:
        unit = np.concatenate([unit, np.sqrt(damping) * np.eye(len(scale))])
        right = np.concatenate([right, np.zeros(len(scale))])
    x: Array = np.linalg.lstsq(unit, right, rcond=RANK_TOLERANCE)[0] / scale
    return x
