"""`graphdyn study`: identification methods compared on many simulated recordings of one robot."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from crosscheck.commands.program import own_process
from crosscheck.commands.program.console import Advance, progress, say, warnings_shown
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, Ended
from crosscheck.commands.program.options import EXAMPLES, CodeOptions, ReportOptions, WorkerOptions
from crosscheck.commands.program.output_files import OutputFile
from graphdyn.errors import counted

if TYPE_CHECKING:
    from crosscheck.study.running import Progress
    from crosscheck.study.settings.configuration import Configuration
    from crosscheck.study.settings.design import StudyDesign
    from crosscheck.study.statistics.outcomes import StudyOutcomes

EPILOG = f"""{EXAMPLES}  graphdyn study --config small --out small
  graphdyn study --config study.toml --out study --resume
  graphdyn study --report study
  graphdyn study --config study.toml --only 3f0c1a5be2d94a77:2
"""


@dataclass(frozen=True, kw_only=True)
class StudyOptions(CodeOptions, WorkerOptions):
    """What `graphdyn study` is asked for."""

    config: Annotated[
        str | None, typer.Option(metavar="FILE|NAME", help="A TOML file, or of graphdyn: small, birdy, benchmark.")
    ] = None
    folder: Annotated[
        Path | None,
        typer.Option("--out", metavar="DIR", show_default="name of the configuration", help="Folder of the results."),
    ] = None
    resume: Annotated[bool, typer.Option("--resume", help="Continue the study in --out.")] = False
    extend: Annotated[
        bool, typer.Option("--extend", help="Add runs, methods or scenarios of --config to the study in --out.")
    ] = False
    report: Annotated[
        Path | None,
        typer.Option(metavar="DIR", help="Show what the study in this folder has found so far; it may be going on."),
    ] = None
    tables: Annotated[
        Path | None,
        typer.Option(
            metavar="DIR", help="With --report: write CSV and LaTeX tables and SVG pictures for a paper to this folder."
        ),
    ] = None
    only: Annotated[
        str | None,
        typer.Option(metavar="SCENARIO:RUN", help="Repeat this one run and show its results; nothing is written."),
    ] = None


def run(options: StudyOptions) -> None:
    """Compare identification methods on many simulated recordings.

    A robot with known parameters is simulated in its control loop and measured with noise, in several runs of each
    scenario of a grid: noise, rates, motion, filter, errors of the model, start. Every method identifies it from the
    same recordings. Which methods are better, errors, failures, bias and spread go to DIR/study.html and study.json,
    the single results to DIR/results.parquet, scenarios.parquet and times.parquet.

    The results are the same for any number of processes. A study that was interrupted, however it was, goes on with
    --resume; with --extend runs, methods or scenarios are added to what is done. --report shows what there is, while
    another process goes on. A run whose process dies is a failure of the method that is to blame, and the others go on.

    Exit code 0: done; 2: bad input.
    """
    from crosscheck.recordings.arrow import check_arrow

    check_arrow("the tables of a study")  # before the modules that import it
    from crosscheck.commands.study.recordings import identify_recordings
    from crosscheck.distributing import versions as computing_versions
    from crosscheck.report.records.record import versions
    from crosscheck.study.running import run_study
    from crosscheck.study.settings.configuration import read_configuration
    from crosscheck.study.simulated.plants import refuse_unfit
    from crosscheck.study.tasks import LIBRARIES

    config, only, resume, extend = options.config, options.only, options.resume, options.extend
    computing = options.folder is not None or options.jobs or options.scheduler or resume or extend
    if options.report is not None:
        if computing or config is not None or only is not None or options.allow_code:
            raise typer.BadParameter("--report only reads the folder that it names; omit the other options")
        _report_so_far(options.report, options.tables)
        raise typer.Exit(AGREED)
    if options.tables is not None:
        raise typer.BadParameter("--tables writes what --report shows; name the folder of a study by --report")
    if config is None:
        raise typer.BadParameter("name a configuration by --config, or the folder of a study by --report")
    if only is not None and computing:
        raise typer.BadParameter("--only computes one run and writes nothing; omit the other options beside --config")
    study = read_configuration(config, allow_code=options.allow_code)
    refuse_unfit(study)  # before any code of others runs
    if only is not None:
        _refuse_unknown(
            study, only, [f"{scenario.name}:{k}" for scenario in study.scenarios for k in range(study.runs)]
        )
        _check_own(study)
        _show(study, only)
        raise typer.Exit(AGREED)
    folder = options.folder or Path(Path(config).stem)
    if study.own_methods or study.own_laws:
        own_process.enter(f"code {', '.join((*study.own_methods, *study.own_laws))}")
    if study.scenarios:
        _tell_few_runs(study)
    workers, shown = options.workers, _Shown()
    try:
        steps = len(study.recordings) + study.runs * len(study.scenarios)
        with progress("study", steps) as advance:
            shown.advance = advance
            run_study(
                study,
                folder,
                workers,
                resume=resume,
                extend=extend,
                versions={**versions(), **computing_versions(LIBRARIES)},
                progress=shown,
                tell=lambda line: say(line, "yellow"),
                before=lambda: _check_own(study),
                first=lambda: identify_recordings(study, folder, advance, allow_code=options.allow_code),
            )
    except (KeyboardInterrupt, Ended):
        kept = f"{shown.done} of {shown.total} runs are" if shown.total else "what is done is"
        say(f"interrupted: {kept} kept in {folder}; go on with --resume", "yellow")
        raise
    _report(study, config, folder)
    raise typer.Exit(AGREED)


def _tell_few_runs(study: Configuration) -> None:
    """Say before the work begins if nothing can be decided after it."""
    from crosscheck.study.settings.configuration import torque_methods
    from crosscheck.study.statistics.comparison import pair_count
    from crosscheck.study.statistics.signed_ranks import fewest_runs

    pairs = pair_count(len(torque_methods(study)), study.design)
    fewest = fewest_runs(pairs) if pairs else 0
    if study.runs < fewest:
        said = f"{counted(study.runs, 'run')} cannot decide {counted(pairs, 'comparison')}, however clear they are"
        say(f"{said}: give {fewest} runs or more, or fewer methods; errors are shown all the same", "yellow")


def _report(study: Configuration, config: str, folder: Path) -> None:
    """Print it, and write study.html and study.json. Raises OSError."""
    from crosscheck.study.statistics.outcomes import read_outcomes

    robots = ", ".join(robot.name for robot in study.robots)
    simulated = [("robot", robots), ("seed", str(study.seed))] if study.robots else []
    facts = [("configuration", study.file), *simulated]
    labels = [recording.label for recording in study.recordings]
    _deliver(folder, read_outcomes(folder), facts, config, study.design, labels)


def _report_so_far(folder: Path, tables: Path | None) -> None:
    """The same of a study that need not be finished. tables: folder for a paper. Raises InvalidInput, OSError."""
    from crosscheck.study.so_far import read_so_far

    found = read_so_far(folder)
    _deliver(folder, found.outcomes, found.facts, None, found.design, found.recordings, tables)


def _deliver(
    folder: Path,
    outcomes: StudyOutcomes,
    facts: Sequence[tuple[str, str]],
    config: str | None,
    design: StudyDesign,
    labels: Sequence[str],
    tables: Path | None = None,
) -> None:
    """config: for commands that repeat a run; None for that of the folder; labels: of the recordings"""
    from crosscheck.commands.study.recordings import read_recordings
    from crosscheck.commands.study.report import study_report
    from crosscheck.study.inputs import read_inputs

    page, numbers = (OutputFile(str(folder / name)) for name in ("study.html", "study.json"))
    recorded, inputs = read_recordings(folder, labels), read_inputs(folder)

    def repeat(scenario: str, run: int) -> list[str]:
        allowed = ["--allow-code"] if inputs.has_code else []
        return ["graphdyn", "study", "--config", config or inputs.origin, *allowed, "--only", f"{scenario}:{run}"]

    with warnings_shown():
        report = study_report(outcomes, facts, repeat, design, inputs, recorded)
    if tables is not None:
        from crosscheck.commands.study.paper_files import write_paper_files
        from crosscheck.study.statistics.summary import summarized

        written = write_paper_files(summarized(outcomes, design), recorded, report, tables)
        say(f"{counted(len(written), 'file')} for a paper in {tables}: {', '.join(written)}")
    deliver(report, ReportOptions(html_file=page, json_file=numbers))


def _check_own(study: Configuration) -> None:
    """Raises typer.BadParameter for an own method, motion or law of noise that cannot be used."""
    from crosscheck.commands.identify.models import OF_A_METHOD, made
    from crosscheck.commands.program.functions import user_function

    for law in study.own_laws:
        user_function(f"{study.file}: scenarios:", law)
    for method in study.own_methods:
        made(f"{study.file}: methods:", method, *OF_A_METHOD)


class _Shown:
    """Progress as a bar, with the time that is left."""

    def __init__(self) -> None:
        self.done = self.total = 0
        self.advance: Advance = lambda what, steps: None

    def __call__(self, now: Progress) -> None:
        what = "" if now.remaining is None else f"about {_in_words(now.remaining)} left"
        self.advance(what, now.done - self.done)
        self.done, self.total = now.done, now.total


def _in_words(seconds: float) -> str:
    """The time in the unit that people would say."""
    for size, unit in ((3600, "h"), (60, "min")):
        if seconds >= 1.5 * size:
            return f"{seconds / size:.0f} {unit}"
    return f"{seconds:.0f} s"


def _show(study: Configuration, only: str) -> None:
    """The results of one run. Raises typer.BadParameter for one that the study does not have."""
    from crosscheck.commands.study.report import study_run_report
    from crosscheck.study.running import tasks_of
    from crosscheck.study.tasks import compute

    known = {f"{task.scenario.name}:{task.run}": task for task in tasks_of(study)}
    _refuse_unknown(study, only, known)
    task = known[only]
    deliver(study_run_report(task, compute(study, task)))


def _refuse_unknown(study: Configuration, only: str, known: Iterable[str]) -> None:
    if only not in known:
        some = [*known][:3]
        there = f"it has {', '.join(some)}, …" if some else "it simulates nothing"
        raise typer.BadParameter(f"--only {only}: {study.file} has no such run; {there}")
