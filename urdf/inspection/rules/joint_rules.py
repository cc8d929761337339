"""Findings about the joints: axes, limits, types, and values that rigid dynamics leave out."""

from __future__ import annotations

import math
from collections.abc import Iterator

from lxml import etree

from urdf.document.numbers import UNIT_LENGTH_TOLERANCE, values
from urdf.errors import listed, shortened
from urdf.inspection.findings import Finding, about, of_file
from urdf.inspection.structure import Structure
from urdf.reading.repairing import RIGHT_ANGLE, is_truncated

MAX_AXIS_LENGTH_ERROR = 1e-2
"""Difference from 1 of the length of an axis: a smaller one is rounding, a larger one probably another mistake."""

ZERO_COMPONENT = 1e-6
"""Part of its largest component below which a component of an axis counts as zero."""


def joint_findings(structure: Structure) -> Iterator[Finding]:
    """Findings about the joints in the order of the file."""
    for element in (*structure.source.links, *structure.source.joints):
        yield from _angles(element)
    for joint in structure.source.joints:
        if joint.find("origin") is None:
            problem = "without <origin>: the joint is at the origin of its parent link"
            yield about("joint-origin-missing", joint, problem)
    for joint in structure.movable:
        yield from _kind(joint)
        yield from _axis(joint)
        yield from _position_limits(joint)
        yield from _rate_limits(joint)
        yield from _dynamics(joint)
    if structure.movable:
        yield of_file(
            "rotor-inertia",
            "URDF has no place for rotor inertia: the model has none, though behind high gear ratios it can be most of "
            "the inertia that a motor accelerates",
        )


def _angles(element: etree._Element) -> Iterator[Finding]:
    for origin in element.iter("origin"):
        odd = [angle for angle in values(origin, "rpy", 3) or () if is_truncated(angle)]
        if odd:
            missed = max(abs(angle - RIGHT_ANGLE * round(angle / RIGHT_ANGLE)) for angle in odd)
            yield about(
                "rpy-truncated",
                origin,
                f"{', '.join(f'{angle:g}' for angle in odd)}: a truncated multiple of π/2, off by {missed:.1e} rad; it "
                "is used as written",
            )


def _kind(joint: etree._Element) -> Iterator[Finding]:
    kind = joint.get("type")
    if kind == "continuous":
        yield about("continuous-joint", joint, "a continuous joint: its coordinate is one angle")
    if kind == "prismatic":
        yield about("prismatic-joint", joint, "a prismatic joint: meters and newtons")
    mimic = joint.find("mimic")
    if mimic is not None:
        problem = f"it mimics joint '{shortened(mimic.get('joint', ''))}': it has no entry in q, v, a and τ"
        yield about("mimic-joint", joint, problem)


def _axis(joint: etree._Element) -> Iterator[Finding]:
    element = joint.find("axis")
    if element is None:
        yield about("axis-missing", joint, "without <axis>: it is (1, 0, 0)")
        return
    axis = values(element, "xyz", 3)
    if axis is None or not any(axis):
        return
    length, largest = math.hypot(*axis), max(map(abs, axis))
    if abs(length - 1) > UNIT_LENGTH_TOLERANCE:
        problem = f"the axis has length {length:.9g}; load normalizes it"
        yield about(
            "axis-not-normalized",
            element,
            problem,
            severity="note" if abs(length - 1) < MAX_AXIS_LENGTH_ERROR else "warning",
        )
    along = [x for x in axis if abs(x) > ZERO_COMPONENT * largest]
    if len(along) > 1:
        text = " ".join(f"{x:g}" for x in axis)
        yield about("oblique-axis", element, f"the axis {text} is along no coordinate axis")
    elif along[0] < 0:
        yield about("negative-axis", element, "the axis points along a negative coordinate axis")


def _position_limits(joint: etree._Element) -> Iterator[Finding]:
    limit, bounded = joint.find("limit"), joint.get("type") in ("revolute", "prismatic")
    names = ("lower", "upper", "effort", "velocity") if bounded else ("effort", "velocity")
    missing = [name for name in names if limit is not None and limit.get(name) is None]
    if bounded and limit is None:
        yield about("limits-missing", joint, "without <limit>")
    elif limit is not None and missing:
        yield about("limits-missing", limit, f"without {', '.join(missing)}: there is no such limit")
    lower, upper = values(limit, "lower", 1), values(limit, "upper", 1)
    if limit is None or not bounded or lower is None or upper is None:
        return
    if lower[0] == upper[0]:
        yield about(
            "limits-zero",
            limit,
            f"lower and upper limit are both {lower[0]:g}: the joint cannot move"
            + ("; random states ignore such limits" if lower[0] == 0 else ""),
        )


def _rate_limits(joint: etree._Element) -> Iterator[Finding]:
    limit = joint.find("limit")
    for name in ("effort", "velocity"):
        bound = values(limit, name, 1)
        if limit is None or bound is None:
            continue
        if bound[0] == 0:
            yield about(f"{name}-zero", limit, f"the {name} limit is 0: a placeholder for an unknown one")
        elif bound[0] < 0:
            yield about(f"{name}-negative", limit, f"the {name} limit {bound[0]:g} is negative")


def _dynamics(joint: etree._Element) -> Iterator[Finding]:
    element = joint.find("dynamics")
    friction = values(element, "friction", 1)
    if element is not None and friction is not None and friction[0] < 0:
        yield about("friction-negative", element, f"the friction {friction[0]:g} is negative")
    others = [] if element is None else [name for name in element.attrib if name not in ("damping", "friction")]
    if element is not None and others:
        problem = f"URDF knows no attributes {listed(map(str, others))} of <dynamics>: not read"
        yield about("unknown-joint-dynamics", element, problem)
    stated = {name: values(element, name, 1) or [0.0] for name in ("damping", "friction")}
    if element is not None and any(value[0] for value in stated.values()):
        said = ", ".join(f"{name} {value[0]:g}" for name, value in stated.items() if value[0])
        yield about("joint-dynamics", element, f"{said}: kept with the joint, not part of the rigid dynamics")
