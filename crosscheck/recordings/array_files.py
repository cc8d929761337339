"""Parquet, NumPy .npz and MATLAB .mat files: named arrays, one per column or one for several columns."""

from __future__ import annotations

import zipfile
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.recordings.cells import as_doubles
from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.recordings.findings import RecordingFinding
from crosscheck.recordings.table import RecordedTable


def read_parquet(path: Path) -> RecordedTable:
    """Read a Parquet file; a column of lists becomes one column per element, name_1, name_2, …"""
    import pyarrow as pa
    from pyarrow import parquet

    try:
        table = parquet.read_table(pa.BufferReader(path.read_bytes()))
    except (pa.ArrowException, OSError) as error:
        raise BadRecordingFile(f"{path}: not a readable Parquet file ({error}); save it again") from error
    arrays: dict[str, Any] = {}
    for name, column in zip(table.column_names, table.columns, strict=True):
        if pa.types.is_list(column.type) or pa.types.is_fixed_size_list(column.type):
            lists = column.to_pylist()
            widths = {len(cells or ()) for cells in lists}
            arrays[name] = np.array(lists, dtype=float) if len(widths) == 1 else "lists of different lengths"
        elif pa.types.is_timestamp(column.type):
            arrays[name] = column.to_numpy().astype("datetime64[ns]")
        else:
            arrays[name] = as_doubles(column)
    return table_of(path, arrays)


def read_npz(path: Path) -> RecordedTable:
    """Read the arrays of a NumPy archive; pickled objects are refused."""
    try:
        with np.load(path, allow_pickle=False) as archive:
            arrays = {}
            for name in archive.files:
                try:
                    arrays[name] = archive[name]
                except ValueError as error:
                    raise BadRecordingFile(f"{path}: '{name}' is not an array of numbers; save it as one") from error
    except (zipfile.BadZipFile, ValueError, EOFError, TypeError) as error:
        if isinstance(error, BadRecordingFile):
            raise
        raise BadRecordingFile(f"{path}: not a readable .npz file ({error}); save it with numpy.savez") from error
    return table_of(path, arrays)


def read_mat(path: Path) -> RecordedTable:
    """Read the variables of a MATLAB file, including fields of structures (data.q); version 7.3 needs h5py."""
    from scipy.io import loadmat
    from scipy.io.matlab import MatReadError

    try:
        variables = loadmat(path, simplify_cells=True)
    except NotImplementedError:
        variables = _read_hdf5(path)
    except (MatReadError, ValueError, TypeError, EOFError) as error:
        raise BadRecordingFile(f"{path}: not a readable .mat file ({error}); save it with save('-v7')") from error
    return table_of(path, _flat({name: value for name, value in variables.items() if not name.startswith("__")}))


def _read_hdf5(path: Path) -> dict[str, Any]:
    """The variables of a version 7.3 file, which stores arrays with their axes reversed."""
    try:
        import h5py
    except ImportError as error:
        raise BadRecordingFile(
            f"{path}: of MATLAB version 7.3; save it with save('-v7'), or install graphdyn with its extra 'mat73'"
        ) from error

    def content(node: Any) -> Any:
        if isinstance(node, h5py.Group):
            return {name: content(child) for name, child in node.items() if not name.startswith("#")}
        return np.transpose(node[()]) if node.dtype.kind in "fiub" else "no numbers"

    try:
        with h5py.File(path) as file:
            return dict(content(file))
    except OSError as error:
        raise BadRecordingFile(f"{path}: not a readable .mat file ({error}); save it with save('-v7')") from error


def _flat(variables: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    """The fields of structures as 'structure.field'."""
    flat: dict[str, Any] = {}
    for name, value in variables.items():
        flat |= _flat(value, f"{prefix}{name}.") if isinstance(value, Mapping) else {f"{prefix}{name}": value}
    return flat


def table_of(path: Path, arrays: Mapping[str, Any]) -> RecordedTable:
    """One row per time: (N,) becomes a column, (N, k) and (k, N) the columns name_1 … name_k.

    N is the length that most arrays have along their longest axis. Raises BadRecordingFile where no array has rows.
    """
    numbers, left_out = {}, {}
    for name, value in arrays.items():
        array = np.squeeze(np.asarray(value))
        if array.dtype.kind == "M":
            array = (array - array.min()) / np.timedelta64(1, "s")
        if array.dtype.kind not in "fiub":
            left_out[name] = value if isinstance(value, str) and value else "it holds no numbers"
        elif array.ndim not in (1, 2):
            left_out[name] = f"its shape is {array.shape}"
        else:
            numbers[name] = array.astype(float)
    if not numbers:
        raise BadRecordingFile(f"{path}: no arrays with one row per time; save t (N,) and q, tau (N, n)")
    count = Counter(max(array.shape) for array in numbers.values()).most_common(1)[0][0]
    names, columns, turned = [], [], []
    for name, array in numbers.items():
        if array.ndim == 2 and len(array) != count and array.shape[1] == count:
            array = array.T
            turned.append(name)
        if len(array) != count:
            left_out[name] = f"its shape is {array.shape}, most others have {count} rows"
        elif array.ndim == 1:
            names.append(name)
            columns.append(array)
        else:
            names += [f"{name}_{k + 1}" for k in range(array.shape[1])]
            columns += list(array.T)
    findings = []
    if turned:
        message = f"{', '.join(turned)}: one column per time"
        findings.append(
            RecordingFinding(
                "turned-array", "note", str(path), None, (), message, "transposed, so that each row is a time"
            )
        )
    return RecordedTable(path, tuple(names), np.column_stack(columns), left_out=left_out, findings=tuple(findings))
