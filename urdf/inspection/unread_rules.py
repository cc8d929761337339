"""Findings about what urdf.load does not read."""

from __future__ import annotations

from collections.abc import Iterator

from urdf.inspection.findings import Finding
from urdf.inspection.structure import Structure
from urdf.inspection.telling import told

REMEDIES = {
    "unread-dynamics": "change the model after loading it, if that matters",
    "unknown-element": "correct its name, or remove it",
    "unknown-attribute": "correct its name, or remove it",
}


def unread_findings(structure: Structure) -> Iterator[Finding]:
    """Findings about elements and attributes that change the dynamics elsewhere, or that URDF does not know."""
    for unread in structure.source.extensions.unread:
        number = f" ({unread.places} such places)" if unread.places > 1 else ""
        message = told(unread.code, f"{unread.problem}: not read{number}")
        yield Finding(unread.code, "warning", unread.element, unread.line, message, REMEDIES[unread.code])
