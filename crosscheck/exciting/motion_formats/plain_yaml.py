"""YAML of mappings, lists and texts alone, with their lines: what a message of numbers needs.

Aliases, anchors, tags, a key stated twice and deep nesting are refused; numbers are texts, so that none is read as
something else (YAML 1.1 takes 1:30 for 90, 010 for 8).
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple, TypeAlias

from crosscheck.recordings.errors import BadRecordingFile, quoted

MAX_YAML_DEPTH = 8
"""Largest number of mappings and lists within each other; a message has four."""

Content: TypeAlias = "str | list[YamlNode] | dict[str, YamlNode]"


class YamlNode(NamedTuple):
    """What stands in a line of the file."""

    line: int
    content: Content


def read_yaml(path: Path) -> YamlNode:
    """The one document of a file. Raises BadRecordingFile for another content; OSError."""
    try:
        import yaml
    except ImportError as error:
        raise BadRecordingFile(f"{path}: to read YAML, install PyYAML") from error
    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    try:
        events = list(yaml.parse(path.read_bytes(), loader))
    except (yaml.YAMLError, UnicodeDecodeError) as error:
        raise BadRecordingFile(f"{path}: is no YAML: {' '.join(str(error).split())}") from None
    count = sum(isinstance(event, yaml.DocumentStartEvent) for event in events)
    if count != 1:
        raise BadRecordingFile(f"{path}: has {count} YAML documents; give a file of one")
    left = iter(events[2:])  # after the starts of the stream and of the document
    return _Reader(path, left).node(next(left), MAX_YAML_DEPTH)


class _Reader:
    def __init__(self, path: Path, events: Iterator[Any]) -> None:
        self.path, self.events = path, events

    def node(self, event: Any, depth: int) -> YamlNode:
        line = event.start_mark.line + 1
        kind = type(event).__name__
        if kind == "AliasEvent" or event.anchor is not None:
            raise fault(self.path, line, f"the name {quoted(event.anchor)} for a part of the file", "write it out")
        if event.tag is not None:
            raise fault(self.path, line, f"the tag {quoted(event.tag)}", "leave it out")
        if kind == "ScalarEvent":
            return YamlNode(line, event.value)
        if not depth:
            raise fault(self.path, line, f"more than {MAX_YAML_DEPTH} lists within each other", "give a message")
        if kind == "SequenceStartEvent":
            return YamlNode(line, [self.node(one, depth - 1) for one in self._until("SequenceEndEvent")])
        content: dict[str, YamlNode] = {}
        for one in self._until("MappingEndEvent"):
            if type(one).__name__ != "ScalarEvent":
                raise fault(self.path, one.start_mark.line + 1, "a key that is no text", "give a message")
            key = self.node(one, 0)
            if str(key.content) in content:
                raise fault(self.path, key.line, f"{quoted(key.content)} is stated twice", "keep the one that is meant")
            content[str(key.content)] = self.node(next(self.events), depth - 1)
        return YamlNode(line, content)

    def _until(self, end: str) -> Iterator[Any]:
        while type(event := next(self.events)).__name__ != end:
            yield event


def fault(path: Path, line: int, problem: str, remedy: str) -> BadRecordingFile:
    """An error about a line."""
    return BadRecordingFile(f"{path}: line {line}: {problem}; {remedy}")
