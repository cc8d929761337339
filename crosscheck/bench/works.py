"""The works and the contenders of each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial

from crosscheck.bench import calls
from crosscheck.bench.calls import CALL_WORKS
from crosscheck.bench.contender import Forms, Work
from crosscheck.bench.forms import graphdyn_forms, pinocchio_forms, simulations, single_precision
from crosscheck.bench.forms.peers import Peers
from crosscheck.bench.forms.single_precision import SINGLE_PRECISION_WORKS
from crosscheck.bench.states import States
from crosscheck.quantities import QUANTITIES
from crosscheck.quantities.tolerances import ACCELERATION, AGREEMENT, FORWARD_WRENCH
from graphdyn import ForwardDynamicsDerivatives, InverseDynamicsDerivatives

SINGLE_ARRAY_WORKS = tuple(name for name, row in QUANTITIES.items() if row.benchmark)
"""Works that are one verb with one array, and one function of Pinocchio that takes the same arguments."""

GRAPHDYN_FORMS: Mapping[str, Forms] = {
    "inverse_dynamics": partial(graphdyn_forms.dynamics, False),
    "forward_dynamics": partial(graphdyn_forms.dynamics, True),
    "solve_kkt": graphdyn_forms.solve_kkt,
    "joint_torque_regressor": graphdyn_forms.regressor,
    "inverse_dynamics_derivatives": graphdyn_forms.verb("inverse_dynamics_derivatives", InverseDynamicsDerivatives),
    "forward_dynamics_derivatives": graphdyn_forms.verb("forward_dynamics_derivatives", ForwardDynamicsDerivatives),
    **{name: graphdyn_forms.verb(name) for name in SINGLE_ARRAY_WORKS},
}
PINOCCHIO_FORMS: Mapping[str, Forms] = {
    "inverse_dynamics": partial(pinocchio_forms.dynamics, False),
    "forward_dynamics": partial(pinocchio_forms.dynamics, True),
    "solve_kkt": pinocchio_forms.solve_kkt,
    "joint_torque_regressor": pinocchio_forms.regressor,
    "inverse_dynamics_derivatives": partial(pinocchio_forms.derivatives, False),
    "forward_dynamics_derivatives": partial(pinocchio_forms.derivatives, True),
    **{name: pinocchio_forms.quantity(name) for name in SINGLE_ARRAY_WORKS},
}

TORQUE_ERROR_SCALE = "largest joint wrench of the sample"
DERIVATIVE_SCALES = "the scales of `graphdyn crosscheck` (docs/notation.md), each derivative on its own"
ACCELERATION_ERROR_SCALE = "cond(M) ‖a‖ + ‖M⁻¹‖ (‖τ‖ + largest joint wrench)"

WORK_DESCRIPTIONS: Mapping[str, tuple[str, str, float]] = {
    "inverse_dynamics": ("inverse dynamics", TORQUE_ERROR_SCALE, AGREEMENT.bound),
    "forward_dynamics": ("forward dynamics", ACCELERATION_ERROR_SCALE, ACCELERATION.bound),
    "solve_kkt": (
        "all accelerations and multipliers",
        "largest joint wrench; multipliers are judged",
        FORWARD_WRENCH.bound,
    ),
    "joint_torque_regressor": (
        "joint-torque regressor",
        "largest entry of the type of parameter, or lengths of columns",
        AGREEMENT.bound,
    ),
    "inverse_dynamics_derivatives": ("derivatives of inverse dynamics", DERIVATIVE_SCALES, AGREEMENT.bound),
    "forward_dynamics_derivatives": ("derivatives of forward dynamics", DERIVATIVE_SCALES, ACCELERATION.bound),
    **{
        name: (QUANTITIES[name].benchmark, DERIVATIVE_SCALES, QUANTITIES[name].tolerance.bound)
        for name in SINGLE_ARRAY_WORKS
    },
    **{
        name: (
            single_precision.title(forward),
            ACCELERATION_ERROR_SCALE if forward else TORQUE_ERROR_SCALE,
            single_precision.SINGLE_PRECISION_BOUND,
        )
        for name, forward in SINGLE_PRECISION_WORKS.items()
    },
    simulations.SIMULATION_NAME: (simulations.SIMULATION_TITLE, simulations.ERROR_SCALE, simulations.ERROR_BOUND),
    **{
        name: (
            call.title,
            *(
                (ACCELERATION_ERROR_SCALE, ACCELERATION.bound)
                if call.forward
                else (TORQUE_ERROR_SCALE, AGREEMENT.bound)
            ),
        )
        for name, call in CALL_WORKS.items()
    },
    "single_inverse": ("inverse dynamics, one state per call", TORQUE_ERROR_SCALE, AGREEMENT.bound),
    "single_forward": ("forward dynamics, one state per call", ACCELERATION_ERROR_SCALE, ACCELERATION.bound),
}
"""Title, what errors are relative to, and their bound, in the order of the report."""


def works_of(states: States) -> list[str]:
    """Their names; loops are not simulated."""
    return [name for name in WORK_DESCRIPTIONS if not states.model.chords or name != simulations.SIMULATION_NAME]


def work(name: str, states: States, threads: Sequence[int], peers: Peers) -> Work:
    """A work with all its contenders."""
    if name in ("single_inverse", "single_forward"):
        contenders = calls.single_states(states, name == "single_forward")
    elif name == simulations.SIMULATION_NAME:
        contenders = simulations.contenders(states, peers.mujoco)
    elif name in SINGLE_PRECISION_WORKS:
        contenders = single_precision.contenders(states, SINGLE_PRECISION_WORKS[name], threads)
    elif name in CALL_WORKS:
        contenders = calls.contenders(states, CALL_WORKS[name])
    else:
        contenders = [
            *GRAPHDYN_FORMS[name](states, threads),
            *PINOCCHIO_FORMS[name](states, threads),
            *peers.contenders(name, threads),
        ]
    title, error, bound = WORK_DESCRIPTIONS[name]
    return Work(name, title, error, bound, tuple(contenders))
