"""The format `graphdyn simulate 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.report.record_fields import FORMAT, Command, Count, Index, Number, Versions
from crosscheck.report.versions import versions


@dataclass(frozen=True, kw_only=True)
class SimulatedJointRecord:
    """A joint, over the whole motion."""

    number: Index
    """1 … n."""

    name: str
    """As in the file."""

    prismatic: bool
    """It slides; the others turn."""

    lowest: float
    """Position [rad or m]."""

    highest: float
    """Position [rad or m]."""

    largest_velocity: float
    """Largest |v| [rad/s or m/s]."""

    largest_torque: float
    """Largest |τ| of the actuator [N m or N]."""

    largest_force: Number
    """Largest size of the force that the joint transmits [N]; null where loops leave a component undetermined."""

    largest_moment: Number
    """Largest size of the moment about the joint, that of the actuator included [N m]; null as above."""


@dataclass(frozen=True, kw_only=True)
class OccurrenceRecord:
    """An event."""

    name: str
    """Such as "upper limit of joint 'elbow'"."""

    time: float
    """When it happened [s]."""


@dataclass(frozen=True, kw_only=True)
class SimulateRecord:
    """A motion in short; the motion itself is what --out writes."""

    format: Annotated[Literal["graphdyn simulate 1"], FORMAT] = "graphdyn simulate 1"

    versions: Versions = field(default_factory=versions)

    command: Command

    robot: str
    """Name or path, as given."""

    locked: Mapping[str, float]
    """Joints held still, with their positions [rad or m]."""

    torque: str
    """zero, hold, or the function."""

    method: str
    """dop853, rk8, rk4 or euler."""

    step: Number
    """Of a method of fixed step [s]; null where steps adapt."""

    duration: float
    """That was simulated [s]."""

    rows: Count
    """Of the result."""

    ended: str
    """Name of the event that ended it; empty where it lasted as long as asked for."""

    occurrences: Sequence[OccurrenceRecord]
    """In their order."""

    energy_drift: float
    """Largest error of the balance of energy as a part of the largest kinetic energy."""

    closure_error: float
    """Largest |φ| of joints [m, -] and loops [m, rad]."""

    joints: Sequence[SimulatedJointRecord]
    """In the order of the robot."""

    out: str | None
    """The file of the motion."""
