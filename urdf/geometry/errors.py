"""Why a drawing cannot be read."""

from __future__ import annotations

from urdf.errors import one_line


class UnreadableMesh(Exception):
    """The reason, on one line; caught where the drawings of a robot are read, and listed."""

    def __init__(self, reason: str):
        super().__init__(one_line(reason))
