"""Functions that answer torques, accelerations or reactions."""

from __future__ import annotations

import numpy as np

import graphdyn
from crosscheck.judging.functions.known_function import LOADS, Chosen, KnownFunction
from crosscheck.judging.functions.measures import ORDER, linear_first, parts_relative_to, relative_to, wrench_size
from crosscheck.judging.functions.pinocchio_answers import PinocchioAnswers
from crosscheck.judging.states.judged_states import JudgedStates
from crosscheck.quantities.scales import acceleration_scale, largest, ratio
from crosscheck.reference.reference_values import multipliers_of
from graphdyn.layout import ANGULAR, LINEAR, Array

TORQUE_SCALE = "largest entry of the joint wrenches"
ACCELERATION_SCALE = "cond(M) ‖a‖∞ + ‖M⁻¹‖∞ (‖τ‖∞ + largest joint wrench)"

WRENCH_CONVENTIONS = {
    "axes": ("link", "world"),
    "acts on": ("the outside body", "the inside body"),
    "actuator": ("included", "left out"),
    **ORDER,
}


def _bias(states: JudgedStates, chosen: Chosen) -> Array:
    return graphdyn.bias_torque(states.model, states.q, states.v)


def _bias_size(states: JudgedStates) -> Array:
    return largest(graphdyn.inverse_dynamics(states.model, states.q, states.v, 0 * states.a).joint_wrenches)


def _gravity(states: JudgedStates, chosen: Chosen) -> Array:
    return graphdyn.gravity_torque(states.model, states.q)


def _gravity_size(states: JudgedStates) -> Array:
    return largest(graphdyn.inverse_dynamics(states.model, states.q, 0 * states.v, 0 * states.a).joint_wrenches)


def _static_size(states: JudgedStates) -> Array:
    zero = np.zeros_like(states.q)
    return largest(graphdyn.inverse_dynamics(states.model, states.q, zero, zero, states.all_loads).joint_wrenches)


def _acceleration_errors(answer: Array, reference: Array, states: JudgedStates, chosen: Chosen) -> Array:
    wrenches = graphdyn.inverse_dynamics(states.model, states.q, states.v, reference, states.loads).joint_wrenches
    return ratio(largest(answer - reference), acceleration_scale(states.mass, reference, states.tau, wrenches))


def _wrenches(states: JudgedStates, chosen: Chosen) -> Array:
    return _as_chosen(states.inverse.joint_wrenches, states, chosen)


def _wrenches_of_pinocchio(there: PinocchioAnswers, chosen: Chosen) -> Array:
    return _as_chosen(there.loaded("joint_wrenches"), there.states, chosen)


def _as_chosen(wrenches: Array, states: JudgedStates, chosen: Chosen) -> Array:
    """Wrenches on the outside bodies in link axes, actuators included, as a convention has them."""
    parts = [wrenches[..., LINEAR].copy(), wrenches[..., ANGULAR].copy()]
    if chosen["actuator"] == "left out":
        for k, joint in enumerate(states.model.joints):
            part = parts[0 if joint.is_prismatic else 1]
            part[:, k] -= (part[:, k] @ joint.axis)[:, None] * joint.axis
    if chosen["axes"] == "world":
        parts = [np.einsum("...ab,...b->...a", states.motion.rotation, part) for part in parts]
    found = linear_first(np.concatenate(parts, axis=-1), chosen)
    return -found if chosen["acts on"] == "the inside body" else found


def _multipliers_of_pinocchio(there: PinocchioAnswers, chosen: Chosen) -> Array:
    found: Array = multipliers_of(there.states.model, there.values.rotation, there.loaded("joint_wrenches"))
    return found


TORQUES = (
    KnownFunction(
        "inverse_dynamics", ("q", "v", "a"), ("n",), "N m or N",
        ours=lambda states, _: states.inverse.tau,
        errors=relative_to(wrench_size),
        scale=TORQUE_SCALE,
        code="graphdyn.inverse_dynamics(model, q, v, a, external_wrenches).tau",
        pinocchio=lambda there, _: there.loaded("tau"),
        mujoco="inverse_dynamics",
        takes_loads=True,
    ),
    KnownFunction(
        "forward_dynamics", ("q", "v", "tau"), ("n",), "rad/s² or m/s²",
        ours=lambda states, _: states.accelerations,
        errors=_acceleration_errors,
        scale=ACCELERATION_SCALE,
        code="graphdyn.forward_dynamics(model, q, v, tau, external_wrenches).a",
        pinocchio=lambda there, _: there.loaded("a"),
        mujoco="forward_dynamics",
        takes_loads=True,
        solves=True,
    ),
    KnownFunction(
        "bias_torque", ("q", "v"), ("n",), "N m or N",
        ours=_bias,
        errors=relative_to(_bias_size),
        scale=TORQUE_SCALE,
        code="graphdyn.bias_torque(model, q, v)",
        pinocchio=lambda there, _: there.torques("nonLinearEffects", there.states.v),
    ),
    KnownFunction(
        "gravity_torque", ("q",), ("n",), "N m or N",
        ours=_gravity,
        errors=relative_to(_gravity_size),
        scale=TORQUE_SCALE,
        code="graphdyn.gravity_torque(model, q)",
        pinocchio=lambda there, _: there.torques("computeGeneralizedGravity"),
    ),
    KnownFunction(
        "static_torque", ("q", LOADS), ("n",), "N m or N",
        ours=lambda states, _: graphdyn.static_torque(states.model, states.q, states.all_loads),
        errors=relative_to(_static_size),
        scale=TORQUE_SCALE,
        code="graphdyn.static_torque(model, q, external_wrenches)",
        pinocchio=lambda there, _: there.derived("static_torque"),
    ),
    KnownFunction(
        "power", ("q", "v", "a"), ("n",), "W",
        ours=lambda states, _: graphdyn.power(states.model, states.q, states.v, states.a, states.loads),
        errors=relative_to(lambda states: wrench_size(states) * largest(states.v)),
        scale="largest entry of the joint wrenches × largest velocity",
        code="graphdyn.power(model, q, v, a, external_wrenches)",
        pinocchio=lambda there, _: there.derived("power"),
        takes_loads=True,
    ),
    KnownFunction(
        "joint_wrenches", ("q", "v", "a"), ("n", 6), "N, N m",
        ours=_wrenches,
        errors=parts_relative_to(lambda states: states.sizes.force, lambda states: states.sizes.moment),
        scale="forces: gravity-compensated acceleration × mass; moments: the same × lever",
        code="graphdyn.inverse_dynamics(model, q, v, a, external_wrenches).joint_wrenches",
        pinocchio=_wrenches_of_pinocchio,
        conventions=WRENCH_CONVENTIONS,
        takes_loads=True,
    ),
    KnownFunction(
        "multipliers", ("q", "v", "a"), ("n", 5), "N, N m",
        ours=lambda states, _: states.inverse.multipliers,
        errors=relative_to(wrench_size),
        scale=TORQUE_SCALE,
        code="graphdyn.inverse_dynamics(model, q, v, a, external_wrenches).multipliers",
        pinocchio=_multipliers_of_pinocchio,
        takes_loads=True,
    ),
)  # fmt: skip
