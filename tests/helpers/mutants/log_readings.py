"""Readings of logs in other forms than one plain file: exact ones, compressed ones, bags of folders, streams, parts."""

from __future__ import annotations

import csv
import gzip
import re
import shutil
from collections.abc import Callable, Iterable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from mutants.readings import JOINTS, Numbers, bag_columns, csv_columns, differs, first
from planting import mixed_tree

import graphdyn
from crosscheck.recordings import (
    PartitionedRecording,
    Recording,
    StreamedRecording,
    differentiated,
    load_recording,
    samples_of,
)
from crosscheck.recordings.virtual import ROBOT, TIME, Elements, columns
from graphdyn import VirtualRecording
from graphdyn.layout import Array
from graphdyn.motion_laws import ConstantAcceleration


@cache
def exact() -> VirtualRecording:
    """Three joints, the second of which slides, at three times."""
    laws = [ConstantAcceleration(1.0), ConstantAcceleration(-0.3, 0.1), ConstantAcceleration(2.0)]
    return graphdyn.simulate_recording(mixed_tree(), [0.0, 0.1, 1 / 3], laws)


def exact_fault(second: Callable[[Path], dict[str, list[Any]]]) -> Callable[[Path, Any], str | None]:
    """Every number is that of its column, to the last bit."""

    def fault(path: Path, found: VirtualRecording) -> str | None:
        table = {re.sub(r"\s*\[", " [", name.strip()): cells for name, cells in second(path).items()}

        def one(header: str, values: Array) -> str | None:
            there = np.array(table.pop(header), dtype=float)
            return None if np.array_equal(values, there) else f"{header} is {values!r:.200}, in the file {there!r:.200}"

        elements = Elements(found.joint_names, found.prismatic, found.body_names)
        rows = len(found.time)
        of = {c.header: getattr(found, c.channel).reshape(rows, -1)[:, c.number] for c in columns(elements)}
        robots = {str(name).strip() for name in table.pop(ROBOT)}
        return (
            differs("names of robots", {found.robot}, robots)
            or first(one(header, values) for header, values in {TIME: found.time, **of}.items())
            or differs("columns left over", list(table), [])
        )

    return fault


def exact_csv(path: Path) -> dict[str, list[Any]]:
    with path.open(encoding="utf-8-sig", newline="") as opened:
        head, *rows = csv.reader(opened)
    return {name: [row[k].strip() for row in rows] for k, name in enumerate(head)}


def exact_parquet(path: Path) -> dict[str, list[Any]]:
    from pyarrow import parquet

    table = parquet.read_table(path)
    return dict(zip(table.column_names, (column.to_pylist() for column in table.columns), strict=True))


def compressed_columns(path: Path) -> Numbers:
    plain = path.with_suffix("")
    plain.write_bytes(gzip.decompress(path.read_bytes()))
    return csv_columns(plain)


def folder_of(path: Path, content: bytes, name: str) -> Path:
    """A bag of a file of messages, and of what is in path, the text beside it."""
    folder = path.with_name(f"bag of {path.name}")
    folder.mkdir(exist_ok=True)
    shutil.copy(path, folder / "metadata.yaml")
    (folder / name).write_bytes(content)
    return folder


def folder_recording(content: Callable[[], bytes], name: str) -> Callable[[Path], Recording]:
    return lambda path: load_recording(folder_of(path, content(), name), joints=JOINTS)


def folder_columns(content: Callable[[], bytes], name: str) -> Callable[[Path], Numbers]:
    """The messages of the file, whatever the text beside it says."""
    return lambda path: bag_columns(folder_of(path, content(), name) / name)


Pieces = dict[str, Array]


def streamed(path: Path) -> Pieces:
    return pieces(StreamedRecording(path, joints=JOINTS))


def partitioned(path: Path) -> Pieces:
    return pieces(PartitionedRecording([path], joints=JOINTS))


def pieces(data: Iterable[Any]) -> Pieces:
    found = list(data)
    return {name: np.concatenate([getattr(one, name) for one in found]) for name in ("q", "v", "a", "tau")}


def pieces_fault(path: Path, found: Pieces) -> str | None:
    """They are those of the recording that is loaded whole."""
    whole = pieces(samples_of(differentiated(load_recording(path, joints=JOINTS), None)))
    return first(differs(name, found[name], whole[name]) for name in whole)
