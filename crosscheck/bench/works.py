"""The works and the contenders of each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from crosscheck.bench import calls
from crosscheck.bench.calls import CALL_WORKS
from crosscheck.bench.contender import Contender, Forms, Work
from crosscheck.bench.forms import (
    casadi_forms,
    graphdyn_forms,
    mujoco_forms,
    pinocchio_forms,
    simulations,
    single_states,
)
from crosscheck.bench.forms.casadi_forms import CasadiRefuses
from crosscheck.bench.states import States
from crosscheck.quantities import QUANTITIES
from crosscheck.quantities.tolerances import ACCELERATION, AGREEMENT, FORWARD_WRENCH
from crosscheck.reference.mujoco_model import MujocoModel, MujocoRefuses
from graphdyn import ForwardDynamicsDerivatives, InverseDynamicsDerivatives

SINGLE_ARRAY_WORKS = tuple(name for name, row in QUANTITIES.items() if row.benchmark)
"""Works that are one verb with one array, and one function of Pinocchio that takes the same arguments."""

GRAPHDYN_FORMS: Mapping[str, Forms] = {
    "inverse_dynamics": graphdyn_forms.inverse,
    "forward_dynamics": graphdyn_forms.forward,
    "solve_kkt": graphdyn_forms.solve_kkt,
    "joint_torque_regressor": graphdyn_forms.regressor,
    "inverse_dynamics_derivatives": graphdyn_forms.verb("inverse_dynamics_derivatives", InverseDynamicsDerivatives),
    "forward_dynamics_derivatives": graphdyn_forms.verb("forward_dynamics_derivatives", ForwardDynamicsDerivatives),
    **{name: graphdyn_forms.verb(name) for name in SINGLE_ARRAY_WORKS},
}
PINOCCHIO_FORMS: Mapping[str, Forms] = {
    "inverse_dynamics": pinocchio_forms.inverse,
    "forward_dynamics": pinocchio_forms.forward,
    "solve_kkt": pinocchio_forms.solve_kkt,
    "joint_torque_regressor": pinocchio_forms.regressor,
    "inverse_dynamics_derivatives": pinocchio_forms.inverse_derivatives,
    "forward_dynamics_derivatives": pinocchio_forms.forward_derivatives,
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


class Peers:
    """Other libraries, and why some are left out. folder: for code that is compiled"""

    def __init__(self, states: States, folder: Path) -> None:
        self._states, self._folder = states, folder
        self.left_out: dict[str, str] = {}
        try:
            self.mujoco: MujocoModel | None = MujocoModel(states.model)
        except MujocoRefuses as refusal:
            self.mujoco, self.left_out["mujoco"] = None, str(refusal)

    def contenders(self, work: str, threads: Sequence[int]) -> list[Contender]:
        found: list[Contender] = []
        if self.mujoco is not None and work == "inverse_dynamics":
            found += mujoco_forms.inverse(self._states, self.mujoco)
        if self.mujoco is not None and work == "forward_dynamics":
            found += mujoco_forms.forward(self._states, self.mujoco, threads)
        forms = {"inverse_dynamics": casadi_forms.inverse, "forward_dynamics": casadi_forms.forward}
        if work in forms and "casadi" not in self.left_out:
            try:
                found += forms[work](self._states, self._folder)
            except CasadiRefuses as refusal:
                self.left_out["casadi"] = str(refusal)
        return found


def works_of(states: States) -> list[str]:
    """Their names; couplings and loops are not simulated."""
    tree = not (states.model.couplings or states.model.chords)
    return [name for name in WORK_DESCRIPTIONS if tree or name != simulations.SIMULATION_NAME]


def work(name: str, states: States, threads: Sequence[int], peers: Peers) -> Work:
    """A work with all its contenders."""
    if name == "single_inverse":
        contenders = single_states.inverse(states)
    elif name == "single_forward":
        contenders = single_states.forward(states)
    elif name == simulations.SIMULATION_NAME:
        contenders = simulations.contenders(states, peers.mujoco)
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
