"""The format `graphdyn excite 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.report.record_fields import FORMAT, Command, Count, Index, Number, Versions
from crosscheck.report.versions import versions


@dataclass(frozen=True, kw_only=True)
class LimitUseRecord:
    """A limit of a motion, over all its times."""

    kind: Literal["position", "velocity", "acceleration", "jerk", "torque", "plane"]
    """What is limited."""

    name: str
    """Of the joint, or of the plane."""

    used: float
    """Largest part of the limit that the motion uses, at 1 kHz; above 1 it is violated."""


@dataclass(frozen=True, kw_only=True)
class FourierRecord:
    """A joint's motion: offset + Σ_l (a_l sin(l ω t) - b_l cos(l ω t)) / (l ω), ω = 2π / duration."""

    joint: str
    """Name, as in the file."""

    offset: float
    """Mean position [rad or m]."""

    a: Sequence[float]
    """a_1 … a_L [rad/s or m/s]."""

    b: Sequence[float]
    """b_1 … b_L [rad/s or m/s]."""


@dataclass(frozen=True, kw_only=True)
class CollisionRecord:
    """Two links whose meshes collide."""

    links: str
    """Both names."""

    poses: Count
    """In which they do, of those at 1 kHz."""

    first: float
    """Time of the first [s]."""


@dataclass(frozen=True, kw_only=True)
class CheckedCollisionsRecord:
    """Which pairs of links were looked at. Links that a joint connects are in none of these, nor
    those that are fixed to the inner one with the outer one."""

    margin: float
    """By which meshes must stay apart [m]."""

    checked: Sequence[str]
    """Pairs that were checked."""

    near: Sequence[str]
    """Those of them that are nearer than the margin in all of many random poses: they must not touch."""

    always: Sequence[str]
    """Pairs that were left out because they collide in all of many random poses."""

    disabled: Sequence[str]
    """Pairs that were left out because the SRDF file disables them."""

    missing: Mapping[str, str]
    """Links whose shapes cannot be read, with the reason. They pass unchecked."""

    without_shapes: Sequence[str]
    """Bodies to which the file gives no shapes. They pass unchecked."""


@dataclass(frozen=True, kw_only=True)
class PlannedMotionRecord:
    """A motion."""

    number: Index
    """1 … K."""

    seed: int | None
    """From which it was found; null for a motion that was given."""

    duration: float
    """[s]"""

    limits: Sequence[LimitUseRecord]
    """All of them."""

    fourier: Sequence[FourierRecord] | None
    """In the order of the robot; null for motions that are no Fourier series."""

    collisions: Sequence[CollisionRecord]
    """Of links with each other."""


@dataclass(frozen=True, kw_only=True)
class PlannedParameterRecord:
    """A base parameter, as recordings of all motions will determine it."""

    name: str
    """Such as "XX_2 - YY_2 + 0.18 M_3"."""

    unit: str
    """Of the parameter."""

    prior: float
    """Value in the robot's file; 0 for friction and drives."""

    spread: float
    """How far from it the parameter may be before the experiment."""

    sigma: Number
    """Standard deviation after it; null where the motions do not determine it."""

    relative: Number
    """sigma divided by the larger of |prior| and spread."""

    verdict: Literal["well", "roughly", "not"]
    """Determined: relative up to 0.1, up to 0.5, or beyond."""

    best_random: Number
    """sigma of the best random motions; null without."""

    median_random: Number
    """sigma of the median random motions; null without."""

    recorded: Number
    """sigma of the recordings of --against, for as many samples; null without."""


@dataclass(frozen=True, kw_only=True)
class PlanSummaryRecord:
    """All base parameters together."""

    geometric_mean: Number
    """Of the standard deviations, each divided by the spread of its parameter."""

    condition_number: Number
    """Of the regressor, equations divided by their noise and columns multiplied by the spreads."""


@dataclass(frozen=True, kw_only=True)
class ExciteRecord:
    """Motions, the limits they use, and what they promise."""

    format: Annotated[Literal["graphdyn excite 1"], FORMAT] = "graphdyn excite 1"

    versions: Versions = field(default_factory=versions)

    command: Command

    robot: str
    """Name or path, as given."""

    locked: Mapping[str, float]
    """Joints held still, with their positions [rad or m]."""

    criterion: Literal["log-det", "sigma", "condition"]
    """What was minimized."""

    noise: Sequence[float]
    """Standard deviation of the torques, of each joint that no others drive [N m or N]."""

    rate: float
    """Samples per second of the measurement."""

    motions: Sequence[PlannedMotionRecord]
    """In the order in which they are to be made."""

    plan: PlanSummaryRecord
    """Of recordings of all motions."""

    random: Count
    """Random motions that were compared."""

    best_random: PlanSummaryRecord | None
    """Of as many random motions, each the best of them; null without."""

    median_random: PlanSummaryRecord | None
    """Of as many random motions, each their median; null without."""

    recorded: PlanSummaryRecord | None
    """Of the recordings of --against, for as many samples."""

    parameters: Sequence[PlannedParameterRecord]
    """The base parameters."""

    only_in_sums: Sequence[str]
    """Standard parameters that no motion determines by themselves."""

    without_effect: Sequence[str]
    """Standard parameters on which no torque depends."""

    failures: Sequence[str]
    """Why seeds found no motion."""

    collisions: CheckedCollisionsRecord | None
    """What is known of the robot's collisions with itself; null where they were not looked at."""

    out: Sequence[str]
    """Files of the motions."""
