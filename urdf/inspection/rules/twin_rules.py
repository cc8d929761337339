"""Links of the left and right side that are no mirror images of one another."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import permutations, product

import numpy as np

from graphdyn.layout import Array
from urdf.errors import shortened
from urdf.inspection.findings import Finding, about
from urdf.inspection.structure import LinkInertial
from urdf.reading.corrections import mirrored_names

TWIN_TOLERANCE = 1e-3
"""Relative difference of masses and moments up to which a left and a right link are alike."""

MIRROR_TOLERANCE, MIRRORED_CENTER_TOLERANCE = 3e-3, 1e-2
"""What a mirror image may miss of the sum of the moments, and of the distance of the center of mass from the origin of
the link, or of the radius of gyration."""

_AXES = [
    np.eye(3)[list(order)] * np.array(signs)[:, None]
    for order in permutations(range(3))
    for signs in product((1.0, -1.0), repeat=3)
]
"""Axes of one side in those of the other: link frames are mirrored, turned, or both (48, 3, 3)."""


def twin_findings(moving: Sequence[LinkInertial]) -> Iterator[Finding]:
    """Left links whose mass, moments, or center and tensor together are not those of the right one."""
    by_name = {each.link: each for each in moving}
    for left in moving:
        right = next((by_name[name] for name in mirrored_names(left.link) if name in by_name), None)
        if right is None:
            continue
        other = f"'{shortened(right.link)}'"
        if _apart(np.array([left.mass]), np.array([right.mass])):
            what = f"{left.mass:.4g} kg, where {other} has {right.mass:.4g} kg"
        elif _apart(left.moments, right.moments):
            told = [", ".join(f"{moment:.3g}" for moment in each.moments) for each in (left, right)]
            what = f"principal moments {told[0]} kg m², where {other} has {told[1]}"
        elif (missed := _missed(left, right)) is not None:
            what = f"no mirror image of {other}: {missed}"
        else:
            continue
        yield about("unlike-twin", left.element, what)


def _apart(one: Array, other: Array) -> bool:
    return bool(np.abs(one - other).max() > TWIN_TOLERANCE * np.abs([one, other]).max())


def _missed(left: LinkInertial, right: LinkInertial) -> str | None:
    """What the nearest mirror image misses; None where there is one."""
    reach = max(float(np.linalg.norm(left.center)), float(np.sqrt(left.size / left.mass)))
    images = [
        (
            float(np.linalg.norm(axes @ left.turned @ axes.T - right.turned)) / (left.size or 1.0),
            float(np.linalg.norm(axes @ left.center - right.center)) / (reach or 1.0),
        )
        for axes in _AXES
    ]
    tensor, center = min(images, key=sum)
    if tensor <= MIRROR_TOLERANCE and center <= MIRRORED_CENTER_TOLERANCE:
        return None
    if center > MIRRORED_CENTER_TOLERANCE:
        return f"the center of mass lies {center * reach:.2g} m beside that of any"
    return f"masses, moments and centers of mass are alike, and the tensors differ by {100 * tensor:.2g} %"
