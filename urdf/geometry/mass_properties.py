"""What links would weigh if their shapes were filled uniformly: volume, center of mass and tensor."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from graphdyn import Placement
from graphdyn.layout import Array
from graphdyn.model import parallel_axis
from urdf.document.elements import GEOMETRIES, Geometry
from urdf.document.source import Source
from urdf.geometry.meshes.triangles import Triangles, joined, welded
from urdf.geometry.reading import MESH_KIND, Drawn, Solid, read_solids
from urdf.geometry.shape import UnreadableMesh

if TYPE_CHECKING:
    import trimesh


VOLUME_TOLERANCE = 1e-6
"""Part of the volume of its convex hull by which a closed mesh may be larger than it, and which it must have."""

FLAT_VOLUME_SHARE = 1e-9
"""Volume of a convex hull, as a part of the cube of its longest side, below which it is rounding."""


@dataclass(frozen=True, eq=False)
class Filled:
    """A solid of density 1 kg/m³.

    volume [m³]; center: of mass (3,) [m]; tensor: about it, per density (3, 3) [m⁵]
    low, high: corners of the box around it                 (3,)  [m]
    hull: a part of it is no closed surface, and its convex hull stands in for it
    """

    volume: float
    center: Array
    tensor: Array
    low: Array
    high: Array
    hull: bool = False

    def seen_from(self, placement: Placement, corners: Array) -> Filled:
        """The same in another frame. corners: points of its surface in its own frame (k, 3)."""
        rotation = placement.rotation
        points = corners @ rotation.T + placement.translation
        center = rotation @ self.center + placement.translation
        low, high = points.min(axis=0), points.max(axis=0)
        return Filled(self.volume, center, rotation @ self.tensor @ rotation.T, low, high, self.hull)


def filled(drawn: Drawn, parts: Sequence[Triangles]) -> Filled:
    """A drawing filled uniformly, in the frame of its link. Raises UnreadableMesh for a mesh without volume."""
    whole = joined(parts)
    own = _mesh(welded(whole)) if drawn.kind == MESH_KIND else _primitive(drawn, whole)
    return own.seen_from(drawn.placement, whole.vertices)


def together(solids: Sequence[Filled]) -> Filled:
    """Several of one frame as one; where they overlap, they count twice."""
    volume = sum(solid.volume for solid in solids)
    center = np.sum([solid.volume * solid.center for solid in solids], axis=0) / volume
    tensors = [solid.tensor + parallel_axis(solid.volume, solid.center - center) for solid in solids]
    low, high = np.min([solid.low for solid in solids], axis=0), np.max([solid.high for solid in solids], axis=0)
    return Filled(volume, center, np.sum(tensors, axis=0), low, high, any(solid.hull for solid in solids))


def _primitive(drawn: Drawn, triangles: Triangles) -> Filled:
    """Mass properties by the formulas: the triangles of a round solid lie inside it."""
    if drawn.kind == "box":
        x, y, z = drawn.sizes
        volume = x * y * z
        tensor = np.diag([y * y + z * z, z * z + x * x, x * x + y * y]) * volume / 12
    elif drawn.kind == "sphere":
        (r,) = drawn.sizes
        volume = 4 / 3 * np.pi * r**3
        tensor = np.eye(3) * (0.4 * volume * r * r)
    elif drawn.kind == "cylinder":
        r, length = drawn.sizes
        volume = np.pi * r * r * length
        across = (3 * r * r + length * length) / 12
        tensor = np.diag([across, across, r * r / 2]) * volume
    else:
        return _mesh(triangles)
    low, high = triangles.vertices.min(axis=0), triangles.vertices.max(axis=0)
    return Filled(float(volume), np.zeros(3), tensor, low, high)


def _mesh(triangles: Triangles) -> Filled:
    """A closed surface is filled; of any other, and of one that is larger than its convex hull, the hull."""
    import trimesh

    hull = _hull(triangles.vertices)
    surface = trimesh.Trimesh(triangles.vertices, triangles.faces, process=False)
    largest = float(hull.volume)
    closed = bool(surface.is_watertight and surface.is_winding_consistent)
    if closed and surface.volume < 0:
        surface.invert()
    fits = closed and VOLUME_TOLERANCE * largest < surface.volume <= (1 + VOLUME_TOLERANCE) * largest
    solid = surface if fits else hull
    low, high = surface.bounds
    return Filled(float(solid.volume), np.array(solid.center_mass), np.array(solid.moment_inertia), low, high, not fits)


def _hull(vertices: Array) -> trimesh.Trimesh:
    """The convex hull, its faces counterclockwise from outside. Raises UnreadableMesh for points in one plane."""
    import trimesh
    from scipy.spatial import ConvexHull, QhullError

    try:
        hull = ConvexHull(vertices)
    except QhullError:
        hull = None
    if hull is None or hull.volume < FLAT_VOLUME_SHARE * np.ptp(vertices, axis=0).max() ** 3:
        raise UnreadableMesh("the mesh is flat: it has no volume")
    a, b, c = (vertices[hull.simplices[:, k]] for k in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), hull.equations[:, :3]) < 0
    faces = np.where(inwards[:, None], hull.simplices[:, ::-1], hull.simplices)
    return trimesh.Trimesh(vertices, faces, process=False)


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
