"""The dynamics of robots with loops: Eq. (111) with redundant rows, as it stands or projected onto the closed motions.

Accelerations are unique; of the reactions those that the equations determine (graphdyn.equations.loops.reactions).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from graphdyn.equations import projected
from graphdyn.equations.joint_readings import project_accelerations
from graphdyn.equations.kinematics import MaximalState, bias_acceleration, null_space
from graphdyn.equations.loops.reactions import reactions
from graphdyn.equations.specification import Arguments, Specification
from graphdyn.equations.system.unconstrained import passive_terms
from graphdyn.errors import InconsistentState, InvalidInput, SingularMassMatrix, in_row
from graphdyn.layout import Array, per_body, stacked
from graphdyn.model.assembly import (
    centripetal_size,
    refuse_infinitesimal,
    refuse_moving_apart,
    refuse_open,
    worst_row,
)
from graphdyn.model.loops import LOOP_RANK_TOLERANCE, LoopSpaces
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import apply

PARTING_SHARE = 1e-4
"""How far J a = γ may fail, relative to the squares of velocities: far above what gaps and velocities that count as
closed leave."""

OPEN_LOOP_REMEDY = "graphdyn.assemble(model, q) closes loops"


@dataclass(frozen=True, eq=False)
class Closed:
    """What the loops allow at a state.

    jacobian: J (…, m, n); bias: γ (…, m); spaces: its rank and null spaces
    """

    jacobian: Array
    bias: Array
    spaces: LoopSpaces


def closed(
    model: RobotModel, q: Array, v: Array | None = None, a: Array | None = None, *, moving: bool = True
) -> Closed:
    """The closed state at q, v, a (…, n).

    Raises InconsistentState, naming the loop, where these would open one, and naming the joints where the loops have
    infinitesimal mobility only, unless the robot need not be moving.
    """
    loops, who = model.loops, f"robot '{model.name}'"
    refuse_open(who, loops, loops.gaps(q), OPEN_LOOP_REMEDY)
    links = loops.links(q, v)
    jacobian, bias = loops.jacobian(links), loops.bias(links)
    if v is not None:
        refuse_moving_apart(who, loops, jacobian, v, np.zeros_like(bias), "velocity")
    if a is not None:
        summed = 0.0 if v is None else centripetal_size(loops, jacobian, v)
        refuse_moving_apart(who, loops, jacobian, a, bias, "acceleration", summed)
    held = Closed(jacobian, bias, loops.spaces(jacobian))
    if moving:
        _refuse_infinitesimal(model, q, held.spaces)
    return held


_regular_ranks: WeakKeyDictionary[RobotModel, int] = WeakKeyDictionary()
"""The ranks of loops in a pose that motions leave, by the robot."""


def _refuse_infinitesimal(model: RobotModel, q: Array, spaces: LoopSpaces) -> None:
    """Looks at the pose of smallest rank, of each robot once and in singular poses."""
    ranks = np.where(np.isfinite(q).all(axis=-1), spaces.rank, model.nv + 1)
    lowest = int(ranks.min(initial=model.nv + 1))
    if lowest < _regular_ranks.get(model, model.nv + 1):
        row = np.unravel_index(int(ranks.argmin()), ranks.shape)
        refuse_infinitesimal(f"robot '{model.name}'", model.loops, q[row])
        _regular_ranks.setdefault(model, lowest)


def forward_dynamics(x: Arguments) -> dict[str, Array]:
    """Forward dynamics like projected.forward_dynamics, with chord_multipliers. Raises InconsistentState,
    SingularMassMatrix."""
    found = solved(x)
    state, a, multipliers = found.state, found.a, found.multipliers
    if x.dense:
        solution = projected.kkt(state, x["tau"], x["external_wrenches"], found.bias).solve_redundant()
        accelerations, multipliers = per_body(solution.acceleration), solution.chord_multipliers
        a = project_accelerations(state, accelerations, found.bias)
    else:
        accelerations = found.bias + per_body(apply(found.null_space, a))
    return {"a": a, **reactions(state, found.held.spaces, accelerations, x["external_wrenches"], multipliers)}


@dataclass(frozen=True, eq=False)
class Solved:
    """The accelerations a (…, n) and the smallest chord multipliers (…, m), and what they were computed from.

    null_space: N of the tree; bias: Ṅ v; mass: M of the tree
    """

    held: Closed
    state: MaximalState
    null_space: Array
    bias: Array
    mass: Array
    a: Array
    multipliers: Array


def solved(x: Arguments) -> Solved:
    """M a + h + Jᵀλ = τ and J a = γ, by projection onto the closed motions. Raises as forward_dynamics does."""
    held = closed(x.model, x["q"], x["v"])
    state = x.rooted_state()
    bias = bias_acceleration(x.model.rooted, x["q"], x["v"], state.ground)
    n = null_space(state)
    mass = projected.projected_mass(state, n)
    refuse_massless_motions(x.model, held.spaces, mass)
    passive = passive_terms(state, x["external_wrenches"])
    needed = apply(np.swapaxes(n, -1, -2), stacked(projected.inertial_terms(state, bias) - passive))
    start = held.spaces.least_motion(held.bias)
    refuse_parting(x.model, held, x["v"], start)
    a = start + apply(response(held.spaces, mass), x["tau"] - needed - apply(mass, start))
    return Solved(held, state, n, bias, mass, a, held.spaces.least_multipliers(x["tau"] - needed - apply(mass, a)))


def refuse_parting(model: RobotModel, held: Closed, v: Array, a: Array) -> None:
    """Raises InconsistentState, naming the loop, where a (…, n) that comes nearest to J a = γ(v) does not reach it: a
    singular pose through which no motion has this velocity."""
    loops = model.loops
    left = np.abs(apply(held.jacobian, a) - held.bias) / loops.row_units
    size = centripetal_size(loops, held.jacobian, v)
    apart = left / np.where(size > 0, size, 1.0)[..., None]
    if np.nanmax(apart, initial=0.0) > PARTING_SHARE:
        _, chord, where = worst_row(loops, apart)
        raise InconsistentState(
            f"robot '{model.name}': no acceleration keeps the loop of chord '{chord}' closed at this velocity{where}: "
            "in this singular pose branches of motions meet, and the velocity is that of none; take it along one"
        )


def response(spaces: LoopSpaces, mass: Array) -> Array:
    """Z (Zᵀ M Z)⁻¹ Zᵀ (…, n, n): the accelerations that torques cause, along the closed motions Z."""
    right, free = spaces.right, spaces.free[..., :, None]
    transposed = np.swapaxes(right, -1, -2)
    on_motions = np.where(free & np.swapaxes(free, -1, -2), transposed @ mass @ right, np.eye(right.shape[-1]))
    matrix: Array = right @ np.linalg.solve(on_motions, np.where(free, transposed, 0.0))
    return matrix


def inverse_dynamics(x: Arguments) -> dict[str, Array]:
    """Inverse dynamics like projected.inverse_dynamics, of the actuated joints; the smallest torques where these are
    redundant.

    Raises InconsistentState; InvalidInput, naming the motion, where the actuated joints leave one free.
    """
    held = closed(x.model, x["q"], x["v"], x["a"])
    state = x.rooted_state()
    assert state.acceleration is not None
    accelerations = np.broadcast_to(state.acceleration, state.velocity.shape)
    required = projected.inertial_terms(state, accelerations) - passive_terms(state, x["external_wrenches"])
    needed = apply(np.swapaxes(null_space(state), -1, -2), stacked(required))
    tau = apply(actuation(x.model, held.spaces), needed)
    multipliers = held.spaces.least_multipliers(tau - needed)
    return {"tau": tau, **reactions(state, held.spaces, accelerations, x["external_wrenches"], multipliers)}


def actuation(model: RobotModel, spaces: LoopSpaces) -> Array:
    """T (…, n, n): the torques of the actuated joints that move the robot as torques f at all joints would: τ = T f.

    Zᵀ τ = Zᵀ f with the closed motions Z; the smallest such τ where more joints are actuated than needed.
    Raises InvalidInput where no joints are known to be actuated, or where these leave a motion free.
    """
    if model.actuated is None:
        known = ", ".join(model.independent_joints)
        raise InvalidInput(
            f"robot '{model.name}' has loops, and which joints have motors is not known: give actuated= or "
            f"model.with_actuated(…), names among {known}"
        )
    motors = [model.independent_joints.index(name) for name in model.actuated]
    units = model.loops.column_units
    motions = np.where(spaces.free[..., None, :], spaces.right, 0.0)  # Z, and zero columns
    of_motors = np.swapaxes(motions[..., motors, :] / units[motors, None], -1, -2)  # (…, n, n_actuated)
    left, values, right = np.linalg.svd(of_motors, full_matrices=False)
    kept = values > LOOP_RANK_TOLERANCE
    _refuse_idle(model, spaces, kept, motors)
    inverse = np.where(kept, 1.0 / np.where(kept, values, 1.0), 0.0)
    to_motors = (np.swapaxes(right, -1, -2) * inverse[..., None, :]) @ np.swapaxes(left, -1, -2) / units[motors, None]
    whole = np.zeros((*motions.shape[:-2], model.nv, model.nv))
    whole[..., motors, :] = to_motors @ np.swapaxes(motions, -1, -2)
    return whole


def at_motors(tree: Specification) -> Specification:
    """The torques (…, n) or torques per parameter (…, n, k) that a specification of trees answers, at the motors."""

    def torque(x: Arguments) -> dict[str, Array]:
        held = closed(x.model, x["q"], x.arrays.get("v"), x.arrays.get("a"))
        ((name, of_joints),) = tree(replace(x, model=x.model.opened)).items()
        to_motors = actuation(x.model, held.spaces)
        return {name: apply(to_motors, of_joints) if of_joints.ndim == x["q"].ndim else to_motors @ of_joints}

    return torque


def power(x: Arguments) -> dict[str, Array]:
    """τ_j v_j (…, n) of inverse_dynamics."""
    return {"power": inverse_dynamics(x)["tau"] * x["v"]}


def motion_names(model: RobotModel, motion: Array) -> str:
    """The joints that take part in a motion (n,), largest first, with what they move by: "knee 1, hip -0.5"."""
    size = np.abs(motion) / model.loops.column_units
    order = [k for k in np.argsort(-size) if size[k] > LOOP_RANK_TOLERANCE * size.max()]
    return ", ".join(f"{model.independent_joints[k]} {motion[k] / size.max():.3g}" for k in order)


def refuse_massless_motions(model: RobotModel, spaces: LoopSpaces, mass: Array) -> None:
    """Raises SingularMassMatrix, naming a motion, where a closed motion has no inertia."""
    right, free = spaces.right, spaces.free
    both = free[..., :, None] & free[..., None, :]
    on_motions = np.where(both, np.swapaxes(right, -1, -2) @ mass @ right, np.eye(right.shape[-1]))
    at_fault = projected.singular(on_motions)
    if not at_fault.any():
        return
    row = tuple(np.argwhere(at_fault)[0])
    values, vectors = np.linalg.eigh(on_motions[row])
    motion = right[row] @ vectors[:, np.abs(values).argmin()]
    raise SingularMassMatrix(
        f"robot '{model.name}' can move without inertia{in_row(row)}: "
        f"{motion_names(model, motion)}. Torques do not determine accelerations there; see physical_consistency()"
    )


def _refuse_idle(model: RobotModel, spaces: LoopSpaces, kept: NDArray[np.bool_], motors: list[int]) -> None:
    """Raises InvalidInput, naming the motion that is left, where motors hold fewer motions than are free."""
    idle = np.count_nonzero(kept, axis=-1) < np.count_nonzero(spaces.free, axis=-1)
    if not idle.any():
        return
    row = tuple(np.argwhere(idle)[0])
    free = spaces.right[row][:, spaces.free[row]]
    _, values, vectors = np.linalg.svd(free[motors, :] / model.loops.column_units[motors, None])
    still = vectors[np.count_nonzero(values > LOOP_RANK_TOLERANCE) :]
    named = "; ".join(motion_names(model, free @ amounts) for amounts in still)
    motors_named = ", ".join(model.actuated or ()) or "no joint"
    raise InvalidInput(
        f"robot '{model.name}': motors at {motors_named} leave {len(still)} of {free.shape[1]} motions free"
        f"{in_row(row)}: {named}. Torques do not follow from accelerations; actuate more joints"
    )
