"""`graphdyn identify --jobs N` and `--scheduler ADDRESS`: recordings of any length, read part by part."""

from __future__ import annotations

import glob
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from crosscheck.commands.identify.models import methods_of
from crosscheck.commands.program.console import progress

if TYPE_CHECKING:
    from crosscheck.distributing import Workers
    from crosscheck.identifying import CandidateModel, Identified, Preparation
    from crosscheck.recordings.errors import RecordingFinding
    from graphdyn.identification import Estimator

JobsOption = Annotated[
    int | None,
    typer.Option(min=1, metavar="N", help="Read LOGs of any length part by part, in this number of processes."),
]


def refuse(logs: Sequence[Path] | None, cutoff: str, **given: object) -> None:
    """Raises typer.BadParameter for what cannot be done part by part."""
    if not logs:
        raise typer.BadParameter("--jobs and --scheduler need LOGs; a simulated robot is identified without them")
    for name, value in given.items():
        if value:
            raise typer.BadParameter(
                f"--{name.replace('_', '-')} needs the recording in memory; leave it out with --jobs and --scheduler"
            )
    if cutoff == "residual":
        raise typer.BadParameter(
            "--cutoff residual, which is the default, needs the recording in memory; give Hz or none with --jobs and "
            "--scheduler"
        )


def methods(text: str | None) -> list[str | Estimator]:
    """--methods; those that need no more than sums where it is left out, or "all"."""
    from crosscheck.identifying.long_recordings import METHODS_OF_SUMS, STANDARD_METHODS_OF_SUMS

    if text is None:
        return list(STANDARD_METHODS_OF_SUMS)
    return list(METHODS_OF_SUMS) if text == "all" else methods_of(text)


def found(
    robot: str,
    logs: Sequence[Path],
    validate: Sequence[Path] | None,
    models: Sequence[CandidateModel],
    preparation: Preparation,
    mapping: Path | None,
    rate: float | None,
    workers: Workers,
    **how: Any,
) -> Identified:
    """crosscheck.identifying.long_recordings.identify_long with a bar. how: the robot is read"""
    from crosscheck.identifying.long_recordings import identify_long
    from crosscheck.recordings import PartitionedRecording

    cutoff = preparation.cutoff
    assert isinstance(cutoff, float | Mapping | None)

    def recording(paths: Sequence[Path]) -> PartitionedRecording:
        return PartitionedRecording(_expanded(paths), mapping, None, rate, cutoff, workers=workers)

    with progress("rows") as advance:
        return identify_long(
            robot,
            recording(logs),
            models,
            validate=recording(validate) if validate else None,
            min_speed=preparation.min_speed,
            progress=advance,
            **how,
        )


def findings(found: Identified) -> list[RecordingFinding]:
    """What was assumed of the columns, once for all logs of which it is the same."""
    read = [*found.recordings, *(trial.test for trial in found.division.trials)]
    every = [finding for recording in read for finding in recording.findings]
    return list({(finding.code, finding.message): finding for finding in reversed(every)}.values())[::-1]


def _expanded(paths: Sequence[Path]) -> list[str]:
    """With patterns, which a shell leaves in quotation marks as they are, replaced by what they match."""
    return [name for path in paths for name in ([str(path)] if path.exists() else _matching(str(path)))]


def _matching(pattern: str) -> list[str]:
    return sorted(glob.glob(pattern)) or [pattern]  # what is not there is refused by name
