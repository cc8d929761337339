"""MATLAB .mat files: variables, and fields of structures."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.recordings.formats.format import MAX_EXPANDED_BYTES, Format, check_expanded, refusing_damage, table_of
from crosscheck.recordings.table import RecordedTable

HEADER_BYTES, COMPRESSED_TYPE = 128, 15
"""Layout of version 5 files: bytes before the first element; type of an element that is compressed with zlib."""


def read_mat(path: Path) -> RecordedTable:
    """Read the variables of a MATLAB file, including fields of structures (data.q); version 7.3 needs h5py."""
    from scipy.io import loadmat

    content = path.read_bytes()
    with refusing_damage(path, ".mat file", "save it with save('-v7')"):
        check_expanded(path, _expanded_size(content))
        try:
            variables = loadmat(io.BytesIO(content), simplify_cells=True)
        except NotImplementedError:
            variables = _read_hdf5(path)
    return table_of(path, _flat({name: value for name, value in variables.items() if not name.startswith("__")}))


def _expanded_size(content: bytes) -> int:
    """Size of the elements of a file of version 5 after expansion [bytes]; the count stops at the limit."""
    order = {b"IM": "<", b"MI": ">"}.get(content[HEADER_BYTES - 2 : HEADER_BYTES])
    if order is None:  # version 4, which is not compressed
        return len(content)
    size, place = 0, HEADER_BYTES
    while place + 8 <= len(content) and size <= MAX_EXPANDED_BYTES:
        kind, length = struct.unpack_from(f"{order}II", content, place)
        place += 8
        if kind == COMPRESSED_TYPE:
            expander, rest = zlib.decompressobj(), content[place : place + length]
            while rest and size <= MAX_EXPANDED_BYTES:
                size += len(expander.decompress(rest, 1 << 24))
                rest = expander.unconsumed_tail
        else:
            size += length
        place += length
    return size


def _read_hdf5(path: Path) -> dict[str, Any]:
    """The variables of a version 7.3 file, which stores arrays with their axes reversed."""
    try:
        import h5py
    except ImportError as error:
        raise BadRecordingFile(
            f"{path}: of MATLAB version 7.3; save it with save('-v7'), or install graphdyn with its extra 'mat73'"
        ) from error
    sizes: list[int] = []

    def content(node: Any) -> Any:
        if isinstance(node, h5py.Group):
            return {name: content(child) for name, child in node.items() if not name.startswith("#")}
        if node.dtype.kind not in "fiub":
            return "no numbers"
        sizes.append(node.size * node.dtype.itemsize)
        check_expanded(path, sum(sizes))
        return np.transpose(node[()])

    with h5py.File(path) as file:
        return dict(content(file))


def _flat(variables: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """The fields of structures as 'structure.field'."""
    flat: dict[str, Any] = {}
    for name, value in variables.items():
        flat |= _flat(value, f"{prefix}{name}.") if isinstance(value, Mapping) else {f"{prefix}{name}": value}
    return flat


FORMATS = (Format((".mat",), lambda path, _mapping, _joints: read_mat(path)),)
