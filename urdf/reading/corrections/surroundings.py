"""The shapes, lengths and neighbors of the links of a robot."""

from __future__ import annotations

from collections.abc import Mapping
from math import exp

import numpy as np

from urdf.document.inertial_numbers import InertialNumbers
from urdf.document.numbers import values
from urdf.document.source import Source
from urdf.document.tree import end, joint_into, joints_by
from urdf.geometry.mass_properties import FilledLink
from urdf.reading.corrections.evidence import LinkSurroundings

MIN_LENGTH = 0.05
"""No link counts as shorter [m]."""


def surroundings(
    source: Source, numbers: Mapping[str, InertialNumbers], filled: Mapping[str, FilledLink]
) -> dict[str, LinkSurroundings]:
    """The surroundings of each link that has an inertial."""
    into, ahead = joint_into(source), joints_by(source, "parent")
    found = {}
    for link, each in numbers.items():
        around = [end(into[link], "parent")] if link in into else []
        around += [end(joint, "child") for joint in ahead.get(link, ()) if joint.get("type") != "fixed"]
        masses = [numbers[name].mass for name in around if name is not None and name in numbers]
        places = [values(joint.find("origin"), "xyz", 3) or (0.0,) for joint in ahead.get(link, ())]
        length = max(MIN_LENGTH, *(float(np.linalg.norm(place)) for place in (each.center, *places)))
        shape = filled[link].filled if link in filled else None
        found[link] = LinkSurroundings(shape, length, exp(float(np.mean(np.log(masses)))) if masses else None)
    return found
