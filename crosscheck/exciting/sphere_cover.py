"""Few spheres that together contain all triangles of a link, and stand out of it by little.

The link is filled on a grid of cells. A sphere about a point at a depth d below the surface may have the radius
d + excess: nowhere does it stand out by more. Of many such spheres the one that contains most triangles is taken, then
the one that contains most of the rest (greedy set cover: Chvátal, Mathematics of Operations Research 4(3), 1979); then
each is made as small as its triangles allow. A triangle lies in a sphere if its corners do, so that nothing is missed.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from graphdyn.layout import Array

CELLS_PER_EXCESS = 4
MAX_SURFACE_CELLS = 20_000
"""Cells are a quarter of the excess, or larger: the box around the link has so many on its surface."""

MAX_CANDIDATES = 1500
"""Points that may become centers, at most."""

CANDIDATES_AT_ONCE = 100
"""Candidates whose distances to all cells are in memory at once."""

RADIUS_ALLOWANCE = 1e-9
"""Part of its radius by which a sphere is larger than its triangles need."""


def sphere_cover(triangles: Array, excess: float) -> tuple[Array, Array]:
    """Centers (k, 3) and radii (k,) [m] for the corners (m, 3, 3) of triangles.

    excess: by which spheres stand out of the link, about [m]. Where the surface has wide holes nothing is filled, and
        more spheres are needed
    """
    corners = triangles.reshape(-1, 3)
    sides = np.ptp(corners, axis=0)
    surface = 2 * (sides[0] * sides[1] + sides[1] * sides[2] + sides[2] * sides[0])
    edge = max(excess / CELLS_PER_EXCESS, float(np.sqrt(surface / MAX_SURFACE_CELLS)))
    pieces = _split(triangles, edge)
    origin = corners.min(axis=0) - 2 * edge
    middles, radii, group = _grouped(pieces, origin, edge)
    centers, depths = _candidates(pieces.reshape(-1, 3), origin, edge)
    chosen, owner = _greedy(centers, depths + excess, middles, radii, excess)
    own = owner[group]
    needed = np.linalg.norm(pieces - chosen[own][:, None], axis=-1).max(axis=-1)
    sizes = np.zeros(len(chosen))
    np.maximum.at(sizes, own, needed)
    return chosen, sizes * (1 + RADIUS_ALLOWANCE)


def _split(triangles: Array, longest: float) -> Array:
    """The same surface in triangles with no edge longer than this, by halving the longest edges."""
    done = []
    while len(triangles):
        lengths = np.linalg.norm(triangles - np.roll(triangles, -1, axis=1), axis=-1)
        is_long = lengths.max(axis=1) > longest
        done.append(triangles[~is_long])
        triangles, first = triangles[is_long], lengths[is_long].argmax(axis=1)
        row = np.arange(len(triangles))
        a, b, c = (triangles[row, (first + k) % 3] for k in range(3))
        middle = (a + b) / 2
        triangles = np.concatenate([np.stack([a, middle, c], axis=1), np.stack([middle, b, c], axis=1)])
    return np.concatenate(done)


def _grouped(pieces: Array, origin: Array, edge: float) -> tuple[Array, Array, NDArray[np.intp]]:
    """Spheres, middle (g, 3) and radius (g,), around the pieces of each cell, and for each piece its cell."""
    centroids = pieces.mean(axis=1)
    _, group = np.unique(_cells(centroids, origin, edge), axis=0, return_inverse=True)
    group = group.ravel()
    count = np.bincount(group)
    middles = np.stack([np.bincount(group, centroids[:, k]) / count for k in range(3)], axis=-1)
    radii = np.zeros(len(count))
    np.maximum.at(radii, group, np.linalg.norm(pieces - middles[group][:, None], axis=-1).max(axis=-1))
    return middles, radii, group


def _candidates(points: Array, origin: Array, edge: float) -> tuple[Array, Array]:
    """Points inside (c, 3), and their depths (c,) below the surface [m]: the deepest all around, and a lattice."""
    from scipy import ndimage

    cells = _cells(points, origin, edge)
    occupied = np.zeros(cells.max(axis=0) + 3, dtype=bool)
    occupied[tuple(cells.T)] = True
    solid = ndimage.binary_fill_holes(ndimage.binary_closing(occupied)) | occupied
    depth = ndimage.distance_transform_edt(solid)
    deepest = np.argwhere(solid & (depth == ndimage.maximum_filter(depth, size=5)))
    inside = np.argwhere(solid)
    stride = int(np.ceil((3 * len(inside) / MAX_CANDIDATES) ** (1 / 3)))
    lattice = inside[np.all(inside % stride == 0, axis=1)]
    found = np.unique(np.concatenate([deepest, lattice]), axis=0)
    found = found[np.unique(np.linspace(0, len(found) - 1, MAX_CANDIDATES).astype(int))]
    return origin + (found + 0.5) * edge, np.maximum(depth[tuple(found.T)] - 0.5, 0.0) * edge


def _greedy(
    centers: Array, reaches: Array, middles: Array, radii: Array, excess: float
) -> tuple[Array, NDArray[np.intp]]:
    """Centers of the spheres that are taken (k, 3), and for every group the sphere that contains it (g,)."""
    from scipy.spatial.distance import cdist

    parts = [slice(k, k + CANDIDATES_AT_ONCE) for k in range(0, len(centers), CANDIDATES_AT_ONCE)]
    inside = np.concatenate([cdist(centers[part], middles) + radii <= reaches[part, None] for part in parts])
    gain, left = inside.sum(axis=1), np.ones(len(middles), dtype=bool)
    owner = np.zeros(len(middles), dtype=np.intp)
    chosen: list[Array] = []
    while left.any():
        best = int(gain.argmax())
        if gain[best]:
            center, contained = centers[best], left & inside[best]
        else:  # too thin for any candidate: a sphere about the surface itself
            first = int(left.argmax())
            center = middles[first]
            contained = left & (np.linalg.norm(middles - center, axis=-1) + radii <= max(excess, radii[first]))
        owner[contained] = len(chosen)
        chosen.append(center)
        left &= ~contained
        gain = gain - inside[:, contained].sum(axis=1)
    return np.array(chosen), owner


def _cells(points: Array, origin: Array, edge: float) -> NDArray[np.intp]:
    return np.floor((points - origin) / edge).astype(np.intp)
