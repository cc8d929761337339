"""Options for where the work is done: processes here, or the workers of a Dask scheduler."""

from __future__ import annotations

from typing import Annotated

import typer

from crosscheck.distributing import DaskWorkers, LocalProcesses
from graphdyn.kernels.running import cores

SchedulerOption = Annotated[
    str | None,
    typer.Option(
        "--scheduler",
        metavar="ADDRESS",
        help="Use the workers of a Dask scheduler, such as tcp://10.0.0.1:8786, in place of processes here (extra "
        "`distributed`). They find the files under the same paths.",
    ),
]


def workers_of(jobs: int | None, scheduler: str | None) -> DaskWorkers | LocalProcesses:
    """What --jobs and --scheduler choose; as many processes as processors without both. Raises typer.BadParameter."""
    if jobs and scheduler:
        raise typer.BadParameter("--jobs and --scheduler exclude each other; the scheduler has workers of its own")
    return DaskWorkers(scheduler) if scheduler else LocalProcesses(jobs or cores())
