"""Options of `graphdyn crosscheck`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

import typer

from crosscheck.commands.program.finding_options import FindingOptions
from crosscheck.commands.program.options import (
    OPTIONAL_NUMBER,
    PageOptions,
    SamplesOption,
    SeedOption,
    WorkerOptions,
    robot_names,
)
from crosscheck.commands.program.reading_options import ReadingOptions

EXACT_STATES = 20
"""Random states of --exact without a number."""


def exact_states(text: str) -> int:
    """The number behind --exact; EXACT_STATES where it is left out. Raises typer.BadParameter."""
    if not text:
        return EXACT_STATES
    if not text.isascii() or not text.isdigit() or int(text) == 0:
        raise typer.BadParameter(f"'{text}' is not a number of states; give a whole number from 1 on")
    return int(text)


@dataclass(frozen=True, kw_only=True)
class CrosscheckOptions(ReadingOptions, FindingOptions, PageOptions, WorkerOptions):
    """What `graphdyn crosscheck` is asked for."""

    robots: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="ROBOT",
            show_default="six arms",
            help="Names (`graphdyn robots`), URDF files, or folders of them.",
            autocompletion=robot_names,
        ),
    ] = None
    samples: SamplesOption = 1000
    seed: SeedOption = 0
    exact: Annotated[
        int | None,
        typer.Option(
            "--exact",
            metavar=OPTIONAL_NUMBER,
            parser=exact_states,
            show_default=f"{EXACT_STATES} states where N is left out",
            help="Measure the errors of all codes against exact values instead, at N random states (extra `exact`). "
            "An arm takes ten seconds with 20 states, half a minute with 100.",
        ),
    ] = None
    truth: Annotated[
        Literal["model", "file"],
        typer.Option(
            "--truth",
            help="With --exact: the doubles of the model in memory, on which all codes work, or the decimals of the "
            "file, so that errors of reading count, too.",
        ),
    ] = "model"
    resume: Annotated[
        bool, typer.Option("--resume", help="Keep the results in --json FILE whose robot and options are unchanged.")
    ] = False
