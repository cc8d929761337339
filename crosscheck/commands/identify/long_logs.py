"""Which LOGs are read part by part although nobody asks for it: those that would take too much memory otherwise."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import TYPE_CHECKING

from crosscheck.commands.program.console import say
from crosscheck.commands.program.recording_options import files_per_recording

if TYPE_CHECKING:
    from crosscheck.commands.identify.options import IdentifyOptions
    from crosscheck.recordings import PartitionedRecording
    from crosscheck.recordings.preparation.derivatives import Cutoff

LONG_ROWS = 150_000
"""Number of rows from which LOGs are read part by part if they can: in memory they take some 2 kB a row, which
`python tests/tools recording_memory` measures."""

LINE_BYTES = 1 << 22
"""Bytes of a text file that are searched for ends of lines at once."""


def are_long(options: IdentifyOptions) -> bool:
    """Whether the LOGs are long, in formats that can be read part by part, and no option needs them in memory.

    Where only their content forbids it (repeated stamps, gaps, uneven steps, …), a note says so.
    """
    logs = [*(options.logs or []), *(options.validate or [])]
    if not logs or not _options_allow(options) or not all(map(_is_streamed, logs)):
        return False
    if sum(map(_rows, logs)) < LONG_ROWS:
        return False
    from crosscheck.recordings import BadRecordingFile, PartitionedRecording, load_mapping
    from graphdyn import InvalidInput

    mapping = None if options.mapping is None else load_mapping(options.mapping)
    if files_per_recording(mapping) > 1:
        return False
    try:
        _check(PartitionedRecording(logs, options.mapping, None, options.rate), options.low_pass)
    except (InvalidInput, BadRecordingFile) as error:
        say(f"note: the LOGs are long, and read into memory all the same: {error}")
        return False
    say(
        "note: the LOGs are long, and read part by part, by methods that need no more than sums; options that need "
        "every sample (--methods huber, --folds, --decimate, …) read them into memory"
    )
    return True


def _check(data: PartitionedRecording, cutoff: Cutoff) -> None:
    """Raise InvalidInput or BadRecordingFile for LOGs that cannot be read in parts.

    data: all LOGs, without a filter
    """
    from crosscheck.identifying.long_recordings import HELD_OUT_SHARE

    data.check()
    cutoff = data.residual_cutoff() if isinstance(cutoff, str) else cutoff
    for between in ((0.0, 1 - HELD_OUT_SHARE), (1 - HELD_OUT_SHARE, 1.0)):
        _ = replace(data, cutoff=cutoff, between=between).logs  # too short for the borders of the filter


def _options_allow(options: IdentifyOptions) -> bool:
    from crosscheck.commands.identify.options import OF_MEMORY
    from crosscheck.identifying import METHODS_OF_SUMS

    defaults = {each.name: each.default for each in fields(options)}
    if any(getattr(options, name) != defaults[name] for name in (*OF_MEMORY, "models", "term")):
        return False
    named = [] if options.methods is None else [name.strip() for name in options.methods.split(",")]
    texts = [
        *(options.terms or []),
        options.width or "",
        options.stribeck_velocity or "",
        options.stribeck_exponent or "",
    ]
    fitted = any("slip" in text or "fit" in text for text in texts)
    return set(named) <= set(METHODS_OF_SUMS) and not fitted


def _is_streamed(path: Path) -> bool:
    from crosscheck.recordings.parts.partitions import PARQUET_SUFFIXES
    from crosscheck.recordings.parts.text_logs import is_text_log

    return path.is_file() and (path.suffix.lower() in PARQUET_SUFFIXES or is_text_log(path))


def _rows(path: Path) -> int:
    """Number of rows; of a text file, that of its lines; of what is no Parquet file, none."""
    from crosscheck.recordings.arrow import check_arrow

    check_arrow(path)
    import pyarrow as pa
    from pyarrow import parquet

    if path.suffix.lower() not in (".csv", ".gz"):
        try:
            return int(parquet.read_metadata(path).num_rows)
        except (pa.ArrowException, OSError):  # reading it says what is wrong
            return 0
    try:
        with pa.input_stream(str(path), compression="gzip" if path.suffix.lower() == ".gz" else None) as file:
            return sum(part.count(b"\n") for part in iter(lambda: file.read(LINE_BYTES), b""))
    except (pa.ArrowException, OSError, EOFError):
        return 0
