"""The JSON Schema of a record or of a dataclass, from the types of its fields and the lines of its docstring.

A field is described by the line of its name, or by the docstring of the property. Arrays have the shape that the line
gives; a number may be null where the line says NaN or ∞, and where the type says None.
"""

from __future__ import annotations

import inspect
import re
import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cached_property
from pathlib import Path
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin, get_type_hints

import numpy as np

from crosscheck.report.records.docstrings import TAIL, names_of, taken_apart
from crosscheck.report.records.record import Keywords, Record

FORMAT = "What this file is; the number grows when a field changes its meaning or disappears. New fields may appear."

TYPE_NAMES = {str: "string", Path: "string", int: "integer", bool: "boolean", float: "number"}
DTYPES = {np.float64: float, np.bool_: bool, np.int_: int, np.int64: int}


@dataclass(frozen=True)
class Member:
    """An attribute of a class: its type, and what its docstring says.

    meaning: in words, with shape and unit
    sizes: of an array, along each axis: a number, or a letter
    """

    kind: Any
    meaning: str = ""
    sizes: tuple[str, ...] = ()

    @property
    def may_be_null(self) -> bool:
        return re.search(r"\bNaN\b|∞", self.meaning) is not None


def schema_of(record: type[Record]) -> dict[str, Any]:
    """The schema of an outermost record, with definitions of the classes inside."""
    definitions: dict[str, Any] = {}
    found = _object(record, definitions)
    return {**found, **({"$defs": definitions} if definitions else {})}


def _object(kind: Any, definitions: dict[str, Any]) -> dict[str, Any]:
    properties = {}
    if issubclass(kind, Record):
        if kind.format:
            properties["format"] = {"description": FORMAT, "const": kind.format, "type": "string"}
        members = {name: _member_of_record(kind, name) for name in kind.paths}
    else:
        members = {field.name: _member(kind, field.name) for field in fields(kind)}
    for name, member in members.items():
        meaning = re.sub(r"\b(NaN|None)\b|∞(?= where)", "null", member.meaning)
        properties[name] = _schema(member.kind, member, member.sizes, definitions)
        if meaning:
            properties[name]["description"] = _sentence(meaning)
    prose = taken_apart(inspect.cleandoc(kind.__doc__ or "").splitlines(), names_of(kind)).prose
    return {
        "description": " ".join(prose[:1]),
        "properties": properties,
        "required": list(properties),
        "type": "object",
    }


def _sentence(meaning: str) -> str:
    """Sentence with a capital letter, but for a symbol, and a full stop."""
    first = meaning[0].upper() if meaning[:2].isalpha() else meaning[0]
    return f"{first}{meaning[1:].rstrip('.')}."


def _member_of_record(record: type[Record], name: str) -> Member:
    """A field: the record's own type and line, or else those of the class of the result."""
    types = get_type_hints(record, include_extras=True)
    own = Member(types.get(name), *_line(record, name))
    try:
        found = _along(record.result, record.paths[name])
    except AttributeError:
        if own.kind is None:
            raise
        return own
    said = own if own.meaning else found
    return Member(own.kind or found.kind, said.meaning, said.sizes)


def _along(kind: Any, path: str) -> Member:
    """The attribute of an attribute of a class; it may be None where one on the way may."""
    first, _, rest = path.partition(".")
    member = _member(kind, first)
    if not rest:
        return member
    choices = [choice for choice in get_args(member.kind) if choice is not NoneType] or [member.kind]
    last = _along(choices[0], rest)
    optional = NoneType in get_args(member.kind)
    return Member(last.kind | None if optional else last.kind, last.meaning, last.sizes)


def _member(kind: Any, name: str) -> Member:
    """A property, or a field of a dataclass or named tuple. Raises AttributeError where there is none."""
    for base in inspect.getmro(kind) if kind else ():
        found = vars(base).get(name)
        function = found.func if isinstance(found, cached_property) else getattr(found, "fget", None)
        if function is not None:
            returned = get_type_hints(function, include_extras=True)["return"]
            return Member(returned, *_meaning_and_sizes(inspect.cleandoc(function.__doc__ or "")))
        annotation = inspect.get_annotations(base).get(name)
        annotation = getattr(annotation, "__forward_arg__", annotation)  # of a named tuple
        if isinstance(annotation, str):  # one at a time: others may need what is imported for type checkers alone
            annotation = eval(annotation, vars(sys.modules[base.__module__]), dict(vars(base)))
        if annotation is not None:
            return Member(annotation, *_line(kind, name))
    raise AttributeError(f"{kind} has no field or property '{name}'")


def _line(kind: type, name: str) -> tuple[str, tuple[str, ...]]:
    """What the docstring of a class says of a field, and its sizes."""
    for base in inspect.getmro(kind):
        lines = inspect.cleandoc(vars(base).get("__doc__") or "").splitlines()
        for entry in taken_apart(lines, names_of(kind) | set(getattr(kind, "paths", ()))).entries:
            if name in entry.names:
                return _meaning_and_sizes(f"{entry.meaning}  {entry.shape}  {entry.unit}")
    return "", ()


def _meaning_and_sizes(text: str) -> tuple[str, tuple[str, ...]]:
    """A description, and the sizes of the shape that it ends with."""
    tail = TAIL.search(text.rstrip(" ."))
    shape = (tail and tail["shape"]) or ""
    sizes = (size.strip() for size in shape.strip("()").split(","))
    return " ".join(text.split()), tuple(size for size in sizes if size not in ("", "…"))


def _schema(kind: Any, member: Member, sizes: Sequence[str], definitions: dict[str, Any]) -> dict[str, Any]:
    """Schema of a type, a part of the type of a member. sizes: of the axes from here on"""
    origin, inner = get_origin(kind), get_args(kind)
    if origin is Annotated:
        keywords = [part.keywords for part in inner[1:] if isinstance(part, Keywords)]
        return {**_schema(inner[0], member, sizes, definitions), **(keywords[0] if keywords else {})}
    if origin is Literal:
        return {"enum": list(inner), "type": TYPE_NAMES[type(inner[0])]}
    if origin in (Union, UnionType):
        return _any_of([_schema(choice, member, sizes, definitions) for choice in inner])
    if origin is np.ndarray:
        if not sizes:
            raise TypeError(f"the line of an array gives no shape: {member}")
        found = _schema(DTYPES[get_args(inner[1])[0]], member, (), definitions)
        for size in reversed(sizes):
            found = _array(found, size)
        return found
    if origin is tuple and Ellipsis not in inner:
        return _array(_schema(inner[0], member, (), definitions), str(len(inner)))
    if isinstance(origin, type) and issubclass(origin, Mapping):
        return {"additionalProperties": _schema(inner[1], member, sizes, definitions), "type": "object"}
    if isinstance(origin, type) and issubclass(origin, Sequence | frozenset):
        return _array(_schema(inner[0], member, sizes[1:], definitions), *sizes[:1])
    if kind is float and member.may_be_null:
        return {"type": ["number", "null"]}
    if kind in TYPE_NAMES:
        return {"type": TYPE_NAMES[kind]}
    if kind is NoneType:
        return {"type": "null"}
    if kind.__name__ not in definitions:
        definitions[kind.__name__] = {}  # a class may hold itself
        definitions[kind.__name__] = _object(kind, definitions)
    return {"$ref": f"#/$defs/{kind.__name__}"}


def _array(items: dict[str, Any], size: str = "") -> dict[str, Any]:
    count = {"minItems": int(size), "maxItems": int(size)} if size.isdigit() else {}
    return {"items": items, **count, "type": "array"}


def _any_of(choices: list[dict[str, Any]]) -> dict[str, Any]:
    """{"type": ["number", "null"]} for a number or null."""
    first, *others = choices
    if others == [{"type": "null"}] and isinstance(first.get("type"), list):
        return first
    if others == [{"type": "null"}] and isinstance(first.get("type"), str) and "enum" not in first:
        return {**first, "type": [first["type"], "null"]}
    return {"anyOf": choices}
