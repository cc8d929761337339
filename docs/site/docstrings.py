"""Docstrings of this project as reStructuredText.

Lines `name: meaning   (shape)  [unit]` become a list of parameters (of a function) or attributes (of a class),
sentences that begin with "Raises" or "Warns" become fields, paragraphs that begin with >>> code, and everything else
is escaped, so that |x| or θ* means itself.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping

from crosscheck.report.records.docstrings import taken_apart


def as_rst(lines: list[str], names: Collection[str], title: str, links: Mapping[str, str]) -> list[str]:
    """The docstring as reStructuredText. title: of the list of entries; links: target of a reference by name."""
    parts = taken_apart(lines, names)
    rst: list[str] = []
    for paragraph in parts.prose:
        rst += [escaped(paragraph), ""]
    if parts.entries:
        rst.append(f":{title}:")
        for entry in parts.entries:
            term = ", ".join(f"**{name}**" for name in entry.names)
            size = escaped("  ".join(text for text in (entry.shape, entry.unit) if text))
            meaning = escaped(entry.meaning)
            rst.append(f"    {term} : {size}" if size and meaning else f"    {term}")
            rst.append(f"        {meaning or size}")
    for kind, text in parts.fields:
        rst.append(f":{kind}: {_linked(escaped(text), links)}")
    for example in parts.examples:
        rst += ["", ".. code-block:: pycon", "", *(f"   {line}" for line in example), ""]
    return [*rst, ""]


def escaped(text: str) -> str:
    """Plain text with `code` in single backticks and pages as docs/NAME.md, as reStructuredText."""
    pieces = text.split("`")
    if len(pieces) % 2 == 0:  # a backtick that stands for itself
        pieces = [text]
    for k in range(0, len(pieces), 2):
        pieces[k] = re.sub(r"([\\*|`])", r"\\\1", pieces[k])
        pieces[k] = re.sub(r"_(?!\w)", r"\\_", pieces[k])
    for k in range(1, len(pieces), 2):
        pieces[k] = f"``{pieces[k]}``"
    return re.sub(r"\bdocs/(\w+)\.md\b", r":doc:`docs/\1.md </\1>`", "".join(pieces))


def _linked(text: str, links: Mapping[str, str]) -> str:
    return re.sub(r"\b[A-Z]\w+\b", lambda found: f":exc:`~{links[found[0]]}`" if found[0] in links else found[0], text)
