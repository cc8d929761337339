"""Text files as bytes, plain or compressed with gzip, and the largest file that is expanded in memory."""

from __future__ import annotations

import gzip
import io
import zlib
from codecs import BOM_UTF8
from pathlib import Path

from crosscheck.recordings.errors import BadRecordingFile

MAX_EXPANDED_BYTES = 1 << 30
"""Largest size of a file in memory after expansion [bytes]: a compressed file may expand a thousandfold. An hour at 1
kHz of six joints with q, v and tau, as doubles, takes half of it."""


def check_expanded(path: Path, size: int) -> None:
    """Raise BadRecordingFile for more bytes than may be expanded in memory."""
    if size > MAX_EXPANDED_BYTES:
        raise BadRecordingFile(
            f"{path}: its content is larger than {MAX_EXPANDED_BYTES} bytes when expanded; divide the file, or stream "
            "it as Parquet or CSV with crosscheck.StreamedRecording"
        )


def content_of(path: Path) -> bytes:
    """The content with line feeds at line ends, without byte order mark. Raises BadRecordingFile if it is not text."""
    content = _expanded(path) if path.suffix.lower() == ".gz" else path.read_bytes()
    try:
        content.decode()
    except UnicodeDecodeError as error:
        line = content[: error.start].count(b"\n") + 1
        raise BadRecordingFile(f"{path}, line {line}: not UTF-8 text; save the file as CSV in UTF-8") from error
    if b"\0" in content:
        line = content[: content.index(b"\0")].count(b"\n") + 1
        raise BadRecordingFile(f"{path}, line {line}: a zero byte, so not text; save the file as CSV in UTF-8")
    content = content.removeprefix(BOM_UTF8)
    return content.replace(b"\r\n", b"\n").replace(b"\r", b"\n") if b"\r" in content else content


def _expanded(path: Path) -> bytes:
    compressed = path.read_bytes()
    try:
        with gzip.open(io.BytesIO(compressed)) as file:
            content = file.read(MAX_EXPANDED_BYTES + 1)
    except (EOFError, OSError, zlib.error) as error:
        raise BadRecordingFile(f"{path}: not a whole gzip file ({error}); compress it again") from error
    check_expanded(path, len(content))
    return content
