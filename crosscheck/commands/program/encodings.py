"""Output on terminals and into files whose encoding has no Greek letters, arrows or frames: spelled in ASCII."""

from __future__ import annotations

import codecs
import io
import sys
import unicodedata

ASCII_SPELLING = str.maketrans(
    {
        **dict.fromkeys("–—−‒‐", "-"), **dict.fromkeys("·•×", "*"), **dict.fromkeys("“”", '"'),
        **dict.fromkeys("‘’", "'"),
        "…": "...", "→": "->", "←": "<-", "≤": "<=", "≥": ">=", "≠": "!=", "≈": "~", "∞": "inf", "√": "sqrt", "‖": "|",
        "✓": "+", "✗": "x", "±": "+-", "°": "deg", "⁻": "-", "∂": "d", "µ": "u", "μ": "u",
    }
)  # fmt: skip
"""What the reports of the program use, in characters that every encoding has."""


def accept_all_characters() -> None:
    """Standard output and standard error spell what their encoding does not have, in place of an exception."""
    codecs.register_error("spelled", _spelled)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper) and not stream.encoding.lower().startswith("utf"):
            stream.reconfigure(errors="spelled")


def spelled(text: str) -> str:
    """The text in ASCII: τ as tau, ẍ as x, 10⁻³ as 10-3; other characters as Python writes them, as \\u4e2d."""
    return "".join(map(_letter, text.translate(ASCII_SPELLING)))


def _letter(character: str) -> str:
    letters = (c for c in unicodedata.normalize("NFKD", character) if not unicodedata.combining(c))
    return "".join(c if c.isascii() else _greek(c) or c.encode("ascii", "backslashreplace").decode() for c in letters)


def _greek(letter: str) -> str:
    """Its name, "" for other letters."""
    script, *_, name = unicodedata.name(letter, "NO NAME").split()
    return (
        {"Ll": name.lower(), "Lu": name.capitalize()}.get(unicodedata.category(letter), "") if script == "GREEK" else ""
    )


def _spelled(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    return spelled(error.object[error.start : error.end]), error.end
