"""Apache Arrow, which parses tables of text and reads and writes Parquet: an extra, because it is large."""

from __future__ import annotations

from importlib.util import find_spec

from crosscheck.recordings.errors import BadRecordingFile
from graphdyn.errors import not_installed


def check_arrow(file: object) -> None:
    """Raise BadRecordingFile, naming a file that is to be read or written, where Arrow is not installed."""
    if find_spec("pyarrow") is None:
        raise BadRecordingFile(f"{file}: {not_installed('pyarrow', 'recordings')}")
