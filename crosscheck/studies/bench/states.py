"""The samples that all contenders share, and Pinocchio's answers for them."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from crosscheck.referee import scales
from crosscheck.referee.pinocchio_model import PinocchioModel
from crosscheck.referee.quantities import multipliers_of
from crosscheck.referee.reference_values import BareCalls, RefereeValues
from crosscheck.referee.states import cases
from graphdyn import RobotModel, inverse_dynamics, mass_matrix
from graphdyn.kernels.aligned import aligned
from graphdyn.layout import Array

FEW = 200
"""Number of samples that are judged where Pinocchio computes one state at a time."""

PORTION = 100_000
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
        """All reference values of Pinocchio for the first FEW samples."""
        q, v, a, tau = (x[:FEW] for x in (self.q, self.v, self.a, self.tau))
        return self.referee.evaluate(q, v, a, tau, np.zeros((*q.shape, 6)))

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
        """Errors of multipliers at tau (N, n, 5), relative to the sample's largest joint wrench; FEW at most."""
        wrenches = self.values.a_wrenches[: len(multipliers)]
        reference = multipliers_of(self.model, self.values.rotation[: len(wrenches)], wrenches)
        return scales.relative(multipliers[: len(reference)], reference, scales.largest(wrenches))

    def regressor_errors(self, w: Array) -> Array:
        """Errors of regressors (N, n, 10n), relative to the largest entry of its parameter type; FEW at most."""
        reference = self.values.torque_regressor[: len(w)]
        none = np.zeros(len(reference))
        return scales.by_parameter_type(w[: len(reference)], reference, none, none, none)

    def _largest_wrench(self, a: Array) -> Array:
        parts = [
            scales.largest(inverse_dynamics(self.model, self.q[rows], self.v[rows], a[rows]).joint_wrenches)
            for rows in self._portions()
        ]
        return np.concatenate(parts)

    def _portions(self) -> list[slice]:
        return [slice(first, first + PORTION) for first in range(0, len(self), PORTION)]


def random_states(model: RobotModel, samples: int, seed: int) -> States:
    """The random states of the cross-check, in aligned memory."""
    case = next(cases(model, samples, seed))
    arrays = []
    for array in (case.q, case.v, case.a, case.tau):
        memory = aligned(case.q.shape)
        memory[:] = array
        arrays.append(memory)
    return States(model, *arrays)
