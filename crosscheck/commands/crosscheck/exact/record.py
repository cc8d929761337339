"""The format `graphdyn accuracy 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from crosscheck.commands.crosscheck.record import CrosscheckFailureRecord
from crosscheck.comparing.accuracy import CodeErrors, QuantityErrors, TrueErrors
from crosscheck.report.records.record import CommandRecord, Count, Index, Keywords, Number, Record, attribute, written


class CodeErrorsRecord(Record, of=CodeErrors, leave_out=("by_case",)):
    """One code. Errors in eps = 2.2e-16; null where an answer is not finite."""

    median: Number = attribute()
    quantile_99: Number = attribute()
    largest: Number = attribute()
    worst_case = attribute()
    quantile_99_of_values: Number = attribute()
    largest_by_case: Mapping[str, Number] = attribute()


class QuantityErrorsRecord(Record, of=QuantityErrors, leave_out=("name",)):
    """One quantity at all states."""

    bound: Annotated[float, Keywords(minimum=0)]
    states: Index
    codes: Mapping[str, CodeErrorsRecord]
    beyond = attribute()


class TrueErrorsRecord(Record, of=TrueErrors, leave_out=("model", "reading")):
    """The accuracy of all codes on one robot of n bodies."""

    n_bodies: Index
    samples: Index
    seed: Count
    locked = attribute()
    chain = attribute()
    agrees = attribute()
    quantities: Mapping[str, QuantityErrorsRecord]
    not_regular: Mapping[str, Count]


class AccuracyRecord(CommandRecord, format="graphdyn accuracy 1"):
    """How far graphdyn, Pinocchio and MuJoCo are from exact values, robot by robot and quantity by quantity.

    agrees: no code exceeds the bound of any quantity, and no robot failed
    robots: one record per robot that was measured
    failures: robots that could not be measured
    """

    agrees: bool
    robots: Sequence[TrueErrorsRecord]
    failures: Sequence[CrosscheckFailureRecord]


def record(
    measured: Sequence[TrueErrors], failures: Sequence[Mapping[str, Any]], command: Sequence[str]
) -> dict[str, Any]:
    """All robots. failures: robot and message of each that could not be measured"""
    return written(
        AccuracyRecord,
        command=command,
        agrees=all(one.agrees for one in measured) and not failures,
        robots=measured,
        failures=failures,
    )
