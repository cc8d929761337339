"""The largest file that is expanded in memory: compressed files may be a thousand times larger than they look."""

from __future__ import annotations

from pathlib import Path

from crosscheck.recordings.errors import BadRecordingFile

LARGEST_EXPANDED = 1 << 30
"""[bytes] An hour at 1 kHz of six joints with q, v and tau, as doubles, is half of it."""


def check_expanded(path: Path, size: int) -> None:
    """Raise BadRecordingFile for more bytes than are expanded in memory."""
    if size > LARGEST_EXPANDED:
        raise BadRecordingFile(
            f"{path}: its content is larger than {LARGEST_EXPANDED} bytes when expanded; divide the file, or stream it "
            "as Parquet or CSV with crosscheck.StreamedRecording"
        )
