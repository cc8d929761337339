"""Information of a motion on the base parameters, criteria of it, and their derivatives by the motion.

Criteria are functions of the information matrix F (b, b) that measure how well a motion determines the base parameters.
Each returns its value and its derivative by F (b, b), symmetric; smaller is better. If F is singular, the value is
infinite.

log_det: ln of the geometric mean of the semi-axes of the error ellipsoid, -ln det F / 2b. Its best motion does not
    depend on units or on how columns are scaled.
mean_sigma: ln of the geometric mean of the standard deviations, Σ ln (F⁻¹)_kk / 2b; never below log_det.
ConditionNumber: ln of that of the regressor with scaled columns, (ln λ_max - ln λ_min) / 2. It depends on the scales,
    and it is small if all parameters are equally badly determined.

Torques with independent errors of standard deviation s_j at every sample give x = (Wᵀ S⁻¹ W)⁻¹ Wᵀ S⁻¹ τ with the
covariance F⁻¹, F = Wᵀ S⁻¹ W = Σ_t Σ_j W_jᵀ W_j / s_j²: the information matrix. A criterion is a function of F alone, so

    ∂c/∂W = 2 S⁻¹ W ∂c/∂F        and        ∂c/∂(q, v, a) = Σ ∂c/∂W ∂W/∂(q, v, a),

the latter by reverse mode on the recorded regressor of the rigid bodies. Columns of friction and drives, which may be
functions of the user, are differentiated by central differences.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from graphdyn.compiler.programs import record_regressor_gradient
from graphdyn.compiler.running import Prepared, chosen_backend
from graphdyn.display import short_repr
from graphdyn.excitation.trajectory import JointMotion
from graphdyn.identification.data.samples import Samples
from graphdyn.identification.problem.torque_model import TorqueModel, random_samples, structure
from graphdyn.identification.terms import RigidBodies, Term
from graphdyn.layout import Array
from graphdyn.verbs.matrices import joint_torque_regressor

Criterion = Callable[[Array], tuple[float, Array]]


def log_det(information: Array) -> tuple[float, Array]:
    """D-optimality: Pukelsheim, Optimal Design of Experiments, 1993, chapter 6."""
    inverse = covariance(information)
    size = len(information)
    if inverse is None:
        return np.inf, np.zeros_like(information)
    return float(-np.linalg.slogdet(information)[1] / (2 * size)), -inverse / (2 * size)


def mean_sigma(information: Array) -> tuple[float, Array]:
    """Mean logarithm of the standard deviations: ∂/∂F of (F⁻¹)_kk is -F⁻¹ e_k e_kᵀ F⁻¹."""
    inverse = covariance(information)
    size = len(information)
    if inverse is None:
        return np.inf, np.zeros_like(information)
    variances = np.diag(inverse)
    return float(np.log(variances).sum() / (2 * size)), -(inverse / variances) @ inverse / (2 * size)


@dataclass(frozen=True, eq=False)
@short_repr
class ConditionNumber:
    """Condition number for columns times scale (b,), the prior spreads of the parameters.

    Gautier and Khalil, "Exciting trajectories for the identification of base inertial parameters of robots",
    International Journal of Robotics Research 11(4), 1992.
    """

    scale: Array

    def __call__(self, information: Array) -> tuple[float, Array]:
        units = np.outer(self.scale, self.scale)
        values, vectors = np.linalg.eigh(information * units)
        if not values[0] > 0:
            return np.inf, np.zeros_like(information)
        low, high = vectors[:, 0], vectors[:, -1]
        slope = np.outer(high, high) / values[-1] - np.outer(low, low) / values[0]
        return float(np.log(values[-1] / values[0]) / 2), slope * units / 2


def covariance(information: Array) -> Array | None:
    """F⁻¹ of a positive definite F, with rows and columns first scaled to a diagonal of one; None for any other F."""
    diagonal = np.diag(information)
    if not np.all(diagonal > 0):
        return None
    scale = 1 / np.sqrt(diagonal)
    try:
        root = np.linalg.inv(np.linalg.cholesky(information * np.outer(scale, scale)))
    except np.linalg.LinAlgError:
        return None
    return np.asarray(root.T @ root) * np.outer(scale, scale)


DIFFERENCE_STEP = 1e-6
"""Step of central differences [rad or m, …/s, …/s²]: truncation and rounding are both near 1e-10 of the slope of a
smooth sign that is a tenth of a unit wide."""


class Information:
    """The information matrix of a torque model, in its base parameters.

    noise: standard deviations of the measured torques      (n,)  [N m or N]
    width: over which the sign of a velocity changes smoothly, for terms with a sharp one   [rad/s or m/s]
    """

    def __init__(self, torque_model: TorqueModel, noise: Array, width: float | None = None) -> None:
        terms = torque_model.terms if width is None else [_smooth(term, width) for term in torque_model.terms]
        self.torque_model = dataclasses.replace(torque_model, terms=tuple(terms))
        self.independent = structure(torque_model).base.independent
        self.noise = noise
        self._is_rigid = np.zeros(len(self.independent), dtype=bool)
        rigid = torque_model.slice_of(RigidBodies)
        if rigid is not None:
            self._is_rigid = (self.independent >= rigid.start) & (self.independent < rigid.stop)
            self._rigid = self.independent[self._is_rigid] - rigid.start

    def matrix(self, motion: JointMotion, samples: float) -> Array:
        """F (b, b) of a recording with so many samples along the motion (N, n)."""
        w = self._weighted_rows(motion).reshape(-1, len(self.independent))
        return np.asarray(w.T @ w) * (samples / len(motion.q))

    def value_and_slopes(
        self, motion: JointMotion, samples: float, known: Array, criterion: Criterion
    ) -> tuple[float, tuple[Array, Array, Array]]:
        """The criterion for F + known, and its derivatives by q, v, a (N, n)."""
        w = self._weighted_rows(motion)
        flat = w.reshape(-1, w.shape[-1])
        share = samples / len(w)
        value, by_matrix = criterion(flat.T @ flat * share + known)
        by_rows = 2 * share * (flat @ by_matrix).reshape(w.shape) / self.noise[:, None]
        slopes = np.zeros((3, *motion.q.shape))
        if self._is_rigid.any():
            slopes += self._rigid_slopes(motion, by_rows[..., self._is_rigid])
        if not self._is_rigid.all():
            slopes += self._other_slopes(motion, by_rows[..., ~self._is_rigid])
        return value, (slopes[0], slopes[1], slopes[2])

    def _weighted_rows(self, motion: JointMotion) -> Array:
        """Weighted regressor W / s (N, n, b)."""
        w = np.empty((*motion.q.shape, len(self.independent)))
        if self._is_rigid.any():
            whole = joint_torque_regressor(self.torque_model.model, *motion[:3], method="recursive")
            w[..., self._is_rigid] = whole[..., self._rigid]
        w[..., ~self._is_rigid] = self._other_rows(*motion[:3])
        return w / self.noise[:, None]

    def _other_rows(self, q: Array, v: Array, a: Array) -> Array:
        """Rows of the terms other than the rigid bodies (N, n, those columns)."""
        samples = Samples(q, v, a, np.zeros_like(q))
        return self.torque_model.rows(samples, self.independent[~self._is_rigid])

    def _rigid_slopes(self, motion: JointMotion, by_rows: Array) -> Array:
        count, n = motion.q.shape
        inputs = dict(zip("qva", map(np.ascontiguousarray, motion[:3]), strict=True))
        inputs["weights"] = np.ascontiguousarray(by_rows.reshape(count, -1))
        gradient = np.empty((count, 3 * n))
        self._gradient_program.backend.bind(inputs, {"gradient": gradient})(0, count)
        return np.moveaxis(gradient.reshape(count, 3, n), 1, 0)

    def _other_slopes(self, motion: JointMotion, by_rows: Array) -> Array:
        """Slopes of terms that are functions in Python. Joints with columns of their own are moved all at once."""
        n = motion.q.shape[1]
        groups = [np.ones(n)] if self._joints_are_apart else list(np.eye(n))
        slopes = np.zeros((3, *motion.q.shape))
        for kind in range(3):
            for group in groups:
                moved = [list(motion[:3]) for _ in range(2)]
                for sign, arrays in zip((1, -1), moved, strict=True):
                    arrays[kind] = arrays[kind] + sign * DIFFERENCE_STEP * group
                more, less = (self._other_rows(*arrays) for arrays in moved)
                change = (by_rows * (more - less)).sum(axis=-1) / (2 * DIFFERENCE_STEP)
                slopes[kind] += change if len(groups) == 1 else change.sum(axis=1, keepdims=True) * group
        return slopes

    @cached_property
    def _joints_are_apart(self) -> bool:
        """Whether each joint's rows of the other terms depend on its own motion alone, in some states."""
        one, other = (random_samples(self.torque_model, 50, seed) for seed in (0, 1))
        rows = self._other_rows(one.q, one.v, one.a)
        joints = np.arange(rows.shape[1])
        for j in joints:
            mixed = [np.where(joints == j, getattr(one, name), getattr(other, name)) for name in "qva"]
            if not np.array_equal(self._other_rows(*mixed)[:, j], rows[:, j]):
                return False
        return True

    @cached_property
    def _gradient_program(self) -> Prepared:
        return Prepared(record_regressor_gradient(self.torque_model.model, self._rigid.tolist()), chosen_backend())


def _smooth(term: Term, width: float) -> Term:
    """A term with a smooth sign in place of a sharp one; others as they are."""
    if dataclasses.is_dataclass(term) and getattr(term, "width", width) is None:
        smooth: Term = dataclasses.replace(term, width=width)
        return smooth
    return term
