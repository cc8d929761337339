"""The published schemas of the JSON files: `python -m crosscheck.commands.schemas docs/schemas` writes them.

A test compares them with the committed ones.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

import crosscheck.commands
from crosscheck.report.records.json_schema import schema_of
from crosscheck.report.records.record import Record, as_bytes
from urdf.document import write_whole


def schemas() -> dict[str, dict[str, Any]]:
    """The schemas of all formats by file name."""
    return {f"{_name(record)}.schema.json": schema(record) for record in formats()}


def formats() -> Iterator[type[Record]]:
    """The outermost record of every command that writes a JSON file."""
    folder = Path(crosscheck.commands.__file__).parent
    for path in sorted(folder.rglob("record.py")):
        module = import_module(".".join(["crosscheck.commands", *path.relative_to(folder).with_suffix("").parts]))
        for thing in vars(module).values():
            if isinstance(thing, type) and issubclass(thing, Record) and thing.format:
                yield thing


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
