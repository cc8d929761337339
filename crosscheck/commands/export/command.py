"""`graphdyn export`: the rigid-body model of a robot as plain numbers."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Annotated

import typer

from crosscheck.commands.program.console import warn, warnings_shown
from crosscheck.commands.program.delivery import json_content
from crosscheck.commands.program.options import EXAMPLES, RobotArgument
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.program.reading_options import MimicOption, ReadingOptions

EPILOG = f"""{EXAMPLES}  graphdyn export ur5 --to ur5.c
  graphdyn export arm.urdf --lock gripper --to arm.m
  graphdyn export arm.urdf --chain base_link tool0 --to arm.json
"""

EXPORT_SUFFIXES = (".json", ".c", ".h", ".m")


@dataclass(frozen=True, kw_only=True)
class ExportOptions(ReadingOptions):
    """What `graphdyn export` is asked for."""

    robot: RobotArgument
    to: Annotated[
        OutputFile,
        typer.Option(
            "--to",
            metavar="FILE",
            parser=OutputFile,
            help="Write to FILE, which ends in .json, .c, .h or .m, or - for JSON on standard output.",
        ),
    ]
    mimic: MimicOption = "independent"


def run(options: ExportOptions) -> None:
    """Write the model of a robot as JSON, C or MATLAB.

    Joint placements and axes, masses, centers of mass, tensors, parents, gravity, named frames: as JSON, as constants
    in C (and C++), or as a function for MATLAB and Octave. Units and frames are said in the file. Mimic joints are
    joints like others, as in `graphdyn judge`; of a robot with loops only the tree is written.
    """
    robot, to, reading = options.robot, options.to, options.reading
    ending = ".json" if to.is_standard_output else to.path.suffix.lower()
    if ending not in EXPORT_SUFFIXES:
        raise typer.BadParameter(
            f"--to {to.name}: end the name in {', '.join(EXPORT_SUFFIXES[:-1])} or {EXPORT_SUFFIXES[-1]}"
        )
    if ending == ".m" and not re.fullmatch("[A-Za-z][A-Za-z0-9_]*", to.path.stem):
        raise typer.BadParameter(
            f"--to {to.name}: a function of MATLAB has the name of its file; use letters, digits and _ alone"
        )
    import urdf
    from crosscheck.commands.export.languages import c_text, matlab_text
    from crosscheck.commands.export.record import ExportedModel, record

    with warnings_shown():
        model = urdf.load(robot, reading=reading)
    if model.chords:
        names = ", ".join(f"'{chord.name}'" for chord in model.chords)
        warn(f"robot '{model.name}' has loops, closed by {names}, which are not written: the model is that of its tree")
    exported = ExportedModel(model, robot, reading)
    if ending == ".json":
        to.write(json_content(record(exported)))
    elif ending == ".m":
        to.write(matlab_text(exported, to.path.stem).encode())
    else:
        to.write(c_text(exported).encode())
