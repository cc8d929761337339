"""The format `graphdyn crosscheck 3`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Annotated, Any, Literal

from crosscheck.comparing.baseline import BaselineIdentification
from crosscheck.comparing.comparison import Comparison, QuantityResult, WorstState
from crosscheck.comparing.conditioning import Conditioning
from crosscheck.report.records.record import CommandRecord, Count, Index, Keywords, Number, Record, attribute, written

Route = Literal["urdf", "model"]
Pair = Annotated[Sequence[Number], Keywords(minItems=2, maxItems=2)]


class CrosscheckFailureRecord(Record):
    """One of them.

    robot: as given
    message: why not
    code: of the error, as in docs/loading.md; "not-compared" where it has none
    file, line: the place, null where there is none
    """

    robot: str
    message: str
    code: str
    file: str | None
    line: Index | None


class CrosscheckWorstRecord(Record, of=WorstState):
    """A state, with the numbers to reproduce it."""

    route: Route


class QuantityRecord(Record, of=QuantityResult, leave_out=("quantity", "errors")):
    """One quantity over all routes, cases and states."""

    agrees = attribute()
    max_relative_error: Number
    quantiles: Annotated[Mapping[str, Number], Keywords(required=["0", "0.5", "0.9", "0.99", "1"])] = attribute()
    bound: Annotated[float, Keywords(minimum=0)] = attribute("quantity.tolerance.bound")
    bound_reason = attribute("quantity.tolerance.why")
    scale = attribute("quantity.scale")
    against = attribute("quantity.against")
    by_case: Mapping[str, Number]
    by_route: Mapping[str, Number]
    worst: CrosscheckWorstRecord | None


class ConditioningRecord(Record, of=Conditioning):
    """Smallest and largest rank and condition number over all states. No units: matrices as docs/notation.md writes
    them, in SI.
    """

    constraint_rank: Pair
    constraint_condition: Pair
    kkt_rank: Pair
    kkt_condition: Pair
    mass_matrix_condition: Pair


class CrosscheckIdentificationRecord(Record, of=BaselineIdentification):
    """Base parameters identified from simulated torques, by both regressors."""

    rank: Count
    rank_there: Count
    condition_number: Number
    gap: Pair
    difference: Number
    error: Number


class RobotRecord(Record, of=Comparison, leave_out=("model", "reading")):
    """The verdict on one robot of n bodies."""

    n_bodies: Index
    samples: Index
    seed: Count
    locked = attribute()
    chain = attribute()
    routes: Sequence[Route]
    agrees = attribute()
    quantities: Mapping[str, QuantityRecord]
    conditioning: ConditioningRecord
    identification: CrosscheckIdentificationRecord | None


class CrosscheckRecord(CommandRecord, format="graphdyn crosscheck 3"):
    """graphdyn against Pinocchio, robot by robot and quantity by quantity. Errors are relative and have no unit.

    agrees: every robot agrees, none failed to load, and none is unfinished
    robots: one record per robot that was compared
    failures: robots that could not be compared
    unfinished: robots as given that had not been compared when the file was written; empty unless a sweep over a folder
        was cut short
    """

    agrees: bool
    robots: Sequence[RobotRecord]
    failures: Sequence[CrosscheckFailureRecord]
    unfinished: Sequence[str]


def robot_record(comparison: Comparison) -> dict[str, Any]:
    """A comparison but for the model and the error of every single state."""
    return written(RobotRecord, comparison)


def record(
    comparisons: Sequence[Comparison], failures: Sequence[Mapping[str, Any]], command: Sequence[str]
) -> dict[str, Any]:
    """All comparisons. failures: robot and message of each that could not be compared"""
    return sweep_record([robot_record(comparison) for comparison in comparisons], failures, [], command)


def sweep_record(
    robots: Sequence[Mapping[str, Any]],
    failures: Sequence[Mapping[str, Any]],
    unfinished: Sequence[str],
    command: Sequence[str],
) -> dict[str, Any]:
    """The same of records that are plain data already, also those of an earlier file."""
    return written(
        CrosscheckRecord,
        command=command,
        agrees=all(robot["agrees"] for robot in robots) and not failures and not unfinished,
        robots=robots,
        failures=failures,
        unfinished=unfinished,
    )
