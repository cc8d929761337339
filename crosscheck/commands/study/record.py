"""The format `graphdyn study 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Annotated, Literal

from crosscheck.report.record_fields import FORMAT, Command, Count, Number, Versions
from crosscheck.report.versions import versions


@dataclass(frozen=True, kw_only=True)
class StudyIntervalRecord:
    """An estimate and its confidence interval."""

    value: Number
    """The estimate; null where there is none, or where it is not finite because runs failed."""

    low: Number
    """Lower end; null where there is none."""

    high: Number
    """Upper end; null where there is none, or where it is not finite because runs failed."""


@dataclass(frozen=True, kw_only=True)
class StudyMethodRecord:
    """A method."""

    name: str
    """As in the configuration."""

    measures: Literal["torques", "wrenches"]
    """What it needs of every joint: its torque, or all six components of its wrench. The two are never compared."""


@dataclass(frozen=True, kw_only=True)
class StudyRankRecord:
    """A method in a ranking."""

    method: str
    """Its name."""

    rank: StudyIntervalRecord
    """Mean rank, 1 is best; interval by bootstrap over runs."""

    ratio: StudyIntervalRecord
    """Geometric mean of its error over that of the first, where both have an answer; interval by bootstrap."""

    failures: Count
    """Records on which it failed, which rank last."""

    better_than: Sequence[str]
    """Methods that it is better than: beyond the critical distance."""


@dataclass(frozen=True, kw_only=True)
class StudyRankingRecord:
    """Methods of one class ranked by one error."""

    measures: Literal["torques", "wrenches"]
    """The class of the methods."""

    error: Literal["parameter_error", "torque_error", "trajectory_error"]
    """By which they are ranked."""

    records: Count
    """Common records on which they were ranked: those for which some method has an answer."""

    friedman: Number
    """Probability of ranks as different as these if all methods were alike; null where nothing can be compared."""

    critical_distance: Number
    """Nemenyi's, of mean ranks."""

    leaders: Sequence[str]
    """The first, and those that it is not better than."""

    methods: Sequence[StudyRankRecord]
    """Best first."""


@dataclass(frozen=True, kw_only=True)
class StudyResultRecord:
    """A method in a scenario."""

    method: str
    """Its name."""

    found: Count
    """Runs in which it has an answer."""

    failed: StudyIntervalRecord
    """Share of the runs in which it has none; Wilson's interval."""

    reasons: Mapping[str, Count]
    """Why it failed, and how often."""

    consistent: StudyIntervalRecord
    """Share of the answers with real bodies in all links; Wilson's interval."""

    parameter_error: StudyIntervalRecord
    """Median relative distance of the base parameters from the true ones; failures count as infinite."""

    torque_error: StudyIntervalRecord
    """The same of the torque of another motion."""

    trajectory_error: StudyIntervalRecord
    """The same of the simulated motion of the closed loop."""

    iterations: Number
    """Median."""

    most_iterations: Number
    """Largest number of iterations."""

    simulations: Number
    """Median number of simulated motions."""

    seconds: StudyIntervalRecord
    """Median processor time [s]."""

    bias: Sequence[Number]
    """Mean of found minus true, of every base parameter, over the runs that did not fail."""

    bias_low: Sequence[Number]
    """Lower ends of the intervals of the bias."""

    bias_high: Sequence[Number]
    """Upper ends."""

    spread: Sequence[Number]
    """Standard deviation of every base parameter over the same runs."""

    spread_low: Sequence[Number]
    """Lower ends of the intervals of the spread."""

    spread_high: Sequence[Number]
    """Upper ends."""

    stated: Sequence[Number]
    """Root mean square of the standard deviations that the method states itself."""


@dataclass(frozen=True, kw_only=True)
class StudyScenarioRecord:
    """A point of the grid."""

    name: str
    """As in the tables."""

    axes: Mapping[str, float | str | None]
    """Its values on the axes of the grid."""

    runs: Count
    """Records that were simulated."""

    base_names: Sequence[str]
    """Of the base parameters, such as "XX_2 - YY_2 + 0.18 M_3"."""

    base_units: Sequence[str]
    """Their units."""

    truth: Sequence[Number]
    """Their true values."""

    results: Sequence[StudyResultRecord]
    """Of all methods that take part: those that need wrenches do where they are measured."""

    rankings: Sequence[StudyRankingRecord]
    """Of every class that has two methods or more, by every error."""


@dataclass(frozen=True, kw_only=True)
class StudyRecord:
    """A study of identification methods, summarized; every run is in results.parquet."""

    format: Annotated[Literal["graphdyn study 1"], FORMAT] = "graphdyn study 1"

    versions: Versions = field(default_factory=versions)

    command: Command

    confidence: float
    """Of all intervals and tests."""

    facts: Mapping[str, str]
    """What all scenarios share, in words."""

    methods: Sequence[StudyMethodRecord]
    """All of them."""

    rankings: Sequence[StudyRankingRecord]
    """Over all scenarios."""

    scenarios: Sequence[StudyScenarioRecord]
    """All of them."""
