"""Closed states from open ones."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.arrays import joint_arrays
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model import assembly
from graphdyn.model.robot_model import RobotModel, check_model

__all__ = ["assemble"]


def assemble(
    model: RobotModel,
    q: ArrayLike,
    v: ArrayLike | None = None,
    a: ArrayLike | None = None,
    *,
    hold: Sequence[str] = (),
) -> Array | tuple[Array, ...]:
    """The closed state near a given one: q, or (q, v), or (q, v, a), as many as are given.

    q: where to start                                       (…, nv)  [rad or m]
    v, a: changed as little as possible (least squares) to keep the loops closed   (…, nv)  [rad/s or m/s, …/s²]
    hold: names of joints that stay as they are in all of them

    Positions by damped Newton steps, which reach a pose near the start where there is one, not the nearest; a body
    flipped by 180° counts as open. Without chords the arguments come back.

    Raises InconsistentState, naming the loop and its gap, where no step helps any more; InvalidInput for joints that
    there are not, wrong shapes, NaN or infinity.

    >>> import graphdyn, numpy as np
    >>> from graphdyn import Body, Chord, Joint, Placement, RobotModel
    >>> def at(x):
    ...     return Placement(translation=np.array([x, 0.0, 0.0]))
    ...
    >>> bodies = [Body(name, 1.0, (0.5, 0, 0), 0.1 * np.eye(3)) for name in ("upper", "lower")]
    >>> joints = [Joint(f"joint {k}", "continuous", k, at(float(k)), (0, 0, 1)) for k in (0, 1)]
    >>> rod = Chord("rod", "distance", 0, at(2.0), 2, at(1.0), length=1.5)  # from the ground to the lower end
    >>> model = RobotModel("linkage", bodies, joints, chords=[rod])
    >>> q = graphdyn.assemble(model, [0.5, 1.0])
    >>> end = graphdyn.frame_placement(model, q, "lower")[1] + graphdyn.frame_placement(model, q, "lower")[0][:, 0]
    >>> round(float(np.linalg.norm(end - (2, 0, 0))), 6)
    1.5
    """
    check_model(model)
    rest = np.zeros(model.nv)
    x = joint_arrays(model, q=q, v=rest if v is None else v, a=rest if a is None else a)
    if isinstance(hold, str):
        raise InvalidInput(f"hold is the text '{hold}'; give a list of joint names")
    for name in hold:
        if name not in model.independent_joints:
            known = ", ".join(model.independent_joints)
            raise InvalidInput(f"robot '{model.name}' has no free joint '{name}' to hold; choose among {known}")
    if a is not None and v is None:
        raise InvalidInput("a is given without v, on which it depends; give both")
    given = 1 + (v is not None) + (a is not None)
    found = tuple(x.values()) if not model.chords else _closed(model, x, hold)
    return found[0] if given == 1 else found[:given]


def _closed(model: RobotModel, x: dict[str, Array], hold: Sequence[str]) -> tuple[Array, Array, Array]:
    loops, who = model.loops, f"robot '{model.name}'"
    held = np.array([model.independent_joints.index(name) for name in hold], dtype=int)
    q, gaps = assembly.assembled(loops, x["q"], held)
    while_held = f" with {', '.join(hold)} held" if hold else ""
    assembly.refuse_open(who, loops, gaps, f"No step from this start closes it further{while_held}: start elsewhere")
    jacobian = loops.jacobian(loops.links(q))
    still = np.zeros(jacobian.shape[:-1])
    v = assembly.completed_rate(loops, jacobian, x["v"], still, held)
    assembly.refuse_moving_apart(who, loops, jacobian, v, still, "velocity")
    wanted = loops.bias(loops.links(q, v))
    a = assembly.completed_rate(loops, jacobian, x["a"], wanted, held)
    summed = assembly.centripetal_size(loops, jacobian, v)
    assembly.refuse_moving_apart(who, loops, jacobian, a, wanted, "acceleration", summed)
    return q, v, a
