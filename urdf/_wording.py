"""Names and values of a file quoted in messages: shortened, whatever the file contains."""

from __future__ import annotations

from collections.abc import Iterable

LONGEST = 80
"""Largest number of characters of a quoted name or value."""

MOST = 20
"""Largest number of names in a quoted list."""


def shortened(text: str) -> str:
    """The text; beyond LONGEST characters, without its middle."""
    half = LONGEST // 2
    return text if len(text) <= LONGEST else f"{text[:half]} … {text[-half:]}"


def listed(names: Iterable[str]) -> str:
    """The names in quotes, the first MOST of them."""
    names = list(names)
    said = ", ".join(f"'{shortened(name)}'" for name in names[:MOST])
    return said if len(names) <= MOST else f"{said} and {len(names) - MOST} more"
