"""Loading of recordings from files: read, map, convert, check, drop the rows that may be dropped."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings.checks import (
    Origin,
    blocks_of,
    cell_findings,
    channel_findings,
    motion_findings,
    stamp_findings,
    step_findings,
    times,
    value_findings,
)
from crosscheck.recordings.errors import (
    DROPPABLE,
    DROPPED_UNASKED,
    BadMapping,
    BadRecordingFile,
    DirtyRecording,
    RecordingFinding,
    spans,
)
from crosscheck.recordings.formats.format import read_table
from crosscheck.recordings.mapping.conversion import (
    RecordedColumn,
    joint_channels,
    mapped_columns,
    sliding_joints,
)
from crosscheck.recordings.mapping.mapping import ColumnMapping, given_mapping
from crosscheck.recordings.mapping.mapping_by_name import mapping_by_name
from crosscheck.recordings.preparation.resampling import with_delays_undone
from crosscheck.recordings.recording import RECORDED_JOINT_CHANNELS, Provenance, Recording
from crosscheck.recordings.table import in_words
from graphdyn import InvalidInput
from graphdyn.layout import Array

Paths = str | PathLike[str] | Sequence[str | PathLike[str]]


class _Content(NamedTuple):
    """Content of the files: mapping, time (N,), joint channels (N, n), which joints slide, all findings.

    origin: the stamp at t = 0
    """

    files: tuple[str, ...]
    mapping: ColumnMapping
    t: Array
    origin: Origin
    channels: dict[str, Array]
    slides: tuple[bool, ...]
    findings: list[RecordingFinding]


def load_recording(
    paths: Paths,
    mapping: ColumnMapping | str | PathLike[str] | None = None,
    *,
    joints: Sequence[str] | None = None,
    rate: float | None = None,
    drop: Collection[str] = (),
    currents: bool = False,
) -> Recording:
    """Read a recording: one file, or several files with the same rows that a mapping joins.

    mapping: a ColumnMapping or its TOML file; None finds the columns by their names
    joints: names in the order of the robot; the recording's joints are these, in this order
    rate: samples per second, if no column holds the time
    drop: codes of findings whose rows are dropped ("repeated-stamp", …; all of them: DROPPABLE)
    currents: without a mapping, tau are the currents of the motors as recorded, where there are any

    t is that of the file; stamps since 1970 are counted from the first row, which the provenance states.

    Raises DirtyRecording, with all findings, for faulty rows that are not to be dropped; BadRecordingFile,
    AmbiguousColumns, BadMapping, InvalidInput; OSError for an unreadable file.
    """
    unknown = [code for code in drop if code not in DROPPABLE]
    if unknown:
        raise InvalidInput(f"drop has {unknown[0]!r}; rows can be dropped for: {', '.join(DROPPABLE)}")
    content = _read(paths, mapping, joints, rate, currents)
    remaining = [f for f in content.findings if f.severity == "error" and f.code not in drop]
    if remaining:
        raise DirtyRecording(tuple(content.findings))
    dropped = [f for f in content.findings if f.code in {*drop, *DROPPED_UNASKED} and f.rows]
    kept = _without(len(content.t), dropped)
    if not kept.any():
        raise BadRecordingFile(f"{', '.join(content.files)}: no row is left; repair the file instead of dropping rows")
    origin = content.origin.seconds
    steps = [f"time counted from the first stamp, {origin:.6f} s"] if origin else []
    steps += [f"dropped {f.code}: rows {spans(f.rows)} of {f.file}" for f in dropped]
    t = content.t[kept]
    channels: dict[str, Any] = {name: values[kept] for name, values in content.channels.items()}
    recording = Recording(
        joint_names=content.mapping.joints,
        prismatic=content.slides,
        t=t,
        **channels,
        block=blocks_of(t),
        rows=np.flatnonzero(kept),
        provenance=Provenance(content.files, content.mapping.source, tuple(steps), content.mapping),
        findings=tuple(content.findings),
    )
    recording = with_delays_undone(recording, content.mapping)
    return recording if joints is None else reordered(recording, joints)


def inspect_recording(
    paths: Paths,
    mapping: ColumnMapping | str | PathLike[str] | None = None,
    *,
    joints: Sequence[str] | None = None,
    rate: float | None = None,
) -> tuple[RecordingFinding, ...]:
    """All findings of load_recording, errors first, without refusing faulty rows. Raises for unreadable files."""
    order = ("error", "warning", "note")
    findings = _read(paths, mapping, joints, rate).findings
    return tuple(sorted(findings, key=lambda finding: order.index(finding.severity)))


def _read(
    paths: Paths,
    mapping: ColumnMapping | str | PathLike[str] | None,
    joints: Sequence[str] | None,
    rate: float | None,
    currents: bool = False,
) -> _Content:
    files = [Path(path) for path in ([paths] if isinstance(paths, str | PathLike) else paths)]
    mapping = given_mapping(mapping, rate)
    if len(files) != 1 and mapping is None:
        raise BadMapping(f"{len(files)} files without a mapping; give one that says which file has which columns")
    tables = [read_table(path, mapping, tuple(joints) if joints else None) for path in files]
    findings = [finding for table in tables for finding in table.findings]
    if mapping is None:
        mapping, said = mapping_by_name(tables[0], joints, rate, currents)
        findings += said
    by_quantity = mapped_columns(tables, mapping)
    columns = list({(c.table.path, c.number): c for found in by_quantity.values() for c in found}.values())
    slides, channels = sliding_joints(mapping, ", ".join(map(str, files))), joint_channels(by_quantity, mapping)
    count, file, lines = len(tables[0].values), str(files[0]), tables[0].lines
    malformed = [f for f in findings if f.rows and f.code != "unterminated-last-line"]
    findings += cell_findings(columns, _without(count, malformed))
    findings += value_findings(file, mapping.joints, slides, channels, lines)
    t, origin = _time(mapping, by_quantity.get("time"), count)
    sound = _without(count, [f for f in findings if f.severity == "error"] + malformed)
    findings += stamp_findings(file, t, sound, lines, origin.seconds)
    sound = _without(count, [f for f in findings if f.severity == "error"] + malformed)
    rows = np.flatnonzero(sound)
    findings += channel_findings(columns, sound)
    findings += step_findings(file, t[sound], rows, mapping.rate if mapping.time else None, lines)
    if "v" in channels and rows.size:
        q, v = channels["q"][sound], channels["v"][sound]
        findings += motion_findings(file, mapping.joints, t[sound], blocks_of(t[sound]), q, v)
    return _Content(tuple(map(str, files)), mapping, t, origin, channels, slides, findings)


def _time(mapping: ColumnMapping, column: list[RecordedColumn] | None, count: int) -> tuple[Array, Origin]:
    if column is not None and mapping.time is not None:
        return times(column, mapping.time.factor)
    assert mapping.rate is not None  # a mapping has one or the other
    return np.arange(count) / mapping.rate, Origin()


def _without(count: int, findings: Iterable[RecordingFinding]) -> NDArray[np.bool_]:
    """The rows (N,) that are in none of the findings."""
    kept = np.ones(count, dtype=bool)
    for finding in findings:
        kept[list(finding.rows)] = False
    return kept


def reordered(recording: Recording, joints: Sequence[str]) -> Recording:
    """The recording with its joints in this order. Raises BadMapping for other joints."""
    missing = [joint for joint in joints if joint not in recording.joint_names]
    if missing:
        raise BadMapping(
            f"{recording.provenance.mapping}: no joint {missing[0]!r} among {in_words(recording.joint_names)}; "
            "name the joints as the robot does"
        )
    order = [recording.joint_names.index(joint) for joint in joints]
    if order == list(range(recording.n_joints)):
        return recording
    moved = {name: getattr(recording, name)[:, order] for name in recording.recorded(RECORDED_JOINT_CHANNELS)}
    slides = tuple(recording.prismatic[j] for j in order)
    step = f"joints in the order {', '.join(joints)}"
    return recording.take(slice(None), step, joint_names=tuple(joints), prismatic=slides, **moved)
