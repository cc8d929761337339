"""The samples that all contenders share, and Pinocchio's answers for them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from crosscheck.comparing.compared_states import ComparedStates
from crosscheck.quantities import QUANTITIES, scales
from crosscheck.quantities.states import RANDOM, Case, cases
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.reference.reference_values import BareCalls
from crosscheck.reference.subject import tip
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
    def reference(self) -> PinocchioModel:
        return PinocchioModel.from_model(self.model)

    @cached_property
    def bare(self) -> BareCalls:
        return self.reference.bare_calls()

    @cached_property
    def compared(self) -> ComparedStates:
        """The first SINGLE_STATE_SAMPLES samples, with Pinocchio's answers."""
        q, v, a, tau = (x[:SINGLE_STATE_SAMPLES] for x in (self.q, self.v, self.a, self.tau))
        case = Case(RANDOM, self.model, Placement(), q, v, a, tau, np.zeros((*q.shape, 6)))
        return ComparedStates.of(case, np.ones(len(q), dtype=bool), self.reference)

    @cached_property
    def regressor(self) -> Array:
        """Pinocchio's joint-torque regressor of the first SINGLE_STATE_SAMPLES samples (N, n, 10n)."""
        return self.reference.torque_regressor(*(x[:SINGLE_STATE_SAMPLES] for x in (self.q, self.v, self.a)))

    @cached_property
    def torque(self) -> Array:
        """Pinocchio's torques of a at all samples (N, n)."""
        return self._in_parallel(self.bare.rnea_in_parallel, self.a)

    @cached_property
    def acceleration(self) -> Array:
        """Pinocchio's accelerations of tau at all samples (N, n)."""
        return self._in_parallel(self.bare.aba_in_parallel, self.tau)

    def _in_parallel(self, function: Callable[..., None], given: Array) -> Array:
        out = aligned(self.q.shape)
        function(1, self.bare.pool(1), self.q.T, self.v.T, given.T, out.T)
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

    def dynamics(self, forward: bool) -> tuple[tuple[Array, Array, Array], Callable[[Array], Array]]:
        """The arguments of forward or inverse dynamics, and what gives the errors of answers (N, n)."""
        if forward:
            return (self.q, self.v, self.tau), self.acceleration_errors
        return (self.q, self.v, self.a), self.torque_errors

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
        there, rows = self.compared.there, slice(len(multipliers))
        reference, wrenches = there.multipliers(there.a_wrenches)[rows], there.a_wrenches[rows]
        return scales.relative(multipliers[: len(reference)], reference, scales.largest(wrenches))

    def regressor_errors(self, w: Array) -> Array:
        """Errors of at most SINGLE_STATE_SAMPLES regressors (N, n, 10n), relative to the largest entry of the type."""
        reference = self.regressor[: len(w)]
        none = np.zeros(len(reference))
        return scales.by_parameter_type(w[: len(reference)], reference, none, none, none)

    def quantity_errors(self, names: Sequence[str]) -> Callable[[Array], Array]:
        """The largest error of the named quantities, on their scales; at most SINGLE_STATE_SAMPLES samples.

        Of answers stacked in this order (k, N, …) it gives one number per sample (N,); of frames, that of the tip.
        """

        def errors(answers: Array) -> Array:
            states = replace(self.compared.rows(slice(answers.shape[1])), frame=tip(self.model))
            found = []
            for row, answer in zip((QUANTITIES[name] for name in names), answers, strict=True):
                chosen = next(row.readings({"reference": JACOBIAN_REFERENCE}))
                theirs = row.pinocchio(states.there, chosen)
                found.append(row.errors(answer[: len(theirs)], theirs, states, chosen))
            largest: Array = np.maximum.reduce(found)
            return largest

        return errors

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
