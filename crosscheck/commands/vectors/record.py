"""The format `graphdyn vectors 2`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from hashlib import sha256
from typing import Any

from crosscheck.judging.exchange.vectors import VectorTable
from crosscheck.report.records.record import CommandRecord, Count, Index, Record, attribute, written
from graphdyn import RobotModel


class VectorTableRecord(Record, of=VectorTable, only=("references",)):
    """The test vectors of one function.

    file: its file in this folder: a head, then a row per state with the arguments, the answer, the tolerances
    sha256: of the file
    function: its name
    arguments: their names, in the order of a row
    argument_count: numbers of all arguments
    shape: of the answer, which is written row by row
    answer_count: numbers of the answer, and of the tolerances
    unit: of the answer
    scale: what the bound is relative to
    conventions: those that the answer follows, where several are right
    """

    file: str
    sha256: str
    function: str = attribute("known.name")
    arguments: Sequence[str]
    argument_count: Index
    shape: Sequence[int]
    answer_count: Index
    unit: str = attribute("known.ours.unit")
    scale: str = attribute("known.judged_relative_to")
    conventions: Mapping[str, str]


class VectorsRecord(CommandRecord, format="graphdyn vectors 2"):
    """A folder of test vectors for one robot.

    sha256: of the hashes of all files, one after the other: names this set of vectors
    files: names of the other files in this folder
    robot: as given
    model: file of the rigid-body model, `graphdyn export 1`
    joint_names: the order of the joints
    gravity: in world axes (3,) [m/s²]
    frame: that functions of one frame belong to; null where none was named
    seed: of the random states
    states: rows of each file
    bound: the tolerance of a number is this times the scale of the function
    tables: one per function
    """

    sha256: str
    files: Sequence[str]
    robot: str
    model: str
    joint_names: Sequence[str]
    gravity: Sequence[float]
    frame: str | None
    seed: Count
    states: Index
    bound: float
    tables: Sequence[VectorTableRecord]


def record(
    robot: str,
    model: RobotModel,
    frame: str | None,
    seed: int,
    bound: float,
    model_file: tuple[str, bytes],
    tables: Mapping[str, tuple[VectorTable, bytes]],
    command: Sequence[str],
) -> dict[str, Any]:
    """robot: as given; model_file: name and content; tables: with the content of the file of this name"""
    rows = [_table(name, table, content) for name, (table, content) in tables.items()]
    hashes = [sha256(model_file[1]).hexdigest(), *(row["sha256"] for row in rows)]
    return written(
        VectorsRecord,
        command=command,
        sha256=sha256("".join(hashes).encode()).hexdigest(),
        files=[model_file[0], *tables],
        robot=robot,
        model=model_file[0],
        joint_names=model.joint_names,
        gravity=model.gravity,
        frame=frame,
        seed=seed,
        states=len(next(iter(tables.values()))[0].answer),
        bound=bound,
        tables=rows,
    )


def _table(name: str, table: VectorTable, content: bytes) -> dict[str, Any]:
    argument_count, answer_count = table.sizes
    return written(
        VectorTableRecord,
        table,
        file=name,
        sha256=sha256(content).hexdigest(),
        arguments=list(table.arguments),
        argument_count=argument_count,
        shape=table.answer.shape[1:],
        answer_count=answer_count,
        conventions=dict(table.conventions),
    )
