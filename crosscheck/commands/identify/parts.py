"""`graphdyn identify --jobs N` and `--scheduler ADDRESS`: recordings of any length, read part by part."""

from __future__ import annotations

import glob
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from crosscheck.commands.identify.models import methods_of
from crosscheck.commands.identify.options import IdentifyOptions

if TYPE_CHECKING:
    from crosscheck.distributing import Workers
    from crosscheck.identifying import Identified, Preparation
    from crosscheck.recordings import PartitionedRecording
    from crosscheck.recordings.errors import RecordingFinding
    from graphdyn.identification import Estimator


def methods(text: str | None) -> list[str | Estimator]:
    """--methods; those that need no more than sums where it is left out, or "all"."""
    from crosscheck.identifying import METHODS_OF_SUMS, STANDARD_METHODS_OF_SUMS

    if text is None:
        return list(STANDARD_METHODS_OF_SUMS)
    return list(METHODS_OF_SUMS) if text == "all" else methods_of(text)


def recording(
    options: IdentifyOptions, paths: Sequence[Path], preparation: Preparation, workers: Workers
) -> PartitionedRecording:
    """The logs of these files, folders and patterns, read part by part."""
    from crosscheck.recordings import PartitionedRecording

    cutoff = preparation.cutoff
    assert isinstance(cutoff, float | Mapping | None)
    return PartitionedRecording(_expanded(paths), options.mapping, None, options.rate, cutoff, workers=workers)


def findings(found: Identified) -> list[RecordingFinding]:
    """What was assumed of the columns, once for all logs of which it is the same."""
    read = [*found.recordings, *(trial.test for trial in found.division.trials)]
    every = [finding for recording in read for finding in recording.findings]
    return list({(finding.code, finding.message): finding for finding in reversed(every)}.values())[::-1]


def _expanded(paths: Sequence[Path]) -> list[str]:
    """The arguments with patterns, which a shell leaves in quotation marks as they are, replaced by what they match."""
    return [name for path in paths for name in ([str(path)] if path.exists() else _matching(str(path)))]


def _matching(pattern: str) -> list[str]:
    return sorted(glob.glob(pattern)) or [pattern]  # what is not there is refused by name
