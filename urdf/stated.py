"""The links and joints that a file states, in its order, once the checks of urdf.reading have passed its numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import cast

import numpy as np
from lxml import etree

from graphdyn.layout import Array
from urdf.document.elements import name_of
from urdf.document.vocabulary import NUMBERS


@dataclass(eq=False)
class StatedInertial:
    """An <inertial>.

    mass: of the link                                       [kg]
    inertia: about the center of mass, in the axes of origin  (3, 3)  [kg m²]
    origin: the frame of the center of mass in that of the link, homogeneous; None where there is no <origin>  (4, 4)
    """

    mass: float
    inertia: Array
    origin: Array | None


@dataclass(eq=False)
class StatedLink:
    """A <link>; inertial is None where it has no <inertial>."""

    name: str
    inertial: StatedInertial | None


@dataclass(frozen=True)
class StatedMimic:
    """A <mimic>: q = multiplier · q of the other joint + offset. joint: its name, empty where there is none."""

    joint: str
    multiplier: float
    offset: float


@dataclass(eq=False)
class StatedJoint:
    """A <joint>.

    type: also "fixed"; parent, child: names of links
    origin: the joint frame in that of the parent, homogeneous; None where there is no <origin>  (4, 4)
    axis: as it is written, of any length                   (3,)
    limits: lower, upper, velocity and effort, those that are stated
    """

    name: str
    type: str
    parent: str
    child: str
    origin: Array | None
    axis: Array
    limits: Mapping[str, float]
    damping: float
    friction: float
    mimic: StatedMimic | None


@dataclass(eq=False)
class StatedRobot:
    """A <robot>."""

    name: str
    links: list[StatedLink]
    joints: list[StatedJoint]


def stated_robot(robot: etree._Element) -> StatedRobot:
    """What a <robot> states whose elements have been checked."""
    links = [StatedLink(name_of(link), _inertial(link.find("inertial"))) for link in robot.findall("link")]
    return StatedRobot(name_of(robot), links, [_joint(joint) for joint in robot.findall("joint")])


def _inertial(element: etree._Element | None) -> StatedInertial | None:
    if element is None:
        return None
    mass, inertia = element.find("mass"), element.find("inertia")
    xx, xy, xz, yy, yz, zz = (_number(inertia, name, 0.0) for name in NUMBERS["inertia"])
    tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return StatedInertial(_number(mass, "value", 0.0), tensor, _origin(element))


def _joint(element: etree._Element) -> StatedJoint:
    limit, dynamics = element.find("limit"), element.find("dynamics")
    return StatedJoint(
        name_of(element),
        element.get("type", ""),
        _link(element, "parent"),
        _link(element, "child"),
        _origin(element),
        np.array(_triple(element.find("axis"), "xyz", (1.0, 0.0, 0.0))),
        {} if limit is None else {name: float(limit.attrib[name]) for name in NUMBERS["limit"] if name in limit.attrib},
        _number(dynamics, "damping", 0.0),
        _number(dynamics, "friction", 0.0),
        _mimic(element.find("mimic")),
    )


def _link(joint: etree._Element, end: str) -> str:
    return cast("etree._Element", joint.find(end)).get("link", "")


def _mimic(element: etree._Element | None) -> StatedMimic | None:
    if element is None:
        return None
    return StatedMimic(element.get("joint", ""), _number(element, "multiplier", 1.0), _number(element, "offset", 0.0))


def _number(element: etree._Element | None, name: str, default: float) -> float:
    text = None if element is None else element.get(name)
    return default if text is None else float(text)


def _triple(element: etree._Element | None, name: str, default: tuple[float, ...]) -> tuple[float, ...]:
    text = None if element is None else element.get(name)
    return default if text is None else tuple(map(float, text.split()))


def _origin(parent: etree._Element) -> Array | None:
    """The frame of its <origin>: R = R_z(yaw) R_y(pitch) R_x(roll)."""
    element = parent.find("origin")
    if element is None:
        return None
    angles = np.array(_triple(element, "rpy", (0.0, 0.0, 0.0)))
    (sr, sp, sy), (cr, cp, cy) = np.sin(angles), np.cos(angles)
    frame = np.eye(4)
    frame[:3, :3] = [
        [cp * cy, sp * (sr * cy) - cr * sy, sp * (cr * cy) + sr * sy],
        [cp * sy, sp * (sr * sy) + cr * cy, sp * (cr * sy) - sr * cy],
        [-sp, cp * sr, cp * cr],
    ]
    frame[:3, 3] = _triple(element, "xyz", (0.0, 0.0, 0.0))
    return np.asarray(frame + 0.0)  # no -0.0
