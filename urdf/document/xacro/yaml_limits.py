"""YAML that can ask for no more than its bytes: bounded nesting, and bounded parts that are named once and repeated.

Files alone are imported here, for the process that expands xacro reads this file by its path.
"""

from __future__ import annotations

from typing import Any

import yaml

MAX_DEPTH = 50
"""Largest number of mappings and lists within each other."""

MAX_PARTS = 100_000
"""Largest number of texts, mappings and lists after every alias is written out."""


class OddYaml(ValueError):
    """A file that is no YAML, or would become too large. line: from 1, None where it has none."""

    def __init__(self, problem: str, line: int | None):
        super().__init__(problem)
        self.line = line


def refuse_growing_yaml(content: bytes) -> None:
    """Refuse YAML that grows: raises OddYaml for text that is no YAML, and for what would become too large."""
    sizes: dict[str, int] = {}
    within: list[tuple[str | None, int]] = []  # the names of what is not closed yet, and their sizes so far
    size = 0
    event: Any
    try:
        for event in yaml.parse(content, getattr(yaml, "CSafeLoader", yaml.SafeLoader)):
            line = event.start_mark.line + 1
            match event:
                case yaml.SequenceStartEvent() | yaml.MappingStartEvent():
                    within.append((event.anchor, size))
                    size = 1
                case yaml.SequenceEndEvent() | yaml.MappingEndEvent():
                    anchor, before = within.pop()
                    _name(sizes, anchor, size)
                    size += before
                case yaml.ScalarEvent():
                    _name(sizes, event.anchor, 1)
                    size += 1
                case yaml.AliasEvent():
                    if event.anchor not in sizes:
                        raise OddYaml(f"*{str(event.anchor)[:80]} stands before the end of what it names", line)
                    size += sizes[event.anchor]
            if len(within) > MAX_DEPTH:
                raise OddYaml(f"more than {MAX_DEPTH} mappings or lists within each other", line)
            if size > MAX_PARTS:
                raise OddYaml(f"more than {MAX_PARTS} parts, once its aliases are written out", line)
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise OddYaml(*_said(error)) from error


def _name(sizes: dict[str, int], anchor: str | None, size: int) -> None:
    if anchor is not None:
        sizes[anchor] = size


def _said(error: Any) -> tuple[str, int | None]:
    """Problem and line."""
    mark = getattr(error, "problem_mark", None)
    problem = getattr(error, "problem", None) or " ".join(str(error).split())[:80] or type(error).__name__
    return f"not well-formed YAML: {problem}", None if mark is None else mark.line + 1
