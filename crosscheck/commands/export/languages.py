"""A rigid-body model as constants in C, which C++ takes as well, and as a function for MATLAB and Octave."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from crosscheck.commands.export.record import ExportedModel
from crosscheck.report.plain_text import printable
from crosscheck.report.records.record import versions
from graphdyn.layout import Array

C_NUMBERING = "Bodies and joints: 0 ... N - 1, parents first; joint j carries body j; body -1 is the ground."
MATLAB_NUMBERING = "Bodies and joints: 1 ... n, parents first; joint j carries body j; body 0 is the ground."

OF_THE_WHOLE = ("gravity", "base_rotation", "base_translation")
"""The constants that are no lists over bodies or frames."""


def c_text(exported: ExportedModel) -> str:
    """Constants with internal linkage, to be included where they are used."""
    comment = "\n".join(f" * {line}".rstrip() for line in _head(exported, C_NUMBERING))
    comment = comment.replace("*/", "* /").replace("/*", "/ *")
    lines = [
        _c_constant(name, value)
        for name, value in _constants(exported, first=0).items()
        if exported.model.frames or not name.startswith("frame_")
    ]
    return f"/*\n{comment}\n */\n\nenum {{ N = {exported.model.n_bodies} }};\n\n" + "\n".join(lines) + "\n"


def matlab_text(exported: ExportedModel, function: str) -> str:
    """A function that returns a structure. function: its name, which has to be that of the file"""
    lines = [
        f"function model = {function}()",
        *(f"% {line}".rstrip() for line in _head(exported, MATLAB_NUMBERING)),
        f"model.n = {exported.model.n_bodies};",
    ]
    for name, value in _constants(exported, first=1).items():
        lines += _matlab_constant(name, value)
    return "\n".join([*lines, "end"]) + "\n"


def _head(exported: ExportedModel, numbering: str) -> list[str]:
    """Lines of a comment: units, frames, numbering. numbering: of bodies and joints in this language, one sentence"""
    locked = ", ".join(f"{printable(name)} at {value:g}" for name, value in exported.locked.items())
    return [
        f"Rigid-body model of {printable(exported.robot)}, written by graphdyn {versions()['graphdyn']}.",
        *([f"Locked joints: {locked}."] if locked else []),
        *([f"Chain from {printable(exported.chain[0])} to {printable(exported.chain[1])}."] if exported.chain else []),
        "",
        "Units: m, rad, kg, kg m^2, m/s^2.",
        numbering,
        "",
        "rotation R, translation t: placement of the joint frame in the link frame of the parent; a point with",
        "    coordinates x in the joint frame has R x + t in the link frame of the parent",
        "axis: unit axis in the joint frame. The link frame of the body coincides with the joint frame at q = 0;",
        "    a revolute joint turns it about the axis by q, a prismatic joint shifts it along the axis by q",
        "center_of_mass: in the link frame",
        "inertia: tensor about the center of mass, in link axes",
        "gravity: in world axes. base_rotation, base_translation: placement of the ground frame in the world",
        "frame_...: further named frames fixed in bodies, placed in their link frames",
    ]


def _constants(exported: ExportedModel, first: int) -> Mapping[str, Array | Sequence[str]]:
    """Numbers and names. first: number of the first body in the language"""
    model = exported.model
    bodies, joints, frames = model.bodies, model.joints, model.frames
    return {
        "gravity": model.gravity,
        "base_rotation": model.base.rotation,
        "base_translation": model.base.translation,
        "parent": np.array([joint.inside + first - 1 for joint in joints]),
        "prismatic": np.array([joint.is_prismatic for joint in joints]),
        "rotation": np.array([joint.placement.rotation for joint in joints]),
        "translation": np.array([joint.placement.translation for joint in joints]),
        "axis": np.array([joint.axis for joint in joints]),
        "mass": np.array([body.mass for body in bodies]),
        "center_of_mass": np.array([body.center_of_mass for body in bodies]),
        "inertia": np.array([body.inertia for body in bodies]),
        "joint_name": model.joint_names,
        "body_name": model.body_names,
        "frame_name": [frame.name for frame in frames],
        "frame_body": np.array([frame.body + first - 1 for frame in frames], dtype=int),
        "frame_rotation": np.reshape([frame.placement.rotation for frame in frames], (-1, 3, 3)),
        "frame_translation": np.reshape([frame.placement.translation for frame in frames], (-1, 3)),
    }


def _c_constant(name: str, value: Array | Sequence[str]) -> str:
    """Vectors, matrices and names of bodies and frames stand in a line each."""
    size = len(value) if name.startswith("frame_") or name in OF_THE_WHOLE else "N"
    if not isinstance(value, np.ndarray):
        return f"static const char *const {name}[{size}] = {_c_lines(map(_c_literal, value))};"
    kind = "double" if value.dtype == float else "int"
    declared = f"static const {kind} {name}[{size}]" + "".join(f"[{count}]" for count in value.shape[1:])
    numbers = value.astype(kind).tolist()
    if value.ndim == 1 or name in OF_THE_WHOLE:
        return f"{declared} = {_c_braces(numbers)};"
    return f"{declared} = {_c_lines(map(_c_braces, numbers))};"


def _c_lines(items: Iterator[str]) -> str:
    return "{\n" + "".join(f"    {item},\n" for item in items) + "}"


def _c_braces(value: Any) -> str:
    return "{" + ", ".join(map(_c_braces, value)) + "}" if isinstance(value, list) else repr(value)


def _c_literal(text: str) -> str:
    """A string in UTF-8; all but printable ASCII as octal escapes, which end after three digits."""
    plain = set(range(0x20, 0x7F)) - set(b'"\\?')
    written = (chr(byte) if byte in plain else f"\\{byte:03o}" for byte in text.encode(errors="replace"))
    return f'"{"".join(written)}"'


def _matlab_constant(name: str, value: Array | Sequence[str]) -> Iterator[str]:
    """Vectors (3, n) and matrices (3, 3, n) of bodies and frames are filled one after the other."""
    if not isinstance(value, np.ndarray):
        yield f"model.{name} = {{{', '.join(map(_matlab_literal, value))}}};"
    elif name in OF_THE_WHOLE:
        yield f"model.{name} = {_matlab_array(value)};"
    elif value.ndim == 1:
        row = f"[{_matlab_row(value.astype(int) if value.dtype == bool else value)}]"
        yield f"model.{name} = {f'logical({row})' if value.dtype == bool else row};"
    else:
        yield f"model.{name} = zeros({', '.join(map(str, (*value.shape[1:], len(value))))});"
        for number, one in enumerate(value, start=1):
            yield f"model.{name}({':, ' * one.ndim}{number}) = {_matlab_array(one)};"


def _matlab_array(array: Array) -> str:
    """A column of three, or a matrix."""
    return f"[{_matlab_row(array)}]'" if array.ndim == 1 else f"[{'; '.join(map(_matlab_row, array))}]"


def _matlab_row(values: Array) -> str:
    return " ".join(map(repr, values.tolist()))


def _matlab_literal(text: str) -> str:
    """A character array; of codes where a character cannot stand in a literal."""
    if text.isascii() and text.isprintable():
        return "'" + text.replace("'", "''") + "'"
    return f"char([{' '.join(map(str, text.encode('utf-8', 'replace')))}])"
