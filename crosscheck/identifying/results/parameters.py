"""Identified parameters and those of CAD, row by row, for tables and pages."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crosscheck.identifying.results.identified_model import IdentifiedModel
from crosscheck.identifying.results.result import Identified
from graphdyn.identification import MIN_CORRELATION_TIMES, MethodResult
from graphdyn.layout import Array
from graphdyn.model import pseudo_inertia_from_parameters

ZERO_VALUE_SHARE = 1e-13
"""Value, relative to the largest, that counts as zero: the rounding of canceling terms."""

DEVIATION_METHODS = ("WLS", "GLS", "OLS")
"""Methods whose standard deviations are shown for a method without time-correlated ones; the first available is
used."""


@dataclass(frozen=True)
class BaseRow:
    """One base parameter.

    name: in standard parameters; symbol: in Khalil's notation; unit: of the numbers
    cad: of the robot as given; drives are zero
    value: identified
    deviation: standard deviation for white noise; NaN where there is none
    block_deviation: the same, allowing for correlation in time: jackknife over time blocks; NaN where there is none
    relative_deviation: 100 block_deviation / |value|; NaN where there is none [%]
    truth: true value, of a simulated robot; NaN where it is not known
    error: value minus truth; NaN where that is not known
    """

    name: str
    symbol: str
    unit: str
    cad: float
    value: float
    deviation: float
    block_deviation: float
    relative_deviation: float
    truth: float
    error: float


@dataclass(frozen=True, eq=False)
class BodyRow:
    """One link.

    name: of the link
    parameters, cad_parameters: all ten, identified and as given
    mass, cad_mass: [kg]
    center, cad_center: of mass, in link axes (3,) [m]
    eigenvalue: smallest of the pseudo-inertia; below zero the link is not physically consistent
    """

    name: str
    parameters: Array
    cad_parameters: Array
    cad_mass: float
    mass: float
    cad_center: Array
    center: Array
    eigenvalue: float


def deviations_of(found: Identified, result: MethodResult) -> tuple[MethodResult | None, str]:
    """The result whose standard deviations are shown, and a text that names it."""
    if result.block_deviations is not None:
        return result, f"of {result.name}"
    for name in DEVIATION_METHODS:
        for other in found.model_of(result).comparison.results:
            if other.name == name and other.block_deviations is not None:
                return other, f"of {name}, because {result.name} gives none: from the data alone"
    return None, f"{result.name} gives none"


@dataclass(frozen=True)
class Correlation:
    """Correlation time of the residual of a result, of the joint with the longest one.

    joint: its name; time: until the autocorrelation has fallen to 1/e, 0 where all residuals are white [s]
    times: length of the rows of the fit in correlation times
    """

    joint: str
    time: float
    times: float

    @property
    def lower_bound(self) -> bool:
        """Whether block deviations are a lower bound only."""
        return self.times < MIN_CORRELATION_TIMES


def correlation_of(found: Identified, result: MethodResult) -> Correlation:
    """Correlation over the rows of the fit; the result must have an estimate."""
    assert result.training is not None
    lengths = np.nan_to_num(result.training.correlation_length)
    j = int(np.argmax(lengths))
    return Correlation(
        found.torque_model.model.independent_joints[j],
        float(lengths[j]) * found.fit.period,
        result.training.correlation_times,
    )


def base_rows(found: Identified, result: MethodResult) -> list[BaseRow]:
    """Rows of every base parameter of the recording; the result must have an estimate."""
    model, source = found.model_of(result), deviations_of(found, result)[0]
    comparison, problem = model.comparison, model.problem
    assert result.base_values is not None
    unknown = np.full(comparison.rank, np.nan)
    cad = model.prior_base_values
    deviations = unknown if source is None or source.standard_deviations is None else source.standard_deviations
    blocks = unknown if source is None or source.block_deviations is None else source.block_deviations
    truth = unknown if found.truth is None else problem.base.values(_truth_of(found, model))
    cad, truth = (_without_rounding(values) for values in (cad, truth))
    rows = []
    for k, x in enumerate(result.base_values):
        relative = 100 * blocks[k] / abs(x) if x else float("inf")
        numbers = (cad[k], x, deviations[k], blocks[k], relative, truth[k], x - truth[k])
        names = (comparison.base_names[k], comparison.base_symbols[k], comparison.base_units[k])
        rows.append(BaseRow(*names, *map(float, numbers)))
    return rows


def _truth_of(found: Identified, model: IdentifiedModel) -> Array:
    """True parameters of a torque model, by their names; NaN for those that the simulated robot lacks."""
    assert found.truth is not None
    known = dict(zip(found.comparison.names, found.truth, strict=True))
    return np.array([known.get(name, np.nan) for name in model.comparison.names])


def _without_rounding(values: Array) -> Array:
    """The values, with zero for those that are rounding relative to the largest."""
    return np.where(np.abs(values) < ZERO_VALUE_SHARE * np.nanmax(np.abs(values), initial=0.0), 0.0, values)


def body_rows(found: Identified, result: MethodResult) -> list[BodyRow]:
    """Rows of every link; the result must have an estimate."""
    model = found.model_of(result)
    new, rows = model.body_parameters(result), []
    eigenvalues = np.linalg.eigvalsh(pseudo_inertia_from_parameters(new))[:, 0]
    for body, ten, eigenvalue in zip(model.torque_model.model.bodies, new, eigenvalues, strict=True):
        center = ten[1:4] / ten[0] if ten[0] > 0 else np.full(3, np.nan)
        rows.append(
            BodyRow(body.name, ten, body.parameters, body.mass, float(ten[0]), body.center_of_mass, center, eigenvalue)
        )
    return rows
