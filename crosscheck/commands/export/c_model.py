"""A rigid-body model as constants in C, which C++ takes as well."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

from crosscheck.commands.export.conventions import head
from crosscheck.commands.export.record import ExportedModel

C_NUMBERING = "Bodies and joints: 0 ... N - 1, parents first; joint j carries body j; body -1 is the ground."


def c_text(model: ExportedModel) -> str:
    """Constants with internal linkage, to be included where they are used."""
    bodies, frames = model.bodies, model.frames
    comment = "\n".join(f" * {line}".rstrip() for line in head(model, C_NUMBERING))
    comment = comment.replace("*/", "* /").replace("/*", "/ *")
    constants = [
        _constant("double", "gravity[3]", model.gravity),
        _constant("double", "base_rotation[3][3]", model.base_rotation),
        _constant("double", "base_translation[3]", model.base_translation),
        _constant("int", "parent[N]", [body.parent - 1 for body in bodies]),
        _constant("int", "prismatic[N]", [int(body.kind == "prismatic") for body in bodies]),
        _of_each("rotation[N][3][3]", [body.rotation for body in bodies]),
        _of_each("translation[N][3]", [body.translation for body in bodies]),
        _of_each("axis[N][3]", [body.axis for body in bodies]),
        _constant("double", "mass[N]", [body.mass for body in bodies]),
        _of_each("center_of_mass[N][3]", [body.center_of_mass for body in bodies]),
        _of_each("inertia[N][3][3]", [body.inertia for body in bodies]),
        _names("joint_name[N]", [body.joint for body in bodies]),
        _names("body_name[N]", [body.name for body in bodies]),
    ]
    if frames:
        count = len(frames)
        constants += [
            _names(f"frame_name[{count}]", [frame.name for frame in frames]),
            _constant("int", f"frame_body[{count}]", [frame.body - 1 for frame in frames]),
            _of_each(f"frame_rotation[{count}][3][3]", [frame.rotation for frame in frames]),
            _of_each(f"frame_translation[{count}][3]", [frame.translation for frame in frames]),
        ]
    return f"/*\n{comment}\n */\n\nenum {{ N = {model.n} }};\n\n" + "\n".join(constants) + "\n"


def _constant(kind: str, name: str, value: Any) -> str:
    return f"static const {kind} {name} = {_braces(value)};"


def _of_each(name: str, values: Sequence[Any]) -> str:
    """One line per body or frame."""
    return f"static const double {name} = {{\n" + "".join(f"    {_braces(value)},\n" for value in values) + "};"


def _names(name: str, names: Iterable[str]) -> str:
    return f"static const char *const {name} = {{\n" + "".join(f"    {_literal(text)},\n" for text in names) + "};"


def _braces(value: Any) -> str:
    if isinstance(value, int | float):
        return repr(value)
    return "{" + ", ".join(map(_braces, value)) + "}"


def _literal(text: str) -> str:
    """A string in UTF-8; all but printable ASCII as octal escapes, which end after three digits."""
    plain = set(range(0x20, 0x7F)) - set(b'"\\?')
    written = (chr(byte) if byte in plain else f"\\{byte:03o}" for byte in text.encode(errors="replace"))
    return f'"{"".join(written)}"'
