"""Functions of a robot in C: the options, the folder, and what is said of the check."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

import typer

from crosscheck.commands.program.console import out, progress, warn, warnings_shown
from crosscheck.commands.program.delivery import json_content
from crosscheck.commands.program.exits import DISAGREED
from crosscheck.commands.program.judged_functions import names
from crosscheck.commands.program.options import RobotArgument, command_line
from crosscheck.commands.program.output_files import refuse_folder, write_folder
from crosscheck.commands.program.reading_options import MimicOption, ReadingOptions
from graphdyn.errors import counted

if TYPE_CHECKING:
    from crosscheck.judging.exchange.exported_code import CheckedCode
    from crosscheck.judging.setting import Setting
    from graphdyn import RobotModel
    from graphdyn.export import CCode

TABLE = "code.json"
"""Name of the file that lists the others."""

ALL = "all"
"""Instead of names: every function that the robot has."""


@dataclass(frozen=True, kw_only=True)
class FunctionCodeOptions(ReadingOptions):
    """Which functions, and how they are written."""

    PANEL: ClassVar[str] = "Functions in C (docs/export.md)"

    robot: RobotArgument
    folder: Annotated[
        Path | None,
        typer.Option(
            "--c",
            metavar="FOLDER",
            help="Folder for functions in C99, with headers for C and C++, CMakeLists.txt and a test; it may exist "
            "from an earlier run.",
        ),
    ] = None
    functions: Annotated[
        str | None,
        typer.Option(
            metavar="NAME,NAME,…",
            show_default="joint_torques,joint_accelerations,mass_matrix,solve_kkt",
            help=f"The functions, of those in docs/dynamics.md, or '{ALL}'.",
        ),
    ] = None
    name: Annotated[
        str | None, typer.Option(metavar="NAME", show_default="the robot's", help="With which all names in C begin.")
    ] = None
    precision: Annotated[Literal["double", "single"], typer.Option(help="double or float for all numbers.")] = "double"
    sines: Annotated[
        Literal["own", "libm"],
        typer.Option(help="Sine and cosine: own ones, faster and for angles up to 1e6 rad, or those of the C library."),
    ] = "own"
    external_wrenches: Annotated[
        bool,
        typer.Option(
            "--external-wrenches", help="Functions that can take wrenches on the links (n, 6) as an argument."
        ),
    ] = False
    moving_base: Annotated[
        bool, typer.Option("--moving-base", help="Functions that can take the motion of the base as last arguments.")
    ] = False
    frame: Annotated[str | None, typer.Option(metavar="LINK", help="Frame of the functions that refer to one.")] = None
    reference: Annotated[
        Literal["world", "local", "local_world_aligned"] | None,
        typer.Option(help="Reference of these functions. [required with --frame]"),
    ] = None
    spatial: Annotated[
        bool, typer.Option("--spatial", help="Accelerations of the frame are spatial, not classical.")
    ] = False
    check: Annotated[
        bool | None,
        typer.Option(
            "--check/--no-check",
            show_default="check where there is a C compiler",
            help="Compile the code, run its test and judge its functions before the folder is written.",
        ),
    ] = None
    mimic: MimicOption = "independent"


def refuse_unfit(options: FunctionCodeOptions, folder: Path) -> None:
    """Raises typer.BadParameter for options and a folder that do not fit, before the work begins."""
    refuse_folder("--c", folder, TABLE)
    if (options.frame is None) != (options.reference is None):
        raise typer.BadParameter("--frame and --reference belong together; give both")


def export_code(options: FunctionCodeOptions, folder: Path, model: RobotModel) -> None:
    """Write the folder; exits with code 1, and without it, where the check finds the code wrong."""
    from crosscheck.commands.export.record import code_record

    code = _code(options, model)
    checked = _checked(options, code)
    if checked is not None:
        _tell(checked)
        if not checked.agrees:
            warn(f"the exported code is wrong, and {folder} was not written; please report this robot")
            raise typer.Exit(DISAGREED)
    files = {name: text.encode() for name, text in code.files.items()}
    write_folder(folder, {**files, TABLE: json_content(code_record(code, options.robot, command_line()))})
    functions = counted(len(code.functions), "function")
    out.print(f"{functions} of {options.robot} in {folder}, names begin with {code.name}_")


def _code(options: FunctionCodeOptions, model: RobotModel) -> CCode:
    from graphdyn.export import USUAL_FUNCTIONS, ExportChoices, c_code, exportable

    choices = ExportChoices(
        options.external_wrenches, options.moving_base, options.frame, options.reference, not options.spatial
    )
    chosen = names(options.functions) or USUAL_FUNCTIONS
    if list(chosen) == [ALL]:
        chosen = exportable(model, choices)
    return c_code(model, chosen, choices, name=options.name, precision=options.precision, sines=options.sines)


def _checked(options: FunctionCodeOptions, code: CCode) -> CheckedCode | None:
    """None where nothing is checked. Raises typer.BadParameter for --check without a compiler."""
    if options.check is False:
        return None
    from crosscheck.judging.exchange.exported_code import c_compiler, check_code

    compiler = c_compiler()
    if compiler is None:
        if options.check:
            raise typer.BadParameter("--check: there is no C compiler; install one, or name it in CC")
        warn("not checked: there is no C compiler")
        return None
    with progress(options.robot) as advance, warnings_shown():
        return check_code(code, compiler, _setting(options), lambda what: advance(what, 1))


def _setting(options: FunctionCodeOptions) -> Setting:
    from crosscheck.judging.setting import Setting

    setting = Setting(
        robot=options.robot,
        reading=options.reading,
        frame=options.frame,
        external_wrenches=options.external_wrenches,
    )
    return setting if options.reference is None else replace(setting, conventions={"reference": options.reference})


def _tell(checked: CheckedCode) -> None:
    if checked.arrays:
        worst = max(checked.arrays, key=lambda array: array.error)
        out.print(
            f"test of the code, compiled by {checked.compiler}: {'passed' if checked.passed else 'FAILED'}, largest "
            f"error {worst.error:.1e} of the largest number ({worst.name})"
        )
        for array in checked.arrays:
            if array.states == 0:
                out.print(
                    f"{array.name}: not compared, as the mass matrix is nearly singular at all states of the test"
                )
    if checked.judgment is None:
        out.print("not judged: no function here has the arguments and the robot that graphdyn judge knows")
        return
    for name, function in checked.judgment.functions.items():
        errors = ", ".join(f"{error.max():.1e} against {who}" for who, error in function.errors.items())
        out.print(f"judged {name}: {'agrees' if function.agrees else 'DISAGREES'}, {errors}")
