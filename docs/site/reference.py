"""One page of reference per public module, and one over all of them, written before Sphinx reads the sources."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from pathlib import Path

import docstrings
import rooms
from public_names import FOR_USERS, MODULES, TO_EXTEND, home, kind_of, public_names, room_of, value_of

KINDS = ("function", "class", "data", "exception")
"""In this order within a room."""


def page(module: str, title: str) -> str:
    """The page of a module in reStructuredText: its names by room, each from its docstring."""
    heading = f"{module}: {title[0].lower()}{title[1:]}" if module != "urdf" else f"{module}: {title}"
    lines = [heading, "=" * len(heading), "", f".. py:module:: {module}", ""]
    by_room: dict[str, list[str]] = {}
    for name in sorted(public_names(module), key=lambda name: KINDS.index(kind_of(value_of(module, name)))):
        by_room.setdefault(room_of(module, name), []).append(name)
    for room in (room for room in ["", *rooms.ordered(module)] if room in by_room):
        if room:
            summary = rooms.summary(rooms.rooms(module)[room])
            lines += [room, "-" * len(room), "", *docstrings.as_rst([summary], (), "", {})]
        for name in by_room[room]:
            elsewhere, kind = home(module, name), kind_of(value_of(module, name))
            lines += (
                _entry(kind, module, name) if elsewhere == f"{module}.{name}" else [f"See :py:obj:`{elsewhere}`.", ""]
            )
    return "\n".join(lines)


def _entry(kind: str, module: str, name: str) -> list[str]:
    if kind == "data":
        value = value_of(module, name)
        shown = list(value) if isinstance(value, Mapping) else value
        return [f".. py:data:: {name}", f"   :value: {shown!r}" + (" by name" if shown is not value else ""), ""]
    lines = [f".. auto{kind}:: {module}.{name}"]
    if kind in ("class", "exception"):
        lines += ["   :members:", "   :show-inheritance:" if kind == "exception" else "   :member-order: bysource"]
    return [*lines, ""]


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
    folder.mkdir(exist_ok=True)
    pages = {"index": index()} | {module: page(module, title) for module, title in MODULES.items()}
    for name, text in pages.items():
        path = folder / f"{name}.rst"
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")
    for path in folder.glob("*.rst"):
        if path.stem not in pages:
            path.unlink()


def missing(documented: Collection[str]) -> list[str]:
    """Public names that are not among the documented ones."""
    return [
        f"{module}.{name}"
        for module in MODULES
        for name in public_names(module)
        if home(module, name) not in documented
    ]
