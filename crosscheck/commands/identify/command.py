"""`graphdyn identify`: from recordings and a URDF to a model that predicts."""

from __future__ import annotations

import glob
from collections.abc import Mapping, Sequence
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import typer
from rich.text import Text

from crosscheck.commands.identify.long_logs import are_long
from crosscheck.commands.identify.models import method_shown, methods_of, scaled_torques
from crosscheck.commands.identify.options import IdentifyOptions
from crosscheck.commands.identify.rehearsal.command import rehearsed
from crosscheck.commands.program.console import out, progress, say, warnings_shown
from crosscheck.commands.program.delivery import deliver, recorded
from crosscheck.commands.program.exits import AGREED, DISAGREED, Command
from crosscheck.commands.program.options import EXAMPLES
from crosscheck.commands.program.reading_options import reading_arguments
from crosscheck.commands.program.recording_options import naming_recording_command, show_findings
from crosscheck.report.plain_text import printable
from graphdyn.errors import counted

if TYPE_CHECKING:
    from crosscheck.distributing import Workers
    from crosscheck.identifying import CandidateModel, Identified, Preparation
    from graphdyn.identification import ClosedLoop, MethodResult, PhysicalLimits
    from urdf import Finding, Reading

DEFAULT_ROBOT = "ur5"
"""The robot that `graphdyn identify` without arguments simulates."""

EPILOG = f"""{EXAMPLES}  graphdyn identify --robot ur5 --methods wls,consistent,graph
  graphdyn identify --rehearse motion.csv --robot arm.urdf --torque-noise 0.03 --html rehearsal.html
  graphdyn identify log.csv --robot arm.urdf --cutoff 8 --html found.html --urdf better.urdf
  graphdyn identify a.csv b.csv --validate c.csv --robot arm.urdf --mapping columns.toml --methods all
  graphdyn identify a.csv --robot arm.urdf --models drives.toml --folds 10 --validate b.csv --json rows.json
  graphdyn identify log.csv --robot arm.urdf --currents payload=4:weight.csv --write-gains gains.toml
  graphdyn identify 'fleet/*.parquet' --robot arm.urdf --cutoff 10 --scheduler tcp://10.0.0.1:8786
  graphdyn identify pos.csv cur.csv --mapping tx40.toml --robot tx40.urdf --cutoff 20 --decimate 10,10 --split 0:6 6:9
"""


class IdentifyCommand(Command):
    """The command, which takes a word in place of the three numbers of gravity."""

    def parse_args(self, ctx: Any, args: list[str]) -> Any:
        """The parameters; --gravity free is --free-gravity."""
        for k, pair in enumerate(pairwise(args)):
            if pair == ("--gravity", "free"):
                args = [*args[:k], "--free-gravity", *args[k + 2 :]]
                break
        return super().parse_args(ctx, args)


def run(options: IdentifyOptions) -> None:
    """Find a robot's parameters from recordings.

    Which ones do they determine, how well does each method predict, and which model can be trusted? Methods stand side
    by side with their errors on rows that they have not seen: over all rows, and per joint over those with |v| > 0.02,
    because at standstill friction is undetermined. The recommended one has real bodies, a positive definite mass
    matrix and the smallest held-out error, or is simpler and as good. The links of CAD with fitted drives are always
    among the rows. Without --terms and --models the recording chooses the terms of the drives, step by step, by the
    error of folds; --terms given several times, or --models, compares several torque models. By default the last
    quarter is held out. Without a LOG the robot is simulated with friction, noise and wrong CAD values, and the truth
    is shown.

    Before any fit the recording is examined: the mounting of the robot, signs, exchanged columns, units, zeros, gear
    ratios, delays, the clock, what changed in between. Each finding comes with lines for --mapping or an option.
    Nothing is recommended from a recording with a fault, nor a model that predicts some joint badly, or worse than CAD
    with fitted drives.

    With --currents the LOGs hold motor currents. Their gains are found first, with standard deviations, and convert
    them to torques. What nothing fixes is refused: a gain scales together with all links that its joint moves.

    With --jobs or --scheduler the LOGs may have any length, and are read part by part. Each is a Parquet file, which is
    a log of its own, or a folder, which is one log in Parquet files that follow each other without a gap, in the order
    of the numbers in their names. Filters run across the parts of a log, never from one log into another.

    With --rehearse a planned motion is simulated for robots that differ from the file, with friction and noise of
    stated sizes, and each recording is identified. The report says within which σ links and base parameters will be
    found, before the robot moves.

    Exit code 0: a usable model was found, or the rehearsed motion determines all that any motion could; 1: not so, and
    why; 2: bad input.
    """
    robot = options.robot or DEFAULT_ROBOT
    if options.rehearse is not None:
        rehearsed(options, robot)
    in_parts = options.in_parts or are_long(options)
    models = options.candidates(methods_of(options.methods, of_sums=in_parts, wrenches=not options.logs))
    preparation, loop = options.preparation, options.loop
    from crosscheck.commands.identify.reports.report import identify_report

    with warnings_shown():
        way = simulated if not options.logs else from_parts if in_parts else from_recordings
        found = way(options, robot, Asked(models, preparation, options.poses, loop, options.limits))
    shown = found.shown(None if options.choose is None else method_shown(options.choose))
    deliver(identify_report(found, shown), options, lambda: [recorded(found)])
    if options.urdf_file is not None and not written(found, shown, robot, options.urdf_file.path, options):
        raise typer.Exit(DISAGREED)
    raise typer.Exit(AGREED if found.usable else DISAGREED)


class Asked(NamedTuple):
    """What crosscheck.identify is asked for, whatever the recordings."""

    models: Sequence[CandidateModel]
    preparation: Preparation
    poses: int
    loop: ClosedLoop | None
    limits: PhysicalLimits


def from_recordings(options: IdentifyOptions, robot: str, asked: Asked) -> Identified:
    """The LOGs, each in memory."""
    import urdf
    from crosscheck.identifying import as_torques, friction_terms, identify
    from crosscheck.identifying.identify import number_of_steps
    from crosscheck.identifying.methods.torque_terms import STANDARD_TERM_NAMES

    logs, validate, reading = options.logs or [], options.validate or [], options.reading
    joints = urdf.load(robot, reading=reading).independent_joints
    with_load = [] if options.loaded is None else [options.loaded[1]]
    paths = {"LOG": logs, "--validate": validate, "--currents": with_load}
    with progress("read", sum(map(len, paths.values()))) as advance:
        named, currents = ("--robot", robot, *reading_arguments(options)), bool(options.currents)
        recordings, unseen, loaded = (
            options.recordings(option, given, joints, advance, named, options.rate, currents=currents)
            for option, given in paths.items()
        )
    show_findings(finding for recording in [*recordings, *unseen, *loaded] for finding in recording.findings)
    found = None
    if options.currents:
        terms = (*friction_terms(STANDARD_TERM_NAMES), *scaled_torques(options.scaled_torque))
        found = options.gains(robot, recordings, loaded, terms=terms, preparation=asked.preparation, reading=reading)
        recordings, unseen = ([as_torques(recording, found) for recording in group] for group in (recordings, unseen))
    held_out = options.held_out(unseen)
    with progress("identify", number_of_steps(asked.models, held_out)) as advance:
        result = identify(
            robot,
            recordings,
            held_out=held_out,
            free_gravity=options.free_gravity,
            progress=advance,
            reading=reading,
            **asked._asdict(),
        )
    return replace(result, currents=found)


def from_parts(options: IdentifyOptions, robot: str, asked: Asked) -> Identified:
    """The LOGs, read part by part."""
    from crosscheck.identifying import identify
    from crosscheck.recordings import PartitionedRecording

    with kept_workers(options) as workers, progress("rows") as advance:

        def recording(paths: Sequence[Path], cutoff: float | Mapping[str, float] | None) -> PartitionedRecording:
            names = _expanded(paths)
            return PartitionedRecording(names, options.mapping, None, options.rate, cutoff, workers=workers)

        named = ("--robot", robot, *reading_arguments(options))
        with naming_recording_command(options.logs or [], named, options.mapping):
            cutoff = asked.preparation.cutoff
            if isinstance(cutoff, str):
                cutoff = recording(options.logs or [], None).residual_cutoff()
                asked = asked._replace(preparation=replace(asked.preparation, cutoff=cutoff))
            found = identify(
                robot,
                recording(options.logs or [], cutoff),
                held_out=recording(options.validate, cutoff) if options.validate else None,
                progress=advance,
                reading=options.reading,
                **asked._asdict(),
            )
    read = [*found.recordings, *(trial.test for trial in found.division.trials)]
    every = [finding for recording in read for finding in recording.findings]
    once = {(finding.code, finding.message): finding for finding in reversed(every)}  # the same is said of many logs
    show_findings(reversed(once.values()))
    return found


def kept_workers(options: IdentifyOptions) -> AbstractContextManager[Workers | None]:
    """The processes or the scheduler that were asked for; nothing where the LOGs are only long."""
    return options.workers.kept() if options.in_parts else nullcontext()


def _expanded(paths: Sequence[Path]) -> list[str]:
    """The arguments with patterns, which a shell leaves in quotation marks as they are, replaced by what they match."""
    expanded = list[str]()
    for path in paths:
        matching = [] if path.exists() else sorted(glob.glob(str(path)))
        expanded += matching or [str(path)]  # what is not there is refused by name
    return expanded


def simulated(options: IdentifyOptions, robot: str, asked: Asked) -> Identified:
    """A virtual robot recorded and identified; the truth goes with the result. The first model is the true one."""
    from crosscheck.identifying import OtherRecordings, identify, virtual_robot
    from crosscheck.identifying.identify import number_of_steps
    from graphdyn.identification.terms import RigidBodies

    with progress("simulate", 2) as advance:
        virtual = virtual_robot(
            robot,
            [term for term in asked.models[0].terms if not isinstance(term, RigidBodies)],
            seconds=20.0 if options.seconds is None else options.seconds,
            seed=options.seed or 0,
            progress=lambda what: advance(what, 1),
            reading=options.reading,
        )
    held_out = OtherRecordings((virtual.held_out,))
    with progress("identify", number_of_steps(asked.models, held_out)) as advance:
        found = identify(virtual.subject.model, virtual.fitted, held_out=held_out, progress=advance, **asked._asdict())
    return replace(found, subject=virtual.subject, truth=virtual.truth)


def written(found: Identified, shown: MethodResult | None, robot: str, path: Path, options: IdentifyOptions) -> bool:
    """The shown result in a copy of the user's file; False, saying why, where it cannot be trusted."""
    if found.recommendation.rejection_reasons and options.choose is None:
        say(f"{path} is not written: no model is recommended; --choose METHOD writes one all the same", "red")
        return False
    if shown is None:
        return False
    import urdf
    from crosscheck.identifying.results.link_findings import link_findings
    from crosscheck.identifying.results.recommending import real

    model = found.model_of(shown)
    name = model.row_name(shown)
    if name != found.recommendation.name and not real(shown):
        say(f"{path} is not written: {name} is not physically consistent", "red")
        return False
    update = urdf.update(robot, path, model.body_parameters(shown), reading=options.reading)
    for line in (f"{path}: {counted(len(update.changed), 'link')} with the inertials of {name}", *update.notes):
        out.print(Text(printable(line)), soft_wrap=True)
    for each in link_findings(found, shown):
        say(f"{each.message}; {each.remedy}", "yellow")
    for finding in new_warnings(robot, path, options.reading):
        say(f"inspect warns of {path}, and did not of {robot}: {finding.text}", "yellow")
    return True


def new_warnings(robot: str, path: Path, reading: Reading) -> list[Finding]:
    """Warnings and errors about a written file that its original has not."""
    import urdf

    known = {(finding.code, finding.element) for finding in urdf.inspect(robot, reading=reading).findings}
    return [
        finding
        for finding in urdf.inspect(path, reading=reading).findings
        if finding.severity != "note" and (finding.code, finding.element) not in known
    ]
