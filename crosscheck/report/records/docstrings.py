"""Docstrings of this project, taken apart.

A docstring is plain text: a sentence, paragraphs, and lines `name: meaning   (shape)  [unit]` about the parameters of a
function or the attributes of a class. The site and the schemas of the JSON files take their descriptions from them.
"""

from __future__ import annotations

import contextlib
import dataclasses
import inspect
import re
from collections.abc import Collection, Iterator
from dataclasses import dataclass, field

ENTRY_NAMES = r"[A-Za-z_]\w*(?:, [A-Za-z_]\w*)*"
ENTRY = re.compile(rf"({ENTRY_NAMES}): *(?=\S)|({ENTRY_NAMES}):$")
_SIZE = r"(?:…|\w[\w +\-]{0,7})"
_SHAPE = rf"\((?:{_SIZE},|{_SIZE}(?:, ?{_SIZE})+)\)"
TAIL = re.compile(rf"[ ,;]*(?P<shape>{_SHAPE}(?:, ?{_SHAPE})*)?\s*(?P<unit>\[[^\[\]]*\])?$")
FIELDS = ("Raises", "Warns")
PROMPT = ">>>"
"""Begins a line of Python in an example."""

SENTENCE = re.compile(rf"(?<=[.)\]]) (?=(?:{'|'.join(FIELDS)}) [A-Z])")
"""The space before a sentence of an error or a warning."""


@dataclass(frozen=True)
class DocstringEntry:
    """One line `name: meaning   (shape)  [unit]`.

    names: what the line is about
    meaning: in words
    shape, unit: as written, brackets included; empty where there is none
    """

    names: tuple[str, ...]
    meaning: str
    shape: str = ""
    unit: str = ""


@dataclass
class DocstringParts:
    """A docstring taken apart: paragraphs of prose, entries, and the sentences that begin with Raises or Warns.

    examples: lines of Python with their output, those of each paragraph that begins with >>>
    """

    prose: list[str]
    entries: list[DocstringEntry]
    fields: list[tuple[str, str]]
    examples: list[list[str]] = field(default_factory=list)


def names_of(thing: object) -> set[str]:
    """The names that an entry can be about: parameters of a function; fields, attributes, parameters of a class."""
    names: set[str] = set()
    if inspect.isclass(thing):
        for base in thing.__mro__:
            names |= set(vars(base)) | set(vars(base).get("__annotations__", ()))
        if dataclasses.is_dataclass(thing):
            names |= {field.name for field in dataclasses.fields(thing)}
    if callable(thing):
        with contextlib.suppress(TypeError, ValueError):  # of some classes written in C
            names |= set(inspect.signature(thing).parameters)
    return names


def taken_apart(lines: list[str], names: Collection[str]) -> DocstringParts:
    """The parts of a docstring whose entries can be about these names only."""
    parts = DocstringParts([], [], [])
    for paragraph in _paragraphs(lines):
        if paragraph[0].startswith(PROMPT):
            parts.examples.append(paragraph)
            continue
        for kind, text in _pieces(paragraph, names):
            if kind == "entry":
                parts.entries += _entries(text, names)
            else:
                for sentence in SENTENCE.split(text):
                    first, _, rest = sentence.partition(" ")
                    if first in FIELDS:
                        parts.fields.append((first, rest))
                    else:
                        parts.prose.append(sentence)
    return parts


def _paragraphs(lines: list[str]) -> Iterator[list[str]]:
    paragraph: list[str] = []
    for line in [*lines, ""]:
        if line.strip():
            paragraph.append(line.rstrip())
        elif paragraph:
            yield paragraph
            paragraph = []


def _pieces(paragraph: list[str], names: Collection[str]) -> Iterator[tuple[str, str]]:
    """Kind and text of the pieces: a line goes on with the one before it if it is indented, or in mid-sentence."""
    kind, text = "", ""
    for line in paragraph:
        starts = _kind(line, names)
        ended = kind == "entry" and not line.startswith(" ") and line[0].isupper()
        if not kind or starts != "prose" or ended:
            if text:
                yield kind, text
            kind, text = starts, line.strip()
        else:
            text += ("  " if kind == "entry" else " ") + line.strip()
    yield kind, text


def _kind(line: str, names: Collection[str]) -> str:
    if _starts_entry(line, names):
        return "entry"
    first = line.split(" ", 1)[0]
    return first if first in FIELDS else "prose"


def _starts_entry(text: str, names: Collection[str]) -> bool:
    found = ENTRY.match(text)
    return found is not None and _about(found).issubset(names)


def _about(found: re.Match[str]) -> set[str]:
    return set((found[1] or found[2]).split(", "))


def _entries(text: str, names: Collection[str]) -> Iterator[DocstringEntry]:
    """A line can hold several: `shape: of the array; unit: of its numbers`."""
    pieces = [""]
    for piece in re.split(r"(?<=;) ", text):
        if _starts_entry(piece, names):
            pieces.append(piece)
        else:
            pieces[-1] = f"{pieces[-1]} {piece}"
    for piece in pieces[1:]:
        who, meaning = piece.rstrip(" ;").split(":", 1)
        tail = TAIL.search(meaning)
        assert tail is not None  # it can be empty
        shape, unit = tail["shape"] or "", tail["unit"] or ""
        yield DocstringEntry(tuple(who.split(", ")), " ".join(meaning[: tail.start()].split()), shape, unit)
