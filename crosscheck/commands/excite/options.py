"""Options of `graphdyn excite`, and what their texts mean."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import typer

from crosscheck.commands.identify.options import numbers
from crosscheck.commands.program.options import robot_names
from crosscheck.commands.program.output_files import OutputFile

if TYPE_CHECKING:
    from crosscheck.exciting.motion_formats.krl import AxisSettings
    from crosscheck.exciting.self_collision import SelfCollision
    from graphdyn import RobotModel
    from graphdyn.excitation import Criterion, MotionLimits, Plane
    from graphdyn.identification import TorqueModel
    from graphdyn.identification.terms import Term
    from graphdyn.layout import Array
    from urdf import Reading

CRITERIA = ("log-det", "sigma", "condition")

RobotOption = Annotated[
    str,
    typer.Option("--robot", metavar="ROBOT", help="Name (`graphdyn robots`), URDF or .xacro file.",
                 autocompletion=robot_names),
]  # fmt: skip
DurationOption = Annotated[float, typer.Option(metavar="S", help="Of each motion [s].")]
HarmonicsOption = Annotated[
    int, typer.Option(min=2, metavar="N", help="Harmonics of the Fourier series; their period is the duration.")
]
SplineOption = Annotated[
    int | None, typer.Option(min=2, metavar="N", help="Quintic B-splines of N pieces instead of a Fourier series.")
]
MotionsOption = Annotated[
    int,
    typer.Option(min=1, metavar="K", help="Motions one after the other, each the one that adds most to the others."),
]
CriterionOption = Annotated[
    str,
    typer.Option(
        metavar="|".join(CRITERIA),
        help="What is to be small: the volume of the ellipsoid of errors, the geometric mean of the standard "
        "deviations, or the condition number, which says little about them.",
    ),
]
TermsOption = Annotated[
    str, typer.Option(metavar="NAME,…", help="What the drives add to the bodies, as in `graphdyn identify`; none.")
]
NoiseOption = Annotated[
    str | None,
    typer.Option(
        metavar="X|X,X,…", help="Standard deviation of the measured torques [N m or N]; 1 % of the efforts if left out."
    ),
]
RateOption = Annotated[float, typer.Option(metavar="HZ", help="Samples per second, each with its own error.")]
VelocityOption = Annotated[
    str | None,
    typer.Option("--velocity", metavar="X|X,X,…", help="Limit of velocity, in place of the file's [rad/s or m/s]."),
]
VelocityShareOption = Annotated[float, typer.Option(metavar="X", help="Part of the file's limits of velocity.")]
AccelerationOption = Annotated[
    str, typer.Option("--acceleration", metavar="X|X,X,…", help="Limit of acceleration [rad/s² or m/s²].")
]
JerkOption = Annotated[
    str | None, typer.Option("--jerk", metavar="X|X,X,…", help="Limit of jerk [rad/s³ or m/s³]; none if left out.")
]
TorqueOption = Annotated[
    str | None, typer.Option("--torque", metavar="X|X,X,…", help="Limit of torque, in place of the file's [N m or N].")
]
TorqueShareOption = Annotated[float, typer.Option(metavar="X", help="Part of the file's efforts.")]
LowerOption = Annotated[
    str | None, typer.Option("--lower", metavar="X|X,X,…", help="Lower limits of position, in place of the file's.")
]
UpperOption = Annotated[
    str | None, typer.Option("--upper", metavar="X|X,X,…", help="Upper limits of position, in place of the file's.")
]
PlaneOption = Annotated[
    list[str] | None,
    typer.Option(
        metavar="X,Y,Z,D",
        help="The origins of all links stay where (X, Y, Z) · p ≥ D, in world axes; 0,0,1,0.1 is 0.1 m above the base. "
        "Repeatable.",
    ),
]
CollisionsOption = Annotated[
    bool,
    typer.Option("--collisions/--no-collisions", help="Keep links from hitting each other, where meshes are found."),
]
ClearanceOption = Annotated[
    float, typer.Option(min=0.0, metavar="M", help="Distance that meshes of different links keep [m].")
]
SrdfOption = Annotated[
    Path | None, typer.Option(metavar="FILE", help="SRDF file: pairs of links that it disables may touch.")
]
SeedsOption = Annotated[int, typer.Option(min=1, metavar="N", help="Random starts; the best motion is kept.")]
SeedOption = Annotated[int, typer.Option(min=0, metavar="N", help="First seed.")]
JobsOption = Annotated[int | None, typer.Option(min=1, metavar="N", help="Processes; one per core if left out.")]
RandomOption = Annotated[
    int, typer.Option(min=0, metavar="N", help="Random motions within the limits for comparison; 0 for none.")
]
MotionOption = Annotated[
    Path | None,
    typer.Option(
        "--motion",
        metavar="FILE",
        help="Examine this motion instead: a file of --out, or a recording.",
    ),
]
AgainstOption = Annotated[
    list[Path] | None,
    typer.Option(metavar="LOG", help="Compare with the motion of a recording. Repeatable."),
]
AfterOption = Annotated[
    list[Path] | None,
    typer.Option(metavar="LOG", help="Add to what this recording determines already. Repeatable."),
]
OutOption = Annotated[
    OutputFile | None,
    typer.Option(
        metavar="FILE",
        parser=OutputFile,
        help="Write the motion: .csv, .yaml (ROS 2 JointTrajectory), .script (URScript servoj), .src (KRL spline). Of "
        "several motions, the number is added to the name.",
    ),
]
OutRateOption = Annotated[float, typer.Option(metavar="HZ", help="Rows per second of --out.")]
SignsOption = Annotated[
    str,
    typer.Option("--axis-signs", metavar="1,-1,…", help="Of KRL: the directions in which the maker counts its axes."),
]
ZerosOption = Annotated[
    str,
    typer.Option("--axis-zeros", metavar="X,X,…", help="Of KRL: the maker's angles where the URDF has 0 [° or mm]."),
]


def limits_of(model: RobotModel, planes: list[str] | None, **texts: str | float | None) -> MotionLimits:
    """The limits of the file and of the options. Raises typer.BadParameter, InvalidInput."""
    from graphdyn.excitation import MotionLimits

    given = {
        name: _one_or_all(f"--{name}", value) if isinstance(value, str) else value
        for name, value in texts.items()
        if value is not None
    }
    for name in ("velocity_share", "torque_share"):
        share = given[name]
        if not 0 < share <= 1:
            raise typer.BadParameter(f"--{name.replace('_', '-')} {share}: give a part, above 0 and at most 1")
    return MotionLimits.of_model(model, planes=tuple(map(_plane, planes or ())), **given)  # type: ignore[arg-type]


def collisions_of(robot: str, model: RobotModel, reading: Reading, margin: float, srdf: Path | None) -> SelfCollision:
    """Raises InvalidInput for a wrong SRDF file, OSError."""
    from crosscheck.exciting.link_meshes import link_meshes
    from crosscheck.exciting.self_collision import self_collision
    from crosscheck.exciting.srdf import disabled_pairs

    meshes, missing = link_meshes(robot, model, reading)
    if srdf is None:
        return self_collision(model, meshes, missing, margin)
    links = {mesh.link for mesh in meshes}.union(missing, model.body_names, (frame.name for frame in model.frames))
    return self_collision(model, meshes, missing, margin, disabled_pairs(srdf, links))


def noise_of(text: str | None, model: RobotModel) -> tuple[Array, str]:
    """Standard deviations, and in words where they come from. Raises typer.BadParameter."""
    from crosscheck.exciting.noise import assumed_noise

    return assumed_noise(model) if text is None else (np.asarray(_one_or_all("--noise", text)), "as given")


def criterion_of(name: str, torque_model: TorqueModel) -> Criterion:
    """--criterion. Raises typer.BadParameter."""
    from graphdyn.excitation import ConditionNumber, log_det, mean_sigma, prior_spread

    if name not in CRITERIA:
        raise typer.BadParameter(f"--criterion {name}: use one of {', '.join(CRITERIA)}")
    if name == "condition":
        return ConditionNumber(prior_spread(torque_model))
    return log_det if name == "log-det" else mean_sigma


def terms_of(names: str, further: list[str] | None) -> tuple[Term, ...]:
    """--terms and --term. Raises InvalidInput for unknown names, typer.BadParameter for a wrong FILE.py:NAME."""
    from crosscheck.commands.identify.models import drives_of

    return drives_of([names], None, (None, None), further)[0]


def axis_settings(signs: str, zeros: str) -> AxisSettings:
    """Raises typer.BadParameter, InvalidInput."""
    from crosscheck.exciting.motion_formats.krl import AxisSettings

    return AxisSettings(tuple(numbers("--axis-signs", signs)), tuple(numbers("--axis-zeros", zeros)))


def check_out(out: OutputFile) -> None:
    """Raises typer.BadParameter for a name that no format belongs to."""
    from crosscheck.exciting.motion_formats.motion_file import WRITTEN_SUFFIXES

    if out.is_standard_output or out.path.suffix.lower() not in WRITTEN_SUFFIXES:
        raise typer.BadParameter(f"--out {out.name}: name a file that ends with {', '.join(WRITTEN_SUFFIXES)}")


def _one_or_all(option: str, text: str) -> Array | float:
    found = numbers(option, text)
    return found[0] if len(found) == 1 else np.array(found)


def _plane(text: str) -> Plane:
    from graphdyn.excitation import Plane

    found = numbers("--plane", text)
    if len(found) != 4:
        raise typer.BadParameter(f"--plane {text}: four numbers X,Y,Z,D are needed")
    return Plane(found[:3], found[3])
