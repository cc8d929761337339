"""`graphdyn repair`: a copy of a URDF file in which named faults are mended."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, DISAGREED
from crosscheck.commands.program.options import EXAMPLES, JsonOptions, robot_names
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.program.reading_options import FROM_MESHES, repair_of

EPILOG = f"""{EXAMPLES}  graphdyn repair kinova --list
  graphdyn repair arm.urdf --take limits-crossed --take rpy-truncated --out repaired.urdf
  graphdyn repair arm.urdf --take {FROM_MESHES}=2700 --out repaired.urdf
"""


@dataclass(frozen=True, kw_only=True)
class RepairOptions(JsonOptions):
    """What `graphdyn repair` is asked for."""

    robot: Annotated[
        str,
        typer.Argument(metavar="FILE|NAME", help="URDF file, or name (`graphdyn robots`).", autocompletion=robot_names),
    ]
    take: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME|CODE",
            help="A repair: angles, axis, inertials, limits, or the code of a finding that it mends; or "
            f"{FROM_MESHES}=DENSITY [kg/m³] or =MASSkg, then ,all or ,LINK,… for other links than those without "
            "<inertial>. Repeatable.",
        ),
    ] = None
    out: Annotated[
        OutputFile | None,
        typer.Option(metavar="FILE", parser=OutputFile.robot, help="Write the repaired copy to FILE."),
    ] = None
    listed: Annotated[bool, typer.Option("--list", help="Show what could be repaired; write nothing.")] = False


def run(options: RepairOptions) -> None:
    """Write a copy of a URDF file in which named faults are mended.

    Nothing is mended that is not named, and no other byte of the file changes. Every change is told with its line, the
    old value and the new one.

    Exit code 0: repaired, or listed; 1: nothing of what is named is there; 2: bad input.
    """
    import urdf
    from crosscheck.commands.program.repair_commands import repairs_of
    from crosscheck.commands.repair.report import list_report, repair_report

    if options.listed == bool(options.take):
        raise typer.BadParameter("give --take NAME for each repair, or --list to see what could be repaired")
    if options.take and options.out is None:
        raise typer.BadParameter("--take needs --out FILE, for the repaired copy")
    if options.listed:
        deliver(list_report(options.robot, *repairs_of(options.robot)), options)
        return
    take = [repair_of("--take", text) for text in options.take or ()]
    repaired = urdf.repair(options.robot, None if options.out is None else options.out.path, take)
    deliver(repair_report(options.robot, repaired), options)
    raise typer.Exit(AGREED if repaired.changes else DISAGREED)
