"""Options of `graphdyn crosscheck`."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import typer

from crosscheck.commands.program.options import PageOptions, SamplesOption, SeedOption, WorkerOptions, robot_names
from crosscheck.commands.program.reading_options import ReadingOptions


@dataclass(frozen=True, kw_only=True)
class CrosscheckOptions(ReadingOptions, PageOptions, WorkerOptions):
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
    resume: Annotated[
        bool, typer.Option("--resume", help="Keep the results in --json FILE whose robot and options are unchanged.")
    ] = False
