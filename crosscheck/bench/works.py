"""The works and the contenders of each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

from crosscheck.bench import calls
from crosscheck.bench.calls import CALLS
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
from crosscheck.quantities.tolerances import ACCELERATION, AGREEMENT, FORWARD_WRENCH
from crosscheck.reference.mujoco_model import MujocoModel, MujocoRefuses
from graphdyn import ForwardDynamicsDerivatives, InverseDynamicsDerivatives

QUANTITIES = ("mass_matrix_inverse", "coriolis_matrix", "kinetic_energy", "frame_jacobian")
"""Works that are one verb with one array, and one function of Pinocchio that takes the same arguments."""

OURS: Mapping[str, Forms] = {
    "inverse_dynamics": graphdyn_forms.inverse,
    "forward_dynamics": graphdyn_forms.forward,
    "everything": graphdyn_forms.everything,
    "regressor": graphdyn_forms.regressor,
    "inverse_dynamics_derivatives": graphdyn_forms.verb("inverse_dynamics_derivatives", InverseDynamicsDerivatives),
    "forward_dynamics_derivatives": graphdyn_forms.verb("forward_dynamics_derivatives", ForwardDynamicsDerivatives),
    **{name: graphdyn_forms.verb(name) for name in QUANTITIES},
}
PINOCCHIO: Mapping[str, Forms] = {
    "inverse_dynamics": pinocchio_forms.inverse,
    "forward_dynamics": pinocchio_forms.forward,
    "everything": pinocchio_forms.everything,
    "regressor": pinocchio_forms.regressor,
    "inverse_dynamics_derivatives": pinocchio_forms.inverse_derivatives,
    "forward_dynamics_derivatives": pinocchio_forms.forward_derivatives,
    **{name: pinocchio_forms.quantity(name) for name in QUANTITIES},
}

TORQUE = "largest joint wrench of the sample"
DERIVED = "the scales of `graphdyn crosscheck` (docs/notation.md), each derivative on its own"
ACCELERATED = "cond(M) ‖a‖ + ‖M⁻¹‖ (‖τ‖ + largest joint wrench)"

DESCRIPTIONS: Mapping[str, tuple[str, str, float]] = {
    "inverse_dynamics": ("inverse dynamics", TORQUE, AGREEMENT.bound),
    "forward_dynamics": ("forward dynamics", ACCELERATED, ACCELERATION.bound),
    "everything": (
        "all accelerations and multipliers",
        "largest joint wrench; multipliers are judged",
        FORWARD_WRENCH.bound,
    ),
    "regressor": (
        "joint-torque regressor",
        "largest entry of the type of parameter, or lengths of columns",
        AGREEMENT.bound,
    ),
    "inverse_dynamics_derivatives": ("derivatives of inverse dynamics", DERIVED, AGREEMENT.bound),
    "forward_dynamics_derivatives": ("derivatives of forward dynamics", DERIVED, ACCELERATION.bound),
    "mass_matrix_inverse": ("inverse of the mass matrix", DERIVED, ACCELERATION.bound),
    "coriolis_matrix": ("Coriolis matrix", DERIVED, AGREEMENT.bound),
    "kinetic_energy": ("kinetic energy", DERIVED, AGREEMENT.bound),
    "frame_jacobian": ("frame Jacobian", DERIVED, AGREEMENT.bound),
    simulations.NAME: (simulations.TITLE, simulations.ERROR, simulations.BOUND),
    **{
        name: (call.title, *((ACCELERATED, ACCELERATION.bound) if call.forward else (TORQUE, AGREEMENT.bound)))
        for name, call in CALLS.items()
    },
    "single_inverse": ("inverse dynamics, one state per call", TORQUE, AGREEMENT.bound),
    "single_forward": ("forward dynamics, one state per call", ACCELERATED, ACCELERATION.bound),
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
    return [name for name in DESCRIPTIONS if tree or name != simulations.NAME]


def work(name: str, states: States, threads: Sequence[int], peers: Peers) -> Work:
    """A work with all its contenders."""
    if name == "single_inverse":
        contenders = single_states.inverse(states)
    elif name == "single_forward":
        contenders = single_states.forward(states)
    elif name == simulations.NAME:
        contenders = simulations.contenders(states, peers.mujoco)
    elif name in CALLS:
        contenders = calls.contenders(states, CALLS[name])
    else:
        contenders = [*OURS[name](states, threads), *PINOCCHIO[name](states, threads), *peers.contenders(name, threads)]
    title, error, bound = DESCRIPTIONS[name]
    return Work(name, title, error, bound, tuple(contenders))
