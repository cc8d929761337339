"""Chords: the edges of the graph that close loops, beside the joints of its tree."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from numbers import Integral
from typing import Literal

import numpy as np

from graphdyn.display import short_repr
from graphdyn.errors import InvalidModel
from graphdyn.layout import Array
from graphdyn.model.parts import axis_normals, check_type, freeze, unit_axis
from graphdyn.model.spatial import Placement

ChordKind = Literal["hinge", "ball", "slide", "weld", "distance"]

FORCES, MOMENTS = ("force t1", "force t2", "force p"), ("moment t1", "moment t2", "moment p")

CHORD_ROWS: dict[ChordKind, tuple[str, ...]] = {
    "hinge": (*FORCES, *MOMENTS[:2]),
    "ball": FORCES,
    "slide": (*FORCES[:2], *MOMENTS),
    "weld": (*FORCES, *MOMENTS),
    "distance": ("tension",),
}
"""What each kind transmits: its multipliers, along t_1, t_2 and p of the chord or along the line between its points."""


@dataclass(frozen=True, eq=False)
@short_repr
class Chord:
    """A connection between bodies i and j that closes a loop; it adds constraint rows and no freedom.

    kind: "hinge" (5 rows: both frames share their origin and the direction of the axis), "ball" (3: the origin),
        "slide" (5: orientation and axis; free along it), "weld" (6: origin and orientation), "distance" (1: origins
        this far apart)
    body_i, body_j: numbers of the bodies, 0 for the ground
    placement_i, placement_j: the chord's frame in the link frames of both bodies
    axis: p of a hinge or slide, in both chord frames; normalized at construction      (3,)
    length: of a distance, and None for the others                                     [m]

    Raises InvalidModel, naming the chord, for anything else.
    """

    name: str
    kind: ChordKind
    body_i: int
    placement_i: Placement
    body_j: int
    placement_j: Placement
    axis: Array = field(default_factory=lambda: np.array((0.0, 0.0, 1.0)))
    length: float | None = None

    def __post_init__(self) -> None:
        who = f"chord '{self.name}'"
        if self.kind not in CHORD_ROWS:
            raise InvalidModel(f"{who}: kind '{self.kind}' is unknown; use one of {', '.join(CHORD_ROWS)}")
        for name, kind in (("body_i", Integral), ("body_j", Integral)):
            check_type(who, name, getattr(self, name), kind)
        for name in ("placement_i", "placement_j"):
            check_type(who, name, getattr(self, name), Placement)
        if self.body_i == self.body_j:
            raise InvalidModel(f"{who}: both ends are on body {self.body_i}; a chord connects two bodies")
        freeze(self, who, axis=(3,))
        object.__setattr__(self, "axis", unit_axis(who, self.axis))
        if self.kind != "distance":
            if self.length is not None:
                raise InvalidModel(f"{who}: length is {self.length}; only a distance has one")
            return
        if self.length is None:
            raise InvalidModel(f"{who}: a distance needs its length")
        freeze(self, who, length=())
        if self.length <= 0:
            raise InvalidModel(f"{who}: length is {self.length} m; give a positive one, or use a ball")

    @property
    def rows(self) -> tuple[str, ...]:
        """Names of its multipliers, in their order."""
        return CHORD_ROWS[self.kind]

    @cached_property
    def triad(self) -> Array:
        """Columns t_1, t_2, p (3, 3) in chord axes, chosen as those of a joint (Joint.axis_normals)."""
        triad = np.stack([*axis_normals(self.axis), self.axis], axis=-1)
        triad.setflags(write=False)
        return triad
