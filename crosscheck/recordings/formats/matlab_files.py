"""MATLAB .mat files: variables, and fields of structures."""

from __future__ import annotations

from pathlib import Path

from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.recordings.formats.format import MAX_EXPANDED_BYTES, Format, check_expanded, refusing_damage, table_of
from crosscheck.recordings.formats.parsed_apart import arrays_apart
from crosscheck.recordings.table import RecordedTable
from graphdyn.errors import install_line


def read_mat(path: Path) -> RecordedTable:
    """Read the variables of a MATLAB file, including fields of structures (data.q); version 7.3 needs h5py."""
    path.open("rb").close()  # what the system refuses is not the file's fault
    with refusing_damage(path, ".mat file", "save it with save('-v7')"):
        try:
            arrays, size = arrays_apart(path, MAX_EXPANDED_BYTES)
        except ModuleNotFoundError:
            raise BadRecordingFile(
                f"{path}: of MATLAB version 7.3; save it with save('-v7'), or run: {install_line('mat73')}"
            ) from None
        check_expanded(path, size)
        return table_of(path, arrays)


FORMATS = (Format((".mat",), lambda path, _mapping, _joints: read_mat(path)),)
