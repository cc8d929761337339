"""The reference, written before Sphinx reads the sources: one page per public function, or per file of few names.

A page over each public module lists its names by room with their first sentences, and one page over all lists the
modules. Pages of functions say which guides speak of them (mentions.py).
"""

from __future__ import annotations

import inspect
from collections.abc import Collection, Mapping
from pathlib import Path

import docstrings
import mentions
import rooms
from public_names import FOR_USERS, MODULES, TO_EXTEND, home, kind_of, public_names, room_of, value_of

from crosscheck.report.records.docstrings import names_of, taken_apart

KINDS = ("function", "class", "data", "exception")
"""In this order within a room."""

SHARED_PAGES = {"data": "constants", "exception": "errors"}
"""Page of a module that holds all its names of a kind."""


def pages_of(module: str) -> dict[str, list[str]]:
    """The names of every page of a module: each function that users call has its own, classes are by file."""
    found: dict[str, list[str]] = {}
    for name in _in_order(module):
        if home(module, name) == f"{module}.{name}":
            found.setdefault(page_of(module, name), []).append(name)
    return found


def page_of(module: str, name: str) -> str:
    """The page on which a public name is documented, in the folder of its module."""
    value = value_of(module, name)
    kind = kind_of(value)
    if kind in SHARED_PAGES:
        return SHARED_PAGES[kind]
    if kind == "function" and module in FOR_USERS:
        return name
    return str(getattr(value, "__module__", module)).rpartition(".")[2]


def page(module: str, names: Collection[str]) -> str:
    """A page of these names of a module in reStructuredText, each from its docstring."""
    title = ", ".join(names) if len(names) < 4 else f"{', '.join(list(names)[:2])} and {len(names) - 2} more"
    lines = [":orphan:", "", *_heading(title, "="), f"In :doc:`{module} </reference/{module}>`.", ""]
    lines += [f".. py:currentmodule:: {module}", ""]
    for name in names:
        lines += _entry(kind_of(value_of(module, name)), module, name)
    if speaking := mentions.speaking_of([f"{module}.{name}" for name in names]):
        lines += [f"**In the guide**: {', '.join(f':doc:`/{guide}`' for guide in speaking)}", ""]
    return "\n".join(lines)


def overview(module: str, title: str) -> str:
    """The page over a module: its names by room, each with its first sentence."""
    lines = _heading(f"{module}: {title[0].lower()}{title[1:]}" if module != "urdf" else f"{module}: {title}", "=")
    lines += [f".. py:module:: {module}", ""]
    by_room: dict[str, list[str]] = {}
    for name in _in_order(module):
        by_room.setdefault(room_of(module, name), []).append(name)
    for room in (room for room in ["", *rooms.ordered(module)] if room in by_room):
        if room:
            summary = rooms.summary(rooms.rooms(module)[room])
            lines += [*_heading(room, "-"), *docstrings.as_rst([summary], (), "", {})]
        for name in by_room[room]:
            lines += [f"- :py:obj:`{name} <{home(module, name)}>`{_said(module, name)}"]
        lines.append("")
    return "\n".join(lines)


def index() -> str:
    """The page over all modules."""
    lines = ["Reference", "=========", "", "Every public name of the three packages, from its docstring. Shapes are in"]
    lines += ["round brackets, units in square ones; … stands for any leading dimensions, which broadcast.", ""]
    for caption, modules in (("For users", FOR_USERS), ("For those who extend the program", TO_EXTEND)):
        lines += [caption, "-" * len(caption), "", ".. toctree::", "   :maxdepth: 1", ""]
        lines += [*(f"   {module}" for module in modules), ""]
    return "\n".join(lines)


def write(folder: Path) -> None:
    """All pages; files that are right already are left alone, so that Sphinx does not read them again."""
    pages = {"index": index()} | {module: overview(module, title) for module, title in MODULES.items()}
    for module in MODULES:
        pages |= {f"{module}/{name}": page(module, names) for name, names in pages_of(module).items()}
    for name, text in pages.items():
        path = folder / f"{name}.rst"
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    for path in folder.rglob("*.rst"):
        if path.relative_to(folder).with_suffix("").as_posix() not in pages:
            path.unlink()


def missing(documented: Collection[str]) -> list[str]:
    """Public names that are not among the documented ones."""
    return [
        f"{module}.{name}"
        for module in MODULES
        for name in public_names(module)
        if home(module, name) not in documented
    ]


def _in_order(module: str) -> list[str]:
    return sorted(public_names(module), key=lambda name: KINDS.index(kind_of(value_of(module, name))))


def _heading(title: str, line: str) -> list[str]:
    return [title, line * len(title), ""]


def _said(module: str, name: str) -> str:
    """The first sentence of its docstring, after a colon; nothing for values."""
    value = value_of(module, name)
    if kind_of(value) == "data":
        return ""
    found = taken_apart((inspect.getdoc(value) or "").splitlines(), names_of(value))
    return f": {docstrings.escaped(found.prose[0])}"


def _entry(kind: str, module: str, name: str) -> list[str]:
    if kind == "data":
        value = value_of(module, name)
        shown = list(value) if isinstance(value, Mapping) else value
        return [f".. py:data:: {name}", f"   :value: {shown!r}" + (" by name" if shown is not value else ""), ""]
    lines = [f".. auto{kind}:: {module}.{name}"]
    if kind in ("class", "exception"):
        lines += ["   :members:", "   :show-inheritance:" if kind == "exception" else "   :member-order: bysource"]
    return [*lines, ""]
