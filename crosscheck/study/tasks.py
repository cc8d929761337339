"""One task of a study: one run of one scenario, simulated once and identified with every method.

A method has a name, or is FILE.py:NAME, and is given what it needs of a record.
"""

from __future__ import annotations

import logging
import platform
import time
import warnings
from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.distributing import differences, versions
from crosscheck.identifying import method_named
from crosscheck.identifying.methods.loop_methods import in_loop
from crosscheck.study.distances import distances
from crosscheck.study.settings.configuration import Configuration, hash_of, shown_name, takes_wrenches
from crosscheck.study.settings.design import Redraw
from crosscheck.study.settings.scenarios import Scenario
from crosscheck.study.simulated.own_code import own
from crosscheck.study.simulated.runs import RecordedProblem, known_model, simulated
from crosscheck.study.validation import ValidationMetric, validation_metric
from graphdyn import EstimationFailed, GraphDynError, InvalidInput
from graphdyn.identification import (
    Estimate,
    Estimator,
    one_thread,
    plausibility,
)

log = logging.getLogger(__name__)

TORQUES, WRENCHES = "torques", "wrenches"
"""What a method takes for measured."""


def estimator_of(method: str) -> Estimator:
    """A new one. Raises whatever a file of one's own raises."""
    if ":" not in method:
        return method_named(method)
    made: Estimator = own(method)()
    return made


def taking_part(methods: Sequence[str], scenario: Scenario) -> tuple[str, ...]:
    """All, or, where the scenario has no wrenches, those that need none."""
    measured = scenario.force_noise is not None
    return tuple(method for method in methods if measured or not takes_wrenches(estimator_of(method)))


def measures(estimator: Estimator) -> str:
    """What the method measures, in one of these words."""
    return WRENCHES if takes_wrenches(estimator) else TORQUES


def ready(estimator: Estimator, record: RecordedProblem, scenario: Scenario) -> Estimator:
    """The estimator with the loop, the start of its iteration, and the recording, as far as it has a use for them."""
    (known,) = in_loop([estimator], record.loop)
    given: dict[str, Any] = {}
    if hasattr(known, "start"):
        given["start"] = scenario.start if record.start is None else record.start
    if takes_wrenches(known):
        given["recording"] = record.recording
    fitted: Estimator = replace(known, **given) if given else known  # type: ignore[type-var]
    return fitted


@dataclass(frozen=True)
class StudyTask:
    """One run of a scenario. methods: as in the configuration."""

    scenario: Scenario
    run: int
    methods: tuple[str, ...]


@dataclass(frozen=True)
class Result:
    """One method in one task: a row of results.parquet.

    method: as in tables; measures: "torques" or "wrenches"
    reason: why it failed, None where it did not
    rank: base parameters that the recording determines
    simulations: of the loop, in all iterations
    base, sigma: values of the base parameters of the scenario, and their standard deviations as the method states them
    parameter_error, torque_error, trajectory_error: as in validation metrics
    consistent: whether every body can be real
    d_beta, d_tau, d_q, diverged: as in distances, where the study asks for them
    redrawn, repeat: source that this record draws once more than the run, and how often; None and 0 for the run itself
    """

    method: str
    measures: str
    reason: str | None = None
    rank: int | None = None
    iterations: int | None = None
    simulations: int | None = None
    base: tuple[float, ...] | None = None
    sigma: tuple[float, ...] | None = None
    parameter_error: float | None = None
    torque_error: float | None = None
    trajectory_error: float | None = None
    consistent: bool | None = None
    d_beta: float | None = None
    d_tau: float | None = None
    d_q: float | None = None
    diverged: bool | None = None
    redrawn: str | None = None
    repeat: int = 0


@dataclass(frozen=True)
class StudyOutcome:
    """The results of a task, one for each method, and the processor time of each.

    seconds: of the estimation alone, None where there was none; total: of the whole task, simulation included   [s]
    """

    results: tuple[Result, ...]
    seconds: tuple[float | None, ...]
    total: float

    def __add__(self, other: StudyOutcome) -> StudyOutcome:
        """The outcome with that of further methods."""
        return StudyOutcome(self.results + other.results, self.seconds + other.seconds, self.total + other.total)

    def as_json(self) -> dict[str, Any]:
        return asdict(self)

    @classmethod
    def from_json(cls, plain: dict[str, Any]) -> StudyOutcome:
        """Raises LookupError, TypeError, ValueError or AttributeError for what another version has written."""
        rows: list[dict[str, Any]] = [
            {name: tuple(value) if isinstance(value, list) else value for name, value in row.items()}
            for row in plain["results"]
        ]
        if any(row.keys() != Result.__dataclass_fields__.keys() for row in rows):
            raise ValueError("a result with other fields")
        results = tuple(Result(**row) for row in rows)
        return cls(results, tuple(plain["seconds"]), plain["total"])


def failed(task: StudyTask, reason: str) -> StudyOutcome:
    """All methods, for one reason."""
    results = tuple(Result(shown_name(method), measures(estimator_of(method)), reason) for method in task.methods)
    return StudyOutcome(results, (None,) * len(results), 0.0)


class CannotCompute(GraphDynError):
    """This process lacks what a task needs, so that its failures would say nothing of the methods."""


@dataclass(frozen=True)
class Unfit:
    """The answer of a process that lacks what a task needs. reason: in words."""

    reason: str


LIBRARIES = ("clarabel",)
"""What computes beside the libraries that every process has."""


@dataclass(frozen=True)
class Surroundings:
    """What the results depend on beside the configuration: the same in every process of a study.

    files: path and hash of each; libraries: name and version of each
    """

    files: tuple[tuple[str, str], ...]
    libraries: tuple[tuple[str, str], ...]

    @classmethod
    def here(cls, study: Configuration) -> Surroundings:
        return cls(tuple(study.own_files.items()), tuple(versions(LIBRARIES).items()))


@cache
def unlike(given: Surroundings) -> str:
    """How this process differs, in words; empty where it does not."""
    found = differences(dict(given.libraries), versions(LIBRARIES))
    different = [found] if found else []
    for path, content in given.files:
        if not Path(path).is_file():
            different.append(f"there is no file {path}")
        elif hash_of(Path(path)) != content:
            different.append(f"{path} is another file")
    return ", ".join(different)


def computed(study: Configuration, given: Surroundings, task: StudyTask) -> StudyOutcome | Unfit:
    """The outcome where this process is like the one that gives the tasks."""
    different = unlike(given)
    if different:
        return Unfit(f"on the machine {platform.node()}: {different}")
    try:
        return compute(study, task)
    except CannotCompute as error:
        return Unfit(f"on the machine {platform.node()}: {error}")


def compute(study: Configuration, task: StudyTask) -> StudyOutcome:
    """Simulate and identify. Whatever goes wrong is the reason of failures, but for what is missing here.

    Raises CannotCompute.
    """
    begin = time.process_time()
    with one_thread(), warnings.catch_warnings(action="ignore"), np.errstate(all="ignore"):
        records = [_of_record(study, task, redraw) for redraw in study.design.redraws]
    results, seconds = zip(*(pair for record in records for pair in record), strict=True)
    return StudyOutcome(results, seconds, time.process_time() - begin)


def _of_record(study: Configuration, task: StudyTask, redraw: Redraw) -> list[tuple[Result, float | None]]:
    """What each method makes of one record. Raises CannotCompute."""
    draw = study.design.draw(task.run, redraw)
    try:
        log.info("simulating run %d", task.run)
        record = simulated(study, task.scenario, draw)
        if not record.problem.equations.n_columns:  # which are read once, before any method is timed
            raise InvalidInput("it shows no parameter: the robot stands still")
        known = known_model(study, task.scenario, draw)
        measure = validation_metric(study.robot_of(task.scenario), study.seed, known, draw.motion)
    except Exception as failure:
        _refuse_missing(failure)
        found: list[tuple[Result, float | None]] = [
            (result, None) for result in failed(task, f"no record: {failure}").results
        ]
    else:
        far = study.design.distances
        found = [_identified(method, record, task.scenario, measure, far) for method in task.methods]
    return [(replace(result, redrawn=redraw.source, repeat=redraw.repeat), seconds) for result, seconds in found]


def _identified(
    method: str, record: RecordedProblem, scenario: Scenario, measure: ValidationMetric, far: bool
) -> tuple[Result, float | None]:
    """What a method finds, or why it does not. far: with its distances. Raises CannotCompute."""
    try:
        estimator = estimator_of(method)
    except Exception as error:  # it could be made where the study began
        raise CannotCompute(f"{method} cannot be made: {type(error).__name__}: {error}") from error
    blank = Result(shown_name(method), measures(estimator), rank=record.problem.base.rank)
    log.info("%s", blank.method)
    begin = time.process_time()
    seconds = None
    try:
        estimate = ready(estimator, record, scenario).estimate(record.problem)
        seconds = time.process_time() - begin
        result = _judged(blank, estimate, record, measure)
        if far and result.reason is None:
            result = replace(result, **vars(distances(record, measure.base, np.asarray(estimate.parameters))))
    except EstimationFailed as failure:
        _refuse_missing(failure)
        result = replace(blank, reason=str(failure))
    except Exception as failure:  # whatever a method written elsewhere raises or answers, the others go on
        _refuse_missing(failure)
        result = replace(blank, reason=f"{type(failure).__name__}: {failure}")
    return result, time.process_time() - begin if seconds is None else seconds


def _refuse_missing(failure: BaseException) -> None:
    """Raise CannotCompute where a package that is missing has led to the failure."""
    cause: BaseException | None = failure
    while cause is not None:
        if isinstance(cause, ImportError):
            raise CannotCompute(str(failure)) from failure
        cause = cause.__cause__ or cause.__context__


def _judged(blank: Result, estimate: Estimate, record: RecordedProblem, measure: ValidationMetric) -> Result:
    """Raises whatever an answer that is none leads to."""
    x = np.asarray(estimate.parameters, dtype=float)
    if x.shape != record.truth.shape or not np.all(np.isfinite(x)):
        reason = f"the method answers parameters of shape {x.shape}; {len(record.truth)} finite numbers needed"
        return replace(blank, reason=reason)
    base = measure.base.values(x)
    return replace(
        blank,
        iterations=int(estimate.iterations),
        simulations=int(estimate.settings.get("simulations", 0)),
        base=tuple(base.tolist()),
        sigma=_sigma(estimate, record, measure),
        parameter_error=measure.parameter_error(base),
        torque_error=measure.torque_error(base),
        trajectory_error=measure.trajectory_error(base),
        consistent=plausibility(record.problem.torque_model, x[None], poses=1)[0].consistent,
    )


def _sigma(estimate: Estimate, record: RecordedProblem, measure: ValidationMetric) -> tuple[float, ...] | None:
    """Standard deviations, with correlation in time where the method states them. None where it states none, and where
    the recording determines fewer base parameters than any motion could: its own are other ones then.
    """
    covariance = estimate.covariance if estimate.block_covariance is None else estimate.block_covariance
    if covariance is None or record.problem.base.rank != measure.base.rank:
        return None
    if np.shape(covariance) != 2 * (measure.base.rank,):
        raise ValueError(f"the method answers a covariance of shape {np.shape(covariance)}")
    return tuple(np.sqrt(np.maximum(np.diag(covariance), 0.0)).tolist())
