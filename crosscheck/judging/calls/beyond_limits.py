"""Whether states are those beyond the limits of positions, velocities or torques."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.fault import named
from crosscheck.judging.special_states import position_limits
from crosscheck.judging.states import JudgedStates

MIN_STATES = 3
"""Number of states from which on they are told as those beyond limits."""

Outside = NDArray[np.bool_]
"""(N, n)"""


def beyond_limits(selected: NDArray[np.bool_], states: JudgedStates, arguments: Collection[str]) -> str | None:
    """The limits beyond which all selected states are, and no others: "q is beyond the position limits"; None if these
    are other states.

    selected: (N,); arguments: of the function
    """
    if int(selected.sum()) < MIN_STATES or selected.all():
        return None
    names, sets = states.model.joint_names, dict(_sets(states, arguments))
    for what, outside in sets.items():
        inside = [k for k in range(len(names)) if not (outside[:, k] & ~selected).any() and outside[:, k].any()]
        if np.array_equal(outside[:, inside].any(axis=1), selected):
            every = len(inside) == int(outside.any(axis=0).sum())
            return what if every else f"{what} of {named('joint', [names[k] for k in inside])}"
    if {"q", "v"} <= {x[0] for x in sets}:
        either = [x.any(axis=1) for what, x in sets.items() if what in (POSITIONS, VELOCITIES)]
        if len(either) > 1 and np.array_equal(either[0] | either[1], selected):
            return "q or v is beyond the position or velocity limits"
    return None


POSITIONS = "q is beyond the position limits"
VELOCITIES = "v is beyond the velocity limits"


def _sets(states: JudgedStates, arguments: Collection[str]) -> Iterator[tuple[str, Outside]]:
    joints = states.model.joints
    if "q" in arguments:
        lower, upper = np.transpose([position_limits(joint) for joint in joints])
        yield POSITIONS, (states.q < lower) | (states.q > upper)
        yield "q is at or beyond the position limits", (states.q <= lower) | (states.q >= upper)
    for name, what, sizes in (
        ("v", VELOCITIES, [joint.limits.velocity for joint in joints]),
        ("tau", "tau is beyond the effort limits", [joint.limits.effort for joint in joints]),
    ):
        if name in arguments:
            largest = np.array([x or np.inf for x in sizes])
            yield what, np.abs(getattr(states, name)) > largest
