"""Placements, inertials and numbers as the attributes that urdf.save writes."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from lxml import etree

from graphdyn import Body, Placement
from graphdyn.layout import Array
from urdf.document.numbers import rpy_from_rotation


def add_placement(element: etree._Element, placement: Placement) -> None:
    """<origin> of a frame."""
    add_origin(element, placement.translation, rpy_from_rotation(placement.rotation))


def add_origin(element: etree._Element, xyz: Array, rpy: Array) -> None:
    etree.SubElement(element, "origin", xyz=text(xyz), rpy=text(rpy))


def add_numbers(element: etree._Element, tag: str, values: Mapping[str, float]) -> None:
    etree.SubElement(element, tag, {name: repr(float(value)) for name, value in values.items()})


def inertial_element(body: Body) -> etree._Element:
    """<inertial> of a body, in link axes."""
    inertial = etree.Element("inertial")
    add_origin(inertial, body.center_of_mass, np.zeros(3))
    add_numbers(inertial, "mass", {"value": body.mass})
    entries = {
        f"i{'xyz'[row]}{'xyz'[column]}": body.inertia[row, column] for row in range(3) for column in range(row, 3)
    }
    add_numbers(inertial, "inertia", entries)
    return inertial


def text(values: Array) -> str:
    """Numbers as the shortest text that is read as the same doubles."""
    return " ".join(repr(float(value)) for value in np.asarray(values))
