"""What C takes for names and for comments."""

from __future__ import annotations

import re
from collections.abc import Iterable

from graphdyn.errors import InvalidInput

_RESERVED_WORDS = """
alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t char8_t class co_await
co_return co_yield compl concept const const_cast consteval constexpr constinit continue decltype default delete do
double dynamic_cast else enum explicit export extern false float for friend goto if inline int long mutable
namespace new noexcept not not_eq nullptr operator or or_eq private protected public register reinterpret_cast
requires restrict return short signed sizeof static static_assert static_cast struct switch template this
thread_local throw true try typedef typeid typename union unsigned using virtual void volatile wchar_t while xor
xor_eq linux unix std main m all clean help install package test assert complex ctype errno fenv inttypes iso646
limits locale math setjmp signal stdalign stdarg stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string
tgmath threads time uchar wchar wctype
"""

RESERVED = frozenset(_RESERVED_WORDS.split())
"""Keywords of C and C++, macros of common compilers, headers of C, and what C++ and CMake keep for themselves."""

IDENTIFIER = re.compile(r"[A-Za-z](?:_?[A-Za-z0-9])*")
"""Identifiers that neither C nor C++ reserves: no underscore at an end, nor two in a row."""


def prefix_of(robot: str) -> str:
    """The robot's name, or as much of it as an identifier can have."""
    letters = re.sub(r"[^A-Za-z0-9]+", "_", robot).strip("_") or "robot"
    name = letters if letters[0].isalpha() else f"robot_{letters}"
    return f"{name}_robot" if name in RESERVED else name


def checked_prefix(name: str) -> str:
    """The name itself. Raises InvalidInput for one that C, C++ or CMake does not take."""
    if not IDENTIFIER.fullmatch(name) or name in RESERVED:
        raise InvalidInput(
            f"'{name}' is no name for functions in C; begin with a letter, use letters and digits with single _ "
            "between them, and no keyword"
        )
    return name


def comment_text(text: str) -> str:
    """Text that stands in a comment in C: printable ASCII, and nothing that ends the comment."""
    ascii_only = text.encode("unicode_escape").decode("ascii")
    for pair in ("*/", "/*", "??"):  # ??/ is a backslash in C99
        while pair in ascii_only:
            ascii_only = ascii_only.replace(pair, " ".join(pair))
    return ascii_only


def comment(lines: Iterable[str]) -> str:
    """A comment of several lines, of which names went through comment_text."""
    return "\n".join(["/*", *(f" * {line}".rstrip() for line in lines), " */"])
