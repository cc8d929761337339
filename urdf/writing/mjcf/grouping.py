"""Bodies of the model as bodies of MuJoCo, which have mass: bodies without any are further joints of the next one.

A joint that moves a body without mass, on which nothing but one further joint stands, moves the body of that joint. At
q = 0, its anchor and axis are fixed in the axes of that body.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn import Body, Joint, Placement, RobotModel
from graphdyn.layout import Array
from graphdyn.model import consistency_problems
from urdf.errors import MAX_QUOTED_NAMES, CannotSave, shortened

MIN_MASS = 1e-15
"""Mass [kg] and principal moment [kg m²] up to which MuJoCo takes a body for massless (mjMINVAL)."""


@dataclass(frozen=True, eq=False)
class Axis:
    """A joint of a body; anchor, direction: in the axes of the body (3,), (3,)  [m, 1]"""

    joint: Joint
    anchor: Array
    direction: Array


@dataclass(frozen=True, eq=False)
class MovedBody:
    """A body of MuJoCo.

    number: of the body in the model; inside: that of the body on which it stands, 0 for the ground
    placement: in that body, at q = 0; axes: of its joints, the first next to that body
    """

    number: int
    inside: int
    placement: Placement
    axes: tuple[Axis, ...]


def groups(model: RobotModel) -> list[MovedBody]:
    """The bodies, parents first. Raises CannotSave with the names of all that MuJoCo would refuse."""
    carried = {frame.body for frame in model.frames}
    carried |= {body for chord in model.chords for body in (chord.body_i, chord.body_j)}
    merged = {
        number
        for number, body in enumerate(model.bodies, start=1)
        if _is_empty(body) and number not in carried and len(model.graph.outside(number)) == 1
    }
    refuse_impossible([body for number, body in enumerate(model.bodies, start=1) if number not in merged])
    return [_group(model, number, merged) for number in range(1, model.n_bodies + 1) if number not in merged]


def refuse_impossible(bodies: list[Body]) -> None:
    """Raises CannotSave with the names of all bodies that MuJoCo refuses, and why."""
    said = [f"'{shortened(body.name)}' ({why})" for body in bodies if (why := _refused(body))]
    if said:
        listed = ", ".join(said[:MAX_QUOTED_NAMES])
        more = f" and {len(said) - MAX_QUOTED_NAMES} more" if len(said) > MAX_QUOTED_NAMES else ""
        remedy = "give them real inertials, or lock their joints (lock=, --lock)"
        raise CannotSave(f"MuJoCo refuses bodies with these inertials: {listed}{more}", remedy)


def _is_empty(body: Body) -> bool:
    return body.mass == 0 and not body.inertia.any()


def _refused(body: Body) -> str:
    problems = consistency_problems(body.mass, body.inertia)
    if not problems and (body.mass <= MIN_MASS or np.linalg.eigvalsh(body.inertia)[0] <= MIN_MASS):
        problems = (f"mass {body.mass:.3g} kg and smallest principal moment are as good as zero",)
    return "; ".join(problems)


def _group(model: RobotModel, number: int, merged: set[int]) -> MovedBody:
    placement, inside = Placement(), number
    axes: list[Axis] = []
    while True:
        joint = model.joints[inside - 1]
        back = placement.inverse()
        axes.append(Axis(joint, back.translation, back.rotation @ joint.axis))
        placement = joint.placement @ placement
        inside = joint.inside
        if inside not in merged:
            return MovedBody(number, inside, placement, tuple(reversed(axes)))
