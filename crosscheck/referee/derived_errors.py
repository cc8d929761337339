"""How the errors of the quantities are measured that are compared at the first random states.

Every function returns one relative error per sample (N,): ‖x - reference‖∞ over a scale that cannot vanish.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from crosscheck.referee.reference_values import RefereeValues
from crosscheck.referee.scales import acceleration_scale, center_offset, largest, ratio, relative, term_sizes
from crosscheck.referee.states import Case
from graphdyn.layout import Array


def derived_errors(
    case: Case, ours: Mapping[str, Array], ref: RefereeValues, derived: Mapping[str, Array]
) -> dict[str, Array]:
    """Errors of derivatives, matrices and energies, of those that need no regular mass matrix."""
    model = case.model
    size = term_sizes(model, case.v, case.a, ref.position, ref.velocity, ref.acceleration)
    by_rate = largest(ref.mass_matrix) * largest(case.v)
    weight = float(np.linalg.norm(model.gravity)) * sum(body.mass for body in model.bodies)
    scales = {
        "dtau_dq": (largest(ref.joint_wrenches), size.spin),
        "dtau_dv": (by_rate,),
        "coriolis_matrix": (by_rate,),
        "kinetic_energy": (),
        "potential_energy": (weight * (largest(ref.position) + center_offset(model)),),
    }
    return {name: relative(ours[name], derived[name], *sizes) for name, sizes in scales.items()}


def derived_forward_errors(
    tau: Array, ours: Mapping[str, Array], ref: RefereeValues, derived: Mapping[str, Array]
) -> dict[str, Array]:
    """Errors of derivatives and matrices that need a regular mass matrix, at the torques tau (N, n)."""
    mass, wrenches = ref.mass_matrix, ref.a_wrenches
    inverted = acceleration_scale(mass, derived["mass_matrix_inverse"], 0 * tau, 0 * wrenches)
    scales = {
        "da_dq": acceleration_scale(mass, derived["da_dq"], derived["dtau_dq"], wrenches),
        "da_dv": acceleration_scale(mass, derived["da_dv"], derived["dtau_dv"], wrenches),
        "da_dtau": inverted,
        "mass_matrix_inverse": inverted,
    }
    return {name: ratio(largest(ours[name] - derived[name]), scale) for name, scale in scales.items()}
