"""Plan of an experiment: standard deviations of all base parameters for a given noise."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from graphdyn.display import short_repr
from graphdyn.errors import InvalidInput
from graphdyn.excitation.information import covariance
from graphdyn.identification.algebra.base_parameters import BaseParameters
from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.problem.torque_model import STATES_PER_PARAMETER, TorqueModel, random_samples, structure
from graphdyn.identification.terms import RigidBodies
from graphdyn.layout import Array

DRIVE_SHARE = 0.1
"""Prior spread of a drive parameter: its torque relative to that of the joint's bodies over random states."""

ZERO_PARAMETER_SHARE = 1e-12
"""Value of the model, relative to the prior spread, below which it is a sum that cancels."""

MAX_WELL_DETERMINED, MAX_ROUGHLY_DETERMINED = 0.1, 0.5
"""Largest standard deviations, relative to a parameter's size, that count as well and as roughly determined."""


@dataclass(frozen=True, eq=False)
@short_repr
class ExcitationPlan:
    """Standard deviations of a future weighted least-squares fit.

    base: the base parameters
    names, units: of each                                   (b,)
    prior: their values in the model; zero for friction and drives   (b,)
    spread: expected distance from them before the experiment   (b,)
    information: F of the recording                         (b, b)
    """

    torque_model: TorqueModel
    base: BaseParameters
    prior: Array
    spread: Array
    information: Array

    @property
    def names(self) -> tuple[str, ...]:
        """Names such as "XX_2 - YY_2 + 0.18 M_3"."""
        return self.base.names([column.symbol for column in self.torque_model.columns])

    @property
    def units(self) -> tuple[str, ...]:
        return tuple(self.torque_model.columns[k].unit for k in self.base.independent)

    @cached_property
    def sigma(self) -> Array:
        """Standard deviations (b,), in the parameters' units; infinite if the recording does not determine them."""
        found = covariance(self.information)
        return np.full(self.base.rank, np.inf) if found is None else np.sqrt(np.diag(found))

    @property
    def relative(self) -> Array:
        """σ relative to the parameter's value in the model, or to its prior spread if that is larger (b,)."""
        return np.asarray(self.sigma / np.maximum(np.abs(self.prior), self.spread))

    @property
    def geometric_mean(self) -> float:
        """Geometric mean of all standard deviations, in units of the prior spreads."""
        return float(np.exp(np.log(self.sigma / self.spread).mean()))

    @property
    def condition_number(self) -> float:
        """Condition number of the regressor, equations divided by their noise and columns times the prior spreads."""
        scaled = np.linalg.eigvalsh(self.information * np.outer(self.spread, self.spread))
        return float(np.sqrt(scaled[-1] / scaled[0])) if scaled[0] > 0 else np.inf

    @property
    def verdicts(self) -> tuple[str, ...]:
        """Verdict on each base parameter: "well", "roughly" or "not"; the latter need another motion, or less noise."""
        return tuple(
            "well" if x <= MAX_WELL_DETERMINED else "roughly" if x <= MAX_ROUGHLY_DETERMINED else "not"
            for x in self.relative
        )

    @property
    def only_in_sums(self) -> tuple[str, ...]:
        """Standard parameters that no motion determines individually, because others imitate them."""
        known = set(self.base.alone.tolist()) | set(self.base.structural_zeros.tolist())
        known |= set(self.base.numerical_zeros.tolist())
        columns = self.torque_model.columns
        return tuple(column.name for k, column in enumerate(columns) if k not in known)

    @property
    def without_effect(self) -> tuple[str, ...]:
        """Standard parameters that no torque depends on."""
        zeros = np.concatenate([self.base.structural_zeros, self.base.numerical_zeros])
        return tuple(self.torque_model.columns[k].name for k in np.sort(zeros).tolist())


def excitation_plan(torque_model: TorqueModel, information: Array) -> ExcitationPlan:
    """The plan of recordings with an information matrix F (b, b). Raises InvalidInput for another shape."""
    base = structure(torque_model).base
    if information.shape != (base.rank, base.rank):
        raise InvalidInput(f"the information matrix has shape {information.shape}; {(base.rank,) * 2} needed")
    spread, known = prior_spread(torque_model), torque_model.prior()
    prior = base.values(known)
    prior[np.abs(prior) < ZERO_PARAMETER_SHARE * spread] = 0.0
    alone = np.isin(base.independent, base.alone)
    prior[alone] = known[base.independent[alone]]  # without what rounding groups with them
    return ExcitationPlan(torque_model, base, prior, spread, information)


def prior_spread(torque_model: TorqueModel) -> Array:
    """Expected distance of the base parameters from the model before the experiment (b,), in their units.

    It is that of identification.model_prior for bodies (m, m l, m l²), and that of DRIVE_SHARE for the rest. The
    summands of a base parameter count as independent.
    """
    return np.asarray(np.linalg.norm(structure(torque_model).base.matrix * _spreads(torque_model), axis=1))


def expected_parameters(torque_model: TorqueModel) -> Array:
    """Standard parameters (p,) with the bodies of the model, and drives as large as their prior spread."""
    x, bodies = _spreads(torque_model), torque_model.slice_of(RigidBodies)
    if bodies is not None:
        x[bodies] = torque_model.prior()[bodies]
    return x


def _spreads(torque_model: TorqueModel) -> Array:
    """Expected distance of the standard parameters from the model (p,)."""
    scale = model_prior(torque_model).scale
    unknown = np.flatnonzero(~np.isfinite(scale))
    if unknown.size:
        samples = random_samples(torque_model, STATES_PER_PARAMETER * len(scale), 0)
        rows = torque_model.rows(samples)
        torques = rows @ torque_model.prior()
        scale[unknown] = _drive_spread(rows[..., unknown], torques)
    return scale


def _drive_spread(rows: Array, torques: Array) -> Array:
    """Prior spread (k,) for columns (N, n, k). The torque of a robot without masses counts as 1 N m or N."""
    size = np.sqrt(np.mean(torques**2, axis=0))
    size = np.where(size > 0, size, 1.0)
    columns = np.sqrt(np.mean(rows**2, axis=0))
    strongest = columns.argmax(axis=0)
    reach = columns[strongest, np.arange(columns.shape[1])]
    return np.asarray(DRIVE_SHARE * size[strongest] / np.where(reach > 0, reach, 1.0))
