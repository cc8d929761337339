"""How results show themselves: in few characters as text, and in notebooks as the beginning of their page.

A package that draws pages announces a function `(result) -> str` of HTML as an entry point of the group
`graphdyn.html`. Where none is installed, notebooks show the text.
"""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import fields, is_dataclass
from functools import cache
from importlib.metadata import entry_points
from typing import Any, TypeVar

import numpy as np

MAX_CHARACTERS = 2000
"""Largest number of characters of the str and the repr of a result."""

MAX_FIELD_CHARACTERS = 120
"""Largest number of characters of one field in the repr of a result."""

MAX_ENTRIES = 6
"""Largest number of entries of an array, a sequence or a mapping that are shown one by one."""

GROUP = "graphdyn.html"
"""Entry points that draw results."""

Class = TypeVar("Class", bound=type)


def short_repr(cls: Class) -> Class:
    """A decorator below `@dataclass`: the repr names every field, of arrays the shape, in MAX_CHARACTERS at most."""
    cls.__repr__ = described  # type: ignore[method-assign, assignment]
    return cls


class Displayed:
    """A result that says in a few lines what it is, and shows the beginning of its page in notebooks.

    Its dataclass is made with repr=False.
    """

    def summary(self) -> str:
        """What a reader wants to know first, in a few lines; by default the class with its fields."""
        return described(self)

    def __str__(self) -> str:
        return cut(self.summary(), MAX_CHARACTERS)

    def __repr__(self) -> str:
        said, name = self.summary(), type(self).__name__
        return cut(said if said.startswith(name) else f"<{name}: {said}>", MAX_CHARACTERS)

    def _repr_html_(self) -> str | None:
        """The first section of the page with its picture; None where no package that draws is installed."""
        for draw in _drawers():
            return str(draw(self))
        return None


@cache
def _drawers() -> tuple[Any, ...]:
    return tuple(point.load() for point in entry_points(group=GROUP))


def described(value: Any) -> str:
    """The class of a dataclass with its fields, each of them short."""
    shown = ", ".join(
        f"{one.name}={cut(_short(getattr(value, one.name, None)), MAX_FIELD_CHARACTERS)}"
        for one in fields(value)
        if one.repr
    )
    return cut(f"{type(value).__qualname__}({shown})", MAX_CHARACTERS)


def cut(text: str, characters: int) -> str:
    """The text, or its beginning and … where it is longer."""
    return text if len(text) <= characters else f"{text[: characters - 1]}…"


def _short(value: Any) -> str:
    match value:
        case np.ndarray():
            return _array(value)
        case str() | bytes():
            return repr(value[: MAX_FIELD_CHARACTERS + 1])
        case Mapping():
            shown = ", ".join(f"{key!r}: {_inner(one)}" for key, one in list(value.items())[:MAX_ENTRIES])
            return f"{{{shown}{_more(len(value))}}}"
        case tuple() | list() | Set():
            shown = ", ".join(_inner(one) for one in list(value)[:MAX_ENTRIES])
            ends = "()" if isinstance(value, tuple) else "[]" if isinstance(value, list) else "{}"
            return f"{ends[0]}{shown}{_more(len(value))}{ends[1]}"
        case _:
            return _inner(value)


def _more(entries: int) -> str:
    return f", … {entries} in all" if entries > MAX_ENTRIES else ""


def _inner(value: Any) -> str:
    """A value inside another: of dataclasses the class, and the name where there is one."""
    if isinstance(value, np.ndarray):
        return _array(value)
    if isinstance(value, tuple | list | Mapping | Set) and len(value) > 0:
        return f"{type(value).__name__} of {len(value)}"
    if is_dataclass(value) and not isinstance(value, type):
        name = getattr(value, "name", None)
        return f"{type(value).__name__}({name!r})" if isinstance(name, str) else f"{type(value).__name__}(…)"
    if isinstance(value, float):
        return f"{value:.6g}"
    if callable(value):
        return getattr(value, "__qualname__", type(value).__qualname__)
    return cut(repr(value), MAX_FIELD_CHARACTERS)


def _array(value: np.ndarray[Any, Any]) -> str:
    """Its numbers where they are few, otherwise its shape."""
    if value.size <= MAX_ENTRIES and value.dtype.kind in "fiub":
        return np.array2string(value, precision=6, separator=", ").replace("\n", "")
    return f"array of shape {value.shape}"
