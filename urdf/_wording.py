"""Text of a file inside sentences: never endless, whatever the file contains."""

from __future__ import annotations

from collections.abc import Iterable

LONGEST = 80
"""Characters of a name or value."""

MOST = 20
"""Names of a list."""


def shortened(text: str) -> str:
    """The text, its middle left out where it is long."""
    half = LONGEST // 2
    return text if len(text) <= LONGEST else f"{text[:half]} … {text[-half:]}"


def listed(names: Iterable[str]) -> str:
    """The names in quotes, the first MOST of them."""
    names = list(names)
    said = ", ".join(f"'{shortened(name)}'" for name in names[:MOST])
    return said if len(names) <= MOST else f"{said} and {len(names) - MOST} more"
