"""Masses and principal moments of inertia from measured joint wrenches, Eq. (40)-(64).

Every body is independent: its equations contain the measured wrenches of its own joints, and no parameter of another
body. It therefore does not matter whether bodies are solved from outside to inside, as in section 3.1, or all at once.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.identification.wrenches.body_wrenches import WrenchData, body_wrenches, fitting_data
from graphdyn.identification.wrenches.wrench_equations import IdentifiedBodies, WrenchEquations
from graphdyn.layout import ANGULAR, LINEAR, Array
from graphdyn.model.robot_model import RobotModel

PRINCIPAL_PARAMETER_NAMES = ("m(e_1)", "m(e_2)", "m(e_3)", "J_11", "J_22", "J_33")
"""X_i of Eq. (51): the mass from each world direction, then the moments of inertia about the body axes."""

_PRINCIPAL_KINDS = (0, 0, 0, 1, 1, 1)


def mass_rows(acceleration: ArrayLike, gravity: ArrayLike) -> Array:
    """R_i = diag(r̈_i - g) (…, 3, 3) [m/s²], Eq. (44). With g along -e_3 its last entry is z̈ + 9.8 (A6).

    acceleration: r̈ of the center of mass (…, 3), gravity: g (3,); world axes
    """
    compensated: Array = np.asarray(acceleration, dtype=float) - np.asarray(gravity, dtype=float)
    return compensated[..., None] * np.eye(3)


def moment_rows(angular_velocity: ArrayLike, angular_acceleration: ArrayLike) -> Array:
    """S_i (…, 3, 3) with S_i (J_11, J_22, J_33) = J ω̇ + ω × J ω, Eq. (48) [rad/s²]. ω, ω̇ (…, 3) in body axes."""
    omega, alpha = np.asarray(angular_velocity, dtype=float), np.asarray(angular_acceleration, dtype=float)
    w1, w2, w3 = omega[..., 0], omega[..., 1], omega[..., 2]
    rows = [
        [alpha[..., 0], -w2 * w3, w2 * w3],
        [w1 * w3, alpha[..., 1], -w1 * w3],
        [-w1 * w2, w1 * w2, alpha[..., 2]],
    ]
    return np.stack([np.stack(row, axis=-1) for row in rows], axis=-2)


def principal_regressor(model: RobotModel, data: WrenchData) -> Array:
    """Y_i (N, n, 6, 6) with Y_i X_i = Z_i, Eq. (50)-(51): mass rows in world axes, moment rows in body axes.

    Raises InvalidInput if the data do not fit the model, or are not finite.
    """
    x = fitting_data(model, data, "rotation", "acceleration", "angular_velocity", "angular_acceleration")
    omega, alpha = (
        np.einsum("...iba,...ib->...ia", x["rotation"], x[name])
        for name in ("angular_velocity", "angular_acceleration")
    )
    y = np.zeros((*omega.shape[:-1], 6, 6))
    y[..., LINEAR, LINEAR] = mass_rows(x["acceleration"], model.gravity)
    y[..., ANGULAR, ANGULAR] = moment_rows(omega, alpha)
    return y


def identify_principal_parameters(
    model: RobotModel, data: WrenchData, *, precision: float | None = None
) -> IdentifiedBodies:
    """m(e_1), m(e_2), m(e_3), J_11, J_22, J_33 of every body, one body at a time, Eq. (52)-(56) [kg, kg m²].

    model: joints, centers of mass and gravity; link axes along the principal axes of inertia. Its masses and moments
        are not read
    precision: relative rounding or noise of the data, estimated from the fit if left out; a parameter whose effect does
        not exceed it counts as undetermined

    Raises InvalidInput if the data do not fit the model, or are not finite.
    """
    return _equations(model, data).solve_by_body(precision)


def identify_principal_parameters_together(
    model: RobotModel, data: WrenchData, *, precision: float | None = None
) -> IdentifiedBodies:
    """The same numbers from one block-diagonal system of all bodies, Eq. (57)-(64)."""
    return _equations(model, data).solve_together(precision)


def _equations(model: RobotModel, data: WrenchData) -> WrenchEquations:
    y = principal_regressor(model, data)
    bodies = np.arange(model.n_bodies)
    matrix = np.zeros((*y.shape[:-1], *y.shape[1:3]))  # (59): block diagonal
    matrix[:, bodies, :, bodies] = np.moveaxis(y, 1, 0)
    right = np.concatenate(body_wrenches(model, data), axis=-1)
    return WrenchEquations(model.body_names, PRINCIPAL_PARAMETER_NAMES, _PRINCIPAL_KINDS, matrix, right)
