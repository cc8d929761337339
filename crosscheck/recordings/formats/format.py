"""Description of a file format of recordings, what several formats share, and reading and writing by the suffix.

A file of this room describes its formats in FORMATS. Shared are text files as bytes, plain or compressed with gzip, and
named arrays of a file as columns.
"""

from __future__ import annotations

import gzip
import io
import pkgutil
import zlib
from codecs import BOM_UTF8
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from errno import ENOENT
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.recordings.arrow import check_arrow
from crosscheck.recordings.errors import BadRecordingFile, RecordingFinding, noted, reason
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.table import Cells, RecordedTable, cells_of_array, cells_of_column, in_words
from crosscheck.recordings.virtual import RecordedMotion
from graphdyn import InvalidInput
from graphdyn.errors import counted


@dataclass(frozen=True)
class Format:
    """A file format of recordings; formats() collects those in FORMATS of the modules of this room.

    suffixes: endings of its files in lower case; a motion is written with the first
    read: the table of a file, given the mapping and the joints wanted, if they are known
    batches: column names and Arrow batches of at most this number of rows, given the mapping; None for a format that
        is only read as a whole
    write: the content of a file with this motion and metadata; None for a format that is only read
    """

    suffixes: tuple[str, ...]
    read: Callable[[Path, ColumnMapping | None, tuple[str, ...] | None], RecordedTable]
    batches: Callable[[Path, ColumnMapping | None, int], tuple[Sequence[str], Iterable[Any]]] | None = None
    write: Callable[[RecordedMotion, Path, Mapping[str, str]], bytes] | None = None


MAX_EXPANDED_BYTES = 1 << 30
"""Largest size of a file in memory after expansion [bytes]: a compressed file may expand a thousandfold. An hour at 1
kHz of six joints with q, v and tau, as doubles, takes half of it."""


def check_expanded(path: Path, size: int) -> None:
    """Raise BadRecordingFile for more bytes than may be expanded in memory."""
    if size > MAX_EXPANDED_BYTES:
        raise BadRecordingFile(
            f"{path}: its content is larger than {MAX_EXPANDED_BYTES} bytes when expanded; divide the file, or stream "
            "a recording as Parquet or CSV with crosscheck.StreamedRecording"
        )


@contextmanager
def refusing_damage(path: Path, what: str, remedy: str) -> Iterator[None]:
    """Raise BadRecordingFile in place of whatever a damaged file makes a library raise. what: kind of file"""
    try:
        yield
    except (BadRecordingFile, BlockingIOError):  # the latter: no further process can be started
        raise
    except Exception as error:
        raise BadRecordingFile(f"{path}: not a readable {what} ({reason(error)}); {remedy}") from error


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
        raise BadRecordingFile(f"{path}: not a whole gzip file ({reason(error)}); compress it again") from error
    check_expanded(path, len(content))
    return content


def table_of(path: Path, arrays: Mapping[str, Any]) -> RecordedTable:
    """Table with one row per time: (N,) becomes a column, (N, k) and (k, N) the columns name_1 … name_k.

    N is the length that most arrays have along their longest axis. Raises BadRecordingFile if no array has rows.
    """
    found: dict[str, tuple[tuple[int, ...], Cells]] = {}
    left_out = {}
    for name, value in arrays.items():
        array = np.asarray(value)
        numeric = array.dtype.kind in "biufcmM"
        if numeric and array.ndim == 0:  # a parameter, no column
            continue
        if array.ndim == 2 and 1 in array.shape:  # MATLAB has no arrays of one dimension
            array = array.ravel()
        cells: Cells | str = f"its shape is {array.shape}, where (N,) or (N, n) is needed"
        if not numeric or (array.ndim in (1, 2) and array.size):
            cells = cells_of_array(array)
        if isinstance(cells, str):
            left_out[name] = cells
        else:
            found[name] = (array.shape, cells)
    if not found:
        reasons = "; ".join(f"{name!r}: {reason}" for name, reason in left_out.items())
        there = f" ({reasons})" if reasons else ""
        raise BadRecordingFile(f"{path}: no arrays with one row per time{there}; save t (N,) and q, tau (N, n)")
    count = Counter(max(shape) for shape, _ in found.values()).most_common(1)[0][0]
    names: list[str] = []
    columns: list[Cells] = []
    turned = []
    for name, (shape, cells) in found.items():
        values = cells.values
        if len(shape) == 2 and shape[0] != count and shape[1] == count:
            values = values.T
            turned.append(name)
        if len(values) != count:
            left_out[name] = f"its shape is {shape}, most others have {counted(count, 'row')}"
        elif values.ndim == 1:
            names.append(name)
            columns.append(cells)
        else:
            names += [f"{name}_{k}" for k in range(1, values.shape[1] + 1)]
            columns += [cells._replace(values=column) for column in values.T]
    findings = left_out_findings(path, left_out)
    if turned:
        message = f"{in_words(turned)}: one column per time"
        remedy = "transposed, so that each row is a time"
        findings += (noted(str(path), "turned-array", message, remedy),)
    return RecordedTable.of(path, names, columns, left_out=left_out, findings=findings)


def left_out_findings(path: Path, left_out: Mapping[str, str]) -> tuple[RecordingFinding, ...]:
    """Findings on parts of the file that are not read."""
    if not left_out:
        return ()
    message = f"not read: {in_words(f'{name} ({reason})' for name, reason in left_out.items())}"
    return (noted(str(path), "left-out", message, "save columns of numbers"),)


def table_of_columns(path: Path, headers: Sequence[str], arrays: Sequence[Any]) -> RecordedTable:
    """The table of Arrow columns. Raises BadRecordingFile if none holds numbers."""
    import pyarrow as pa

    names: list[str] = []
    columns: list[Cells] = []
    left_out: dict[str, str] = {}
    texts: dict[int, dict[int, str]] = {}
    for name, column in zip(headers, arrays, strict=True):
        kind = column.type
        if pa.types.is_list(kind) or pa.types.is_large_list(kind) or pa.types.is_fixed_size_list(kind):
            elements: list[Cells] | Cells | str = _elements(column)
        else:
            elements = cells_of_column(column)
        if isinstance(elements, str):
            left_out[name] = elements
        elif isinstance(elements, Cells):
            if pa.types.is_string(kind) or pa.types.is_large_string(kind):
                cells = column.to_pylist()
                texts[len(names)] = {int(row): cells[row] or "" for row in np.flatnonzero(np.isnan(elements.values))}
            names.append(name)
            columns.append(elements)
        else:
            names += [f"{name}_{k}" for k in range(1, len(elements) + 1)]
            columns += elements
    if not columns:
        raise BadRecordingFile(f"{path}: no column of numbers; save time, q and tau")
    findings = left_out_findings(path, left_out)
    return RecordedTable.of(path, names, columns, texts=texts, left_out=left_out, findings=findings)


def _elements(column: Any) -> list[Cells] | str:
    """One column per element of lists of the same length; or the reason why there are none."""
    from pyarrow import compute

    widths = compute.unique(compute.list_value_length(column)).to_pylist()
    if len(widths) != 1 or not widths[0]:
        return "lists of different lengths"
    flat = cells_of_column(compute.list_flatten(column))
    if isinstance(flat, str):
        return flat
    return [flat._replace(values=values) for values in flat.values.reshape(-1, widths[0]).T]


BAG = ".bag"
"""Suffix of the format that a folder has."""


@cache
def formats() -> Mapping[str, Format]:
    """Formats by suffix: those in FORMATS of the modules of this room."""
    folder = [str(Path(__file__).parent)]
    modules = (import_module(f"{__package__}.{found.name}") for found in pkgutil.iter_modules(folder))
    found = [each for module in modules for each in getattr(module, "FORMATS", ())]
    return {suffix: each for each in found for suffix in each.suffixes}


def suffix_of(path: Path) -> str:
    """The suffix of a name in lower case, .csv.gz as a whole."""
    return "".join(path.suffixes[-2:] if path.suffix.lower() == ".gz" else path.suffixes[-1:]).lower()


def read_table(path: Path, mapping: ColumnMapping | None, joints: tuple[str, ...] | None) -> RecordedTable:
    """The table of one file, read by its suffix; a folder is a ROS 2 bag. Raises BadRecordingFile, OSError."""
    if not path.exists():
        raise FileNotFoundError(ENOENT, "no such file", str(path))
    if path.is_dir() and not (path / "metadata.yaml").exists():
        raise BadRecordingFile(f"{path}: is a folder, and no ROS 2 bag: it has no metadata.yaml; give a file")
    suffix = BAG if path.is_dir() else suffix_of(path)
    if suffix not in formats():
        known = ", ".join(formats())
        raise BadRecordingFile(
            f"{path}: recordings cannot be read from '{suffix}' files; convert it to one of: {known}"
        )
    return formats()[suffix].read(path, mapping, joints)


def tables(path: Path, mapping: ColumnMapping | None, rows: int) -> Iterator[RecordedTable]:
    """The file as tables of at most this number of rows. Raises BadRecordingFile, OSError."""
    check_arrow(path)
    import pyarrow as pa

    if not path.exists():
        raise FileNotFoundError(ENOENT, "no such file", str(path))
    path.open("rb").close()  # what the system refuses is not the file's fault
    found = formats().get(suffix_of(path))
    if found is None or found.batches is None:
        streamed = ", ".join(suffix for suffix, each in formats().items() if each.batches)
        raise BadRecordingFile(f"{path}: only {streamed} files are streamed; convert it to one")
    try:
        names, batches = found.batches(path, mapping, rows)
        for batch in batches:
            columns = pa.table(batch.columns, names=[str(k) for k in range(len(names))]).columns
            yield table_of_columns(path, names, columns)
    except (pa.ArrowException, OSError, EOFError, UnicodeDecodeError, zlib.error) as error:
        raise BadRecordingFile(f"{path}: {reason(error)}; load_recording gives details, or repair the file") from error


def written_suffixes() -> tuple[str, ...]:
    """Suffixes with which a motion can be written."""
    return tuple(suffix for suffix, each in formats().items() if each.write and suffix == each.suffixes[0])


def motion_document(recording: RecordedMotion, path: Path, metadata: Mapping[str, str]) -> bytes:
    """The content of a file of this name with a simulated motion; load_recording reads it.

    Parquet and CSV take a VirtualRecording, with every channel; .npz has the channels of the joints. An MCAP bag has
    the messages that a robot publishes, sensor_msgs/JointState, which cannot hold accelerations and constraint
    forces. Parquet, .npz and MCAP carry the metadata, such as the URDF; CSV cannot.

    Raises InvalidInput for another suffix; BadRecordingFile without rosbags.
    """
    found = formats().get(path.suffix.lower())
    if found is None or found.write is None or path.suffix.lower() != found.suffixes[0]:
        known = ", ".join(written_suffixes())
        raise InvalidInput(f"{path}: a motion is written as {known}, not as '{path.suffix}'")
    return found.write(recording, path, metadata)
