"""What a JSON file holds: the fields of a command's result, and what differs from them.

Of a dataclass all fields are written; their annotations and the lines of its docstring describe them. A record says
what differs from that in the file:

    class ContenderRecord(Record, of=Entry, leave_out=("times",)):
        '''One contender.

        rank: among all, 1 is the fastest
        '''

        median = attribute("times.median")
        rank: int

    written(ContenderRecord, entry, rank=1)

It leaves out fields, or has `only` some, and adds

- `name = attribute("path")`: a property, an attribute of another name, or an attribute of an attribute
- `name: type`: a value that `written` is given, or a field of the result, which is then written as this type. A type
  that is a record says how the objects inside are written

A line in the docstring of the record goes before that of the result's class. No record is ever made: `written` gives a
dictionary.
"""

from __future__ import annotations

import json
import math
import platform
import sys
from collections.abc import Collection, Mapping, Sequence
from dataclasses import fields, is_dataclass
from functools import cache
from importlib.metadata import version
from inspect import get_annotations
from pathlib import Path
from typing import Annotated, Any, ClassVar, NamedTuple, get_args, get_origin, get_type_hints

import numpy as np

from crosscheck.report.plain_text import INVISIBLE_CHARACTERS

REPORTED_LIBRARIES = ("graphdyn", "numpy", "scipy", "yourdfpy", "example-robot-data")


def versions() -> dict[str, str]:
    """Versions of everything that takes part in a comparison."""
    from crosscheck.reference.pinocchio_model import PINOCCHIO_VERSION

    return {**{name: version(name) for name in REPORTED_LIBRARIES}, "pinocchio": PINOCCHIO_VERSION}


FURTHER_LIBRARIES = {
    name: {"flint": "python-flint"}.get(name, name)
    for name in ("mujoco", "clarabel", "cvxpy", "casadi", "jax", "flint", "xacro", "distributed")
}
"""Packages by the names of their modules that take part in some calls: references, solvers, readers."""


def taking_part() -> dict[str, str]:
    """Versions of everything that has taken part so far in this process, and the platform."""
    further = {package: version(package) for name, package in FURTHER_LIBRARIES.items() if name in sys.modules}
    here = {"python": platform.python_version(), "platform": f"{platform.system()} {platform.machine()}"}
    return {**versions(), "llvmlite": version("llvmlite"), **further, **here}


class Keywords:
    """JSON Schema keywords of a type, for instance Annotated[int, Keywords(minimum=1)]."""

    def __init__(self, **keywords: Any):
        self.keywords = keywords


Number = float | None
"""A number that may not exist or not be finite: NaN and ±∞ are written as null."""

Numbers = Sequence[Number]

Count = Annotated[int, Keywords(minimum=0)]

Index = Annotated[int, Keywords(minimum=1)]

Versions = Annotated[
    Mapping[str, str],
    Keywords(
        description="Versions of graphdyn and of the libraries that took part, by name.",
        required=[*REPORTED_LIBRARIES, "pinocchio"],
    ),
]

Warnings = Annotated[
    Sequence[str],
    Keywords(description="What the command warned of; of a folder's robots, in their notes."),
]

Command = Annotated[Sequence[str], Keywords(description="The arguments as given.")]


class Attribute(NamedTuple):
    """A field that is an attribute of the result, such as a property, or one of another name."""

    path: str


def attribute(path: str = "") -> Any:
    """An attribute of the result, or `one.of` an attribute: None where the one before the point is None.

    path: the name of the field if left out, for a property
    """
    return Attribute(path)


class Record:
    """The base of all records; the own fields of the outermost one, which has a format, come first.

    format: name and number of the format, of outermost records; empty for others
    result: the class of the result, None where all fields are the record's own
    paths: attribute of the result by name of the field
    """

    format: ClassVar[str] = ""
    result: ClassVar[type | None] = None
    paths: ClassVar[Mapping[str, str]] = {}

    def __init_subclass__(
        cls,
        of: type | None = None,
        leave_out: Collection[str] = (),
        only: Collection[str] | None = None,
        format: str = "",
    ) -> None:
        """of: class of the result; leave_out: its fields that are not written, or only: those that are"""
        names = [] if of is None else [field.name for field in fields(of)]
        if unknown := {*leave_out, *(only or ())}.difference(names):
            raise TypeError(f"{cls.__name__}: {of} has no field {', '.join(unknown)}")
        own: dict[str, str] = {}
        for base in reversed(cls.__mro__[: cls.__mro__.index(Record)]):
            own |= {name: name for name in get_annotations(base)}
            own |= {name: value.path or name for name, value in vars(base).items() if isinstance(value, Attribute)}
        kept = [name for name in names if name not in leave_out and (only is None or name in only)]
        result = {name: own.pop(name, name) for name in kept}
        cls.format, cls.result, cls.paths = format, of, own | result if format else result | own


def written(record: type[Record], result: object = None, **said: Any) -> dict[str, Any]:
    """The fields of a record: those that are said, versions, no warnings yet, and the others from a result."""
    inside = _records_inside(record)  # type: ignore[arg-type]  # mypy takes the class for an instance
    if "versions" in record.paths:
        said["versions"] = taking_part()
    if "warnings" in record.paths:
        said.setdefault("warnings", [])
    values = {name: said[name] if name in said else _found(result, path) for name, path in record.paths.items()}
    head = {"format": record.format} if record.format else {}
    return head | {name: _as_typed(value, *inside.get(name, (None, False))) for name, value in values.items()}


def has_form(record: type[Record], value: Any) -> bool:
    """Whether what a file holds has the members of a record, and those of the records inside."""
    if not isinstance(value, dict) or not set(record.paths) <= set(value):
        return False
    inside = _records_inside(record)  # type: ignore[arg-type]  # mypy takes the class for an instance
    for name in record.paths:
        kind, by_name = inside.get(name, (None, False))
        held = value[name]
        if kind is None or held is None:
            continue
        items = held.values() if by_name and isinstance(held, dict) else held if isinstance(held, list) else [held]
        if not all(has_form(kind, item) for item in items):
            return False
    return True


class CommandRecord(Record):
    """The base of outermost records that say how their command was called, and of what it warned."""

    versions: Versions
    command: Command
    warnings: Warnings


def _found(result: object, path: str) -> Any:
    for name in path.split("."):
        if result is None:
            return None
        result = getattr(result, name)
    return result


def _as_typed(value: Any, record: type[Record] | None, by_name: bool) -> Any:
    """A value in which objects are written as this record; dictionaries are written already, unless they hold them."""
    if record is None or value is None:
        return value
    if isinstance(value, list | tuple):
        return [_as_typed(item, record, False) for item in value]
    if isinstance(value, Mapping):
        return {key: _as_typed(item, record, False) for key, item in value.items()} if by_name else value
    return written(record, value)


@cache
def _records_inside(record: type[Record]) -> dict[str, tuple[type[Record] | None, bool]]:
    """The record that the type of a field names, and whether it holds them by name, for each field with a type."""
    return {name: (_record_in(kind), _is_mapping(kind)) for name, kind in get_type_hints(record).items()}


def _is_mapping(kind: Any) -> bool:
    origin = get_origin(kind)
    return isinstance(origin, type) and issubclass(origin, Mapping)


def _record_in(kind: Any) -> type[Record] | None:
    if isinstance(kind, type) and issubclass(kind, Record):
        return kind
    return next((found for inner in get_args(kind) if (found := _record_in(inner)) is not None), None)


def as_bytes(data: Any) -> bytes:
    """Plain data as the text of a JSON file; characters that cannot be seen are escaped, as \\u202e."""
    text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    return INVISIBLE_CHARACTERS.sub(
        lambda found: found[0] if found[0] == "\n" else f"\\u{ord(found[0]):04x}", text
    ).encode()


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
    if isinstance(value, Path):
        return str(value)
    return None if isinstance(value, float) and not math.isfinite(value) else value
