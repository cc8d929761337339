"""`graphdyn identify`: from recordings and a URDF to a model that predicts."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer
from rich.text import Text

from crosscheck.commands.identify import loop_options, options
from crosscheck.commands.identify import parts as identify_parts
from crosscheck.commands.identify.model_file import models_of
from crosscheck.commands.identify.models import (
    candidate_models,
    known_torques,
    method_shown,
    methods_of,
    payload_of,
    scaled_torques,
)
from crosscheck.commands.program.console import out, progress, say, warnings_shown
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, DISAGREED
from crosscheck.commands.program.options import (
    EXAMPLES,
    ChainOption,
    HtmlOption,
    JsonOption,
    LockOption,
    SchedulerOption,
    locked_joints,
    workers_of,
)
from crosscheck.commands.program.three_d import ThreeDOption, recorded, refuse_without_page
from crosscheck.report.plain_text import printable

if TYPE_CHECKING:
    import urdf
    from crosscheck.identifying import CandidateModel, Identified, Preparation
    from crosscheck.recordings import Recording
    from crosscheck.recordings.errors import RecordingFinding
    from graphdyn import RobotModel
    from graphdyn.identification import MethodResult

DEFAULT_ROBOT = "ur5"
"""The robot that `graphdyn identify` without arguments simulates."""

EPILOG = f"""{EXAMPLES}  graphdyn identify --robot ur5 --methods wls,consistent,graph
  graphdyn identify log.csv --robot arm.urdf --cutoff 8 --html found.html --urdf better.urdf
  graphdyn identify a.csv b.csv --validate c.csv --robot arm.urdf --mapping columns.toml --methods all
  graphdyn identify a.csv --robot arm.urdf --models drives.toml --folds 10 --validate b.csv --json rows.json
  graphdyn identify 'fleet/*.parquet' --robot arm.urdf --cutoff 10 --scheduler tcp://10.0.0.1:8786
  graphdyn identify pos.csv cur.csv --mapping tx40.toml --robot tx40.urdf --cutoff 20 --decimate 10,10 --split 0:6 6:9
"""


def run(
    logs: options.LogsArgument = None,
    robot: options.RobotOption = None,
    mapping: options.MappingOption = None,
    rate: options.RateOption = None,
    drop: options.DropOption = None,
    cutoff: options.CutoffOption = "residual",
    derive_velocity: options.DerivedOption = False,
    decimate: options.DecimateOption = None,
    min_speed: options.MinSpeedOption = "0",
    terms: options.TermsOption = None,
    models: options.ModelsOption = None,
    width: options.WidthOption = None,
    stribeck_velocity: options.StribeckOption = None,
    stribeck_exponent: options.StribeckExponentOption = None,
    term: options.TermOption = None,
    known_torque: options.KnownTorqueOption = None,
    scaled_torque: options.ScaledTorqueOption = None,
    known_bodies: options.KnownBodiesOption = False,
    payload: options.PayloadOption = None,
    payload_on: options.PayloadLinkOption = None,
    methods: options.MethodsOption = None,
    controller: loop_options.ControllerOption = None,
    control_rate: loop_options.ControlRateOption = None,
    torque_hold: loop_options.TorqueHoldOption = 0.0,
    validate: options.ValidateOption = None,
    split: options.SplitOption = None,
    split_rows: options.SplitRowsOption = None,
    folds: options.FoldsOption = None,
    choose: options.ChooseOption = None,
    poses: options.PosesOption = 10_000,
    seconds: options.SecondsOption = None,
    seed: options.SimulationSeedOption = None,
    lock: LockOption = None,
    chain: ChainOption = None,
    gravity: options.GravityOption = None,
    urdf_file: options.UrdfOption = None,
    json_file: JsonOption = None,
    html_file: HtmlOption = None,
    three_d: ThreeDOption = False,
    jobs: identify_parts.JobsOption = None,
    scheduler: SchedulerOption = None,
) -> None:
    """Find a robot's parameters from recordings.

    Which ones do they determine, how well does each method predict, and which model can be trusted? Methods stand side
    by side with their errors on rows that they have not seen: over all rows, and per joint over those with |v| > 0.02,
    because at standstill friction is undetermined. The recommended one has real bodies, a positive definite mass
    matrix and the smallest held-out error, or is simpler and as good. The links of CAD with fitted drives are always
    among the rows; --terms given several times, or --models, compares several torque models. Held out is the last
    quarter unless told otherwise. Without a LOG the robot is simulated with friction, noise and wrong CAD values, and
    the truth is shown.

    Before any fit the recording is examined: reversed signs, exchanged columns, degrees, zeros, units, delays. Each
    finding comes with lines for --mapping. Nothing is recommended from a recording with a fault, nor a model that
    predicts some joint badly, or worse than CAD with fitted drives.

    With --jobs or --scheduler the LOGs may have any length, and are read part by part. Each is a Parquet file, which is
    a log of its own, or a folder, which is one log in Parquet files that follow each other without a gap, in the order
    of the numbers in their names. Filters run across the parts of a log, never from one log into another.

    Exit code 0: a usable model was found; 1: none was, and why; 2: bad input.
    """
    if robot is None and logs:
        raise typer.BadParameter("--robot is missing; give a name (`graphdyn robots`) or a URDF file")
    import urdf

    robot = robot or DEFAULT_ROBOT
    refuse_without_page(three_d, html_file)
    if urdf_file is not None and urdf_file.is_standard_output:
        raise typer.BadParameter("--urdf: name a file; only --json and --html can go to standard output")
    if not logs:
        options.refuse_without_log(
            validate=validate, split=split, split_rows=split_rows, folds=folds, mapping=mapping, rate=rate, drop=drop,
            known_torque=known_torque, known_bodies=known_bodies, payload=payload, payload_on=payload_on, models=models,
            controller=controller, control_rate=control_rate, torque_hold=torque_hold,
        )  # fmt: skip
    in_parts = bool(jobs or scheduler)
    if in_parts:
        identify_parts.refuse(
            logs, cutoff,
            drop=drop, derive_velocity=derive_velocity, decimate=decimate, split=split, split_rows=split_rows,
            folds=folds, controller=controller, control_rate=control_rate, torque_hold=torque_hold,
        )  # fmt: skip
    reading = urdf.Reading(lock=locked_joints(lock) or None, chain=chain, gravity=gravity)
    load, known_load = payload_of(payload, payload_on)
    load += scaled_torques(scaled_torque)
    ways, known = (
        identify_parts.methods(methods) if in_parts else methods_of(methods),
        (*known_torques(known_torque), *known_load),
    )
    if models is None:
        stribeck = (stribeck_velocity, stribeck_exponent)
        compared = candidate_models(terms, width, stribeck, term, ways, load, known, known_bodies)
    else:
        options.refuse_beside_models(
            terms=terms,
            width=width,
            stribeck_velocity=stribeck_velocity,
            stribeck_exponent=stribeck_exponent,
            term=term,
        )
        compared = models_of(models, ways, load, known, known_bodies)
    preparation = prepared_as(cutoff, derive_velocity, decimate, min_speed, torque_hold)
    loop = loop_options.loop_of(controller, control_rate)
    from crosscheck.commands.identify.report import identify_report
    from crosscheck.report.report import with_stage

    if logs:
        options.refuse_with_log(seconds=seconds, seed=seed)
    if logs and in_parts:
        with warnings_shown(), workers_of(jobs, scheduler).kept() as workers:
            found = identify_parts.found(
                robot,
                logs,
                validate,
                compared,
                preparation,
                mapping,
                rate,
                workers,
                reading=reading,
                poses=poses,
            )
            show_findings(identify_parts.findings(found))
    elif logs:
        with warnings_shown():
            joints = urdf.load(robot, reading=reading).independent_joints
            with progress("read", len(logs) + len(validate or [])) as advance:
                columns = (mapping, joints, rate, drop or [], advance)
                recordings = options.recordings("LOG", logs, *columns)
                unseen = options.recordings("--validate", validate or [], *columns)
            show_findings(finding for recording in [*recordings, *unseen] for finding in recording.findings)
            found = from_records(
                robot,
                recordings,
                reading,
                models=compared,
                preparation=preparation,
                held_out=options.held_out_of(unseen, split, split_rows, folds),
                loop=loop,
                poses=poses,
            )
    else:
        with warnings_shown():
            how_long, which = 20.0 if seconds is None else seconds, seed or 0
            found = simulated(robot, compared, reading, how_long, which, preparation=preparation, poses=poses)
    shown = found.shown(None if choose is None else method_shown(choose))
    report = identify_report(found, shown)
    if three_d:
        report = with_stage(report, [recorded(found)])
    deliver(report, html_file, json_file)
    if urdf_file is not None:
        doubted = bool(found.recommendation.doubts) and choose is None
        if doubted:
            say(
                f"{urdf_file.path} is not written: no model is recommended; --choose METHOD writes one all the same",
                "red",
            )
        written = shown is not None and not doubted and write_urdf(found, shown, robot, urdf_file.path, reading)
        if not written:
            raise typer.Exit(DISAGREED)
    raise typer.Exit(AGREED if found.usable else DISAGREED)


def prepared_as(
    cutoff: str, derive_velocity: bool, decimate: str | None, min_speed: str, torque_hold: float
) -> Preparation:
    """The options as one object. Raises typer.BadParameter."""
    from crosscheck.identifying import Preparation

    if not (0 <= torque_hold < float("inf")):
        raise typer.BadParameter(f"--torque-hold {torque_hold:g}: give seconds, 0 for none")
    speeds = options.numbers("--min-speed", min_speed)
    return Preparation(
        options.cutoff_of(cutoff),
        "derived" if derive_velocity else "recorded",
        options.stages(decimate),
        torque_hold,
        speeds if len(speeds) > 1 else speeds[0],
    )


def show_findings(findings: Iterable[RecordingFinding]) -> None:
    """What is odd in the files, one line each."""
    for finding in findings:
        say(f"{finding.severity}: {finding.text}", "yellow" if finding.severity != "note" else None)


def from_records(
    robot: str | RobotModel,
    recordings: Sequence[Recording],
    reading: urdf.Reading,
    **how: Any,
) -> Identified:
    """crosscheck.identify with a bar."""
    from crosscheck.identifying import identify
    from crosscheck.identifying.identify import number_of_steps

    with progress("identify", number_of_steps(how["models"], how["held_out"])) as advance:
        return identify(
            robot,
            recordings,
            reading=reading,
            progress=lambda what: advance(what, 1),
            **how,
        )


def simulated(
    robot: str, compared: Sequence[CandidateModel], reading: urdf.Reading, seconds: float, seed: int, **how: Any
) -> Identified:
    """A virtual robot recorded and identified; the truth goes with the result. The first model is the true one."""
    import urdf
    from crosscheck.identifying import OtherRecordings, virtual_robot
    from graphdyn.identification.terms import RigidBodies

    with progress("simulate", 2) as advance:
        virtual = virtual_robot(
            robot,
            [term for term in compared[0].terms if not isinstance(term, RigidBodies)],
            seconds=seconds,
            seed=seed,
            reading=reading,
            progress=lambda what: advance(what, 1),
        )
    found = from_records(
        virtual.subject.model,
        [virtual.fitted],
        urdf.Reading(),
        models=compared,
        held_out=OtherRecordings((virtual.held_out,)),
        **how,
    )
    return replace(found, subject=virtual.subject, truth=virtual.truth)


def write_urdf(found: Identified, shown: MethodResult, robot: str, path: Path, reading: urdf.Reading) -> bool:
    """The shown result in a copy of the user's file; False, saying why, where it cannot be trusted."""
    import urdf
    from crosscheck.identifying.results.recommending import real

    model = found.model_of(shown)
    name = model.row_name(shown)
    if name != found.recommendation.name and not real(shown):
        say(f"{path} is not written: {name} is not physically consistent", "red")
        return False
    update = urdf.update(robot, path, model.body_parameters(shown), reading=reading)
    for line in (f"{path}: {len(update.changed)} links with the inertials of {name}", *update.notes):
        out.print(Text(printable(line)), soft_wrap=True)
    return True
