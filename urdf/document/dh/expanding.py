"""The URDF that a table of Denavit-Hartenberg parameters says: its joints and links, each about its z axis."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from lxml import etree

from graphdyn import Body, Placement
from urdf.document.dh.reading import read_table
from urdf.document.dh.table import DHRow
from urdf.document.document import BeyondURDF, ExpandedURDF
from urdf.document.numbers import NO_LIMIT, add_numbers, add_placement, inertial_element


def expand_dh(path: Path, content: bytes) -> ExpandedURDF:
    """The URDF of a table in TOML. Raises InvalidDH."""
    table, lines = read_table(path, content)
    robot = etree.Element("robot", name=table.name)
    etree.SubElement(robot, "link", name=table.base_name)
    places: dict[etree._Element, int] = {}
    parent = table.base_name
    for number, (row, placement) in enumerate(zip(table.rows, table.joint_placements(), strict=True)):
        joint, link = _joint(row, parent, placement), _link(row, table.frame_of(row))
        for element in (joint, link):
            robot.append(element)
            places.update(dict.fromkeys(element.iter(etree.Element), lines[number]))
        parent = row.link.name
    last = table.rows[-1]
    etree.SubElement(robot, "link", name=table.tool_name)
    fixed = etree.SubElement(robot, "joint", name=f"{table.tool_name}_fixed", type="fixed")
    add_placement(fixed, table.frame_of(last) @ table.tool)
    etree.SubElement(fixed, "parent", link=last.link.name)
    etree.SubElement(fixed, "child", link=table.tool_name)
    x, y, z = map(float, table.gravity)
    return ExpandedURDF(
        etree.tostring(robot, encoding="UTF-8"),
        tuple((path, places[one]) if one in places else None for one in robot.iter(etree.Element)),
        (x, y, z),
        BeyondURDF({row.name: row.armature for row in table.rows if row.armature}),
    )


def _joint(row: DHRow, parent: str, placement: Placement) -> etree._Element:
    joint = etree.Element("joint", name=row.name, type=row.kind)
    add_placement(joint, placement)
    etree.SubElement(joint, "parent", link=parent)
    etree.SubElement(joint, "child", link=row.link.name)
    etree.SubElement(joint, "axis", xyz=f"0 0 {row.sign:g}")
    if row.damping or row.friction:
        add_numbers(joint, "dynamics", {"damping": row.damping, "friction": row.friction})
    limits = row.limits
    given = {name: value for name in ("lower", "upper") if (value := getattr(limits, name)) is not None}
    if row.kind != "continuous" and not given:
        given = {"lower": -NO_LIMIT, "upper": NO_LIMIT}
    given |= {name: NO_LIMIT if (x := getattr(limits, name)) is None else x for name in ("effort", "velocity")}
    add_numbers(joint, "limit", given)
    return joint


def _link(row: DHRow, frame: Placement) -> etree._Element:
    link = etree.Element("link", name=row.link.name)
    if (body := row.link.body) is not None:
        link.append(inertial_element(placed(body, frame)))
    return link


def placed(body: Body, frame: Placement) -> Body:
    """The body in axes in which its own frame has this placement."""
    R = frame.rotation
    tensor = R @ body.inertia @ R.T
    center = frame.translation + R @ body.center_of_mass
    return replace(body, center_of_mass=np.asarray(center), inertia=(tensor + tensor.T) / 2)
