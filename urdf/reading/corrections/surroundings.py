"""The shapes, lengths and neighbors of the links of a robot."""

from __future__ import annotations

from collections.abc import Mapping
from math import exp

import numpy as np
from lxml import etree

from urdf.document.inertial_numbers import InertialNumbers
from urdf.document.numbers import values
from urdf.document.source import Source
from urdf.document.tree import end, joint_into, joints_by
from urdf.geometry.mass_properties import FilledLink
from urdf.reading.corrections.evidence import MIN_LENGTH, LinkSurroundings


def surroundings(
    source: Source, numbers: Mapping[str, InertialNumbers], filled: Mapping[str, FilledLink]
) -> dict[str, LinkSurroundings]:
    """The surroundings of each link that has an inertial."""
    into, ahead = joint_into(source), joints_by(source, "parent")
    reaches = {link: max((_distance(joint) for joint in ahead.get(link, ())), default=0.0) for link in numbers}
    usual = float(np.median([reach for reach in reaches.values() if reach > MIN_LENGTH] or [MIN_LENGTH]))
    found = {}
    for link in numbers:
        around = [end(into[link], "parent")] if link in into else []
        around += [end(joint, "child") for joint in ahead.get(link, ()) if joint.get("type") != "fixed"]
        masses = [numbers[name].mass for name in around if name is not None and name in numbers]
        shape = filled[link].filled if link in filled else None
        neighbors = exp(float(np.mean(np.log(masses)))) if masses else None
        found[link] = LinkSurroundings(shape, reaches[link], usual, neighbors)
    return found


def _distance(joint: etree._Element) -> float:
    return float(np.linalg.norm(values(joint.find("origin"), "xyz", 3) or (0.0,)))
