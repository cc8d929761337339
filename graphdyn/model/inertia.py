"""Inertia of one rigid body: the ten parameters, the pseudo-inertia matrix, and what a real body can have."""

from dataclasses import dataclass

import numpy as np

from graphdyn.display import short_repr
from graphdyn.layout import Array

TRIANGLE_TOLERANCE_SHARE = 1e-12
"""A triangle inequality violated by less than this part of the trace is rounding, not a finding."""

PARAMETER_NAMES = ("m", "mc_x", "mc_y", "mc_z", "I_xx", "I_xy", "I_yy", "I_xz", "I_yz", "I_zz")
_TENSOR_ENTRIES = ((0, 0), (0, 1), (1, 1), (0, 2), (1, 2), (2, 2))


@dataclass(frozen=True)
@short_repr
class Consistency:
    """Verdict on one body's inertials.

    pseudo_inertia_eigenvalue: smallest eigenvalue of the 4×4 pseudo-inertia matrix; a real body has it ≥ 0
    problems: sentences; empty where a real body can have these inertials
    """

    body: str
    pseudo_inertia_eigenvalue: float
    problems: tuple[str, ...]

    @property
    def consistent(self) -> bool:
        """A real body can have these inertials."""
        return not self.problems


def parallel_axis(mass: float, offset: Array) -> Array:
    """m (c·c E - c cᵀ): what a point mass at offset c adds to the tensor (3, 3) [kg m²]."""
    return mass * (offset @ offset * np.eye(3) - np.outer(offset, offset))


def parameters_from_inertia(mass: float, center_of_mass: Array, inertia: Array) -> Array:
    """(10,) from mass, center of mass and the tensor about it, all in link axes."""
    about_origin = inertia + parallel_axis(mass, center_of_mass)
    return np.array([mass, *(mass * center_of_mass), *(about_origin[k] for k in _TENSOR_ENTRIES)])


def inertia_from_parameters(parameters: Array) -> tuple[float, Array, Array]:
    """mass, center of mass (3,) and the tensor about it (3, 3); the inverse of parameters_from_inertia."""
    mass = float(parameters[0])
    center = parameters[1:4] / mass if mass != 0 else np.zeros(3)
    about_origin = np.empty((3, 3))
    for value, (row, column) in zip(parameters[4:], _TENSOR_ENTRIES, strict=True):
        about_origin[row, column] = about_origin[column, row] = value
    return mass, center, about_origin - parallel_axis(mass, center)


def pseudo_inertia(mass: float, center_of_mass: Array, inertia: Array) -> Array:
    """4×4 matrix [∫x xᵀdm, m c; m cᵀ, m] about the link origin; positive definite for a real body.

    Wensing, Kim and Slotine, "Linear matrix inequalities for physically consistent inertial parameter
    identification", IEEE Robotics and Automation Letters 3(1), 2018.
    """
    return pseudo_inertia_from_parameters(parameters_from_inertia(mass, center_of_mass, inertia))


def pseudo_inertia_from_parameters(parameters: Array) -> Array:
    """The pseudo-inertia matrices (…, 4, 4) of ten parameters each (…, 10); linear."""
    about_origin = np.empty((*parameters.shape[:-1], 3, 3))
    for k, (row, column) in enumerate(_TENSOR_ENTRIES, start=4):
        about_origin[..., row, column] = about_origin[..., column, row] = parameters[..., k]
    matrix = np.empty((*parameters.shape[:-1], 4, 4))
    half_trace = np.trace(about_origin, axis1=-2, axis2=-1)[..., None, None] / 2
    matrix[..., :3, :3] = half_trace * np.eye(3) - about_origin
    matrix[..., :3, 3] = matrix[..., 3, :3] = parameters[..., 1:4]
    matrix[..., 3, 3] = parameters[..., 0]
    return matrix


def parameters_from_pseudo_inertia(matrix: Array) -> Array:
    """(…, 10) from symmetric (…, 4, 4); the inverse of pseudo_inertia_from_parameters."""
    second_moments = matrix[..., :3, :3]
    trace = np.trace(second_moments, axis1=-2, axis2=-1)[..., None, None]
    about_origin = trace * np.eye(3) - second_moments
    entries = [about_origin[..., row, column] for row, column in _TENSOR_ENTRIES]
    return np.stack([matrix[..., 3, 3], *np.moveaxis(matrix[..., :3, 3], -1, 0), *entries], axis=-1)


def consistency_problems(mass: float, inertia: Array) -> tuple[str, ...]:
    """Sentences on why no real body has this mass and this tensor about its center of mass; empty if one can."""
    problems = []
    moments = np.linalg.eigvalsh(inertia)
    size = float(np.abs(moments).sum())
    if mass == 0:
        problems.append("mass is zero" if size == 0 else "mass is zero but the inertia tensor is not")
    if size == 0 and mass > 0:
        problems.append("inertia tensor is zero: a point mass")
    elif moments[0] <= TRIANGLE_TOLERANCE_SHARE * size and size > 0:
        problems.append(f"inertia tensor is not positive definite (smallest principal moment {moments[0]:.3g} kg m²)")
    excess = moments[2] - moments[0] - moments[1]
    if size > 0 and excess > TRIANGLE_TOLERANCE_SHARE * size:
        problems.append(
            f"triangle inequality violated: principal moment {moments[2]:.3g} exceeds the sum "
            f"{moments[0] + moments[1]:.3g} kg m² of the others"
        )
    return tuple(problems)
