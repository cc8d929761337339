"""Names and values of a file quoted in messages: shortened, whatever the file contains."""

from __future__ import annotations

from collections.abc import Iterable

LONGEST = 80
"""Largest number of characters of a quoted name or value."""

MOST = 20
"""Largest number of names in a quoted list."""


def shortened(text: str) -> str:
    """The text on one line; beyond LONGEST characters, without its middle."""
    text = one_line(text)
    half = LONGEST // 2
    return text if len(text) <= LONGEST else f"{text[:half]} … {text[-half:]}"


def one_line(text: str) -> str:
    """The text on one line: characters that do not print, such as line breaks, as in a Python string: \\n, \\x1b."""
    return "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def listed(names: Iterable[str]) -> str:
    """The names in quotes, the first MOST of them."""
    names = list(names)
    said = ", ".join(f"'{shortened(name)}'" for name in names[:MOST])
    return said if len(names) <= MOST else f"{said} and {len(names) - MOST} more"
