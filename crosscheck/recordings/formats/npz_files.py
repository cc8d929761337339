"""NumPy .npz files."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.recordings.formats.format import Format, check_expanded, refusing_damage, table_of
from crosscheck.recordings.table import RecordedTable
from crosscheck.recordings.virtual import RecordedMotion


def read_npz(path: Path) -> RecordedTable:
    """Read the arrays of a NumPy archive; pickled objects are refused."""
    return table_of(path, npz_arrays(path))


def npz_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of a NumPy archive by name. Raises BadRecordingFile, OSError."""
    content = path.read_bytes()
    arrays = {}
    with refusing_damage(path, ".npz file", "save it with numpy.savez"):
        _check_headers(path, content)
        with np.load(io.BytesIO(content), allow_pickle=False) as archive:
            for name in archive.files:
                try:
                    arrays[name] = np.asarray(archive[name])
                except (ValueError, MemoryError) as error:
                    raise BadRecordingFile(f"{path}: {name!r} is not an array of numbers; save it as one") from error
    return arrays


def _check_headers(path: Path, content: bytes) -> None:
    """Raise BadRecordingFile for arrays that are larger than allowed, or than their part of the archive."""
    from numpy.lib import format as npy

    newer = npy.read_array_header_2_0  # version 3 has field names in UTF-8 besides, of arrays that are no numbers
    readers = {(1, 0): npy.read_array_header_1_0, (2, 0): newer, (3, 0): newer}
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        check_expanded(path, sum(member.file_size for member in archive.infolist()))
        for member in archive.infolist():
            with archive.open(member) as file:
                if not member.filename.endswith(".npy") or (version := npy.read_magic(file)) not in readers:
                    continue
                shape, _, kind = readers[version](file)
                size = int(np.prod(shape, dtype=object)) * kind.itemsize
                if size > member.file_size and not kind.hasobject:
                    raise BadRecordingFile(
                        f"{path}: {member.filename!r} announces {size} bytes of numbers and has {member.file_size}; "
                        "save it with numpy.savez"
                    )


def write_npz(recording: RecordedMotion, path: Path, metadata: Mapping[str, str]) -> bytes:
    """An archive with the arrays t, q, v, a, tau, and the metadata as texts."""
    sink = io.BytesIO()
    texts = {name: np.array(text) for name, text in metadata.items()}
    channels = {"t": recording.time, "q": recording.q, "v": recording.v, "a": recording.a, "tau": recording.tau}
    arrays: dict[str, Any] = {"joint_names": np.array(recording.joint_names), **channels, **texts}
    np.savez_compressed(sink, **arrays)
    return sink.getvalue()


FORMATS = (Format((".npz",), lambda path, _mapping, _joints: read_npz(path), write=write_npz),)
