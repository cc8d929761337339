"""The samples that all contenders share, and Pinocchio's answers for them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from crosscheck.quantities import scales
from crosscheck.quantities.derived_errors import derived_errors, derived_forward_errors
from crosscheck.quantities.states import RANDOM, Case, cases
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.reference.reference_values import BareCalls, RefereeValues, multipliers_of
from graphdyn import Placement, RobotModel, inverse_dynamics, mass_matrix
from graphdyn.arguments import Reference
from graphdyn.compiler import aligned
from graphdyn.layout import Array

SINGLE_STATE_SAMPLES = 200
"""Number of samples that are judged where Pinocchio computes one state at a time."""

JACOBIAN_REFERENCE: Reference = "local_world_aligned"
"""Point and axes of the frame Jacobian."""

ERROR_SAMPLES_AT_ONCE = 100_000
"""Number of samples whose errors are computed at once, to limit the memory."""


@dataclass(frozen=True, eq=False)
class States:
    """Random states of a robot: q, v, a (N, n), and torques tau (N, n) that belong to other accelerations."""

    model: RobotModel
    q: Array
    v: Array
    a: Array
    tau: Array

    def __len__(self) -> int:
        return len(self.q)

    @cached_property
    def referee(self) -> PinocchioModel:
        return PinocchioModel.from_model(self.model)

    @cached_property
    def bare(self) -> BareCalls:
        return self.referee.bare_calls()

    @cached_property
    def values(self) -> RefereeValues:
        """All reference values of Pinocchio for the first SINGLE_STATE_SAMPLES samples."""
        q, v, a, tau = (x[:SINGLE_STATE_SAMPLES] for x in (self.q, self.v, self.a, self.tau))
        return self.referee.evaluate(q, v, a, tau, np.zeros((*q.shape, 6)))

    @cached_property
    def derived(self) -> dict[str, Array]:
        """Pinocchio's derivatives, matrices and energies for the first SINGLE_STATE_SAMPLES samples."""
        q, v, a, tau = (x[:SINGLE_STATE_SAMPLES] for x in (self.q, self.v, self.a, self.tau))
        return self.referee.derive(q, v, a, tau, np.zeros((*q.shape, 6)))

    @cached_property
    def frame_jacobian(self) -> Array:
        """Pinocchio's Jacobian of the tip (subject.tip) for the first SINGLE_STATE_SAMPLES samples (N, 6, n)."""
        call = self.bare
        return np.array(
            [call.frame_jacobian(call.model, call.data, q, *call.tip) for q in self.q[:SINGLE_STATE_SAMPLES]]
        )

    @cached_property
    def torque(self) -> Array:
        """Pinocchio's torques of a at all samples (N, n)."""
        out = aligned(self.q.shape)
        self.bare.rnea_in_parallel(1, self.bare.pool(1), self.q.T, self.v.T, self.a.T, out.T)
        return out

    @cached_property
    def acceleration(self) -> Array:
        """Pinocchio's accelerations of tau at all samples (N, n)."""
        out = aligned(self.q.shape)
        self.bare.aba_in_parallel(1, self.bare.pool(1), self.q.T, self.v.T, self.tau.T, out.T)
        return out

    @cached_property
    def torque_size(self) -> Array:
        """Largest joint wrench of each sample at a (N,): the scale of the terms of a torque."""
        return self._largest_wrench(self.a)

    @cached_property
    def acceleration_size(self) -> Array:
        """Scale of the accelerations, scales.acceleration_scale (N,)."""
        wrench, parts = self._largest_wrench(self.acceleration), []
        for rows in self._portions():
            mass = mass_matrix(self.model, self.q[rows])
            size = scales.acceleration_scale(mass, self.acceleration[rows], self.tau[rows], wrench[rows])
            parts.append(size)
        return np.concatenate(parts)

    def torque_errors(self, tau: Array) -> Array:
        """Errors of torques, relative to the largest torque or joint wrench (N,)."""
        count = len(tau)
        return scales.relative(tau, self.torque[:count], self.torque_size[:count])

    def acceleration_errors(self, a: Array) -> Array:
        """Errors of accelerations, relative to acceleration_size (N,)."""
        count = len(a)
        return scales.ratio(scales.largest(a - self.acceleration[:count]), self.acceleration_size[:count])

    def multiplier_errors(self, multipliers: Array) -> Array:
        """Errors of at most SINGLE_STATE_SAMPLES multipliers at tau (N, n, 5), relative to the largest joint wrench."""
        wrenches = self.values.a_wrenches[: len(multipliers)]
        reference = multipliers_of(self.model, self.values.rotation[: len(wrenches)], wrenches)
        return scales.relative(multipliers[: len(reference)], reference, scales.largest(wrenches))

    def regressor_errors(self, w: Array) -> Array:
        """Errors of at most SINGLE_STATE_SAMPLES regressors (N, n, 10n), relative to the largest entry of the type."""
        reference = self.values.torque_regressor[: len(w)]
        none = np.zeros(len(reference))
        return scales.by_parameter_type(w[: len(reference)], reference, none, none, none)

    def derived_errors(self, names: Sequence[str]) -> Callable[[Array], Array]:
        """The largest error of the named quantities, on the cross-check's scales; at most SINGLE_STATE_SAMPLES samples.

        Of answers stacked in this order (k, N, …) it gives one number per sample (N,).
        """

        def errors(answers: Array) -> Array:
            rows = slice(min(SINGLE_STATE_SAMPLES, answers.shape[1]))
            given = {x: getattr(self, x)[rows] for x in ("q", "v", "a", "tau")}
            case = Case(RANDOM, self.model, Placement(), **given, external_wrenches=np.zeros((*given["q"].shape, 6)))
            values, derived = self.values.rows(rows), {name: x[rows] for name, x in self.derived.items()}
            answered = {name: answer[rows] for name, answer in zip(names, answers, strict=True)}
            # of the tip alone, which the cross-check does not ask for
            matrices = answered.pop("frame_jacobian", None)
            ours = {**derived, "dtau_da": values.mass_matrix, **answered}  # what is not asked for has no error
            tensor = np.full(rows.stop, scales.largest_tensor(self.model))
            found = {
                **derived_errors(case, ours, values, derived),
                **derived_forward_errors(case, given["tau"], ours, values, derived),
                "dtau_da": scales.relative(ours["dtau_da"], values.mass_matrix, tensor),
            }
            if matrices is not None:
                found["frame_jacobian"] = self._frame_jacobian_errors(matrices)
            largest: Array = np.maximum.reduce([found[name] for name in names])
            return largest

        return errors

    def _frame_jacobian_errors(self, matrices: Array) -> Array:
        """Of (N, 6, n): positions on the largest lever, axes on 1 (N,)."""
        count = len(matrices)
        ours, reference = np.swapaxes(matrices, -1, -2), np.swapaxes(self.frame_jacobian[:count], -1, -2)
        lever = scales.largest(self.values.position[:count] - self.model.base.translation)
        return scales.by_part(ours, reference, lever, np.ones(count))

    def _largest_wrench(self, a: Array) -> Array:
        parts = [
            scales.largest(inverse_dynamics(self.model, self.q[rows], self.v[rows], a[rows]).joint_wrenches)
            for rows in self._portions()
        ]
        return np.concatenate(parts)

    def _portions(self) -> list[slice]:
        return [slice(first, first + ERROR_SAMPLES_AT_ONCE) for first in range(0, len(self), ERROR_SAMPLES_AT_ONCE)]


def random_states(model: RobotModel, samples: int, seed: int) -> States:
    """The random states of the cross-check, in aligned memory."""
    case = next(cases(model, samples, seed))
    arrays = []
    for array in (case.q, case.v, case.a, case.tau):
        memory = aligned(case.q.shape)
        memory[:] = array
        arrays.append(memory)
    return States(model, *arrays)
