"""What `graphdyn identify 2` says of a torque model: its parameters, and every method on it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from crosscheck.commands.identify.record.methods import MethodRecord, method_record
from crosscheck.identifying.results.identified_model import IdentifiedModel
from crosscheck.report.record_fields import taken
from graphdyn.identification import MethodComparison


@dataclass(frozen=True, kw_only=True)
class ParameterRecord:
    """A standard parameter."""

    name: str
    """Of the parameter."""

    symbol: str
    """As Khalil and Gautier write it."""

    unit: str
    """Of the parameter."""


@dataclass(frozen=True, kw_only=True)
class BaseParameterRecord:
    """A base parameter."""

    name: str
    """In standard parameters."""

    symbol: str
    """As Khalil writes it: XX_2, or XXR_2 where others are regrouped into it."""

    unit: str
    """Of the parameter."""


@dataclass(frozen=True, kw_only=True)
class SettingRecord:
    """A setting of a torque model's term that was found together with the parameters."""

    name: str
    """Of term and setting, such as coulomb width."""

    values: Sequence[float]
    """One per joint."""

    at_end: Sequence[bool]
    """Per joint, whether it is at the end of the range of the search, because the recording does not say."""


@dataclass(frozen=True, kw_only=True)
class ModelRecord:
    """A further torque model."""

    name: str
    """As in the tables."""

    cad_links: bool
    """The links are those of CAD, only the drives are fitted."""

    parameters: Sequence[ParameterRecord]
    """Standard parameters of the torque model, in order."""

    rank: int
    """Number of base parameters that the recording determines."""

    structural_rank: int
    """Number that any motion could determine."""

    condition_number: float
    """Of the regressor, joints weighted by their torque, columns at unit length."""

    exogeneity: str
    """Of the regressor, in words: the result of the Durbin-Wu-Hausman test, or why it is not made."""

    base_parameters: Sequence[BaseParameterRecord]
    """Base parameters of the recording, in order."""

    base_matrix: Sequence[Sequence[float]]
    """B with base parameters = B · parameters, one row per base parameter."""

    settings: Sequence[SettingRecord]
    """Those that were found together with the parameters."""

    methods: Sequence[MethodRecord]
    """Every method, in the order asked for."""


def model_record(model: IdentifiedModel) -> ModelRecord:
    return taken(
        ModelRecord,
        model.comparison,
        name=model.name,
        cad_links=model.cad_of is not None,
        parameters=[taken(ParameterRecord, column) for column in model.torque_model.columns],
        base_parameters=base_parameter_records(model.comparison),
        base_matrix=model.problem.base.matrix.tolist(),
        settings=[taken(SettingRecord, setting) for setting in model.settings],
        exogeneity=model.exogeneity,
        methods=[method_record(model, result) for result in model.comparison.results],
    )


def base_parameter_records(comparison: MethodComparison) -> list[BaseParameterRecord]:
    return [
        BaseParameterRecord(name=name, symbol=symbol, unit=unit)
        for name, symbol, unit in zip(
            comparison.base_names, comparison.base_symbols, comparison.base_units, strict=True
        )
    ]
