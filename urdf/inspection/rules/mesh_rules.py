"""Findings about inertials that do not fit the meshes of their links."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from graphdyn.layout import Array
from graphdyn.model import TRIANGLE_TOLERANCE_SHARE
from urdf.errors import MAX_QUOTED_NAMES, shortened
from urdf.geometry.mass_properties import FilledLink, filled_links
from urdf.inspection.findings import Finding, about, of_file
from urdf.inspection.rules.miswritten_rules import miswritten
from urdf.inspection.structure import LinkInertial, Structure

MAX_OUTSIDE_SHARE, DOUBTFULLY_OUTSIDE = 0.05, 0.25
"""Distance of a center of mass from the box around the mesh, as a part of its longest side, from which it is noted, and
from which it is doubtful; motors, feet and hands that are not drawn shift it less."""

MIN_MESH_DENSITY, MAX_MESH_DENSITY = 50.0, 20_000.0
"""Plausible mass over volume [kg/m³]: foam, solid tungsten; printed shanks and open frames have 65 and more."""

MAX_CENTER_SHARE = 0.05
"""An inertial is that of its mesh if the centers of mass are apart by less than this part of the diagonal of the box
around it."""

MAX_MOMENT_RATIO = 10.0
"""Factor between a principal moment and that of the filled mesh beyond which they do not fit. A thin shell has at most
5/3 of a filled body; of the catalog's links, nine in ten stay below 7."""


@dataclass(frozen=True, eq=False)
class Compared:
    """An inertial beside its link, filled uniformly with the same mass."""

    inertial: LinkInertial
    link: FilledLink

    @cached_property
    def moments(self) -> Array:
        """Principal moments of the filled link, ascending (3,) [kg m²]."""
        return np.linalg.eigvalsh(self.link.filled.tensor * self.density).astype(float)

    @property
    def density(self) -> float:
        """[kg/m³]."""
        return self.inertial.mass / self.link.filled.volume

    @property
    def factor(self) -> float:
        """Largest ratio of the moments, either way; 1 for singular and negative tensors, which have findings."""
        own = self.inertial.moments
        if own[0] <= TRIANGLE_TOLERANCE_SHARE * self.inertial.size:
            return 1.0
        ratios = own / self.moments
        return float(max(ratios.max(), 1 / ratios.min()))

    @property
    def has_center(self) -> bool:
        """Whether the center of mass is that of the filled link."""
        solid = self.link.filled
        apart = np.linalg.norm(self.inertial.center - solid.center)
        return bool(apart <= MAX_CENTER_SHARE * np.linalg.norm(solid.high - solid.low))

    @property
    def what(self) -> str:
        """ "visual mesh", "convex hull of its collision mesh"."""
        return f"{'convex hull of its ' if self.link.filled.hull else ''}{self.link.geometry} mesh"


def mesh_findings(structure: Structure, detail: bool) -> Iterator[Finding]:
    """What the meshes say about the inertials of the moving links; nothing where no mesh is found.

    detail: tensors link by link, instead of one line for all that are far from their meshes
    """
    moving = {each.link: each for each in structure.inertials if structure.moving(each.link) and each.mass > 0}
    links, failed = filled_links(structure.source, moving, only_meshes=True)
    compared = [Compared(moving[name], links[name]) for name in moving if name in links]
    if not compared:
        return
    yield _files(structure, len(compared), failed)
    for each in compared:
        yield from _place(each)
        yield from _density(each)
        if each.factor != 1 and each.has_center:
            yield from miswritten(each.inertial, each.link.filled, each.what)
        if detail:
            yield _tensor(each)
    yield from _tensors(compared)


def _files(structure: Structure, compared: int, failed: dict[str, str]) -> Finding:
    names = [f"'{shortened(link)}' ({reason})" for link, reason in failed.items()][:MAX_QUOTED_NAMES]
    more = f" and {len(failed) - MAX_QUOTED_NAMES} more" if len(failed) > MAX_QUOTED_NAMES else ""
    left = f"; links that are not: {', '.join(names)}{more}" if failed else ""
    drawings = structure.source.drawings.drawings
    drawn = [each.element for each in drawings if each.mesh]
    return of_file(
        "mesh-files",
        f"mesh files: {len(drawn)}; links whose inertials are compared with them: {compared}{left}",
        at=drawn[0],
    )


def _place(each: Compared) -> Iterator[Finding]:
    solid, center = each.link.filled, each.inertial.center
    outside = float(np.linalg.norm(np.maximum(np.maximum(solid.low - center, center - solid.high), 0.0)))
    size = float((solid.high - solid.low).max())
    if outside > MAX_OUTSIDE_SHARE * size:
        yield about(
            "center-outside-mesh",
            each.inertial.element,
            f"the center of mass lies {outside:.3g} m outside the box around the {each.link.geometry} mesh, whose "
            f"longest side is {size:.3g} m",
            "warning" if outside > DOUBTFULLY_OUTSIDE * size else "note",
        )


def _density(each: Compared) -> Iterator[Finding]:
    if not MIN_MESH_DENSITY <= each.density <= MAX_MESH_DENSITY:
        yield about(
            "mesh-density",
            each.inertial.element,
            f"{each.inertial.mass:.3g} kg in {each.link.filled.volume:.3g} m³ ({each.what}) are "
            f"{each.density:.4g} kg/m³",
        )


def _tensors(compared: list[Compared]) -> Iterator[Finding]:
    far = sorted((each for each in compared if each.factor > MAX_MOMENT_RATIO), key=lambda each: -each.factor)
    if far:
        yield of_file(
            "inertia-unlike-mesh",
            f"the tensors of {len(far)} of {len(compared)} links are far from those of their meshes, filled uniformly "
            f"with the same mass: by a factor of {far[0].factor:.3g} for link '{shortened(far[0].inertial.link)}'",
        )


def _tensor(each: Compared) -> Finding:
    own, filled = (
        ", ".join(f"{moment:.3g}" for moment in moments) for moments in (each.inertial.moments, each.moments)
    )
    apart = float(np.linalg.norm(each.inertial.center - each.link.filled.center))
    return about(
        "inertia-of-mesh",
        each.inertial.element,
        f"principal moments {own} kg m²; filled uniformly with {each.inertial.mass:.3g} kg ({each.density:.4g} kg/m³), "
        f"the {each.what} has {filled}, a factor of {each.factor:.3g}, and its center of mass {apart:.3g} m away",
    )
