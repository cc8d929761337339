"""Records in which every number that may be null is NaN or infinite."""

from collections.abc import Mapping, Sequence
from dataclasses import fields, is_dataclass, replace
from types import NoneType
from typing import Any, get_args, get_origin, get_type_hints


def planted(record: Any, number: float) -> Any:
    """The same record with a number in place of everything whose type is a number or null."""
    hints = get_type_hints(type(record))
    values = {field.name: _planted(getattr(record, field.name), hints[field.name], number) for field in fields(record)}
    return replace(record, **values)


def _planted(value: Any, hint: Any, number: float) -> Any:
    if hint == float | None:
        return number
    if value is None:
        return None
    if is_dataclass(hint):
        return planted(value, number)
    kind, inner = get_origin(hint), get_args(hint)
    if kind is Sequence:
        return [_planted(item, inner[0], number) for item in value]
    if kind is Mapping:
        return {key: _planted(item, inner[1], number) for key, item in value.items()}
    if NoneType in inner:
        (inner,) = (part for part in inner if part is not NoneType)
        return _planted(value, inner, number)
    return value
