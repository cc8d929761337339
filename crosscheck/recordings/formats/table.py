"""The table of formats: reading, streaming and writing a file by its suffix."""

from __future__ import annotations

import pkgutil
import zlib
from collections.abc import Iterator, Mapping
from errno import ENOENT
from functools import cache
from importlib import import_module
from pathlib import Path

from crosscheck.recordings.errors import BadRecordingFile
from crosscheck.recordings.formats.format import Format, table_of_columns
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.table import RecordedTable
from crosscheck.recordings.virtual import RecordedMotion
from graphdyn import InvalidInput

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


def tables(path: Path, delimiter: str | None, rows: int) -> Iterator[RecordedTable]:
    """The file as tables of at most this number of rows. Raises BadRecordingFile, OSError."""
    import pyarrow as pa

    if not path.exists():
        raise FileNotFoundError(ENOENT, "no such file", str(path))
    path.open("rb").close()  # what the system refuses is not the file's fault
    found = formats().get(suffix_of(path))
    if found is None or found.batches is None:
        streamed = ", ".join(suffix for suffix, each in formats().items() if each.batches)
        raise BadRecordingFile(f"{path}: only {streamed} files are streamed; convert it to one")
    try:
        names, batches = found.batches(path, delimiter, rows)
        for batch in batches:
            columns = pa.table(batch.columns, names=[str(k) for k in range(len(names))]).columns
            yield table_of_columns(path, names, columns)
    except (pa.ArrowException, OSError, EOFError, UnicodeDecodeError, zlib.error) as error:
        raise BadRecordingFile(f"{path}: {error}; load_recording gives details, or repair the file") from error


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
