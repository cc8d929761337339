"""`graphdyn export`: the rigid-body model of a robot as plain numbers, MJCF or a DH table, and its functions in C."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

import typer

from crosscheck.commands.export.code import FunctionCodeOptions, export_code, refuse_unfit
from crosscheck.commands.export.robot_files import RobotFormat, export_dh, export_mjcf, refuse_options, target
from crosscheck.commands.program.console import warn, warnings_shown
from crosscheck.commands.program.delivery import json_content
from crosscheck.commands.program.options import EXAMPLES
from crosscheck.commands.program.output_files import OutputFile
from graphdyn import RobotModel

EPILOG = f"""{EXAMPLES}  graphdyn export ur5 --to ur5.c
  graphdyn export arm.urdf --lock gripper --to arm.m
  graphdyn export arm.urdf --chain base_link tool0 --to arm.json
  graphdyn export arm.urdf --to mjcf --out arm.xml
  graphdyn export better.urdf --to mjcf --patch arm.xml --out better.xml
  graphdyn export arm.urdf --to dh --dh modified --out arm.toml
  graphdyn export arm.urdf --c arm_c
  graphdyn export arm.urdf --c arm_c --functions joint_torques,frame_jacobian --frame tool0 --reference local
  graphdyn export arm.urdf --c arm_c --functions all --precision single --no-check
"""

EXPORT_SUFFIXES = (".json", ".c", ".h", ".m")


@dataclass(frozen=True, kw_only=True)
class ExportOptions(FunctionCodeOptions):
    """What `graphdyn export` is asked for."""

    to: Annotated[
        OutputFile | None,
        typer.Option(
            "--to",
            metavar="FILE|mjcf|dh",
            parser=target,
            help="Write the model to FILE, which ends in .json, .c, .h or .m, or - for JSON on standard output; mjcf: "
            "as MJCF, dh: as a table of Denavit-Hartenberg parameters, to the file of --out.",
        ),
    ] = None
    out: Annotated[
        OutputFile | None,
        typer.Option(
            "--out", metavar="FILE", parser=OutputFile.robot, help="The file of --to mjcf (.xml), of --to dh (.toml)."
        ),
    ] = None
    patch: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE.xml",
            help="With --to mjcf: a copy of this MJCF file with inertials, armature, damping and friction of ROBOT, in "
            "which no other byte differs (docs/mjcf.md).",
        ),
    ] = None
    dh: Annotated[
        Literal["standard", "modified"] | None,
        typer.Option("--dh", show_default="standard", help="Convention of --to dh."),
    ] = None
    mimic: Annotated[
        Literal["coupled", "independent", "locked"] | None,
        typer.Option(
            show_default="independent; coupled for MJCF",
            help="Mimic joints follow their joint, are joints of their own, or are locked.",
        ),
    ] = None  # type: ignore[assignment]  # __post_init__ makes it one of the words

    @property
    def format(self) -> str | None:
        """The format of the file of --out, None without it."""
        return self.to.word if isinstance(self.to, RobotFormat) else None

    def __post_init__(self) -> None:
        """The default of mimic."""
        if self.mimic is None:
            object.__setattr__(self, "mimic", "coupled" if self.format == "mjcf" else "independent")


def run(options: ExportOptions) -> None:
    """Write the model of a robot to a file, or its functions in C.

    --to writes joint placements and axes, masses, centers of mass, tensors, parents, gravity, named frames: as JSON, as
    constants in C (and C++), or as a function for MATLAB and Octave. Units and frames are said in the file. Mimic
    joints are joints like others, as in `graphdyn judge`; of a robot with loops only the tree is written.

    --c writes a folder of functions such as inverse dynamics, compiled for this robot: C99 that needs no library,
    allocates nothing and keeps nothing between calls. Where there is a C compiler, they are tested against the
    equations and judged before they are written.

    --to mjcf writes the robot for MuJoCo: inertials, joints with damping, friction, armature and limits, motors,
    couplings, loops, sites, every number with all digits. With --patch it writes only inertials, damping, friction and
    armature, into a copy of an existing file.

    --to dh writes a serial robot as a table of Denavit-Hartenberg parameters in TOML, with base, tool and inertias,
    which every command reads as a robot.
    """
    if options.to is None and options.folder is None:
        raise typer.BadParameter(
            "nothing to write; give --to FILE for the model, --c FOLDER for functions in C, or both"
        )
    refuse_options(options.to, options.out, options.patch, options.dh)
    if options.to is not None and options.format is None:
        _refuse_ending(options.to)
    if options.folder is not None:
        refuse_unfit(options, options.folder)
    import urdf

    with warnings_shown():
        model = urdf.load(options.robot, reading=options.reading)
    if options.out is not None and options.format == "dh":
        export_dh(model, options.robot, options.out.path, options.dh or "standard")
    elif options.out is not None:
        with warnings_shown():
            export_mjcf(model, options.robot, options.out.path, options.patch)
    elif options.to is not None:
        _export_model(options, options.to, model)
    if options.folder is not None:
        export_code(options, options.folder, model)


def _ending(to: OutputFile) -> str:
    return ".json" if to.is_standard_output else to.path.suffix.lower()


def _refuse_ending(to: OutputFile) -> None:
    ending = _ending(to)
    if ending not in EXPORT_SUFFIXES:
        raise typer.BadParameter(
            f"--to {to.name}: end the name in {', '.join(EXPORT_SUFFIXES[:-1])} or {EXPORT_SUFFIXES[-1]}"
        )
    if ending == ".m" and not re.fullmatch("[A-Za-z][A-Za-z0-9_]*", to.path.stem):
        raise typer.BadParameter(
            f"--to {to.name}: a function of MATLAB has the name of its file; use letters, digits and _ alone"
        )


def _export_model(options: ExportOptions, to: OutputFile, model: RobotModel) -> None:
    from crosscheck.commands.export.languages import c_text, matlab_text
    from crosscheck.commands.export.record import ExportedModel, record

    if model.chords:
        names = ", ".join(f"'{chord.name}'" for chord in model.chords)
        warn(f"robot '{model.name}' has loops, closed by {names}, which are not written: the model is that of its tree")
    exported, ending = ExportedModel(model, options.robot, options.reading), _ending(to)
    if ending == ".json":
        to.write(json_content(record(exported)))
    elif ending == ".m":
        to.write(matlab_text(exported, to.path.stem).encode())
    else:
        to.write(c_text(exported).encode())
