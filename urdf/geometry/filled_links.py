"""The links of a robot as if their shapes were filled uniformly."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from urdf.document.elements import GEOMETRIES, Geometry
from urdf.document.source import Source
from urdf.geometry.drawn import MESH_KIND
from urdf.geometry.mass_properties import Filled, filled, together
from urdf.geometry.reading import Solid, read_solids
from urdf.geometry.shape import UnreadableMesh


@dataclass(frozen=True)
class FilledLink:
    """A link filled uniformly. geometry: of which of its shapes; mesh: one of them comes from a mesh file"""

    filled: Filled
    geometry: Geometry
    mesh: bool


def filled_links(
    source: Source, links: Collection[str], *, only_meshes: bool = False
) -> tuple[dict[str, FilledLink], dict[str, str]]:
    """Per link what it is, filled; per other link that has shapes, why it cannot be filled.

    The visual shapes of a link are taken, where one is missing its collision shapes, never some of them. only_meshes:
    leaves out the links without a mesh file.
    """
    found: dict[str, FilledLink] = {}
    failed: dict[str, str] = {}
    for geometry in GEOMETRIES:
        solids, missing = read_solids(source, geometry, set(links).difference(found))
        for each in missing:
            failed.setdefault(each.link, each.reason)
        by_link: dict[str, list[Solid]] = {}
        for solid in solids:
            by_link.setdefault(solid.link, []).append(solid)
        for link in {each.link for each in missing}:
            by_link.pop(link, None)
        for link, own in by_link.items():
            mesh = any(solid.drawn.kind == MESH_KIND for solid in own)
            if only_meshes and not mesh:
                continue
            try:
                found[link] = FilledLink(together([filled(one.drawn, one.parts) for one in own]), geometry, mesh)
            except UnreadableMesh as error:
                failed.setdefault(link, str(error))
    return found, {link: reason for link, reason in failed.items() if link not in found}
