"""Options of `graphdyn excite`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
import typer

from crosscheck.commands.identify.models import FUNCTION_FORM, drives_of
from crosscheck.commands.program.options import PageOptions, RobotOption
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.program.reading_options import ReadingOptions
from crosscheck.commands.program.recording_options import ColumnOptions, numbers

if TYPE_CHECKING:
    from crosscheck.exciting.encoder_noise import EncoderNoise
    from crosscheck.exciting.motion_formats.krl import AxisSettings
    from crosscheck.exciting.self_collision import SelfCollision
    from graphdyn import RobotModel
    from graphdyn.excitation import Criterion, ExcitationProblem, MotionLimits, Plane
    from graphdyn.identification import TorqueModel
    from graphdyn.layout import Array

MEASURED_PANEL = "What is measured"
RECORDED_PANEL = "Comparison with recordings"

FEWEST_HARMONICS, HARMONICS_STEP, MOST_HARMONICS = 5, 2, 13
"""Numbers of harmonics that are tried where none is given: from the first one, by steps, to the last."""

CRITERIA = ("log-det", "sigma", "condition")


@dataclass(frozen=True, kw_only=True)
class LimitOptions:
    """What the motion keeps."""

    PANEL: ClassVar[str] = "Limits of the motion"

    velocity: Annotated[
        str | None,
        typer.Option(metavar="X|X,X,…", show_default="those of the file", help="Velocity limits [rad/s or m/s]."),
    ] = None
    velocity_share: Annotated[
        float, typer.Option(metavar="X", help="Fraction of the file's velocity limits that is used.")
    ] = 0.95
    acceleration: Annotated[str, typer.Option(metavar="X|X,X,…", help="Acceleration limits [rad/s² or m/s²].")] = "10"
    jerk: Annotated[
        str | None, typer.Option(metavar="X|X,X,…", show_default="none", help="Jerk limits [rad/s³ or m/s³].")
    ] = None
    torque: Annotated[
        str | None,
        typer.Option(metavar="X|X,X,…", show_default="those of the file", help="Torque limits [N m or N]."),
    ] = None
    torque_share: Annotated[
        float, typer.Option(metavar="X", help="Fraction of the file's effort limits that is used.")
    ] = 0.8
    lower: Annotated[
        str | None,
        typer.Option(metavar="X|X,X,…", show_default="those of the file", help="Lower position limits [rad or m]."),
    ] = None
    upper: Annotated[
        str | None,
        typer.Option(metavar="X|X,X,…", show_default="those of the file", help="Upper position limits [rad or m]."),
    ] = None
    plane: Annotated[
        list[str] | None,
        typer.Option(
            metavar="X,Y,Z,D",
            help="Keep the origins of all links where (X, Y, Z) · p ≥ D, in world axes; 0,0,1,0.1 is 0.1 m above the "
            "base. Repeatable.",
        ),
    ] = None

    def limits(self, model: RobotModel) -> MotionLimits:
        """The limits of the file and of the options. Raises typer.BadParameter, InvalidInput."""
        from graphdyn.excitation import MotionLimits

        for name in ("velocity_share", "torque_share"):
            share = getattr(self, name)
            if not 0 < share <= 1:
                raise typer.BadParameter(f"--{name.replace('_', '-')} {share}: give a part, above 0 and at most 1")
        texts = {name: getattr(self, name) for name in ("velocity", "acceleration", "jerk", "torque", "lower", "upper")}
        given = {name: _one_or_all(f"--{name}", text) for name, text in texts.items() if text is not None}
        return MotionLimits.of_model(
            model,
            planes=tuple(map(_plane, self.plane or ())),
            velocity_share=self.velocity_share,
            torque_share=self.torque_share,
            **given,
        )


@dataclass(frozen=True, kw_only=True)
class CollisionOptions:
    """What the links keep from."""

    PANEL: ClassVar[str] = "Collisions of links"

    collisions: Annotated[
        bool,
        typer.Option(
            "--collisions/--no-collisions", help="Keep links from hitting each other, where meshes are found."
        ),
    ] = True
    clearance: Annotated[
        float, typer.Option(min=0.0, metavar="M", help="Distance that meshes of different links keep [m].")
    ] = 0.0
    srdf: Annotated[
        Path | None, typer.Option(metavar="FILE", help="SRDF file: pairs of links that it disables may touch.")
    ] = None


@dataclass(frozen=True, kw_only=True)
class SearchOptions:
    """The form of the motion, and how it is searched for."""

    PANEL: ClassVar[str] = "Search"

    harmonics: Annotated[
        int | None,
        typer.Option(
            min=2,
            metavar="N",
            show_default="5, 7, 9, … while that helps",
            help="Harmonics of the Fourier series; their period is the duration.",
        ),
    ] = None
    spline: Annotated[
        int | None, typer.Option(min=2, metavar="N", help="Use quintic B-splines of N pieces, not a Fourier series.")
    ] = None
    motions: Annotated[
        int,
        typer.Option(min=1, metavar="K", help="Number of motions, one after the other; each adds most to the others."),
    ] = 1
    criterion: Annotated[
        str,
        typer.Option(
            metavar="|".join(CRITERIA),
            help="Minimize the volume of the ellipsoid of errors, the geometric mean of the standard deviations, or "
            "the condition number, which says little about them.",
        ),
    ] = "log-det"
    seeds: Annotated[int, typer.Option(min=1, metavar="N", help="Random starts; the best motion is kept.")] = 5
    seed: Annotated[int, typer.Option(min=0, metavar="N", help="First seed.")] = 0
    jobs: Annotated[
        int | None, typer.Option(min=1, metavar="N", show_default="one per core", help="Number of parallel processes.")
    ] = None
    random: Annotated[
        int, typer.Option(min=0, metavar="N", help="Random motions within the limits, for comparison.")
    ] = 100

    def chosen_criterion(self, torque_model: TorqueModel) -> Criterion:
        """--criterion. Raises typer.BadParameter."""
        from graphdyn.excitation import ConditionNumber, log_det, mean_sigma, prior_spread

        if self.criterion not in CRITERIA:
            raise typer.BadParameter(f"--criterion {self.criterion}: use one of {', '.join(CRITERIA)}")
        if self.criterion == "condition":
            return ConditionNumber(prior_spread(torque_model))
        return log_det if self.criterion == "log-det" else mean_sigma


@dataclass(frozen=True, kw_only=True)
class MotionFileOptions:
    """The file of the motion."""

    PANEL: ClassVar[str] = "File of the motion"

    out_rate: Annotated[float, typer.Option(metavar="HZ", help="Rows per second of --out.")] = 125.0
    axis_signs: Annotated[
        str, typer.Option(metavar="1,-1,…", help="For KRL: directions in which the maker counts its axes.")
    ] = "1"
    axis_zeros: Annotated[
        str, typer.Option(metavar="X,X,…", help="For KRL: the maker's angles where the URDF has 0 [° or mm].")
    ] = "0"

    @property
    def axis_settings(self) -> AxisSettings:
        """Raises typer.BadParameter, InvalidInput."""
        from crosscheck.exciting.motion_formats.krl import AxisSettings

        return AxisSettings(
            tuple(numbers("--axis-signs", self.axis_signs)), tuple(numbers("--axis-zeros", self.axis_zeros))
        )


@dataclass(frozen=True, kw_only=True)
class ExciteOptions(
    LimitOptions, CollisionOptions, SearchOptions, ColumnOptions, MotionFileOptions, ReadingOptions, PageOptions
):
    """What `graphdyn excite` is asked for."""

    robot: RobotOption
    out: Annotated[
        OutputFile | None,
        typer.Option(
            metavar="FILE",
            parser=OutputFile,
            help="Write the motion: .csv, .yaml (ROS 2 JointTrajectory), .script (URScript servoj), .src (KRL spline). "
            "Of several motions, the number is added to the name.",
        ),
    ] = None
    duration: Annotated[float, typer.Option(metavar="S", help="Duration of each motion [s].")] = 10.0
    noise: Annotated[
        str | None,
        typer.Option(
            metavar="X|X,X,…",
            show_default="1 % of the efforts",
            help="Standard deviation of the measured torques [N m or N].",
        ),
    ] = None
    terms: Annotated[
        str,
        typer.Option(
            metavar="NAME,…",
            rich_help_panel=MEASURED_PANEL,
            help="Terms of the drives, as in `graphdyn identify`, or none.",
        ),
    ] = "viscous,coulomb,offset"
    term: Annotated[
        list[str] | None,
        typer.Option(
            metavar=FUNCTION_FORM,
            rich_help_panel=MEASURED_PANEL,
            help="A function without arguments that returns a further term. Repeatable.",
        ),
    ] = None
    rate: Annotated[
        float,
        typer.Option(metavar="HZ", rich_help_panel=MEASURED_PANEL, help="Samples per second, each with its own error."),
    ] = 500.0
    position_noise: Annotated[
        float | None,
        typer.Option(
            min=0.0,
            metavar="X",
            rich_help_panel=MEASURED_PANEL,
            show_default="none",
            help="Standard deviation of measured positions [rad or m]: predict scatter and bias after --cutoff and "
            "differences, and choose the motion by both.",
        ),
    ] = None
    motion: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Examine this motion instead: a file of --out, or a recording."),
    ] = None
    against: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="LOG", rich_help_panel=RECORDED_PANEL, help="Compare with the motion of a recording. Repeatable."
        ),
    ] = None
    after: Annotated[
        list[Path] | None,
        typer.Option(
            "--after",
            "--next",
            metavar="LOG",
            rich_help_panel=RECORDED_PANEL,
            help="Find the motion that adds most to what this recording determines already. Repeatable.",
        ),
    ] = None

    def __post_init__(self) -> None:
        """Raises typer.BadParameter for a file of no format, and numbers that no motion has."""
        super().__post_init__()
        if self.out is not None:
            self._check_out(self.out)
        if not (self.out_rate > 0 and self.rate > 0):
            raise typer.BadParameter("--rate and --out-rate must be above zero")
        if not self.collisions and (self.clearance or self.srdf):
            raise typer.BadParameter("--no-collisions looks at no links: leave out --clearance and --srdf")
        if self.clearance == math.inf:
            raise typer.BadParameter("--clearance must be finite")

    @property
    def encoder(self) -> EncoderNoise | None:
        """--position-noise and --cutoff. Raises typer.BadParameter."""
        from crosscheck.exciting.encoder_noise import EncoderNoise

        return None if self.position_noise is None else EncoderNoise(self.position_noise, self.low_pass)

    def _check_out(self, out: OutputFile) -> None:
        from crosscheck.exciting.motion_formats.motion_file import WRITTEN_SUFFIXES

        if out.is_standard_output or out.path.suffix.lower() not in WRITTEN_SUFFIXES:
            raise typer.BadParameter(f"--out {out.name}: name a file that ends with {', '.join(WRITTEN_SUFFIXES)}")

    def problem(self, model: RobotModel) -> tuple[ExcitationProblem, str]:
        """What is minimized within which limits, and in words where the noise comes from.

        Raises typer.BadParameter, InvalidInput.
        """
        from graphdyn.excitation import ExcitationProblem, FourierBasis, SplineBasis
        from graphdyn.identification import TorqueModel
        from graphdyn.identification.terms import RigidBodies

        torque_model = TorqueModel(model, (RigidBodies(), *drives_of([self.terms], None, (None, None), self.term)[0]))
        limits = self.limits(model)
        sizes, words = self._noise(model)
        spline = self.spline
        basis = (
            FourierBasis(self.duration, self.harmonics or FEWEST_HARMONICS)
            if spline is None
            else SplineBasis(self.duration, spline)
        )
        criterion = self.chosen_criterion(torque_model)
        return ExcitationProblem(torque_model, limits, basis, sizes, self.rate, criterion), words

    def _noise(self, model: RobotModel) -> tuple[Array, str]:
        """Standard deviations, and in words where they come from. Raises typer.BadParameter."""
        from crosscheck.exciting.excited import assumed_noise

        if self.noise is None:
            return assumed_noise(model)
        return np.asarray(_one_or_all("--noise", self.noise)), "as given"

    def self_collision(self, model: RobotModel) -> SelfCollision | None:
        """None where it is not looked at. Raises InvalidInput for a wrong SRDF file, OSError."""
        from crosscheck.exciting.mesh_contacts import link_meshes
        from crosscheck.exciting.self_collision import self_collision
        from crosscheck.exciting.srdf import disabled_pairs

        if not self.collisions:
            return None
        meshes, missing = link_meshes(self.robot, model, self.reading)
        if self.srdf is None:
            return self_collision(model, meshes, missing, self.clearance)
        links = {mesh.link for mesh in meshes}.union(missing, model.body_names, (frame.name for frame in model.frames))
        return self_collision(model, meshes, missing, self.clearance, disabled_pairs(self.srdf, links))


def _one_or_all(option: str, text: str) -> Array | float:
    found = numbers(option, text)
    return found[0] if len(found) == 1 else np.array(found)


def _plane(text: str) -> Plane:
    from graphdyn.excitation import Plane

    found = numbers("--plane", text)
    if len(found) != 4:
        raise typer.BadParameter(f"--plane {text}: four numbers X,Y,Z,D are needed")
    return Plane(found[:3], found[3])
