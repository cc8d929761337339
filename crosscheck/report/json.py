"""Records as JSON files, and the published schemas of these files.

`python -m crosscheck.report.json docs/schemas` writes the schemas; a test compares them with the committed ones. Only
this needs pydantic, which reads the types and the descriptions of the fields.
"""

from __future__ import annotations

import json
import math
import sys
from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crosscheck.report.plain_text import UNSEEN
from urdf._files import write_whole


def as_bytes(data: Any) -> bytes:
    """Plain data as the text of a JSON file; characters that cannot be seen are escaped, as \\u202e."""
    text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    return UNSEEN.sub(lambda found: found[0] if found[0] == "\n" else f"\\u{ord(found[0]):04x}", text).encode()


def plain(value: Any) -> Any:
    """What JSON has: dictionaries for records, lists for arrays and tuples, None for NaN and ±∞."""
    if is_dataclass(value):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {key: plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    return None if isinstance(value, float) and not math.isfinite(value) else value


def schemas() -> dict[str, dict[str, Any]]:
    """The schemas of all formats by file name."""
    from crosscheck.report.records import (
        bench,
        crosscheck,
        errata,
        excite,
        export,
        identify,
        inspect,
        judge,
        paper,
        questions,
        robots,
        show,
        simulate,
        study,
        vectors,
    )

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


def schema(record: Any) -> dict[str, Any]:
    """The JSON Schema of a format. record: its outermost class."""
    from pydantic import ConfigDict, TypeAdapter

    program, command, _ = record.format.split()
    # a dataclass takes its configuration from what holds it, here a list
    holder: TypeAdapter[Any] = TypeAdapter(list[record], config=ConfigDict(use_attribute_docstrings=True))
    definitions = {name: _tidied(found) for name, found in holder.json_schema()["$defs"].items()}
    head = {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "$id": f"urn:graphdyn:schema:{_name(record)}",
        "title": f"{program} {command} --json",
    }
    outermost = definitions.pop(record.__name__)
    return {**head, **outermost, **({"$defs": definitions} if definitions else {})}


def _tidied(found: Any) -> Any:
    """Without titles made of names, without defaults; every property required; null beside its type."""
    if not isinstance(found, dict):
        return found
    tidy: dict[str, Any] = {}
    if "description" in found:
        tidy["description"] = " ".join(found["description"].split())
    for keyword, inner in found.items():
        if keyword == "properties":
            tidy[keyword] = {name: _tidied(field) for name, field in inner.items()}
            tidy["required"] = list(inner)
        elif keyword == "anyOf":
            tidy.update(_any_of([_tidied(choice) for choice in inner]))
        elif keyword not in ("title", "default", "description", "required"):
            tidy[keyword] = _tidied(inner)
        elif keyword == "required":
            tidy.setdefault(keyword, inner)
    return tidy


def _any_of(choices: list[dict[str, Any]]) -> dict[str, Any]:
    """{"type": ["number", "null"]} for a number or null."""
    first, *others = choices
    if others == [{"type": "null"}] and isinstance(first.get("type"), str) and "enum" not in first:
        return {**first, "type": [first["type"], "null"]}
    return {"anyOf": choices}


def _name(record: Any) -> str:
    """ "graphdyn show 1" → "show-1"."""
    return "-".join(record.format.split()[1:])


def main(arguments: Sequence[str]) -> None:
    """Write all schemas into a folder. Raises OSError."""
    if len(arguments) != 2:
        raise SystemExit("usage: python -m crosscheck.report.json FOLDER")
    folder = Path(arguments[1])
    folder.mkdir(parents=True, exist_ok=True)
    for name, found in schemas().items():
        write_whole(folder / name, as_bytes(found))


if __name__ == "__main__":
    main(sys.argv)
