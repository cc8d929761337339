"""What `graphdyn identify 2` says of the result in the tables: base parameters and links."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from crosscheck.identifying.results.parameters import base_rows, body_rows, correlation_of, deviations_of
from crosscheck.identifying.results.result import Identified
from crosscheck.report.record_fields import Keywords, Number, taken
from graphdyn.identification import MethodResult
from graphdyn.model import PARAMETER_NAMES

Inertial = Annotated[
    Mapping[str, float],
    Keywords(
        properties={
            name: {"description": "In the link frame [kg, kg m, kg m²].", "type": "number"} for name in PARAMETER_NAMES
        },
        required=list(PARAMETER_NAMES),
    ),
]


@dataclass(frozen=True, kw_only=True)
class ShownParameterRecord:
    """A base parameter of the shown result."""

    name: str
    """In standard parameters."""

    unit: str
    """Of the numbers."""

    cad: float
    """Of the robot as given; drives are zero."""

    value: float
    """Identified."""

    deviation: Number
    """Standard deviation for white noise."""

    block_deviation: Number
    """Allowing for correlation in time: jackknife over time blocks."""

    relative_deviation: Number
    """100 block_deviation / |value| [%]."""

    truth: Number
    """True value, of a simulated robot."""

    error: Number
    """value minus truth."""


@dataclass(frozen=True, kw_only=True)
class IdentifyBodyRecord:
    """A link of the shown result."""

    name: str
    """Of the link."""

    cad: Inertial
    """As given."""

    identified: Inertial
    """What --urdf writes."""

    center_of_mass: Sequence[Number]
    """In link axes [m]."""

    pseudo_inertia_eigenvalue: float
    """The smallest; below zero: no real body."""


@dataclass(frozen=True, kw_only=True)
class ShownRecord:
    """The result in the tables: the chosen one, else the recommended one, else the one that predicts best; null where
    no method has an answer.
    """

    name: str
    """As in comparison."""

    method: str
    """Name of the method."""

    deviations: str
    """Whose standard deviations these are."""

    correlation_time: Number
    """Until the autocorrelation of the residual behind them has fallen to 1/e, at the slowest joint [s]."""

    correlation_times: Number
    """How many times as long the fitted rows are; null for a white residual."""

    lower_bound: bool | None
    """Block deviations are a lower bound: fewer than 80 correlation times; null without them."""

    base_parameters: Sequence[ShownParameterRecord]
    """Base parameters."""

    bodies: Sequence[IdentifyBodyRecord]
    """Links."""


def shown_record(found: Identified, result: MethodResult | None) -> ShownRecord | None:
    if result is None:
        return None
    source, words = deviations_of(found, result)
    correlation = None if source is None else correlation_of(found, source)
    return ShownRecord(
        name=found.model_of(result).row_name(result),
        method=result.name,
        deviations=words,
        correlation_time=correlation.time if correlation else None,
        correlation_times=correlation.times if correlation else None,
        lower_bound=correlation.lower_bound if correlation else None,
        base_parameters=[taken(ShownParameterRecord, row) for row in base_rows(found, result)],
        bodies=[
            IdentifyBodyRecord(
                name=row.name,
                cad=dict(zip(PARAMETER_NAMES, row.cad_parameters, strict=True)),
                identified=dict(zip(PARAMETER_NAMES, row.parameters, strict=True)),
                center_of_mass=row.center.tolist(),
                pseudo_inertia_eigenvalue=row.eigenvalue,
            )
            for row in body_rows(found, result)
        ],
    )
