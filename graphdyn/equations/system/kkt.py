"""The constrained system, Eq. (111): one matrix for all accelerations and all constraint forces.

    ⎡ A    φ_qᵀ ⎤ ⎡ q̈ ⎤   ⎡ B ⎤
    ⎣ φ_q   0   ⎦ ⎣ λ ⎦ = ⎣ ζ ⎦

66 × 66 for six bodies. This dense form is the specification; faster forms are tested against it.

The system as the paper writes it, in q = (r, θ) with Cardano angles, is a view of this twist form: with ω = D θ̇ (Eq.
33) and ω̇ = D θ̈ + Ḋ θ̇: rotational rows times Dᵀ, columns times D (docs/deviations.md, A1, A3).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np

from graphdyn.display import short_repr
from graphdyn.equations.kinematics import MaximalState
from graphdyn.errors import GimbalLock, InconsistentState, RankDeficientConstraints, SingularMassMatrix
from graphdyn.layout import (
    ANGULAR,
    BODY_DOF,
    JOINT_CONSTRAINTS,
    LINEAR,
    Array,
    block_diagonal,
    constraint_row_names,
    per_joint,
    stacked,
)
from graphdyn.model.loops import LOOP_RANK_TOLERANCE, SELF_STRESS_SHARE
from graphdyn.model.spatial import apply, cardano_rate_matrix, cardano_rate_matrix_derivative, cos_beta, solve

Coordinates = Literal["twist", "cardano"]

DEPENDENT_SHARE = 0.1
"""A row takes part in a dependency if its entry in a null vector reaches this part of the largest one."""


@dataclass(frozen=True, eq=False)
@short_repr
class KKTSystem:
    """Eq. (111) at one state, or at a batch of states.

    The m rows of φ_q are 5 for each of the n joints, one for each coupling, and those of the chords.

    mass: A                                                 (…, 6n, 6n)
    constraint_jacobian: φ_q                                (…, m, 6n)
    force: B                                                (…, 6n)
    zeta: ζ                                                 (…, m)
    coordinates: "twist", q̈ = (r̈, ω̇) per body, or "cardano", q̈ = (r̈, θ̈) with the rotational rows times Dᵀ
    n_chord_rows: how many of the last rows are those of chords; with these, rows may depend on each other
    length_unit: in which lengths are compared with angles where rows may depend on each other [m]
    refusal: why there is no solution, although the equations have one
    """

    mass: Array
    constraint_jacobian: Array
    force: Array
    zeta: Array
    coordinates: Coordinates = "twist"
    n_chord_rows: int = 0
    length_unit: float = 1.0
    refusal: InconsistentState | None = None

    @property
    def matrix(self) -> Array:
        """The matrix of Eq. (111) (…, 6n + m, 6n + m)."""
        rows, columns = self.constraint_jacobian.shape[-2:]
        batch = np.broadcast_shapes(self.mass.shape[:-2], self.constraint_jacobian.shape[:-2])
        number = np.result_type(self.mass, self.constraint_jacobian)
        matrix = np.zeros((*batch, rows + columns, rows + columns), dtype=number)
        matrix[..., :columns, :columns] = self.mass
        matrix[..., :columns, columns:] = np.swapaxes(self.constraint_jacobian, -1, -2)
        matrix[..., columns:, :columns] = self.constraint_jacobian
        return matrix

    @property
    def rhs(self) -> Array:
        """The right side (B, ζ) of Eq. (111) (…, 6n + m)."""
        return np.concatenate([self.force, self.zeta], axis=-1)

    def rank(self) -> int | Array:
        """Numerical rank of the matrix, balanced (see _balance); 6n + m where everything is determined."""
        rank: int | Array = np.linalg.matrix_rank(self._balanced(), hermitian=True)
        return rank

    def constraint_rank(self) -> int | Array:
        """Numerical rank of φ_q; m for every tree of bodies."""
        rank: int | Array = np.linalg.matrix_rank(self.constraint_jacobian)
        return rank

    def condition_number(self) -> float | Array:
        """2-norm condition number of the matrix as Eq. (111) writes it, in SI units; infinite where it is singular."""
        condition: float | Array = np.linalg.cond(self.matrix)
        return condition

    def solve(self, *, least_norm: bool = False) -> KKTSolution:
        """All accelerations and all multipliers.

        With chords, multipliers that the equations do not determine are NaN. least_norm: the smallest ones that satisfy
        the equations instead, which depend on the units: newtons and newton meters count alike

        Raises InconsistentState where loops close only when stretched; RankDeficientConstraints, naming rank and rows,
        where φ_q loses rank; SingularMassMatrix where the
        matrix is singular although the constraints are independent, or are those of loops (a massless body).
        """
        if self.refusal is not None:
            raise self.refusal
        if self.n_chord_rows:
            return self.solve_redundant(least_norm, check=True)
        n_rows, size = self.constraint_jacobian.shape[-2], self.matrix.shape[-1]
        if np.any(np.asarray(self.constraint_rank()) < n_rows):
            raise self._dependent_rows()
        if np.any(np.asarray(self.rank()) < size):
            raise SingularMassMatrix(
                f"the {size}×{size} system has rank {int(np.min(self.rank()))} although its constraints are "
                "independent: a body that can move freely has no inertia; see RobotModel.physical_consistency()"
            )
        return self.solve_unchecked()

    def solve_unchecked(self) -> KKTSolution:
        """Solve like solve, without the two rank tests: for systems whose rank is known.

        One step of iterative refinement makes the residual of every row small on its own scale, also where masses
        differ by many orders (Higham, Accuracy and Stability of Numerical Algorithms, chapter 12).
        """
        balance, matrix, balanced = self._balance(), self.matrix, self._balanced()
        solution = solve(balanced, self.rhs * balance) * balance
        residual = self.rhs - apply(matrix, solution)
        solution = solution + solve(balanced, residual * balance) * balance
        nv = self.mass.shape[-1]
        return KKTSolution(self, solution[..., :nv], solution[..., nv:])

    def solve_redundant(self, least_norm: bool = True, check: bool = False) -> KKTSolution:
        """Solve, like solve, systems of rows that may depend on each other: φ_q = U Σ Vᵀ, whose first rows Vᵀ are
        independent.

        Lengths are taken in length_unit and rows at the same size: how large the robot is does not decide which rows
        depend on others. Accelerations are unique; multipliers are the smallest. Systems of different rank are solved
        one by one.
        check: with the rank tests of solve
        """
        jacobian, nv = self.constraint_jacobian, self.mass.shape[-1]
        batch = jacobian.shape[:-2]
        acceleration, multipliers = np.empty((*batch, nv)), np.empty(jacobian.shape[:-1])
        units = np.tile([self.length_unit] * 3 + [1.0] * 3, nv // BODY_DOF)
        mass = self.mass * units[:, None] * units
        for row in np.ndindex(batch):
            scaled = jacobian[row] * units
            sizes = np.linalg.norm(scaled, axis=-1)
            sizes = np.where(sizes > 0, sizes, 1.0)
            left, values, right = np.linalg.svd(scaled / sizes[:, None])
            rank = int(np.count_nonzero(values > LOOP_RANK_TOLERANCE * values.max()))
            zeta = left.T[:rank] @ (self.zeta[row] / sizes) / values[:rank]
            independent = KKTSystem(mass, right[:rank], self.force[row] * units, zeta)
            reduced = independent.solve() if check else independent.solve_unchecked()
            acceleration[row] = reduced.acceleration * units
            null = left[:, rank:]
            idle, _ = np.linalg.qr(null / sizes[:, None])
            found = left[:, :rank] @ (reduced.stacked_multipliers / values[:rank]) / sizes
            multipliers[row] = found - idle @ (idle.T @ found)
            if not least_norm:
                null = np.abs(null)
                multipliers[row][(null > SELF_STRESS_SHARE * null.max(axis=0, initial=0.0)).any(axis=-1)] = np.nan
        return KKTSolution(self, acceleration, multipliers)

    def _balance(self) -> Array:
        """Scaling d of rows and columns, diag(d) K diag(d): forces are measured in units of the largest mass term.

        Accelerations of 1 m/s² and multipliers of 1e5 N share one vector; without this the rounding error of the
        solution is that of the multipliers.
        """
        unit = np.sqrt(np.abs(self.mass).max(axis=(-2, -1), keepdims=True)[..., 0])
        unit = np.where(unit > 0, unit, 1.0)
        n_rows, nv = self.constraint_jacobian.shape[-2:]
        return np.concatenate([np.repeat(1 / unit, nv, axis=-1), np.repeat(unit, n_rows, axis=-1)], axis=-1)

    def _balanced(self) -> Array:
        balance = self._balance()
        return self.matrix * balance[..., :, None] * balance[..., None, :]

    def _dependent_rows(self) -> RankDeficientConstraints:
        """Name the rows of the first deficient system whose combination vanishes (left null vectors of φ_q)."""
        n_rows, nv = self.constraint_jacobian.shape[-2:]
        systems = self.constraint_jacobian.reshape(-1, n_rows, nv)
        ranks = np.atleast_1d(np.linalg.matrix_rank(systems))
        first = int(np.argmax(ranks < n_rows))
        left, _, _ = np.linalg.svd(systems[first])
        share = np.linalg.norm(left[:, ranks[first] :], axis=1)
        involved = [k for k in np.argsort(-share) if share[k] > DEPENDENT_SHARE * share.max()]
        n = nv // BODY_DOF
        names = [*constraint_row_names(n), *(f"coupling {k}" for k in range(1, n_rows - JOINT_CONSTRAINTS * n + 1))]
        return RankDeficientConstraints(int(ranks[first]), n_rows, [names[k] for k in involved])


@dataclass(frozen=True, eq=False)
@short_repr
class KKTSolution:
    """The answer of a KKTSystem, which computes its own residuals.

    acceleration: q̈ of all bodies                           (…, 6n)
    multipliers: λ of the joints                            (…, n, 5)  [N, N m]
    coupling_multipliers: what couplings supply to the joints that they drive   (…, n_couplings)  [N m or N]
    chord_multipliers: λ of the chords, one after the other (…, n_chord_rows)  [N, N m]
    """

    system: KKTSystem
    acceleration: Array
    stacked_multipliers: Array

    @property
    def multipliers(self) -> Array:
        return per_joint(self.stacked_multipliers[..., : self._of_joints])

    @property
    def coupling_multipliers(self) -> Array:
        return self.stacked_multipliers[..., self._of_joints : self._before_chords]

    @property
    def chord_multipliers(self) -> Array:
        return self.stacked_multipliers[..., self._before_chords :]

    @property
    def _before_chords(self) -> int:
        return int(self.stacked_multipliers.shape[-1] - self.system.n_chord_rows)

    @property
    def _of_joints(self) -> int:
        return int(JOINT_CONSTRAINTS * self.acceleration.shape[-1] // BODY_DOF)

    def dynamics_residual(self) -> Array:
        """‖A q̈ + φ_qᵀλ - B‖∞ relative to the largest of the terms that are summed (…)."""
        s = self.system
        transposed = np.swapaxes(s.constraint_jacobian, -1, -2)
        return _residual(((s.mass, self.acceleration), (transposed, self.stacked_multipliers)), s.force)

    def constraint_residual(self) -> Array:
        """‖φ_q q̈ - ζ‖∞ relative to the largest of the terms that are summed and of q̈ (…)."""
        s = self.system
        # an acceleration in the direction of a row may vanish: the rows then have no scale but that of q̈
        return _residual(((s.constraint_jacobian, self.acceleration),), s.zeta, np.abs(self.acceleration))


def _residual(products: tuple[tuple[Array, Array], ...], right: Array, *others: Array) -> Array:
    """‖Σ matrix vector - right‖∞ over the largest row of Σ |matrix| |vector| + |right|: no term hides by canceling."""
    error = np.abs(sum(apply(matrix, vector) for matrix, vector in products) - right).max(axis=-1)
    terms = sum(apply(np.abs(matrix), np.abs(vector)) for matrix, vector in products) + np.abs(right)
    scale = np.maximum.reduce([x.max(axis=-1) for x in (terms, *others)])
    relative: Array = np.divide(error, scale, out=np.zeros_like(error), where=scale > 0)
    return relative


MIN_BETA_COSINE = 1e-4
"""|cos β| below which Cardano coordinates are refused: the error of the solution grows as eps / cos²β or faster,
to 3e-7 at 1e-4 (`graphdyn errata` measures it)."""


def cardano_system(state: MaximalState, twist: KKTSystem) -> KKTSystem:
    """Eq. (111) in (r̈, θ̈) from the twist form of the same state. Raises GimbalLock, naming the body."""
    cosines = cos_beta(state.rotation)
    if np.any(cosines < MIN_BETA_COSINE):
        body = int(np.argmin(cosines)) % state.model.n_bodies
        raise GimbalLock(
            f"body '{state.model.body_names[body]}' is at |cos β| = {cosines.min():.1e}, below {MIN_BETA_COSINE:g}: "
            "the Cardano angles do not determine its motion there; use coordinates='twist', regular in every pose"
        )
    return cardano_form(state, twist)


def cardano_form(state: MaximalState, twist: KKTSystem) -> KKTSystem:
    """The system like cardano_system, at any |cos β| > 0: for showing what happens near gimbal lock."""
    to_twist, drift = rate_map(state), cardano_drift(state)
    transposed = np.swapaxes(to_twist, -1, -2)
    return KKTSystem(
        mass=transposed @ twist.mass @ to_twist,
        constraint_jacobian=twist.constraint_jacobian @ to_twist,
        force=apply(transposed, twist.force - apply(twist.mass, drift)),
        zeta=twist.zeta - apply(twist.constraint_jacobian, drift),
        coordinates="cardano",
        n_chord_rows=twist.n_chord_rows,
        length_unit=twist.length_unit,
    )


def rate_map(state: MaximalState) -> Array:
    """T = diag(E, D_1, …, E, D_n) (…, 6n, 6n): from (ṙ, θ̇) to (ṙ, ω), Eq. (33)."""
    blocks = np.zeros((*state.velocity.shape, 6))
    blocks[..., LINEAR, LINEAR] = np.eye(3)
    blocks[..., ANGULAR, ANGULAR] = cardano_rate_matrix(state.cardano)
    return block_diagonal(blocks)


def cardano_drift(state: MaximalState) -> Array:
    """Ṫ (ṙ, θ̇) (…, 6n): (r̈, ω̇) = T (r̈, θ̈) + this; its angular parts are Ḋ θ̇, Eq. (34)."""
    rates = state.cardano_rates
    drift = np.zeros_like(state.velocity)
    drift[..., ANGULAR] = apply(cardano_rate_matrix_derivative(state.cardano, rates), rates)
    return stacked(drift)
