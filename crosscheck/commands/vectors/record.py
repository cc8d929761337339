"""The format `graphdyn vectors 2`."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from hashlib import sha256
from importlib.metadata import version
from typing import Any

from crosscheck.judging.exchange.proven_digits import ProvenDigits
from crosscheck.judging.exchange.vectors import VectorTable
from crosscheck.report.records.record import CommandRecord, Count, Index, Record, attribute, written
from graphdyn import RobotModel


class ExactVectorsRecord(Record, of=ProvenDigits):
    """The exact answers.

    count: digits that are proven, relative to the largest number of an answer
    truth: whether the decimals of the file are exact, or the doubles of the model
    python_flint: version of the library that computed them
    """

    python_flint: str


class VectorTableRecord(Record, of=VectorTable, only=("references",)):
    """The test vectors of one function.

    file: its file in this folder: a head, then a row per state with the arguments, the answer, the tolerances
    sha256: of the file
    exact_file: the same with exact answers as decimals; null where there are none
    exact_sha256: of that file
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
    exact_file: str | None
    exact_sha256: str | None
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
    exact: of the exact answers; null where there are none
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
    exact: ExactVectorsRecord | None
    tables: Sequence[VectorTableRecord]


def record(
    robot: str,
    model: RobotModel,
    frame: str | None,
    seed: int,
    bound: float,
    digits: ProvenDigits | None,
    model_file: tuple[str, bytes],
    tables: Mapping[str, VectorTable],
    files: Mapping[str, bytes],
    command: Sequence[str],
) -> dict[str, Any]:
    """robot: as given; model_file: name and content; tables: by the name of their file; files: contents by name"""
    hashes = {name: sha256(content).hexdigest() for name, content in files.items()}
    rows = [_table(name, table, hashes) for name, table in tables.items()]
    return written(
        VectorsRecord,
        command=command,
        sha256=sha256("".join([sha256(model_file[1]).hexdigest(), *hashes.values()]).encode()).hexdigest(),
        files=[model_file[0], *files],
        robot=robot,
        model=model_file[0],
        joint_names=model.joint_names,
        gravity=model.gravity,
        frame=frame,
        seed=seed,
        states=len(next(iter(tables.values())).answer),
        bound=bound,
        exact=digits and written(ExactVectorsRecord, digits, python_flint=version("python-flint")),
        tables=rows,
    )


def _table(name: str, table: VectorTable, hashes: Mapping[str, str]) -> dict[str, Any]:
    exact_file = None if table.exact is None else name.replace(".csv", "_exact.csv")
    argument_count, answer_count = table.sizes
    return written(
        VectorTableRecord,
        table,
        file=name,
        sha256=hashes[name],
        exact_file=exact_file,
        exact_sha256=None if exact_file is None else hashes[exact_file],
        arguments=list(table.arguments),
        argument_count=argument_count,
        shape=table.answer.shape[1:],
        answer_count=answer_count,
        conventions=dict(table.conventions),
    )
