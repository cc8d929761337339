"""Which guides speak of which public names."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from pathlib import Path

from public_names import FOR_USERS, home, kind_of, public_names, value_of

from graphdyn.verbs import VERBS

HERE = Path(__file__).parents[1]
CODE = re.compile(r"`([\w.]+)(?:\([^`]*\))?`")
"""Inline code of a guide: a name, or a call of it."""

NOT_GUIDES = {"index", "architecture", "recipes", "contributing", "glossary", "json", "agreement", "accuracy"}
"""Pages that lists of names and numbers are on."""

MAX_GUIDES = 4
"""Guides that the page of a name leads to, those that speak of it most."""


@cache
def targets() -> dict[str, str]:
    """Full name of what code in a guide means: qualified names, and short ones that mean nothing else.

    Short names of one small word (`judge`) are also those of commands and arguments, unless they are verbs (`power`).
    """
    found: dict[str, str] = {}
    short: dict[str, set[str]] = {}
    for module in FOR_USERS:
        for name in public_names(module):
            if kind_of(value_of(module, name)) in ("function", "class", "exception"):
                full = home(module, name)
                found[f"{module}.{name}"] = full
                if "_" in name or name[0].isupper() or name in VERBS:
                    short.setdefault(name, set()).add(full)
    return found | {name: next(iter(full)) for name, full in short.items() if len(full) == 1}


@cache
def mentions() -> dict[str, dict[str, int]]:
    """How often each guide speaks of a public name, by full name and name of the guide."""
    found: dict[str, dict[str, int]] = {}
    for path in sorted(HERE.glob("*.md")):
        if path.stem in NOT_GUIDES:
            continue
        for name in CODE.findall(path.read_text(encoding="utf-8")):
            if name in targets():
                counts = found.setdefault(targets()[name], {})
                counts[path.stem] = counts.get(path.stem, 0) + 1
    return found


def speaking_of(names: Iterable[str]) -> list[str]:
    """The guides that speak of any of these names, those that do most first."""
    counts: dict[str, int] = {}
    for name in names:
        for guide, times in mentions().get(name, {}).items():
            counts[guide] = counts.get(guide, 0) + times
    return sorted(counts, key=lambda guide: (-counts[guide], guide))[:MAX_GUIDES]
