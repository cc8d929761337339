"""How the errors of the quantities are measured that are compared at the first random states.

Every function returns one relative error per sample (N,): ‖x - reference‖∞ over a scale that cannot vanish.
"""

from __future__ import annotations

import numpy as np

from crosscheck.quantities.derived_answers import Answers
from crosscheck.quantities.scales import (
    PARAMETER_TYPES,
    acceleration_scale,
    by_parameter_type,
    by_part,
    center_offset,
    largest,
    largest_tensor,
    ratio,
    relative,
    term_sizes,
)
from crosscheck.quantities.states import Case, has_mass
from crosscheck.reference.frame_choices import FRAME_REFERENCES, compared_frames
from crosscheck.reference.reference_values import RefereeValues
from graphdyn import inverse_dynamics
from graphdyn.layout import BODY_PARAMETERS, Array


def derived_errors(case: Case, ours: Answers, ref: RefereeValues, theirs: Answers) -> dict[str, Array]:
    """Errors of the quantities that need no regular mass matrix."""
    return {
        **_dynamics_errors(case, ours, ref, theirs),
        **_reaction_errors(case, ours, ref, theirs),
        **_frame_errors(case, ours, ref, theirs),
        **_regressor_errors(case, ours, ref, theirs),
        **(_momentum_errors(case, ours, ref, theirs) if has_mass(case.model) else {}),
    }


def _dynamics_errors(case: Case, ours: Answers, ref: RefereeValues, theirs: Answers) -> dict[str, Array]:
    model = case.model
    size = term_sizes(model, case.v, case.a, ref.position, ref.velocity, ref.acceleration)
    by_rate = largest(ref.mass_matrix) * largest(case.v)
    weight = float(np.linalg.norm(model.gravity)) * sum(body.mass for body in model.bodies)
    rest = np.zeros_like(case.q)
    at_rest = inverse_dynamics(model, case.q, rest, rest, case.external_wrenches).joint_wrenches
    torque = np.maximum(largest(ref.joint_wrenches_external), size.spin)
    scales = {
        "dtau_dq": (largest(ref.joint_wrenches), size.spin),
        "dtau_dv": (by_rate,),
        "coriolis_matrix": (by_rate,),
        "static_torque": (largest(at_rest),),
        "power": (torque * largest(case.v),),
        "kinetic_energy": (),
        "potential_energy": (weight * (largest(ref.position) + center_offset(model)),),
    }
    return {name: relative(ours[name], theirs[name], *sizes) for name, sizes in scales.items()}


def _reaction_errors(case: Case, ours: Answers, ref: RefereeValues, theirs: Answers) -> dict[str, Array]:
    """Forces and moments per unit of q, v, a, on the scale of their terms."""
    size = term_sizes(case.model, case.v, case.a, ref.position, ref.velocity, ref.acceleration)
    mass, tensor = sum(body.mass for body in case.model.bodies), np.full(len(case.q), largest_tensor(case.model))
    forces = {
        "q": mass * np.maximum(size.compensated, size.turn * size.arm),
        "v": 2 * mass * (size.omega * size.arm + size.slide_rate),
        "a": mass * size.arm,
    }
    spins = {"q": size.spin, "v": 2 * tensor * size.omega, "a": tensor}
    errors = {}
    for name, force in forces.items():
        moment = force * size.arm + spins[name]
        wrenches, multipliers = f"dwrenches_d{name}", f"dmultipliers_d{name}"
        here, there = (np.swapaxes(x[wrenches], -1, -2) for x in (ours, theirs))  # the wrench comes last
        errors[wrenches] = by_part(here, there, force, moment)
        errors[multipliers] = relative(ours[multipliers], theirs[multipliers], force, moment)
    return errors


def _frame_errors(case: Case, ours: Answers, ref: RefereeValues, theirs: Answers) -> dict[str, Array]:
    """The largest error of all references and frames, of linear and angular part each on its own scale."""
    model = case.model
    size = term_sizes(model, case.v, case.a, ref.position, ref.velocity, ref.acceleration)
    from_link = max(float(np.abs(model.frame(name).placement.translation).max()) for name in compared_frames(model))
    from_world = float(np.abs(model.base.translation).max())
    errors: dict[str, Array] = {}
    for k, reference in enumerate(FRAME_REFERENCES):
        there = size.farther(from_world if reference == "world" else from_link)
        scales = {
            "frame_jacobian": (there.arm, np.ones_like(there.arm)),
            "frame_velocity": (there.velocity, 0 * there.omega),
            "frame_acceleration": (there.acceleration, there.turn),
            "frame_acceleration_spatial": (there.acceleration, there.turn),
            "frame_jacobian_derivative": (there.omega * there.arm + there.slide_rate, there.omega),
        }
        for name, sizes in scales.items():
            x, y = ours[name][:, k], theirs[name][:, k]
            if "jacobian" in name:  # the parts come last
                x, y = np.swapaxes(x, -1, -2), np.swapaxes(y, -1, -2)
            errors[name] = np.maximum(errors.get(name, 0.0), by_part(x, y, *sizes))
    return errors


def _regressor_errors(case: Case, ours: Answers, ref: RefereeValues, theirs: Answers) -> dict[str, Array]:
    """Columns of m, of m c and of I, each on its own scale."""
    model = case.model
    size = term_sizes(model, case.v, case.a, ref.position, ref.velocity, ref.acceleration)
    gravity = np.full(len(case.q), np.linalg.norm(model.gravity))
    rate = size.omega * size.arm + size.slide_rate
    scales = {
        "kinetic_energy_regressor": (size.velocity**2, size.velocity * size.omega, size.omega**2),
        "potential_energy_regressor": (
            gravity * (largest(ref.position) + center_offset(model)),
            gravity,
            0 * rate,
        ),
        "momentum_regressor": (rate * size.arm, rate, size.omega),
    }
    return {name: by_parameter_type(ours[name], theirs[name], *sizes) for name, sizes in scales.items()}


def _momentum_errors(case: Case, ours: Answers, ref: RefereeValues, theirs: Answers) -> dict[str, Array]:
    model = case.model
    size = term_sizes(model, case.v, case.a, ref.position, ref.velocity, ref.acceleration)
    mass, tensor = sum(body.mass for body in model.bodies), largest_tensor(model)
    linear, spin = mass * size.velocity, tensor * size.omega
    from_origin = size.lever + float(np.abs(model.base.translation).max())
    here, there = (np.swapaxes(x["centroidal_map"], -1, -2) for x in (ours, theirs))  # the momentum comes last
    momenta = {
        "centroidal_momentum": (linear, linear * size.lever + spin),
        "momentum_about_origin": (linear, linear * from_origin + spin),
    }
    return {
        "center_of_mass": relative(
            ours["center_of_mass"], theirs["center_of_mass"], largest(ref.position) + center_offset(model)
        ),
        "center_of_mass_velocity": relative(
            ours["center_of_mass_velocity"], theirs["center_of_mass_velocity"], size.velocity
        ),
        "center_of_mass_jacobian": relative(
            ours["center_of_mass_jacobian"], theirs["center_of_mass_jacobian"], size.arm
        ),
        **{name: by_part(ours[name], theirs[name], *sizes) for name, sizes in momenta.items()},
        "centroidal_map": by_part(here, there, mass * size.arm, mass * size.arm * size.lever + tensor),
    }


def second_errors(case: Case, ours: Answers, ref: RefereeValues, theirs: Answers) -> dict[str, Array]:
    """Errors of the second derivatives of the torques."""
    size = term_sizes(case.model, case.v, case.a, ref.position, ref.velocity, ref.acceleration)
    mass = largest(ref.mass_matrix)
    scales = {
        "d2tau_dqdq": (largest(ref.joint_wrenches), size.spin),
        "d2tau_dqdv": (mass * largest(case.v),),
        "d2tau_dqda": (mass,),
        "d2tau_dvdv": (mass * np.maximum(1.0, largest(case.v)),),  # the plain form takes differences of unit steps
    }
    return {name: relative(ours[name], theirs[name], *sizes) for name, sizes in scales.items()}


def derived_forward_errors(
    case: Case, tau: Array, ours: Answers, ref: RefereeValues, theirs: Answers
) -> dict[str, Array]:
    """Errors of the quantities that need a regular mass matrix, at the torques tau (N, n)."""
    mass, wrenches = ref.mass_matrix, ref.a_wrenches
    inverted = acceleration_scale(mass, theirs["mass_matrix_inverse"], 0 * tau, 0 * wrenches)
    scales = {
        "da_dq": acceleration_scale(mass, theirs["da_dq"], theirs["dtau_dq"], wrenches),
        "da_dv": acceleration_scale(mass, theirs["da_dv"], theirs["dtau_dv"], wrenches),
        "da_dtau": inverted,
        "mass_matrix_inverse": inverted,
    }
    errors = {name: ratio(largest(ours[name] - theirs[name]), scale) for name, scale in scales.items()}
    return {**errors, "da_dpi": _parameter_errors(case, tau, ours["da_dpi"], ref, theirs["da_dpi"])}


def _parameter_errors(case: Case, tau: Array, ours: Array, ref: RefereeValues, theirs: Array) -> Array:
    """The largest error of the columns of m, of m c and of I of -M⁻¹ W, each on its own scale."""
    size = term_sizes(case.model, case.v, ref.a, ref.position, ref.velocity, ref.a_body_accelerations)
    ours, theirs = (x.reshape(*tau.shape, -1, BODY_PARAMETERS) for x in (ours, theirs))
    errors = []
    for part, column in zip(PARAMETER_TYPES, size.regressor_columns, strict=True):
        scale = acceleration_scale(ref.mass_matrix, theirs[..., part], column, 0 * tau)
        errors.append(ratio(largest((ours - theirs)[..., part]), scale))
    found: Array = np.maximum.reduce(errors)
    return found
