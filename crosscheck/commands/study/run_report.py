"""One run of a study with all methods, as a report for the terminal."""

from __future__ import annotations

from dataclasses import fields

from crosscheck.report.report import Column, Facts, Report, Row, Section, Table, Verdict
from crosscheck.study.settings.scenarios import Scenario
from crosscheck.study.tasks import Result, StudyOutcome, StudyTask


def study_run_report(task: StudyTask, outcome: StudyOutcome) -> Report:
    facts = Facts(tuple((axis.name.replace("_", " "), _text(task.scenario, axis.name)) for axis in fields(Scenario)))
    table = Table(
        (
            Column("method", "name"),
            Column("measures"),
            Column("iterations", "number"),
            Column("simulations", "number", meaning="of the control loop"),
            Column("parameters", "number", form=".2%", meaning="relative distance, by their effect on the torque"),
            Column("torque", "number", form=".2%", meaning="relative error on another motion"),
            Column("trajectory", "number", form=".2g", meaning="relative error of the simulated loop"),
            Column("consistent"),
            Column("processor time", "number", "s", form=".3g"),
            Column("failure", "text"),
        ),
        tuple(_row(*pair) for pair in zip(outcome.results, outcome.seconds, strict=True)),
        failures_first=False,
    )
    found = sum(result.reason is None for result in outcome.results)
    return Report(
        f"Scenario {task.scenario.name}, run {task.run}",
        Verdict("plain", f"{found} of {len(outcome.results)} methods have an answer"),
        (Section("scenario", "", (facts, table)),),
    )


def _text(scenario: Scenario, axis: str) -> str:
    value = getattr(scenario, axis)
    return "none" if value is None else f"{value:g}" if isinstance(value, float) else str(value)


def _row(result: Result, seconds: float | None) -> Row:
    yes = None if result.consistent is None else "yes" if result.consistent else "no"
    return Row(
        (
            result.method,
            result.measures,
            result.iterations,
            result.simulations,
            result.parameter_error,
            result.torque_error,
            result.trajectory_error,
            yes,
            seconds,
            result.reason or "",
        ),
        "plain" if result.reason is None else "disagrees",
    )
