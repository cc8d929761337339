"""Parameters of a result beside CAD, row by row, for tables and pages."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crosscheck.identifying.result import Identified
from graphdyn._inertia import pseudo_inertia_from_parameters
from graphdyn.identification import MethodResult
from graphdyn.layout import Array

ROUNDING = 1e-13
"""Relative to the largest: sums of terms that cancel leave no more than that."""

LIKELIEST = ("WLS", "GLS", "OLS")
"""Whose deviations stand in, in this order, where a method gives none."""


@dataclass(frozen=True)
class BaseRow:
    """One base parameter; NaN where there is no such number.

    name: in standard parameters; relative_deviation: [%]; error: of the value against the truth
    """

    name: str
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
    """One link; parameters: all ten; masses [kg], centers of mass [m]; eigenvalue: smallest of the pseudo-inertia."""

    name: str
    parameters: Array
    cad_parameters: Array
    cad_mass: float
    mass: float
    cad_center: Array
    center: Array
    eigenvalue: float


def deviations_of(found: Identified, result: MethodResult) -> tuple[MethodResult | None, str]:
    """The result whose standard deviations are shown, and in words whose they are."""
    if result.standard_deviations is not None:
        return result, f"of {result.name}"
    for name in LIKELIEST:
        for other in found.comparison.results:
            if other.name == name and other.standard_deviations is not None:
                return other, f"of {name}, for {result.name} gives none: what the data alone say"
    return None, f"{result.name} gives none"


def base_rows(found: Identified, result: MethodResult) -> list[BaseRow]:
    """Every base parameter of the recording; the result must have an estimate."""
    comparison, source = found.comparison, deviations_of(found, result)[0]
    assert result.base_values is not None
    unknown = np.full(comparison.rank, np.nan)
    cad = found.prior_base_values
    deviations = unknown if source is None or source.standard_deviations is None else source.standard_deviations
    blocks = unknown if source is None or source.block_deviations is None else source.block_deviations
    truth = unknown if found.truth is None else found.problem.base.values(found.truth)
    cad, truth = (_without_rounding(values) for values in (cad, truth))
    rows = []
    for k, x in enumerate(result.base_values):
        relative = 100 * deviations[k] / abs(x) if x else float("inf")
        numbers = (cad[k], x, deviations[k], blocks[k], relative, truth[k], x - truth[k])
        rows.append(BaseRow(comparison.base_names[k], comparison.base_units[k], *map(float, numbers)))
    return rows


def _without_rounding(values: Array) -> Array:
    """Zero where a value is rounding beside the largest of all."""
    return np.where(np.abs(values) < ROUNDING * np.nanmax(np.abs(values), initial=0.0), 0.0, values)


def body_rows(found: Identified, result: MethodResult) -> list[BodyRow]:
    """Every link; the result must have an estimate."""
    new, rows = found.body_parameters(result), []
    eigenvalues = np.linalg.eigvalsh(pseudo_inertia_from_parameters(new))[:, 0]
    for body, ten, eigenvalue in zip(found.torque_model.model.bodies, new, eigenvalues, strict=True):
        center = ten[1:4] / ten[0] if ten[0] > 0 else np.full(3, np.nan)
        rows.append(
            BodyRow(body.name, ten, body.parameters, body.mass, float(ten[0]), body.center_of_mass, center, eigenvalue)
        )
    return rows
