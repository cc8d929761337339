"""A rigid-body model as a function for MATLAB and Octave that returns a structure."""

from __future__ import annotations

from collections.abc import Sequence

from crosscheck.commands.export.conventions import head
from crosscheck.commands.export.record import ExportedModel

MATLAB_NUMBERING = "Bodies and joints: 1 ... n, parents first; joint j carries body j; body 0 is the ground."

Rows = Sequence[Sequence[float]]


def matlab_text(model: ExportedModel, function: str) -> str:
    """function: its name, which has to be that of the file"""
    bodies, frames = model.bodies, model.frames
    lines = [
        f"function model = {function}()",
        *(f"% {line}".rstrip() for line in head(model, MATLAB_NUMBERING)),
        f"model.n = {model.n};",
        f"model.gravity = {_column(model.gravity)};",
        f"model.base_rotation = {_matrix(model.base_rotation)};",
        f"model.base_translation = {_column(model.base_translation)};",
        f"model.parent = {_row([body.parent for body in bodies])};",
        f"model.prismatic = logical({_row([int(body.kind == 'prismatic') for body in bodies])});",
        *_pages("rotation", [body.rotation for body in bodies]),
        *_columns("translation", [body.translation for body in bodies]),
        *_columns("axis", [body.axis for body in bodies]),
        f"model.mass = {_row([body.mass for body in bodies])};",
        *_columns("center_of_mass", [body.center_of_mass for body in bodies]),
        *_pages("inertia", [body.inertia for body in bodies]),
        f"model.joint_name = {_names([body.joint for body in bodies])};",
        f"model.body_name = {_names([body.name for body in bodies])};",
        f"model.frame_name = {_names([frame.name for frame in frames])};",
        f"model.frame_body = {_row([frame.body for frame in frames])};",
        *_pages("frame_rotation", [frame.rotation for frame in frames]),
        *_columns("frame_translation", [frame.translation for frame in frames]),
        "end",
    ]
    return "\n".join(lines) + "\n"


def _columns(name: str, vectors: Sequence[Sequence[float]]) -> list[str]:
    """(3, n)"""
    return [f"model.{name} = zeros(3, {len(vectors)});"] + [
        f"model.{name}(:, {k}) = {_column(vector)};" for k, vector in enumerate(vectors, start=1)
    ]


def _pages(name: str, matrices: Sequence[Rows]) -> list[str]:
    """(3, 3, n)"""
    return [f"model.{name} = zeros(3, 3, {len(matrices)});"] + [
        f"model.{name}(:, :, {k}) = {_matrix(matrix)};" for k, matrix in enumerate(matrices, start=1)
    ]


def _matrix(rows: Rows) -> str:
    return "[" + "; ".join(_numbers(row) for row in rows) + "]"


def _column(vector: Sequence[float]) -> str:
    return f"[{_numbers(vector)}]'"


def _row(values: Sequence[float]) -> str:
    return f"[{_numbers(values)}]"


def _numbers(values: Sequence[float]) -> str:
    return " ".join(map(repr, values))


def _names(names: Sequence[str]) -> str:
    return "{" + ", ".join(map(_literal, names)) + "}"


def _literal(text: str) -> str:
    """A character array; of codes where a character cannot stand in a literal."""
    if text.isascii() and text.isprintable():
        return "'" + text.replace("'", "''") + "'"
    return f"char([{' '.join(map(str, text.encode('utf-8', 'replace')))}])"
