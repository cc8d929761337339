"""Torques, accelerations, reactions and the motion of bodies."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, TypedDict

import numpy as np

from crosscheck.quantities.measures import (
    ORDER,
    Chosen,
    Measure,
    acceleration_bound,
    constant,
    largest_wrench,
    parts_relative_to,
    relative_to,
    spin,
)
from crosscheck.quantities.quantity import (
    DERIVED_LOADED,
    LOADED,
    LOADS,
    PROJECTED,
    SOLVED,
    SOLVED_LOADED,
    USUAL,
    USUAL_TWICE,
    Ours,
    Quantity,
    verb,
)
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.scales import backward_error, center_offset, largest, ratio, relative
from crosscheck.quantities.system import solution
from crosscheck.quantities.tested_function import TestedFunction
from crosscheck.quantities.tolerances import ACCELERATION, BACKWARD, FORWARD_WRENCH, RESIDUAL
from crosscheck.reference.native_functions import NativeFunction
from graphdyn.arguments import Method
from graphdyn.equations import link_origins
from graphdyn.layout import ANGULAR, LINEAR, Array

if TYPE_CHECKING:
    from crosscheck.reference.pinocchio_model import PinocchioAnswers

TORQUE = "largest joint wrench; spin"
SOLVED_SCALE = "only cond(M) ‖a‖ + ‖M⁻¹‖ (‖τ‖ + largest joint wrench)"
PLACED = "rotations: 1; positions: largest position of a link, offset of a center of mass"
_WRENCH = "largest joint wrench"
_BY_PART = "forces: force; moments: moment"

_WRENCH_CONVENTIONS = {
    "axes": ("link", "world"),
    "acts on": ("the outside body", "the inside body"),
    "actuator": ("included", "left out"),
    **ORDER,
}


def _wrenches_as_chosen(wrenches: Array, states: ScaledStates, chosen: Chosen) -> Array:
    """Wrenches on the outside bodies in link axes, actuators included, as a convention has them."""
    parts = [wrenches[..., LINEAR].copy(), wrenches[..., ANGULAR].copy()]
    if chosen.get("actuator") == "left out":
        for k, joint in enumerate(states.model.joints):
            part = parts[0 if joint.is_prismatic else 1]
            part[:, k] -= (part[:, k] @ joint.axis)[:, None] * joint.axis
    if chosen.get("axes") == "world":
        parts = [np.einsum("...ab,...b->...a", states.rotations, part) for part in parts]
    found = np.concatenate(parts, axis=-1)
    return -found if chosen.get("acts on") == "the inside body" else found


def _acceleration_errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
    return ratio(largest(x - y), acceleration_bound(states))


def _body_acceleration_errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
    spread = states.model.n_bodies * np.maximum(1.0, states.solved_sizes.lever)
    return ratio(largest(x - y), spread * acceleration_bound(states) + largest(y))


def _backward_errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
    """Backward errors of accelerations x, which need other torques than the given ones y."""
    torques, wrenches = states.required(x)
    return backward_error(torques, y, wrenches, states.mass, x, *(() if states.loads is None else (states.loads,)))


def placement_errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
    """Errors of rotations and positions side by side (N, n, 3, 4), and of the last row (N, n, 4, 4)."""
    place = (..., slice(0, 3), 3)
    offset = constant(center_offset(states.model), states)
    turned, shifted = x.copy(), relative(x[place], y[place], largest(states.origins), offset)
    turned[place] = y[place]
    return np.maximum(largest(turned - y), shifted)


def _placed(rotation: Array, position: Array) -> Array:
    return np.concatenate([rotation, position[..., None]], axis=-1)


def _motion(field: str, shape: tuple[int | str, ...], unit: str) -> Ours:
    """A field of graphdyn.maximal_state."""

    def compute(states: ScaledStates, chosen: Chosen, method: Method) -> Array:
        found: Array = getattr(states.motion, field)
        return found

    code = f"graphdyn.maximal_state(model, q, v, a).{field}"
    return Ours(("q", "v", "a"), shape, unit, compute, code)


def _residual(name: str) -> Ours:
    def compute(states: ScaledStates, chosen: Chosen, method: Method) -> Array:
        found: Array = getattr(solution(states), name)()
        return found

    return Ours(("q", "v", "tau"), (), "1", compute, f"graphdyn.kkt_system(model, q, v, tau).solve().{name}()")


def _nothing(there: PinocchioAnswers, chosen: Chosen) -> Array:
    return np.zeros(len(there.q))


def _as_it_is(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
    return x


def _at_rest(*names: str) -> Measure:
    """Relative to the largest joint wrench of a robot that moves by these arguments alone."""

    def errors(x: Array, y: Array, states: ScaledStates, chosen: Chosen) -> Array:
        v = states.v if "v" in names else np.zeros_like(states.v)
        return relative(x, y, states.largest_wrench(v, states.all_loads if LOADS in names else None))

    return errors


class DynamicsFunctions(TypedDict, total=False):
    """What of it a user may give to be judged, as keywords of crosscheck.judge."""

    inverse_dynamics: TestedFunction | None
    forward_dynamics: TestedFunction | None
    bias_torque: TestedFunction | None
    gravity_torque: TestedFunction | None
    static_torque: TestedFunction | None
    power: TestedFunction | None
    joint_wrenches: TestedFunction | None
    multipliers: TestedFunction | None


DYNAMICS = (
    Quantity(
        name="inverse_dynamics",
        shows="torques",
        ours=verb("inverse_dynamics", "tau", loads="taken"),
        pinocchio=lambda there, _: there.tau,
        against="rnea",
        errors=relative_to(largest_wrench, spin),
        scale=TORQUE,
        forms=(*USUAL_TWICE, LOADED),
        mujoco="inverse_dynamics",
    ),
    Quantity(
        name="forward_dynamics",
        shows="accelerations",
        ours=verb("forward_dynamics", "a", loads="taken"),
        pinocchio=lambda there, _: there.a,
        against="aba",
        errors=_acceleration_errors,
        scale=SOLVED_SCALE,
        tolerance=ACCELERATION,
        forms=(*SOLVED, PROJECTED, SOLVED_LOADED),
        solves=True,
        mujoco="forward_dynamics",
    ),
    Quantity(
        name="bias_torque",
        shows="gravity and velocity terms",
        ours=verb("bias_torque"),
        pinocchio=NativeFunction("nonLinearEffects", ("q", "v"), "torques"),
        errors=_at_rest("v"),
        scale=_WRENCH,
        forms=USUAL,
    ),
    Quantity(
        name="gravity_torque",
        shows="gravity",
        ours=verb("gravity_torque"),
        pinocchio=NativeFunction("computeGeneralizedGravity", ("q",), "torques"),
        errors=_at_rest(),
        scale=_WRENCH,
        forms=USUAL,
    ),
    Quantity(
        name="static_torque",
        ours=verb("static_torque", loads="needed"),
        pinocchio=NativeFunction("computeStaticTorque", ("q", "forces"), "torques"),
        against="computeStaticTorque with fext",
        errors=_at_rest(LOADS),
        scale="largest joint wrench at rest",
        forms=DERIVED_LOADED,
    ),
    Quantity(
        name="power",
        ours=verb("power", loads="taken"),
        pinocchio=lambda there, _: there.tau * there.v,
        against="rnea with fext, times v",
        errors=relative_to(lambda states: np.maximum(largest_wrench(states), spin(states)) * largest(states.v)),
        scale=f"({TORQUE}) × largest velocity",
        forms=DERIVED_LOADED,
    ),
    Quantity(
        name="joint_wrenches",
        ours=verb("inverse_dynamics", "joint_wrenches", loads="taken"),
        pinocchio=lambda there, _: there.joint_wrenches,
        against="rnea, data.f",
        errors=parts_relative_to(lambda states: states.sizes.force, lambda states: states.sizes.moment),
        scale=_BY_PART,
        forms=(*USUAL_TWICE, LOADED),
        conventions=_WRENCH_CONVENTIONS,
        as_chosen=_wrenches_as_chosen,
    ),
    Quantity(
        name="multipliers",
        ours=verb("inverse_dynamics", "multipliers", loads="taken"),
        pinocchio=lambda there, _: there.multipliers(there.joint_wrenches),
        against="rnea, data.f",
        errors=relative_to(largest_wrench),
        scale=_WRENCH,
        forms=USUAL_TWICE,
    ),
    Quantity(
        name="backward_error",
        ours=replace(
            verb("forward_dynamics", "a", loads="taken"),
            code="there.required(np.array([graphdyn.forward_dynamics(model, q, v, tau, external_wrenches).a]))[0][0]",
            verb="",
        ),
        pinocchio=lambda there, _: there.tau_given,
        against="τ that rnea needs at a",
        errors=_backward_errors,
        scale="only τ, the largest joint wrench and load, ∣M∣ ∣a∣",
        tolerance=BACKWARD,
        forms=(
            *SOLVED,
            PROJECTED,
            SOLVED_LOADED,
            replace(PROJECTED, suffix="_projected_external", loaded=True),
            replace(SOLVED[1], suffix="_external_recursive", loaded=True),
        ),
        solves=True,
    ),
    Quantity(
        name="forward_body_accelerations",
        ours=verb("forward_dynamics", "body_accelerations", loads="taken"),
        pinocchio=lambda there, _: there.a_body_accelerations,
        against="aba, then a",
        errors=_body_acceleration_errors,
        scale="that of forward_dynamics × n × max(1, lever)",
        tolerance=ACCELERATION,
        forms=SOLVED,
        solves=True,
    ),
    Quantity(
        name="forward_joint_wrenches",
        ours=verb("forward_dynamics", "joint_wrenches", loads="taken"),
        pinocchio=lambda there, _: there.a_wrenches,
        against="aba, then rnea",
        errors=parts_relative_to(lambda states: states.solved_sizes.force, lambda states: states.solved_sizes.moment),
        scale=_BY_PART,
        tolerance=FORWARD_WRENCH,
        forms=(*SOLVED, SOLVED_LOADED),
        solves=True,
    ),
    Quantity(
        name="forward_multipliers",
        ours=verb("forward_dynamics", "multipliers", loads="taken"),
        pinocchio=lambda there, _: there.multipliers(there.a_wrenches),
        against="aba, then rnea",
        errors=relative_to(lambda states: states.solved_sizes.force, lambda states: states.solved_sizes.moment),
        scale="force and moment",
        tolerance=FORWARD_WRENCH,
        forms=SOLVED,
        solves=True,
    ),
    Quantity(
        name="link_placement",
        ours=Ours(
            ("q",), ("n", 3, 4), "1, m",
            lambda states, *_: _placed(states.motion.rotation, link_origins(states.motion)),
            "np.dstack([(x := graphdyn.maximal_state(model, q)).rotation, link_origins(x)])",
        ),
        pinocchio=lambda there, _: _placed(there.rotation, there.position),
        against="forwardKinematics, oMi",
        errors=placement_errors,
        scale=PLACED,
        forms=USUAL,
    ),
    Quantity(
        name="body_velocities",
        ours=_motion("velocity", ("n", 6), "m/s, rad/s"),
        pinocchio=lambda there, _: there.velocity,
        against="forwardKinematics, v",
        errors=parts_relative_to(lambda states: states.sizes.velocity, lambda states: constant(0, states)),
        scale="linear: ‖ω‖ × lever + slide rate",
        forms=USUAL,
    ),
    Quantity(
        name="body_accelerations",
        ours=_motion("acceleration", ("n", 6), "m/s², rad/s²"),
        pinocchio=lambda there, _: there.acceleration,
        against="forwardKinematics, a",
        errors=parts_relative_to(lambda states: states.sizes.acceleration, lambda states: states.sizes.turn),
        scale="linear: swing; angular: turn",
        forms=USUAL,
    ),
    Quantity(
        name="dynamics_residual",
        ours=_residual("dynamics_residual"),
        pinocchio=_nothing,
        against="A q̈ + φ_qᵀλ = B",
        errors=_as_it_is,
        scale="only the largest row of Σ ∣terms∣",
        tolerance=RESIDUAL,
        forms=USUAL,
        solves=True,
    ),
    Quantity(
        name="constraint_residual",
        ours=_residual("constraint_residual"),
        pinocchio=_nothing,
        against="φ_q q̈ = ζ",
        errors=_as_it_is,
        scale="only q̈ and the largest row of Σ ∣terms∣",
        tolerance=RESIDUAL,
        forms=USUAL,
        solves=True,
    ),
)  # fmt: skip
