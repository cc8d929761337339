"""The Denavit-Hartenberg parameters of a model, and their TOML file.

Both conventions have the same factors, Rot_z(θ) Tra_z(d) for each joint and Tra_x(a) Rot_x(α) Rot_y(β) between two of
them, and differ in what belongs to one row. The common normal of two axes gives the factors between them; where they
are nearly parallel, the plane through the first frame that is normal to its z axis does.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from os import PathLike
from pathlib import Path

import numpy as np

from graphdyn import Frame, JointLimits, Placement, RobotModel
from graphdyn.layout import Array
from graphdyn.model import check_model
from urdf.document.dh.expanding import placed
from urdf.document.dh.table import CONVENTIONS, Convention, DHLink, DHRow, DHTable, X, Y, along_normal
from urdf.document.files import write_whole
from urdf.document.numbers import rpy_from_rotation
from urdf.errors import CannotSave, listed

PARALLEL_WITHIN = 0.01
"""Angle between axes below which β is written [rad]: a common normal could lie 100 arm lengths away, and all lengths
would lose two digits."""

POINT_ROUNDING = 1e-13
"""Distance below which two points are one, in sizes of the robot: rounding of placements."""

PARALLEL_ROUNDING = 4 * float(np.finfo(float).eps)
"""Angle below which two directions are one [rad]: rounding of products of rotations."""

KEPT = ("limits", "damping", "friction", "armature")
"""Fields of joints that rows have as they are."""

MAX_SHARE_OF_AXIS = 0.9
"""Component along a z axis up to which the x axis of a frame gives the direction of x, else its y axis."""


def dh_table(
    model: RobotModel,
    convention: Convention = "standard",
    *,
    tool: str | None = None,
    parallel_within: float = PARALLEL_WITHIN,
) -> DHTable:
    """The table of a serial robot, with base, tool, and the inertias of its links in the frames of their rows.

    convention: "standard" or "modified", see DHTable
    tool: name of a frame of the last body; None for the last of them, or the last link itself
    parallel_within: angle [rad] below which two axes get β and d = 0 in place of a common normal

    z axes have the senses of the joints, so all signs are 1; of the two senses of a common normal that with the smaller
    θ is taken. `choices` of the table says what could as well be otherwise.

    Raises CannotSave for a robot that is no chain of joints, for couplings and loops, and for a tool that the last body
    does not have; ValueError for another convention.

    >>> import urdf
    >>> table = urdf.dh_table(urdf.load("ur5"))
    >>> [round(row.a, 5) for row in table.rows]
    [0.0, 0.425, 0.39225, 0.0, 0.0, 0.0]
    """
    check_model(model)
    if convention not in CONVENTIONS:
        raise ValueError(f"there is no convention '{convention}'; use {' or '.join(CONVENTIONS)}")
    _refuse_others(model)
    links = [Placement()]
    for joint in model.joints:
        links.append(links[-1] @ joint.placement)
    frame = _tool(model, tool)
    end = links[-1] @ frame.placement
    steps, choices = _steps(model, links, end, parallel_within)
    base, zero = steps[0].start, (0.0, 0.0, 0.0)
    rows = []
    for k, (joint, body) in enumerate(zip(model.joints, model.bodies, strict=True)):
        a, alpha, beta = steps[k].across if convention == "standard" else steps[k - 1].across if k else zero
        step, kept = steps[k], {name: getattr(joint, name) for name in KEPT}
        without = DHLink(body.name, None)
        rows.append(DHRow(joint.name, joint.kind, step.theta, step.d, a, alpha, beta, without, **kept))
    table = DHTable(
        model.name, convention, base, tuple(rows), Placement(), frame.name, model.base_name, model.gravity, choices
    )
    here, placed_rows = Placement(), []
    for row, joint_frame, link, body in zip(rows, table.joint_placements(), links[1:], model.bodies, strict=True):
        here = here @ joint_frame
        own = (here @ table.frame_of(row)).inverse() @ link
        moved = placed(body, own) if body.parameters.any() else None
        placed_rows.append(replace(row, link=DHLink(body.name, moved)))
    last = here @ table.frame_of(rows[-1])
    return replace(table, rows=tuple(placed_rows), tool=last.inverse() @ end)


@dataclass(frozen=True, eq=False)
class _JointStep:
    """What leads from the frame before one joint, `start`, to that before the next: θ, d, then (a, α, β)."""

    start: Placement
    theta: float
    d: float
    across: tuple[float, float, float]


def _steps(
    model: RobotModel, links: list[Placement], end: Placement, parallel_within: float
) -> tuple[list[_JointStep], tuple[str, ...]]:
    """A step for each joint, the last with nothing across; and what in them is a choice."""
    axes = [link.rotation @ joint.axis for link, joint in zip(links[1:], model.joints, strict=True)]
    points = [link.translation for link in links[1:]]
    size = max(1e-300, *(float(np.abs(point).max()) for point in (*points, end.translation)))
    start = Placement(_rotation(_across(axes[0], Placement()), axes[0]), _foot(points[0], axes[0], np.zeros(3)))
    choices = [
        "the first frame lies on axis 1, next to the origin of the base link, with its x axis where it can",
        "each common normal has the sense with the smaller θ; the other sense changes θ by 180°, and the signs of a "
        "and α",
    ]
    found = []
    for k, (z, point) in enumerate(zip(axes[1:], points[1:], strict=True), start=1):
        own = start.rotation[:, 2]
        sine = float(np.linalg.norm(np.cross(own, z)))
        if sine > parallel_within:
            step, start = _common_normal(start, points[k - 1], point, z)
        else:
            step, start = _in_plane(start, point, z, POINT_ROUNDING * size)
            which = f"axes {k} and {k + 1}"
            if sine > PARALLEL_ROUNDING:
                choices.append(f"{which} are parallel within {sine:.2g} rad: β and d = 0 in place of a common normal")
            else:
                choices.append(f"{which} are parallel: d of joint {k} is 0, and d of joint {k + 1} has all of the way")
        found.append(step)
    z = axes[-1]
    x, origin = _across(z, end), _foot(points[-1], z, end.translation)
    found.append(_JointStep(start, *_along(start, x, origin), (0.0, 0.0, 0.0)))
    choices.append("the last frame lies on its axis, next to the tool, with the tool's x axis where it can")
    return found, tuple(choices)


def _common_normal(start: Placement, point: Array, other: Array, z: Array) -> tuple[_JointStep, Placement]:
    """The step along the common normal of the z axis of start, through a point, and of the next axis."""
    own = start.rotation[:, 2]
    normal = np.cross(own, z)
    square = float(normal @ normal)
    between = other - point
    here = point + own * float(np.cross(between, z) @ normal) / square
    there = other + z * float(np.cross(between, own) @ normal) / square
    x = normal / math.sqrt(square)
    x = x if x @ start.rotation[:, 0] >= -PARALLEL_ROUNDING else -x
    across = float((there - here) @ x), math.atan2(float(np.cross(own, z) @ x), float(own @ z)), 0.0
    return _JointStep(start, *_along(start, x, here), across), Placement(_rotation(x, z), there)


def _in_plane(start: Placement, other: Array, z: Array, same: float) -> tuple[_JointStep, Placement]:
    """The step in the plane through start that is normal to its z axis, to where the next axis meets it."""
    own, origin = start.rotation[:, 2], start.translation
    there = other + z * float((origin - other) @ own) / float(z @ own)
    way = there - origin
    way = way - own * float(way @ own)
    a = float(np.linalg.norm(way))
    x = start.rotation[:, 0] if a <= same else way / a
    if x @ start.rotation[:, 0] < -PARALLEL_ROUNDING:
        x, a = -x, -a
    a = 0.0 if abs(a) <= same else a
    turned = _rotation(x, own)
    s, c, along = turned.T @ z
    beta = math.asin(max(-1.0, min(1.0, float(s))))
    alpha = math.atan2(-float(c), float(along))
    alpha, beta = (0.0 if abs(angle) <= PARALLEL_ROUNDING else angle for angle in (alpha, beta))
    step = _JointStep(start, *_along(start, x, origin), (a, alpha, beta))
    return step, Placement(turned, origin) @ along_normal(a, alpha, beta)


def _along(start: Placement, x: Array, origin: Array) -> tuple[float, float]:
    """θ and d from start to a frame with the same z axis."""
    own_x, own_y, z = start.rotation.T
    theta = math.atan2(float(x @ own_y), float(x @ own_x))
    return 0.0 if abs(theta) <= PARALLEL_ROUNDING else theta, float((origin - start.translation) @ z)


def _rotation(x: Array, z: Array) -> Array:
    return np.column_stack([x, np.cross(z, x), z])


def _across(z: Array, frame: Placement) -> Array:
    """The direction normal to z that is next to the x axis of a frame; to its y axis where x is nearly along z."""
    local = frame.rotation.T @ z
    nearest = frame.rotation @ (X if abs(local[0]) <= MAX_SHARE_OF_AXIS else Y)
    rest = nearest - z * (z @ nearest)
    found: Array = rest / np.linalg.norm(rest)
    return found


def _foot(point: Array, z: Array, of: Array) -> Array:
    """The point of the line next to another one."""
    found: Array = point + z * float((of - point) @ z)
    return found


def _tool(model: RobotModel, name: str | None) -> Frame:
    """The frame of the last body that is the tool."""
    last = model.n_bodies
    frames = [frame for frame in model.frames if frame.body == last]
    if name is None:
        return frames[-1] if frames else Frame("tool", last, Placement())
    for frame in frames:
        if name == frame.name or name in frame.aliases:
            return frame
    remedy = f"it has {listed(frame.name for frame in frames)}" if frames else "leave the tool out"
    raise CannotSave(f"'{name}' is no frame of the last body, '{model.bodies[-1].name}'", remedy)


def _refuse_others(model: RobotModel) -> None:
    """Raises CannotSave for what a table cannot hold."""
    remedy = "give a chain (--chain ROOT TIP), or save another format"
    for k, joint in enumerate(model.joints):
        if joint.inside != k:
            where = model.bodies[joint.inside - 1].name if joint.inside else model.base_name
            raise CannotSave(f"joint '{joint.name}' stands on '{where}': the robot is no chain of joints", remedy)
    if not model.joints:
        raise CannotSave("the robot has no joint", "give another robot")
    if model.couplings or model.chords:
        what = "couplings" if model.couplings else "loops"
        raise CannotSave(f"the robot has {what}, which a table of DH parameters cannot hold", remedy)


def save_dh(
    model: RobotModel,
    path: str | PathLike[str],
    convention: Convention = "standard",
    *,
    tool: str | None = None,
) -> None:
    """Write the Denavit-Hartenberg parameters of a serial robot as TOML, which urdf.load reads (docs/dh.md).

    Every number has all its digits, angles in rad. Arguments and errors as in dh_table. The file appears complete or
    not at all.
    """
    document = dh_document(dh_table(model, convention, tool=tool))
    write_whole(Path(path), document.encode())


def dh_document(table: DHTable) -> str:
    """The TOML text of a table."""
    lines = [
        *(f"# {choice}." for choice in table.choices),
        f"name = {_quoted(table.name)}",
        f'convention = "{table.convention}"',
        'angles = "rad"',
        'lengths = "m"',
        f"gravity = {_vector(table.gravity)}",
        *_placement("base", table.base_name, table.base),
        *_placement("tool", table.tool_name, table.tool),
    ]
    for row in table.rows:
        lines += ["", "[[joint]]", *_row(row)]
        lines += ["[joint.link]", *_link(row.link)]
    return "\n".join(lines) + "\n"


def _row(row: DHRow) -> Iterator[str]:
    yield f"name = {_quoted(row.name)}"
    if row.kind == "prismatic":
        yield 'type = "prismatic"'
    yield from (f"{key} = {_number(getattr(row, key))}" for key in ("theta", "d", "a", "alpha"))
    if row.beta:
        yield f"beta = {_number(row.beta)}"
    if row.sign != 1:
        yield f"sign = {row.sign:g}"
    limits: JointLimits = row.limits
    given = {key: getattr(limits, key) for key in ("lower", "upper", "velocity", "effort")}
    if row.kind == "continuous":
        given.update(lower=None, upper=None)
    yield from (f"{key} = {_number(value)}" for key, value in given.items() if value is not None)
    for key in ("damping", "friction", "armature"):
        if value := getattr(row, key):
            yield f"{key} = {_number(value)}"


def _link(link: DHLink) -> Iterator[str]:
    yield f"name = {_quoted(link.name)}"
    if (body := link.body) is None:
        return
    yield f"mass = {_number(body.mass)}"
    yield f"center = {_vector(body.center_of_mass)}"
    tensor = body.inertia
    entries = ("xx", "yy", "zz", "xy", "xz", "yz")
    said = ", ".join(f"{key} = {_number(tensor['xyz'.index(key[0]), 'xyz'.index(key[1])])}" for key in entries)
    yield f"inertia = {{ {said} }}"


def _placement(key: str, name: str, placement: Placement) -> Iterator[str]:
    yield from ("", f"[{key}]", f"name = {_quoted(name)}")
    yield f"xyz = {_vector(placement.translation)}"
    yield f"rpy = {_vector(rpy_from_rotation(placement.rotation))}"


def _vector(values: Array) -> str:
    return f"[{', '.join(map(_number, values))}]"


def _number(value: float) -> str:
    return repr(float(value) + 0.0)


def _quoted(name: str) -> str:
    return '"' + name.replace("\\", "\\\\").replace('"', '\\"') + '"'
