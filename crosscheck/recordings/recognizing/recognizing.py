"""Recognition of the columns of a log: names first, then how columns move together, then what fits the robot.

Where one reading is possible, it is taken, and said; where several are, they are listed, and none is taken.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from os import PathLike
from pathlib import Path

from crosscheck.recordings.errors import AmbiguousColumns, BadRecordingFile
from crosscheck.recordings.formats.format import read_table
from crosscheck.recordings.mapping.mapping import ColumnMapping
from crosscheck.recordings.mapping.units import known_unit
from crosscheck.recordings.recognizing.blocks import ColumnBlock, block_sizes, named_blocks, quantity_of
from crosscheck.recordings.recognizing.clocks import clocks_of, rate_choice
from crosscheck.recordings.recognizing.positions import positions, velocities
from crosscheck.recordings.recognizing.recognized import (
    RecognizedBlock,
    RecognizedClock,
    RecognizedLog,
    Untold,
)
from crosscheck.recordings.recognizing.skeleton import skeleton
from crosscheck.recordings.recognizing.torques import torques
from crosscheck.recordings.recognizing.unnamed import unnamed_blocks
from crosscheck.recordings.recognizing.work import LogWork, column_of, how_told
from crosscheck.recordings.table import RecordedTable, in_words
from graphdyn import InvalidInput, RobotModel
from graphdyn.errors import counted


def recognize(
    paths: str | PathLike[str] | Sequence[str | PathLike[str]],
    model: RobotModel,
    untold: Untold | None = None,
    *,
    topic: str | None = None,
) -> RecognizedLog:
    """What the columns of a log are, and a mapping for load_recording.

    paths: one file, or several with the same rows
    model: the robot that was recorded
    untold: what the log does not tell
    topic: of a bag with several

    Raises BadRecordingFile for files that cannot be read or have different numbers of rows, BadMapping for unknown
    units, InvalidInput for another number of gains or ratios than joints, or for columns that are not there, OSError.
    """
    untold = untold or Untold()
    joints = model.independent_joints
    for name, given in (("ratio", untold.ratio), ("gain", untold.gain)):
        if given and len(given) != len(joints):
            raise InvalidInput(f"{name} has {counted(len(given), 'number')}, the robot {counted(len(joints), 'joint')}")
    for quantity, unit in untold.units.items():
        known_unit(quantity, unit, "the unit that is given")
    files = [Path(path) for path in ([paths] if isinstance(paths, str | PathLike) else paths)]
    tables = [_table(path, joints, topic) for path in files]
    if len({len(table.values) for table in tables}) > 1:
        listed = in_words(f"{table.path} {len(table.values)}" for table in tables)
        raise BadRecordingFile(f"files with different numbers of rows ({listed}); give those of one log")
    return _recognized(LogWork(tables, model, untold), topic)


def _table(path: Path, joints: tuple[str, ...], topic: str | None) -> RecordedTable:
    try:
        return read_table(path, ColumnMapping("", joints, {}, topic=topic) if topic else None, joints)
    except AmbiguousColumns:  # a bag whose joints have other names
        return read_table(path, ColumnMapping("", (), {}, topic=topic) if topic else None, None)


def _recognized(work: LogWork, topic: str | None) -> RecognizedLog:
    """Clocks, then positions, then what depends on them: rates, velocities, torques."""
    joints = work.model.independent_joints
    clocks = clocks_of(work)
    clock = next((one for one in clocks if one.taken), None)
    asked = {label: quantity for quantity, label in work.untold.take.items()}
    found = [
        replace(block, quantity=asked[block.label]) if block.label in asked and not block.quantity else block
        for block in named_blocks(work.tables, joints)
    ]
    work.without_quantity += [block.label for block in found if not block.quantity]
    if not any(block.quantity == "q" for block in found):
        found = unnamed_blocks(work, found, clocks) or found
    rate = clock.rate if clock else work.untold.rate
    loads = [block for block in found if block.quantity in ("tau", "current", "unnamed")]
    loads.sort(key=lambda block: bool(block.computed))  # the measured ones judge the positions
    q = positions(work, [block for block in found if block.quantity == "q"], loads, rate)
    taken_q = next((block for block in q if block.taken), None)
    v, rate = velocities(work, [block for block in found if block.quantity == "v"], taken_q, rate)
    if clock is None and rate is None and not any(choice.quantity == "time" for choice in work.open):
        work.open.append(rate_choice(clocks, taken_q, v))
    tau = torques(work, loads, taken_q, rate)
    rest = [block for block in found if block.quantity in ("a", "temperature", "")]
    blocks = [*q, *v, *tau, *map(partial(_rest, work), rest)]
    used = [block for block in blocks if block.taken]
    text = skeleton(joints, clock, rate, used, len(work.tables) > 1, work.untold, work.open, topic)
    return RecognizedLog(
        tuple(str(table.path) for table in work.tables),
        joints,
        len(work.tables[0].values),
        rate,
        tuple(clocks),
        tuple(blocks),
        _others(work, found, clocks),
        tuple(work.assumed),
        tuple(work.open),
        text,
    )


def _rest(work: LogWork, block: ColumnBlock) -> RecognizedBlock:
    if block.quantity == "temperature" and not block.computed:
        return work.block(block, "temperature", "degC", "", how_told(block))
    if block.quantity == "a":
        return work.block(block, "a", block.unit, "", "accelerations are computed from the positions", False)
    why = f"{block.computed!r} in its name: computed, not measured" if block.computed else "no quantity by its name"
    return work.block(block, "", "", "", why, False)


def _others(work: LogWork, found: Sequence[ColumnBlock], clocks: Sequence[RecognizedClock]) -> dict[str, str]:
    """Columns that are in no block, and sets of columns for another number of joints."""
    others: dict[str, str] = {}
    n = len(work.model.independent_joints)
    for index, table in enumerate(work.tables):
        used = {column_of(table, k) for block in found if block.table == index for k in block.numbers}
        used |= {column for clock in clocks if clock.file == table.path.name for column in clock.columns}
        for label, size in block_sizes(table, work.model.independent_joints).items():
            if quantity_of(label) == "q" and not any(block.quantity == "q" for block in found):
                others[label] = f"{size} columns, the robot has {counted(n, 'joint')}: --lock or --chain"
        for k, name in enumerate(table.names):
            if column_of(table, k) not in used:
                others[str(name or k + 1)] = "in no set of columns with one for each joint"
    return others
