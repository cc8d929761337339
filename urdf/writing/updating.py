"""Positions of the <inertial> elements in the bytes of a URDF file, so that they alone can be replaced.

New inertial parameters into an existing URDF file: every byte outside the <inertial> elements stays as it was.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Unpack
from xml.parsers import expat

import numpy as np
from lxml import etree
from numpy.typing import ArrayLike

from graphdyn import Body, InvalidModel
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model import consistency_problems
from urdf.document.catalog import locate
from urdf.document.files import write_whole
from urdf.document.numbers import inertial_element
from urdf.errors import CannotUpdate, one_line
from urdf.reading.loading import fused_links, load
from urdf.reading.reading import Reading, ReadingKeywords

_TAG = re.compile(rb"""<[^"'>]*(?:"[^"]*"[^"'>]*|'[^']*'[^"'>]*)*>""")
"""A whole tag; attribute values may contain '>'."""

_LINE_START = re.compile(rb"[ \t]*$")


@dataclass(frozen=True)
class Span:
    """Bytes start … end of one link: its <inertial>, or the place for one.

    closed: the link is a single tag, <link …/>, which has to be opened
    indent: what stands before the element on its line
    """

    start: int
    end: int
    closed: bool
    indent: bytes


def inertial_spans(data: bytes) -> dict[str, Span]:
    """The span of every link by its name. data: a document that loads, in an encoding that contains ASCII."""
    spans: dict[str, Span] = {}
    path: list[str] = []
    link = ""
    parser = expat.ParserCreate()

    def start(name: str, attributes: dict[str, str]) -> None:
        nonlocal link
        path.append(name)
        at = parser.CurrentByteIndex
        if path[1:] == ["link"]:
            link = attributes.get("name", "")
            tag = _tag(data, at)
            closed = tag.endswith(b"/>")
            place = at if closed else at + len(tag)
            spans[link] = Span(place, at + len(tag), closed, _indent(data, at) + b"  ")
        elif path[1:] == ["link", "inertial"]:
            spans[link] = Span(at, at, False, _indent(data, at))

    def end(_name: str) -> None:
        at = parser.CurrentByteIndex
        if path[1:] == ["link", "inertial"]:
            spans[link] = Span(spans[link].start, at + len(_tag(data, at)), False, spans[link].indent)
        path.pop()

    parser.StartElementHandler, parser.EndElementHandler = start, end
    parser.Parse(data, True)
    return spans


def _tag(data: bytes, at: int) -> bytes:
    found = _TAG.match(data, at)
    assert found is not None
    return found.group()


def _indent(data: bytes, at: int) -> bytes:
    """The blanks before a tag, if nothing else stands before it on its line."""
    line = data[data.rfind(b"\n", 0, at) + 1 : at]
    return line if _LINE_START.match(line) else b""


@dataclass(frozen=True)
class Update:
    """What urdf.update did.

    changed: links that have a new <inertial>; kept: links that had these parameters already, to the last bit
    notes: the bodies whose mass is shared with links fixed to them
    """

    path: Path
    changed: tuple[str, ...]
    kept: tuple[str, ...]
    notes: tuple[str, ...]


def update(
    source: str | PathLike[str],
    destination: str | PathLike[str],
    parameters: ArrayLike,
    *,
    inconsistent: bool = False,
    **reading: Unpack[ReadingKeywords],
) -> Update:
    """Write a copy of a URDF file in which the bodies have other inertial parameters.

    source: path, or name of the catalog; destination: may be the same path
    parameters: ten per body of urdf.load(source, **reading), in its order
                                                            (n, 10) or (10n,)  [kg, kg m, kg m²]
    inconsistent: also write parameters that no real body can have
    reading: as in urdf.load, if the parameters were identified on an arm cut out or with locked joints

    A body may carry fixed or locked links. They keep their own <inertial>; the link of the body gets the rest, so that
    all together have the given parameters.

    Raises CannotUpdate for parameters of another shape, NaN or infinity, negative masses, physically inconsistent
    parameters unless inconsistent=True, and files in UTF-16 and the like; urdf.load's errors for the source; OSError.
    """
    how = Reading.of(update, reading).without_computed_inertials
    path, _ = locate(source)
    if path.suffix.lower() == ".xacro":
        raise CannotUpdate(
            "a .xacro file has no <inertial> of its own to edit", "expand it and give the URDF", path=path
        )
    model = load(source, reading=how)
    wanted = _checked(parameters, model.n_bodies, path)
    shares = fused_links(source, reading=how)
    data = path.read_bytes()
    try:
        if b"\0" in data:
            raise LookupError
        spans = inertial_spans(data)
    except (LookupError, ValueError, expat.ExpatError):  # of other encodings than of one byte, or UTF-8
        problem = "the file is in UTF-16 or another encoding that cannot be edited"
        raise CannotUpdate(problem, "save it as UTF-8 first", path=path) from None
    edits, changed, notes = [], [], []
    for number, (old, new) in enumerate(zip(model.bodies, wanted, strict=True), start=1):
        carried = {name: share for name, (body, share) in shares.items() if body == number and share.any()}
        if np.array_equal(old.parameters, new):
            continue
        rest = _body(old.name, new - sum(carried.values()), path, bool(carried))
        if not inconsistent:
            _refuse_inconsistent(_body(old.name, new, path, False), path)
            _refuse_inconsistent(rest, path)
        edits.append((spans[old.name], rest))
        changed.append(old.name)
        if carried:
            names = ", ".join(f"'{name}' ({share[0]:.6g} kg)" for name, share in carried.items())
            note = f"link '{old.name}' gets {rest.mass:.6g} kg: its fixed links {names} keep their own <inertial>"
            notes.append(one_line(note))
    write_whole(Path(destination), _edited(data, edits))
    kept = tuple(name for name in model.body_names if name not in changed)
    return Update(Path(destination), tuple(changed), kept, tuple(notes))


def _checked(parameters: ArrayLike, n: int, path: Path) -> Array:
    try:
        wanted = np.asarray(parameters, dtype=float)
    except (TypeError, ValueError) as error:
        raise CannotUpdate(
            f"the parameters are not numbers: {error}", "give ten numbers per body", path=path
        ) from error
    if wanted.shape not in ((n, BODY_PARAMETERS), (n * BODY_PARAMETERS,)):
        problem = f"the parameters have shape {wanted.shape}, expected ({n}, 10) or ({10 * n},)"
        remedy = "give ten per moving body, in the order of urdf.load"
        raise CannotUpdate(problem, remedy, path=path)
    wanted = wanted.reshape(n, BODY_PARAMETERS)
    if not np.isfinite(wanted).all():
        body = int(np.argwhere(~np.isfinite(wanted))[0, 0])
        problem = f"the parameters of body {body + 1} contain NaN or infinity"
        remedy = "parameters that the data do not determine need a value"
        raise CannotUpdate(problem, remedy, path=path)
    return wanted


def _body(name: str, parameters: Array, path: Path, is_rest: bool) -> Body:
    try:
        return Body.from_parameters(name, parameters)
    except InvalidModel as error:
        remedy = "its fixed links weigh as much or more by themselves: correct their <inertial> first" if is_rest else (
            "give a mass of at least 0"
        )  # fmt: skip
        raise CannotUpdate(str(error), remedy, path=path, element=f"link '{name}'") from error


def _refuse_inconsistent(body: Body, path: Path) -> None:
    problems = consistency_problems(body.mass, body.inertia)
    if problems:
        problem = f"no real body has these parameters: {'; '.join(problems)}"
        remedy = "identify with physical constraints, or write them nevertheless with inconsistent=True"
        raise CannotUpdate(problem, remedy, path=path, element=f"link '{body.name}'")


def _edited(data: bytes, edits: list[tuple[Span, Body]]) -> bytes:
    """The document with these elements, inserted from the end so that earlier positions stay valid."""
    newline = b"\r\n" if b"\r\n" in data else b"\n"
    for span, body in sorted(edits, key=lambda edit: edit[0].start, reverse=True):
        element = inertial_element(body)
        etree.indent(element, space="  ")
        lines = etree.tostring(element).split(b"\n")
        text = (newline + span.indent).join(lines)
        if span.closed:
            tag = data[span.start : span.end]
            outer = newline + span.indent[:-2]
            text = tag[: tag.rindex(b"/")].rstrip() + b">" + newline + span.indent + text + outer + b"</link>"
        elif span.start == span.end:
            text = newline + span.indent + text
        data = data[: span.start] + text + data[span.end :]
    return data
