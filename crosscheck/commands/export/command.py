"""`graphdyn export`: the rigid-body model of a robot as plain numbers, and its functions in C."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated

import typer

from crosscheck.commands.export.code import FunctionCodeOptions, export_code, refuse_unfit
from crosscheck.commands.program.console import warn, warnings_shown
from crosscheck.commands.program.delivery import json_content
from crosscheck.commands.program.options import EXAMPLES
from crosscheck.commands.program.output_files import OutputFile
from graphdyn import RobotModel

EPILOG = f"""{EXAMPLES}  graphdyn export ur5 --to ur5.c
  graphdyn export arm.urdf --lock gripper --to arm.m
  graphdyn export arm.urdf --chain base_link tool0 --to arm.json
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
            metavar="FILE",
            parser=OutputFile,
            help="Write the model to FILE, which ends in .json, .c, .h or .m, or - for JSON on standard output.",
        ),
    ] = None


def run(options: ExportOptions) -> None:
    """Write the model of a robot to a file, or its functions in C.

    --to writes joint placements and axes, masses, centers of mass, tensors, parents, gravity, named frames: as JSON, as
    constants in C (and C++), or as a function for MATLAB and Octave. Units and frames are said in the file. Mimic
    joints are joints like others, as in `graphdyn judge`; of a robot with loops only the tree is written.

    --c writes a folder of functions such as inverse dynamics, compiled for this robot: C99 that needs no library,
    allocates nothing and keeps nothing between calls. Where there is a C compiler, they are tested against the
    equations and judged before they are written.
    """
    if options.to is None and options.folder is None:
        raise typer.BadParameter(
            "nothing to write; give --to FILE for the model, --c FOLDER for functions in C, or both"
        )
    if options.to is not None:
        _refuse_ending(options.to)
    if options.folder is not None:
        refuse_unfit(options, options.folder)
    import urdf

    with warnings_shown():
        model = urdf.load(options.robot, reading=options.reading)
    if options.to is not None:
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
