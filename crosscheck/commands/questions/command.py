"""`graphdyn questions`: the states of a judgment as a file, for code that is asked by files."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from crosscheck.commands.program.console import out, warnings_shown
from crosscheck.commands.program.delivery import json_content
from crosscheck.commands.program.judged_functions import JointsOption, SettingOptions, names
from crosscheck.commands.program.options import EXAMPLES
from crosscheck.commands.program.output_files import OutputFile
from graphdyn.errors import counted

if TYPE_CHECKING:
    from collections.abc import Sequence

    from crosscheck.judging.exchange.questions import Question

EPILOG = f"""{EXAMPLES}  graphdyn questions ur5 --for inverse_dynamics --out questions.csv
  graphdyn questions arm.urdf --for inverse_dynamics,mass_matrix --out questions.json
  graphdyn questions arm.urdf --for frame_jacobian --frame tool0 --out questions.npz
"""


@dataclass(frozen=True, kw_only=True)
class QuestionsOptions(SettingOptions):
    """What `graphdyn questions` is asked for."""

    functions: Annotated[
        str, typer.Option("--for", metavar="NAME,NAME,…", help="The functions; `graphdyn judge --help` lists them.")
    ]
    to: Annotated[
        OutputFile,
        typer.Option(
            "--out",
            metavar="FILE",
            parser=OutputFile,
            help="Write to FILE, which ends in .csv, .json, .npz or .parquet, or - for CSV on standard output.",
        ),
    ]
    joint_names: JointsOption = None


def run(options: QuestionsOptions) -> None:
    """Write the questions of a judgment to a file.

    Each has an id, the name of a function and its arguments. Compute the answers with any code, write a file with
    the id and the numbers of each answer, and give it to `graphdyn judge ROBOT --answers FILE` with the same options
    (docs/languages.md).
    """
    robot, to, frame = options.robot, options.to, options.frame
    ending = ending_of("--out", to)
    from crosscheck.judging.exchange.rounds import first_round

    with warnings_shown():
        asked = first_round(
            replace(options.setting, joint_names=names(options.joint_names)), names(options.functions) or []
        )
    to.write(content(ending, robot, asked.joint_names, frame, asked.questions))
    out.print(
        f"{counted(len(asked.questions), 'question')} in {to.name}, joints in the order {', '.join(asked.joint_names)}"
    )


def ending_of(option: str, to: OutputFile) -> str:
    """The ending of the file's name. Raises typer.BadParameter for one of no known form."""
    from crosscheck.judging.exchange.questions import QUESTION_WRITERS

    endings = (".json", *QUESTION_WRITERS)
    ending = ".csv" if to.is_standard_output else Path(to.name).suffix.lower()
    if ending not in endings:
        raise typer.BadParameter(f"{option} {to.name}: end the name in {', '.join(endings[:-1])} or {endings[-1]}")
    return ending


def content(ending: str, robot: str, joint_names: Sequence[str], frame: str | None, asked: Sequence[Question]) -> bytes:
    """Questions in the form of an ending."""
    from crosscheck.commands.questions.record import record
    from crosscheck.judging.exchange.questions import QUESTION_WRITERS

    if ending == ".json":
        return json_content(record(robot, joint_names, frame, asked))
    return QUESTION_WRITERS[ending](asked)
