"""Options of `graphdyn identify`: control loop, torque model, preparation, rows to predict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

import typer

from crosscheck.commands.identify.currents_option import CurrentsOptions
from crosscheck.commands.identify.models import (
    DEFAULT_TERMS,
    FUNCTION_FORM,
    drives_of,
    known_torques,
    links,
    models_of,
    payload_of,
    scaled_torques,
)
from crosscheck.commands.identify.rehearsal_options import CONDITION_OPTIONS, OF_RECORDINGS, RehearsalOptions
from crosscheck.commands.program.functions import user_function
from crosscheck.commands.program.options import CodeOptions, PageOptions, WorkerOptions, robot_names
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.program.reading_options import ReadingOptions
from crosscheck.commands.program.recording_options import RecordingOptions, numbers
from crosscheck.commands.program.settings import refuse

if TYPE_CHECKING:
    from crosscheck.identifying import CandidateModel, HeldOut, Preparation
    from crosscheck.recordings import Recording
    from graphdyn.identification import ClosedLoop, Estimator, PhysicalLimits


@dataclass(frozen=True, kw_only=True)
class LoopOptions:
    """The controller of the recordings."""

    PANEL: ClassVar[str] = "Control loop of the recordings, for iv, didim, cloe and clie"

    controller: Annotated[
        str | None,
        typer.Option(
            metavar="FILE.py:NAME",
            help="A function without arguments that makes the PDControl or ComputedTorqueControl of the recording, its "
            "target over the time of the LOG; or a control law (t, q, v) → τ.",
        ),
    ] = None
    control_rate: Annotated[
        float | None, typer.Option(metavar="HZ", help="Rate of the controller; its torque is held in between.")
    ] = None

    @property
    def loop(self) -> ClosedLoop | None:
        """Raises typer.BadParameter for a rate that is none, or has no controller, and for other answers."""
        from inspect import signature

        from graphdyn import ComputedTorqueControl, PDControl
        from graphdyn.identification import ClosedLoop

        text, rate = self.controller, self.control_rate
        if rate is not None and (text is None or not rate > 0):
            raise typer.BadParameter(f"--control-rate {rate:g}: give Hz above zero, and a --controller")
        if text is None:
            return None
        function: Any = user_function("--controller", text)
        period = None if rate is None else 1 / rate
        if len(signature(function).parameters) > 0:
            return ClosedLoop(function, period=period)
        controller = function()
        if not isinstance(controller, PDControl | ComputedTorqueControl):
            raise typer.BadParameter(
                f"--controller {text} makes a {type(controller).__name__}; a PDControl or ComputedTorqueControl is "
                "needed, or a control law with the arguments t, q and v"
            )
        return ClosedLoop(controller if period is None else replace(controller, period=period))


@dataclass(frozen=True, kw_only=True)
class TorqueOptions(CodeOptions):
    """What makes up the torque."""

    PANEL: ClassVar[str] = "Torque model"

    terms: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME,…",
            rich_help_panel="Options",
            show_default="those that predict best",
            help="Terms of the drives: viscous, coulomb, stribeck, load, smooth-coulomb, offset, rotor, "
            "asymmetric-viscous, asymmetric-coulomb, coupled-wrist, slip, spring, or none; NAME*time and "
            "NAME*temperature for terms that drift. Repeatable: torque models to compare.",
        ),
    ] = None
    models: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="TOML file of torque models to compare (docs/identification.md), instead of --terms.",
        ),
    ] = None
    width: Annotated[
        str | None,
        typer.Option(metavar="X|X,X,…", help="Use tanh(v/X) instead of the sign of v in friction [rad/s or m/s]."),
    ] = None
    stribeck_velocity: Annotated[
        str | None,
        typer.Option(
            metavar="X|X,X,…", show_default="0.1", help="Speed V at which Stribeck friction fades [rad/s, m/s]."
        ),
    ] = None
    stribeck_exponent: Annotated[
        str | None,
        typer.Option(metavar="X|X,X,…", show_default="2", help="Stribeck friction fades as exp(-|v/V|^X)."),
    ] = None
    term: Annotated[
        list[str] | None,
        typer.Option(
            metavar=FUNCTION_FORM, help="A function without arguments that returns a further term. Repeatable."
        ),
    ] = None
    known_torque: Annotated[
        list[str] | None,
        typer.Option(metavar=FUNCTION_FORM, help="(q, v, a) → known torque (N, n), which is subtracted. Repeatable."),
    ] = None
    scaled_torque: Annotated[
        list[str] | None,
        typer.Option(
            metavar=FUNCTION_FORM, help="The same with an unknown factor: springs, counterbalances. Repeatable."
        ),
    ] = None
    known_bodies: Annotated[
        bool, typer.Option("--known-bodies", help="Keep the links of the URDF; identify drives and payload only.")
    ] = False
    payload: Annotated[
        str | None,
        typer.Option(
            metavar="unknown|unknown@X,Y,Z|M@X,Y,Z",
            help="Load on the last link: ten unknowns, an unknown mass with known center, or a known point mass.",
        ),
    ] = None
    payload_on: Annotated[str | None, typer.Option(metavar="LINK", help="Link that carries the payload.")] = None
    angles_as_written: Annotated[
        bool,
        typer.Option("--angles-as-written", help="Keep parameters that only rounded angles show (1.5708 for π/2)."),
    ] = False

    def candidates(self, methods: Sequence[str | Estimator]) -> list[CandidateModel]:
        """One torque model for every --terms, or those of --models. Raises InvalidInput and typer.BadParameter.

        methods: of the models that do not say
        """
        return [replace(each, exact_angles=not self.angles_as_written) for each in self._candidates(methods)]

    def _candidates(self, methods: Sequence[str | Estimator]) -> list[CandidateModel]:
        from crosscheck.identifying import CandidateModel

        load, known_load = payload_of(self.payload, self.payload_on)
        load += scaled_torques(self.scaled_torque)
        known = (*known_torques(self.known_torque), *known_load)
        if self.models is not None:
            models = self.models, methods, load, known
            return models_of(*models, known_bodies=self.known_bodies, allow_code=self.allow_code)
        if self.allow_code:
            raise typer.BadParameter("--allow-code is for --models FILE; code of the command line runs without it")
        bodies, known_links = links(self.known_bodies)
        if self._drives_chosen:
            [own] = drives_of(["none"], None, (None, None), self.term)
            terms, subtracted = (*bodies, *load, *own), (*known_links, *known)
            return [CandidateModel("", terms, subtracted, methods, choose_drives=True)]
        given = list(self.terms or [DEFAULT_TERMS])
        drives = drives_of(given, self.width, (self.stribeck_velocity, self.stribeck_exponent), self.term)
        names = given if len(given) > 1 else [""]
        return [
            CandidateModel(name, (*bodies, *load, *own), (*known_links, *known), methods)
            for name, own in zip(names, drives, strict=True)
        ]

    @property
    def _drives_chosen(self) -> bool:
        """Whether the recording chooses the terms of the drives: no option says anything of them."""
        settings = (self.terms, self.models, self.width, self.stribeck_velocity, self.stribeck_exponent)
        return all(setting is None for setting in settings)


RESULT_PANEL = "Recommended model"


@dataclass(frozen=True, kw_only=True)
class PreparationOptions(RecordingOptions):
    """Which rows are fitted, and how they are filtered."""

    PANEL: ClassVar[str] = "Preparing the recordings"

    derive_velocity: Annotated[
        bool, typer.Option("--derive-velocity", help="Differentiate q even if v was recorded.")
    ] = False
    decimate: Annotated[
        str | None, typer.Option(metavar="K,K,…", help="Lower the rate in these stages, torque and regressor alike.")
    ] = None
    min_speed: Annotated[
        str, typer.Option(metavar="X|X,X,…", help="Do not fit rows of a joint slower than this [rad/s or m/s].")
    ] = "0"
    torque_hold: Annotated[
        float,
        typer.Option(metavar="S", help="Time for which a recorded torque was held [s]; it counts at its middle."),
    ] = 0.0

    @property
    def preparation(self) -> Preparation:
        """Raises typer.BadParameter."""
        from crosscheck.identifying import Preparation

        if not (0 <= self.torque_hold < float("inf")):
            raise typer.BadParameter(f"--torque-hold {self.torque_hold:g}: give seconds, 0 for none")
        speeds = numbers("--min-speed", self.min_speed)
        return Preparation(
            self.low_pass,
            "derived" if self.derive_velocity else "recorded",
            self._stages,
            self.torque_hold,
            speeds if len(speeds) > 1 else speeds[0],
        )

    @property
    def _stages(self) -> tuple[int, ...]:
        if self.decimate is None:
            return ()
        return tuple(map(int, numbers("--decimate", self.decimate, whole=True)))


@dataclass(frozen=True, kw_only=True)
class HeldOutOptions:
    """The rows that are predicted."""

    PANEL: ClassVar[str] = "Rows to predict (by default the last quarter of every LOG)"

    validate: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="LOG",
            rich_help_panel="Options",
            help="Predict this recording; it is not fitted. Repeatable.",
        ),
    ] = None
    split: Annotated[
        tuple[str, str] | None,
        typer.Option(metavar="FIT PREDICT", help="Seconds of one recording, such as 0:6 6:9."),
    ] = None
    split_rows: Annotated[
        tuple[str, str] | None,
        typer.Option(metavar="FIT PREDICT", help="Rows of one recording, such as 60:1700 1750:2400."),
    ] = None
    folds: Annotated[
        int | None,
        typer.Option(
            min=2,
            metavar="N",
            help="Fit everything; predict each of N consecutive pieces from the others. Beside --validate or a split, "
            "the pieces choose the method and the other rows test it.",
        ),
    ] = None

    def held_out(self, validate: list[Recording]) -> HeldOut | None:
        """The one way that is given; folds beside it choose. Raises typer.BadParameter for several.

        validate: the recordings of --validate
        """
        from crosscheck.identifying import ByRows, ByTime, Folds, OtherRecordings

        given = {"--validate": validate, "--split": self.split, "--split-rows": self.split_rows}
        named = [option for option, value in given.items() if value]
        if len(named) > 1:
            raise typer.BadParameter(f"{' and '.join(named)} exclude each other; choose one way to keep rows aside")
        aside: HeldOut | None = None
        if self.split:
            aside = ByTime(*(_interval("--split", text) for text in self.split))
        if self.split_rows:
            aside = ByRows(*(_interval("--split-rows", text) for text in self.split_rows))
        if validate:
            aside = OtherRecordings(tuple(validate))
        return Folds(self.folds, aside) if self.folds else aside


@dataclass(frozen=True, kw_only=True)
class SimulationOptions:
    """The recording that is simulated where there is none."""

    PANEL: ClassVar[str] = "Simulated robot, without a LOG"

    seconds: Annotated[
        float | None, typer.Option(metavar="S", show_default="20", help="Length of the simulated recording [s].")
    ] = None
    seed: Annotated[
        int | None, typer.Option(min=0, metavar="N", show_default="0", help="Seed of the simulated recording.")
    ] = None


OF_MEMORY = (
    *("drop", "derive_velocity", "decimate", "split", "split_rows", "folds", "controller", "control_rate"),
    *("torque_hold", "currents", "free_gravity"),
)
"""Options that need every sample of a recording in memory."""


@dataclass(frozen=True, kw_only=True)
class IdentifyOptions(
    HeldOutOptions,
    TorqueOptions,
    PreparationOptions,
    CurrentsOptions,
    LoopOptions,
    RehearsalOptions,
    SimulationOptions,
    ReadingOptions,
    PageOptions,
    WorkerOptions,
):
    """What `graphdyn identify` is asked for."""

    logs: Annotated[
        list[Path] | None,
        typer.Argument(
            metavar="[LOG]...",
            help="Recordings: CSV, Parquet, .npz, .mat, ROS bags. If the mapping names several files, as many LOGs in "
            "a row make one recording. Without a LOG the robot is simulated.",
        ),
    ] = None
    robot: Annotated[
        str | None,
        typer.Option(
            metavar="ROBOT", help="Name or URDF file; its inertials are the CAD values.", autocompletion=robot_names
        ),
    ] = None
    methods: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,…|all",
            show_default="one of each kind",
            help="ols, wls, wls-pinocchio, gls, huber, tukey, ridge, essential, consistent, entropic, pullback, "
            "consistent-huber, entropic-huber, pullback-huber, log-cholesky, graph, tls, ml, iv, didim, cloe, clie, or "
            f"{FUNCTION_FORM} of your own.",
        ),
    ] = None
    free_gravity: Annotated[
        bool,
        typer.Option(
            "--free-gravity",
            rich_help_panel=TorqueOptions.PANEL,
            help="Find the direction of gravity from the LOGs: the mounting of the robot. Also --gravity free.",
        ),
    ] = False
    choose: Annotated[
        str | None,
        typer.Option(
            metavar="METHOD",
            rich_help_panel=RESULT_PANEL,
            help="Show and write this result instead of the recommended one.",
        ),
    ] = None
    cad_factor: Annotated[
        str | None,
        typer.Option(
            metavar="X|LINK=X,…",
            show_default="3",
            rich_help_panel=RESULT_PANEL,
            help="Keep masses within this factor of CAD, that of all links or of some: 3,wrist=10; inf for no limit.",
        ),
    ] = None
    urdf_file: Annotated[
        OutputFile | None,
        typer.Option("--urdf", metavar="OUT", parser=OutputFile.robot, help="Write the robot with new inertials."),
    ] = None
    poses: Annotated[
        int,
        typer.Option(
            min=1, metavar="N", rich_help_panel=RESULT_PANEL, help="Random poses in which the mass matrix is tested."
        ),
    ] = 10_000
    jobs: Annotated[
        int | None,
        typer.Option(
            min=1,
            metavar="N",
            rich_help_panel=WorkerOptions.PANEL,
            help="Read LOGs of any length part by part, in this number of processes.",
        ),
    ] = None

    @property
    def _drives_chosen(self) -> bool:
        return bool(self.logs) and super()._drives_chosen  # the terms of a simulated robot are known

    @property
    def limits(self) -> PhysicalLimits:
        """Limits of the links. Raises typer.BadParameter for what is no factor."""
        from graphdyn.identification import PhysicalLimits

        return PhysicalLimits(**_factors(self.cad_factor)) if self.cad_factor is not None else PhysicalLimits()

    @property
    def in_parts(self) -> bool:
        """Whether the recordings are read part by part."""
        return bool(self.jobs or self.scheduler)

    def __post_init__(self) -> None:
        """Raises typer.BadParameter for options that exclude each other, or need what is not there."""
        super().__post_init__()
        if self.robot is None and self.logs:
            raise typer.BadParameter("--robot is missing; give a name (`graphdyn robots`) or a URDF file")
        if self.urdf_file is not None and self.urdf_file.is_standard_output:
            raise typer.BadParameter("--urdf: name a file; only --json and --html can go to standard output")
        if self.rehearse is not None:
            self._refuse_in_rehearsal()
            return
        refuse(self, CONDITION_OPTIONS, "is for the rehearsal of a motion; give --rehearse FILE too")
        if not self.logs:
            of_logs = (
                *("validate", "split", "split_rows", "folds", "mapping", "rate", "drop", "known_torque"),
                *("known_bodies", "payload", "payload_on", "models", "controller", "control_rate", "torque_hold"),
                *("currents", "free_gravity", "angles_as_written"),
            )
            refuse(self, of_logs, "needs a LOG; without one the robot is simulated")
        if self.free_gravity and self.gravity is not None:
            raise typer.BadParameter("--gravity X Y Z and --gravity free exclude each other; give one of them")
        if self.in_parts:
            self._refuse_in_parts()
        self.check_currents()
        if self.currents:
            refuse(self, ("known_torque",), "is in N m, which --currents have not yet; give --scaled-torque")
        if self.models is not None:
            of_models = ("terms", "width", "stribeck_velocity", "stribeck_exponent", "term")
            refuse(self, of_models, "and --models exclude each other; write it in the file")
        if self.logs:
            refuse(self, ("seconds", "seed"), "is for the simulated robot; leave it out with a LOG")

    def _refuse_in_rehearsal(self) -> None:
        if self.logs:
            raise typer.BadParameter("--rehearse and LOG exclude each other; a rehearsal comes before the recording")
        if self.robot is None:
            raise typer.BadParameter("--robot is missing; --rehearse needs the robot that will move")
        if len(self.terms or []) > 1:
            raise typer.BadParameter("--terms is given several times; --rehearse takes one torque model")
        refuse(self, OF_RECORDINGS, "is for recordings; leave it out with --rehearse")

    def _refuse_in_parts(self) -> None:
        if not self.logs:
            raise typer.BadParameter("--jobs and --scheduler need LOGs; a simulated robot is identified without them")
        refuse(self, OF_MEMORY, "needs the recording in memory; leave it out with --jobs and --scheduler")


def _factors(text: str) -> dict[str, Any]:
    """X or LINK=X, separated by commas. Raises typer.BadParameter."""
    found: dict[str, Any] = {"cad_factors": {}}
    for part in text.split(","):
        link, equals, number = (piece.strip() for piece in part.rpartition("="))
        try:
            factor = float(number)
        except ValueError:
            factor = math.nan
        if not factor >= 1 or bool(equals) != bool(link):
            raise typer.BadParameter(
                f"--cad-factor {text}: give numbers of 1 or more, LINK=NUMBER, or inf for no limit"
            )
        if link:
            found["cad_factors"][link] = factor
        else:
            found["cad_factor"] = factor
    return found


def _interval(option: str, text: str) -> tuple[float, float]:
    """FIRST:LAST; either may be left out. Raises typer.BadParameter."""
    from urdf.document import finite_number

    first, colon, last = text.partition(":")
    begin, end = finite_number(first or "0"), finite_number(last) if last else math.inf
    if not colon or begin is None or end is None:
        raise typer.BadParameter(f"{option} {text}: give FIRST:LAST, such as 0:6")
    return begin, end
