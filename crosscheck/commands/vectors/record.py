"""The format `graphdyn vectors 1`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from hashlib import sha256
from typing import Annotated, Literal

from crosscheck.judging.exchange.vectors import VectorTable
from crosscheck.report.record_fields import FORMAT, Command, Count, Index, Vector3, Versions
from crosscheck.report.versions import versions
from graphdyn import RobotModel


@dataclass(frozen=True, kw_only=True)
class VectorTableRecord:
    """The test vectors of one function."""

    file: str
    """Its file in this folder: a head, then a row per state with the arguments, the answer, the tolerances."""

    sha256: str
    """Of the file."""

    function: str
    """Its name."""

    arguments: Sequence[str]
    """Their names, in the order of a row."""

    argument_count: Index
    """Numbers of all arguments."""

    shape: Sequence[int]
    """Of the answer, which is written row by row."""

    answer_count: Index
    """Numbers of the answer, and of the tolerances."""

    unit: str
    """Of the answer."""

    scale: str
    """What the bound is relative to."""

    conventions: Mapping[str, str]
    """Those that the answer follows, where several are right."""

    references: Sequence[str]
    """The implementations whose answers agree within the tolerances."""


@dataclass(frozen=True, kw_only=True)
class VectorsRecord:
    """A folder of test vectors for one robot."""

    format: Annotated[Literal["graphdyn vectors 1"], FORMAT] = "graphdyn vectors 1"

    versions: Versions = field(default_factory=versions)

    command: Command

    sha256: str
    """Of the hashes of all files, one after the other: names this set of vectors."""

    files: Sequence[str]
    """Names of the other files in this folder."""

    robot: str
    """As given."""

    model: str
    """File of the rigid-body model, `graphdyn export 1`."""

    joint_names: Sequence[str]
    """The order of the joints."""

    gravity: Vector3
    """In world axes (3) [m/s²]."""

    frame: str | None
    """That functions of one frame belong to. Null where none was named."""

    seed: Count
    """Of the random states."""

    states: Index
    """Rows of each file."""

    bound: float
    """The tolerance of a number is this times the scale of the function."""

    tables: Sequence[VectorTableRecord]
    """One per function."""


def record(
    robot: str,
    model: RobotModel,
    frame: str | None,
    seed: int,
    bound: float,
    model_file: tuple[str, bytes],
    tables: Mapping[str, tuple[VectorTable, bytes]],
    command: Sequence[str],
) -> VectorsRecord:
    """robot: as given; model_file: name and content; tables: with the content of the file of this name"""
    rows = [_table(name, table, content) for name, (table, content) in tables.items()]
    hashes = [sha256(model_file[1]).hexdigest(), *(row.sha256 for row in rows)]
    return VectorsRecord(
        command=command,
        sha256=sha256("".join(hashes).encode()).hexdigest(),
        files=[model_file[0], *tables],
        robot=robot,
        model=model_file[0],
        joint_names=model.joint_names,
        gravity=model.gravity.tolist(),
        frame=frame,
        seed=seed,
        states=len(next(iter(tables.values()))[0].answer),
        bound=bound,
        tables=rows,
    )


def _table(name: str, table: VectorTable, content: bytes) -> VectorTableRecord:
    argument_count, answer_count = table.sizes
    return VectorTableRecord(
        file=name,
        sha256=sha256(content).hexdigest(),
        function=table.known.name,
        arguments=list(table.arguments),
        argument_count=argument_count,
        shape=list(table.answer.shape[1:]),
        answer_count=answer_count,
        unit=table.known.ours.unit,
        scale=table.known.judged_relative_to,
        conventions=dict(table.conventions),
        references=table.references,
    )
