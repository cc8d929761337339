"""The format `graphdyn crosscheck 2`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal

from crosscheck.comparing.comparison import Comparison, QuantityResult
from crosscheck.report.record_fields import FORMAT, Command, Count, Index, Keywords, Number, Vector3, Versions, taken
from crosscheck.report.versions import versions

Pair = Annotated[Sequence[Number], Keywords(minItems=2, maxItems=2)]


@dataclass(frozen=True, kw_only=True)
class CrosscheckFailureRecord:
    """One of them."""

    robot: str
    """As given."""

    message: str
    """Why not."""


@dataclass(frozen=True, kw_only=True)
class CrosscheckWorstRecord:
    """A state, with the numbers to reproduce it."""

    route: Literal["urdf", "model"]
    """The route of this error."""

    case: str
    """The kind of state."""

    q: Sequence[float]
    """Joint positions (n) [rad or m]."""

    v: Sequence[float]
    """Joint velocities (n) [rad/s or m/s]."""

    a: Sequence[float]
    """Joint accelerations (n) [rad/s² or m/s²]."""

    tau: Sequence[float] | None
    """Given torques or forces (n) [N m or N]; null for those that produce exactly a."""

    external_wrenches: Sequence[Annotated[Sequence[float], Keywords(minItems=6, maxItems=6, description="One body.")]]
    """Force, then moment, on each body at its link origin, in link axes (n, 6) [N, N m]."""

    turn: Annotated[
        Sequence[Annotated[Sequence[float], Keywords(minItems=3, maxItems=3, description="A row.")]],
        Keywords(minItems=3, maxItems=3),
    ]
    """Rotation of the world that the base was given (3, 3)."""

    gravity: Vector3
    """Gravity of the case, world axes (3) [m/s²]."""


@dataclass(frozen=True, kw_only=True)
class QuantityRecord:
    """One quantity over all routes, cases and states."""

    agrees: bool
    """The largest error is within the bound."""

    max_relative_error: Number
    """Largest relative error. Null if it is not finite."""

    quantiles: Annotated[Mapping[str, Number], Keywords(required=["0", "0.5", "0.9", "0.99", "1"])]
    """The errors that these parts of all states do not exceed."""

    bound: Annotated[float, Keywords(minimum=0)]
    """Largest relative error that counts as agreement."""

    bound_reason: str
    """Why the bound is what it is."""

    scale: str
    """What errors are relative to, in words."""

    against: str
    """Pinocchio's function, or the other form that was compared."""

    by_case: Mapping[str, Number]
    """Largest relative error of each kind of state. Null if it is not finite."""

    by_route: Mapping[str, Number]
    """Largest relative error of each route. Null if it is not finite."""

    worst: CrosscheckWorstRecord | None
    """Where the error is largest; null where the error belongs to all states together."""


@dataclass(frozen=True, kw_only=True)
class ConditioningRecord:
    """Smallest and largest rank and condition number over all states. No units: matrices as docs/notation.md writes
    them, in SI.
    """

    constraint_rank: Pair
    """Rank of φ_q; full: 5n."""

    constraint_condition: Pair
    """Condition number of φ_q."""

    kkt_rank: Pair
    """Rank of the matrix of Eq. (111); full: 11n."""

    kkt_condition: Pair
    """Condition number of the matrix of Eq. (111)."""

    mass_matrix_condition: Pair
    """Condition number of the joint-space mass matrix M."""


@dataclass(frozen=True, kw_only=True)
class CrosscheckIdentificationRecord:
    """Base parameters identified from simulated torques, by both regressors."""

    rank: Count
    """Number of base parameters by graphdyn's regressor."""

    rank_there: Count
    """Number of base parameters by Pinocchio's regressor."""

    condition_number: Number
    """Of the independent columns at unit length. Null if it is not finite."""

    gap: Pair
    """Smallest accepted and largest rejected pivot."""

    difference: Number
    """Between the two estimates, relative. Null if it is not finite."""

    error: Number
    """Of graphdyn's estimate against the model's own base parameters, relative. Null if it is not finite."""


@dataclass(frozen=True, kw_only=True)
class RobotRecord:
    """The verdict on one robot of n bodies."""

    robot: str
    """Name or path as given."""

    file: str | None
    """The URDF file; null where a RobotModel was given."""

    file_sha256: str | None
    """SHA-256 of the content of that file, in hexadecimal; null where a RobotModel was given."""

    n_bodies: Index
    """n: moving bodies, and joints."""

    samples: Index
    """Random states; the awkward ones come on top."""

    seed: Count
    """Seed of the random states."""

    locked: Mapping[str, float]
    """Joints that were frozen, and where [rad or m]."""

    chain: Annotated[Sequence[str], Keywords(minItems=2, maxItems=2)] | None
    """Base link and tip link of the arm that was cut out of the robot; null for the whole robot."""

    routes: Sequence[Literal["urdf", "model"]]
    """urdf: Pinocchio built the same file; model: Pinocchio was built from graphdyn's model."""

    not_compared: Mapping[str, str]
    """Quantities that were left out, and why."""

    notes: Sequence[str]
    """What a reader must know."""

    agrees: bool
    """Every quantity is within its bound."""

    quantities: Mapping[str, QuantityRecord]
    """What was compared, by name, in the order of the table (docs/notation.md)."""

    conditioning: ConditioningRecord

    identification: CrosscheckIdentificationRecord | None
    """Null where no body has mass."""


@dataclass(frozen=True, kw_only=True)
class CrosscheckRecord:
    """graphdyn against Pinocchio, robot by robot and quantity by quantity. Errors are relative and have no unit."""

    format: Annotated[Literal["graphdyn crosscheck 2"], FORMAT] = "graphdyn crosscheck 2"

    versions: Versions = field(default_factory=versions)

    command: Command

    agrees: bool
    """Every robot agrees, none failed to load, and none is unfinished."""

    robots: Sequence[RobotRecord]
    """One record per robot that was compared."""

    failures: Sequence[CrosscheckFailureRecord]
    """Robots that could not be compared."""

    unfinished: Sequence[str]
    """Robots as given that had not been compared when the file was written; empty unless a sweep over a folder was cut
    short.
    """


def robot_record(comparison: Comparison) -> RobotRecord:
    """A comparison but for the model and the error of every single state."""
    return taken(
        RobotRecord,
        comparison,
        quantities={name: _quantity(result) for name, result in comparison.quantities.items()},
        conditioning=taken(ConditioningRecord, comparison.conditioning),
        identification=comparison.identification and taken(CrosscheckIdentificationRecord, comparison.identification),
    )


def _quantity(result: QuantityResult) -> QuantityRecord:
    quantity = result.quantity
    return taken(
        QuantityRecord,
        result,
        bound=quantity.tolerance.bound,
        bound_reason=quantity.tolerance.why,
        scale=quantity.scale,
        against=quantity.against,
        worst=result.worst and taken(CrosscheckWorstRecord, result.worst),
    )


def record(
    comparisons: Sequence[Comparison], failures: Sequence[Mapping[str, str]], command: Sequence[str]
) -> CrosscheckRecord:
    """All comparisons. failures: robot and message of each that could not be compared"""
    robots = [robot_record(comparison) for comparison in comparisons]
    return _record(robots, all(robot.agrees for robot in robots), failures, [], command)


def sweep_record(
    robots: Sequence[Mapping[str, Any]],
    failures: Sequence[Mapping[str, str]],
    unfinished: Sequence[str],
    command: Sequence[str],
) -> CrosscheckRecord:
    """The same of records that are plain data already, also those of an earlier file."""
    return _record(robots, all(robot["agrees"] for robot in robots), failures, unfinished, command)


def _record(
    robots: Sequence[Any],
    agree: bool,
    failures: Sequence[Mapping[str, str]],
    unfinished: Sequence[str],
    command: Sequence[str],
) -> CrosscheckRecord:
    return CrosscheckRecord(
        command=command,
        agrees=agree and not failures and not unfinished,
        robots=robots,
        failures=[CrosscheckFailureRecord(**failure) for failure in failures],
        unfinished=unfinished,
    )
