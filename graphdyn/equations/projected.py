"""The dynamics as the equations read: Eq. (111) solved as it stands, or projected onto the null space of φ_q.

The specifications (graphdyn.equations.specification) of the verbs of the dynamics.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from graphdyn.equations.joint_readings import project_accelerations
from graphdyn.equations.kinematics import MaximalState, bias_acceleration, null_space
from graphdyn.equations.specification import Arguments, Specification
from graphdyn.equations.system.chord_rows import chord_rows, pin_rows
from graphdyn.equations.system.constraints import constraints, coupling_rows
from graphdyn.equations.system.kkt import KKTSystem
from graphdyn.equations.system.reactions import in_link_axes, join_reactions, split_reactions, transmitted_wrenches
from graphdyn.equations.system.unconstrained import (
    actuator_terms,
    applied_terms,
    mass_blocks,
    mass_terms,
    passive_terms,
)
from graphdyn.errors import SingularMassMatrix, in_row
from graphdyn.layout import BODY_DOF, Array, per_body, per_joint, stacked
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import apply, solve


def forward_dynamics(x: Arguments) -> dict[str, Array]:
    """Forward dynamics from x["q"], x["v"], x["tau"], x["external_wrenches"]. Raises SingularMassMatrix."""
    state = x.rooted_state()
    n, bias = null_space(state), bias_acceleration(x.model.rooted, x["q"], x["v"], state.ground)
    mass = projected_mass(state, n)
    refuse_singular(x.model, mass.real)
    if x.dense:
        solution = kkt(state, x["tau"], x["external_wrenches"], bias).solve_unchecked()
        accelerations = per_body(solution.acceleration)
        transmitted = _at_all_joints(x.model, x["tau"], solution.coupling_multipliers)
        wrenches = join_reactions(state, solution.multipliers, transmitted)
        a = project_accelerations(state, accelerations, bias)
        return {
            "a": a,
            **_reactions(state, accelerations, solution.multipliers, wrenches),
            "coupling_multipliers": solution.coupling_multipliers,
        }
    passive = passive_terms(state, x["external_wrenches"])

    def missing(accelerations: Array) -> Array:
        return x["tau"] - apply(np.swapaxes(n, -1, -2), stacked(inertial_terms(state, accelerations) - passive))

    a = solve(mass, missing(bias))
    a = a + solve(mass, missing(bias + per_body(apply(n, a))))  # what the rounding of M left over
    accelerations = bias + per_body(apply(n, a))
    wrenches = transmitted_wrenches(state, inertial_terms(state, accelerations) - passive)
    multipliers, transmitted = split_reactions(state, wrenches)
    return {
        "a": a,
        **_reactions(state, accelerations, multipliers, wrenches),
        "coupling_multipliers": transmitted @ x.model.degrees_of_freedom.reactions.T,
    }


def inverse_dynamics(x: Arguments) -> dict[str, Array]:
    """Inverse dynamics from x["q"], x["v"], x["a"], x["external_wrenches"]; dense solves E τ - φ_qᵀλ = A q̈ - B for (τ,
    λ)."""
    state = x.rooted_state()
    assert state.acceleration is not None
    accelerations = np.broadcast_to(state.acceleration, state.velocity.shape)
    required = inertial_terms(state, accelerations) - passive_terms(state, x["external_wrenches"])
    if x.dense:
        phi_q, _ = constraints(state)
        actuators = actuator_terms(state)[..., list(x.model.degrees_of_freedom.independent)]
        transposed = (np.swapaxes(rows, -1, -2) for rows in (phi_q, coupling_rows(state)))
        unknowns = solve(np.concatenate([actuators, *(-columns for columns in transposed)], axis=-1), stacked(required))
        tau, joint_multipliers, coupling_multipliers = np.split(
            unknowns, [x.model.nv, x.model.nv + phi_q.shape[-2]], axis=-1
        )
        multipliers = per_joint(joint_multipliers)
        wrenches = join_reactions(state, multipliers, _at_all_joints(x.model, tau, coupling_multipliers))
    else:
        wrenches = transmitted_wrenches(state, required)
        multipliers, transmitted = split_reactions(state, wrenches)
        tau = transmitted @ x.model.degrees_of_freedom.matrix if x.model.couplings else transmitted
        coupling_multipliers = transmitted @ x.model.degrees_of_freedom.reactions.T
    reactions = _reactions(state, accelerations, multipliers, wrenches)
    return {"tau": tau, **reactions, "coupling_multipliers": coupling_multipliers}


def _at_all_joints(model: RobotModel, tau: Array, coupling_multipliers: Array) -> Array:
    """Torques of actuators and couplings at all joints (…, n)."""
    if not model.couplings:
        return tau
    torques = coupling_multipliers @ model.degrees_of_freedom.rows
    torques[..., list(model.degrees_of_freedom.independent)] += tau
    return torques


def mass_matrix(x: Arguments) -> dict[str, Array]:
    """M = NᵀAN (…, n, n) at x["q"]; Eq. (111) has no other form of it."""
    state = x.rooted_state()
    return {"mass_matrix": projected_mass(state, null_space(state))}


def mass_matrix_inverse(x: Arguments) -> dict[str, Array]:
    """M⁻¹ (…, n, n) at x["q"]. Raises SingularMassMatrix."""
    mass = mass_matrix(x)["mass_matrix"]
    refuse_singular(x.model, mass)
    return {"mass_matrix_inverse": np.asarray(np.linalg.inv(mass), dtype=float)}


def power(x: Arguments) -> dict[str, Array]:
    """τ_j v_j (…, n) of inverse_dynamics at x["q"], x["v"], x["a"], x["external_wrenches"]."""
    return {"power": inverse_dynamics(x)["tau"] * x["v"]}


def kinetic_energy(x: Arguments) -> dict[str, Array]:
    """T = ½ ẋᵀ A ẋ (…) of the body velocities ẋ = (ṙ, ω) at x["q"], x["v"]."""
    state = x.rooted_state()
    return {"kinetic_energy": (state.velocity * inertial_terms(state, state.velocity)).sum(axis=(-2, -1)) / 2}


def potential_energy(x: Arguments) -> dict[str, Array]:
    """U = -Σ m g·r (…) of the centers of mass at x["q"]."""
    mass = np.array([body.mass for body in x.model.bodies])
    return {"potential_energy": -(x.state().position @ x.model.gravity) @ mass}


def _reactions(state: MaximalState, accelerations: Array, multipliers: Array, wrenches: Array) -> dict[str, Array]:
    joint_wrenches = in_link_axes(state, wrenches)
    return {
        "body_accelerations": accelerations,
        "multipliers": multipliers,
        "joint_wrenches": joint_wrenches,
        "chord_multipliers": np.empty((*multipliers.shape[:-2], 0)),
    }


def torque_at_zero(name: str, *zero: str) -> Specification:
    """The torque of inverse_dynamics, under this name, with these of v and a zero."""

    def torque(x: Arguments) -> dict[str, Array]:
        nothing = np.zeros_like(x["q"])
        return {name: inverse_dynamics(x.but(**dict.fromkeys(zero, nothing)))["tau"]}

    return torque


bias_torque = torque_at_zero("bias_torque", "a")
gravity_torque = torque_at_zero("gravity_torque", "v", "a")
static_torque = torque_at_zero("static_torque", "v", "a")


def kkt(state: MaximalState, tau: Array, external_wrenches: Array, bias: Array) -> KKTSystem:
    """Eq. (111) at a state, and below its constraints those of couplings and chords; bias: Ṅ v (…, n, 6).

    With chords, the forces of the joints are along t_1, t_2, p.
    """
    phi_q, zeta = pin_rows(state) if state.model.chords else constraints(state)
    if state.model.couplings:
        rows = coupling_rows(state)
        phi_q = np.concatenate([phi_q, rows], axis=-2)
        zeta = np.concatenate([zeta, apply(rows, stacked(bias))], axis=-1)
    if state.model.chords:
        rows, right = chord_rows(state)
        phi_q, zeta = np.concatenate([phi_q, rows], axis=-2), np.concatenate([zeta, right], axis=-1)
    force = applied_terms(state, tau, external_wrenches)
    n_rows, unit = state.model.n_chord_rows, state.model.loops.in_sizes.length_unit
    return KKTSystem(mass_terms(state), phi_q, force, zeta, n_chord_rows=n_rows, length_unit=unit)


def inertial_terms(state: MaximalState, accelerations: Array) -> Array:
    """A q̈ per body (…, n, 6)."""
    terms: Array = np.einsum("iab,...ib->...ia", mass_blocks(state), accelerations)
    return terms


def projected_mass(state: MaximalState, n: Array) -> Array:
    blocks = n.reshape(*n.shape[:-2], state.model.n_bodies, BODY_DOF, n.shape[-1])
    mass = np.einsum("...iak,iab,...ibl->...kl", blocks, mass_blocks(state), blocks, optimize=True)
    symmetric: Array = (mass + np.swapaxes(mass, -1, -2)) / 2
    return symmetric


def singular(mass: Array) -> NDArray[np.bool_]:
    """Which mass matrices (…, n, n) are singular (…): scaled to unit diagonal, an eigenvalue at rounding level."""
    values, _ = _scaled_eigensystem(mass)
    sizes = np.abs(values)
    no_inertia = (np.diagonal(mass, axis1=-2, axis2=-1) == 0).any(axis=-1)
    limit = mass.shape[-1] * np.finfo(float).eps * sizes.max(axis=-1, initial=0.0)
    return np.asarray(no_inertia | (sizes.min(axis=-1, initial=np.inf) <= limit))


def refuse_singular(model: RobotModel, mass: Array, rows: Sequence[tuple[int, ...]] | None = None) -> None:
    """Raises SingularMassMatrix, naming the row and the joint, where one of the mass matrices (…, n, n) is singular.

    rows: what to call the matrices (count, n, n); their indices if left out
    """
    at_fault = singular(mass)
    if not at_fault.any():
        return
    row = tuple(np.argwhere(at_fault)[0])
    values, vectors = _scaled_eigensystem(mass[row])
    joint = int(np.abs(vectors[:, np.abs(values).argmin()]).argmax())
    massless = [body.name for body in model.bodies if body.mass == 0 or not body.inertia.any()]
    cause = f"bodies without mass or inertia: {', '.join(massless)}" if massless else "see physical_consistency()"
    where = in_row(row if rows is None else rows[row[0]])
    joint_name = model.independent_joints[joint]
    raise SingularMassMatrix(
        f"the mass matrix of robot '{model.name}' is singular{where}: joint "
        f"'{joint_name}' moves without inertia, so torques do not determine accelerations ({cause})"
    )


def _scaled_eigensystem(mass: Array) -> tuple[Array, Array]:
    diagonal = np.abs(np.diagonal(mass, axis1=-2, axis2=-1))
    scale = np.where(diagonal > 0, diagonal, 1.0) ** -0.5
    values, vectors = np.linalg.eigh(mass * scale[..., :, None] * scale[..., None, :])
    return values, vectors
