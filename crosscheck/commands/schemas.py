"""The published schemas of the JSON files: `python -m crosscheck.commands.schemas docs/schemas` writes them.

A test compares them with the committed ones.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from crosscheck.commands.bench import record as bench
from crosscheck.commands.crosscheck import record as crosscheck
from crosscheck.commands.errata import record as errata
from crosscheck.commands.excite import record as excite
from crosscheck.commands.export import record as export
from crosscheck.commands.identify import record as identify
from crosscheck.commands.inspect import record as inspect
from crosscheck.commands.judge import record as judge
from crosscheck.commands.paper import record as paper
from crosscheck.commands.questions import record as questions
from crosscheck.commands.robots import record as robots
from crosscheck.commands.show import record as show
from crosscheck.commands.simulate import record as simulate
from crosscheck.commands.study import record as study
from crosscheck.commands.vectors import record as vectors
from crosscheck.report.json import as_bytes
from crosscheck.report.json_schema import schema_of
from crosscheck.report.record import Record
from urdf.document import write_whole


def schemas() -> dict[str, dict[str, Any]]:
    """The schemas of all formats by file name."""
    formats = (
        bench.BenchRecord,
        crosscheck.CrosscheckRecord,
        errata.ErrataRecord,
        excite.ExciteRecord,
        export.ExportRecord,
        identify.IdentifyRecord,
        inspect.InspectRecord,
        judge.JudgeRecord,
        paper.PaperRecord,
        questions.QuestionsRecord,
        robots.RobotsRecord,
        show.ShowRecord,
        simulate.SimulateRecord,
        study.StudyRecord,
        vectors.VectorsRecord,
    )
    return {f"{_name(record)}.schema.json": schema(record) for record in formats}


def schema(record: type[Record]) -> dict[str, Any]:
    """The JSON Schema of a format. record: its outermost class"""
    program, command, _ = record.format.split()
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:graphdyn:schema:{_name(record)}",
        "title": f"{program} {command} --json",
    }
    return {**head, **schema_of(record)}


def _name(record: type[Record]) -> str:
    """ "graphdyn show 1" → "show-1"."""
    return "-".join(record.format.split()[1:])


def main(arguments: Sequence[str]) -> None:
    """Write all schemas into a folder. Raises OSError."""
    if len(arguments) != 2:
        raise SystemExit("usage: python -m crosscheck.commands.schemas FOLDER")
    folder = Path(arguments[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, found in schemas().items():
        write_whole(folder / name, as_bytes(found))


if __name__ == "__main__":
    main(sys.argv)
