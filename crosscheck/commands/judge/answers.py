"""Answers from files: options of `graphdyn judge`, and the file of further questions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import typer

from crosscheck.commands.program.console import out, warn
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.commands.questions.command import content, ending_of
from graphdyn.errors import counted

if TYPE_CHECKING:
    from crosscheck.judging.exchange.rounds import AnswersPending
    from crosscheck.judging.setting import Setting


@dataclass(frozen=True, kw_only=True)
class AnswerOptions:
    """Files of answers, in place of functions."""

    PANEL: ClassVar[str] = "Functions in other languages (docs/languages.md)"

    answers: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="FILE",
            help="Answers to `graphdyn questions`, id and numbers (.csv, .json, .npz, .parquet). Repeatable.",
        ),
    ] = None
    further: Annotated[
        OutputFile | None,
        typer.Option(
            metavar="FILE",
            parser=OutputFile,
            show_default="further_questions.csv beside the answers",
            help="Write the questions of a second round to FILE.",
        ),
    ] = None


def write_further(
    further: OutputFile | None, pending: AnswersPending, setting: Setting, answers: Sequence[Path]
) -> None:
    """Write the questions of a second round, and say so.

    Raises typer.BadParameter for a name of no known form, and rather than replace another file.
    """
    from crosscheck.judging.exchange.rounds import first_round

    to = further or OutputFile(str(answers[0].with_name(f"further_questions{answers[0].suffix}")))
    order = first_round(setting, ()).joint_names
    written = content(ending_of("--further", to), str(setting.robot), order, setting.frame, pending.questions)
    if to.is_regular and to.path.exists() and to.path.read_bytes() != written:
        raise typer.BadParameter(f"--further {to.name}: there is another file of this name; name another")
    to.write(written)
    functions = ", ".join(dict.fromkeys(one.function for one in pending.questions))
    given = " ".join(f"--answers {path}" for path in answers)
    out.print(
        f"{functions}: disagreement with the reference implementations. To find out what is wrong, answer the "
        f"{counted(len(pending.questions), 'question')} in {to.name} as well, and judge with {given} --answers FILE."
    )


def warn_of_unused(ids: Sequence[int]) -> None:
    from crosscheck.judging.exchange.rounds import listed

    belong = "belongs" if len(ids) == 1 else "belong"
    warn(f"{counted(len(ids), 'answer')} {belong} to no question that was asked: {listed(ids)}")
