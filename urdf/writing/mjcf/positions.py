"""Positions of bodies and joints in the bytes of an MJCF file, and new numbers there: no other byte changes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from xml.parsers import expat

from urdf.writing.in_place import attributes_in, indent_before, tag_at

Edit = tuple[int, int, bytes]
"""Begin and end of the bytes to be replaced, and what takes their place."""


@dataclass(eq=False)
class Positions:
    """Positions by name.

    inertials: begin, end and indent of the <inertial> of a body, or of the place for one
    joints: begin of the tag of a joint
    """

    data: bytes
    inertials: dict[str, tuple[int, int, bytes]] = field(default_factory=dict)
    joints: dict[str, int] = field(default_factory=dict)

    def inertial(self, body: str, element: bytes) -> Edit:
        """This <inertial> in place of that of the body."""
        begin, end, indent = self.inertials[body]
        newline = b"\r\n" if b"\r\n" in self.data else b"\n"
        return begin, end, element if end > begin else newline + indent + element

    def attributes(self, joint: str, values: Mapping[str, float]) -> list[Edit]:
        """These numbers in the tag of the joint; of several in one attribute, the first."""
        at = self.joints[joint]
        tag = tag_at(self.data, at)
        edits, missing = [], dict(values)
        for name, begin, end in attributes_in(tag):
            if name in missing:
                others = tag[begin:end].split()[1:]
                text = b" ".join([repr(missing.pop(name)).encode(), *others])
                edits.append((at + begin, at + end, text))
        if missing:
            said = "".join(f' {name}="{value!r}"' for name, value in missing.items()).encode()
            name_ends = at + len(_NAME.match(tag)[0])  # type: ignore[index]  # a tag has a name
            edits.append((name_ends, name_ends, said))
        return edits


_NAME = re.compile(rb"<[^\s/>]+")


def positions(data: bytes) -> Positions:
    """The positions in a document that loads, in an encoding that contains ASCII."""
    found = Positions(data)
    path: list[tuple[str, str]] = []
    parser = expat.ParserCreate()

    def start(tag: str, attributes: dict[str, str]) -> None:
        at, name = parser.CurrentByteIndex, attributes.get("name", "")
        above = path[-1] if path else ("", "")
        path.append((tag, name))
        if "worldbody" not in (tag for tag, _ in path):
            return
        if tag == "body" and name:
            end = at + len(tag_at(data, at))
            found.inertials[name] = end, end, indent_before(data, at) + b"  "
        elif tag == "inertial" and above[1] in found.inertials:
            found.inertials[above[1]] = at, at + len(tag_at(data, at)), indent_before(data, at)
        elif tag == "joint" and name:
            found.joints[name] = at

    def end(tag: str) -> None:
        at = parser.CurrentByteIndex
        path.pop()
        if tag == "inertial" and path and path[-1][1] in found.inertials and data.startswith(b"</inertial", at):
            begin, _, indent = found.inertials[path[-1][1]]
            found.inertials[path[-1][1]] = begin, at + len(tag_at(data, at)), indent

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.Parse(data, True)
    return found


def with_edits(data: bytes, edits: list[Edit]) -> bytes:
    """The document after these edits, made from its end so that earlier positions stay valid."""
    for begin, end, text in sorted(edits, reverse=True):
        data = data[:begin] + text + data[end:]
    return data
