"""`graphdyn identify --jobs N` and `--scheduler ADDRESS`: recordings of any length, read part by part."""

from __future__ import annotations

import glob
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from crosscheck.commands.identify.models import methods_of
from crosscheck.commands.identify.options import IdentifyOptions
from crosscheck.commands.program.console import progress

if TYPE_CHECKING:
    from crosscheck.identifying import CandidateModel, Identified, Preparation
    from crosscheck.recordings.errors import RecordingFinding
    from graphdyn.identification import Estimator


def methods(text: str | None) -> list[str | Estimator]:
    """--methods; those that need no more than sums where it is left out, or "all"."""
    from crosscheck.identifying.long_recordings import METHODS_OF_SUMS, STANDARD_METHODS_OF_SUMS

    if text is None:
        return list(STANDARD_METHODS_OF_SUMS)
    return list(METHODS_OF_SUMS) if text == "all" else methods_of(text)


def found(
    options: IdentifyOptions, robot: str, models: Sequence[CandidateModel], preparation: Preparation
) -> Identified:
    """crosscheck.identifying.identify_long with a bar."""
    from crosscheck.identifying import identify_long
    from crosscheck.recordings import PartitionedRecording

    cutoff = preparation.cutoff
    assert isinstance(cutoff, float | Mapping | None)

    with options.workers.kept() as workers, progress("rows") as advance:

        def recording(paths: Sequence[Path]) -> PartitionedRecording:
            files = _expanded(paths)
            return PartitionedRecording(files, options.mapping, None, options.rate, cutoff, workers=workers)

        return identify_long(
            robot,
            recording(options.logs or ()),
            models,
            validate=recording(options.validate) if options.validate else None,
            min_speed=preparation.min_speed,
            poses=options.poses,
            progress=advance,
            reading=options.reading,
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
