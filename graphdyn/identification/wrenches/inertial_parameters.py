"""All ten inertial parameters of every body from measured joint wrenches: any tree, any tensor, any center of mass.

This goes beyond the paper, whose Eq. (49) needs principal axes and known centers of mass. The motion is computed from
q, v, a and the geometry, not from the recorded accelerations: those belong to centers of mass, which are unknowns here.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike

from graphdyn.arguments.base_motion import BaseMotion
from graphdyn.display import short_repr
from graphdyn.equations.kinematics import link_origins, maximal_state
from graphdyn.errors import InvalidInput
from graphdyn.identification.wrenches.body_wrenches import WrenchData, fitting_data, link_wrenches
from graphdyn.identification.wrenches.wrench_equations import IdentifiedBodies, WrenchEquations
from graphdyn.layout import ANGULAR, BODY_PARAMETERS, LINEAR, Array
from graphdyn.model.inertia import PARAMETER_NAMES
from graphdyn.model.robot_model import RobotModel, check_model
from graphdyn.model.spatial import apply
from graphdyn.verbs.matrices import body_regressor

_PARAMETER_KINDS = (0, 1, 1, 1, 2, 2, 2, 2, 2, 2)


@dataclass(frozen=True, eq=False)
@short_repr
class IdentifiedInertia:
    """Mass, center of mass and tensor about it of one body, in its link frame; NaN if not determined.

    mass [kg], center_of_mass (3,) [m], inertia (3, 3) [kg m²]
    """

    mass: float
    center_of_mass: Array
    inertia: Array


def identify_inertial_parameters(
    model: RobotModel, data: WrenchData, *, base: BaseMotion | None = None, precision: float | None = None
) -> IdentifiedBodies:
    """The ten parameters (Body.parameters) of every body, one body at a time [kg, kg m, kg m²].

    model: joints and gravity; its inertial parameters are not read
    base: prescribed motion of the base during the samples
    precision: relative rounding or noise of the data, estimated from the fit if left out; a parameter whose effect does
        not exceed it counts as undetermined

    Raises InvalidInput if the data do not fit the model, or are not finite.
    """
    y = body_regressor(model, *_motion(model, data), base=base, method="reproducible")
    bodies = np.arange(model.n_bodies)
    matrix = np.zeros((*y.shape[:-1], model.n_bodies, BODY_PARAMETERS))
    matrix[:, bodies, :, bodies] = np.moveaxis(y, 1, 0)
    equations = WrenchEquations(model.body_names, PARAMETER_NAMES, _PARAMETER_KINDS, matrix, link_wrenches(model, data))
    return equations.solve_by_body(precision)


def identify_inertial_parameters_together(
    model: RobotModel,
    data: WrenchData,
    *,
    measured_joints: Sequence[str] | None = None,
    base: BaseMotion | None = None,
    precision: float | None = None,
) -> IdentifiedBodies:
    """The same parameters from the wrenches of some joints alone, all bodies in one system.

    measured_joints: joints whose wrenches are used, all of them if left out. The wrench of a joint is the sum over the
        bodies outside it; with the innermost joint alone many parameters are determined only in combinations

    Raises InvalidInput for an unknown joint, and if the data do not fit the model, or are not finite.
    """
    check_model(model)
    names = model.joint_names if measured_joints is None else tuple(measured_joints)
    unknown = [name for name in names if name not in model.joint_names]
    if unknown or not names:
        what = f"there is no joint '{unknown[0]}'" if unknown else "no measured joint is given"
        raise InvalidInput(f"{what}; robot '{model.name}' has {', '.join(model.joint_names)}")
    measured = [model.joint_names.index(name) for name in names]
    matrix = joint_wrench_regressor(model, *_motion(model, data), base=base)
    right = _joint_wrenches(model, data)
    equations = WrenchEquations(
        model.body_names,
        PARAMETER_NAMES,
        _PARAMETER_KINDS,
        matrix.reshape(*right.shape, model.n_bodies, BODY_PARAMETERS)[:, measured],
        right[:, measured],
    )
    return equations.solve_together(precision)


def joint_wrench_regressor(
    model: RobotModel, q: ArrayLike, v: ArrayLike, a: ArrayLike, *, base: BaseMotion | None = None
) -> Array:
    """W (…, n, 6, 10 n): joint_wrenches = W π, π = model.inertial_parameters [N, N m]. W is block triangular.

    Row block j sums the body regressors of all bodies outside joint j, moved to O_j and rotated into link axes of j.
    q, v, a: (…, n); base: prescribed motion of the base. Raises InvalidInput.
    """
    y = body_regressor(model, q, v, a, base=base, method="reproducible")
    # relative placements: the motion of the base does not matter
    state = maximal_state(model.skeleton, q, method="reproducible")
    origins, n = link_origins(state), model.n_bodies
    path = model.graph.path_matrix()
    w = np.zeros((*y.shape[:-1], n, BODY_PARAMETERS))
    for j, i in np.argwhere(path):
        to_j = np.swapaxes(state.rotation[..., j, :, :], -1, -2)
        turn = to_j @ state.rotation[..., i, :, :]
        lever = apply(to_j, origins[..., i, :] - origins[..., j, :])
        force = turn @ y[..., i, LINEAR, :]
        w[..., j, LINEAR, i, :] = force
        w[..., j, ANGULAR, i, :] = turn @ y[..., i, ANGULAR, :] + np.cross(lever[..., None], force, axis=-2)
    return w.reshape(*y.shape[:-1], n * BODY_PARAMETERS)


def identified_inertia(identified: IdentifiedBodies, body: str) -> IdentifiedInertia:
    """Mass, center of mass and tensor about it of a body whose ten parameters were identified.

    An entry is NaN if it depends on an undetermined parameter, or if the mass is not positive.
    Raises InvalidInput for an unknown body.
    """
    pi = identified.of(body)
    mass = pi["m"] if pi["m"] > 0 else np.nan
    x, y, z = center = np.array([pi["mc_x"], pi["mc_y"], pi["mc_z"]]) / mass
    steiner = np.array(
        [[y * y + z * z, -x * y, -x * z], [-x * y, x * x + z * z, -y * z], [-x * z, -y * z, x * x + y * y]]
    )
    about_origin = np.array(
        [
            [pi["I_xx"], pi["I_xy"], pi["I_xz"]],
            [pi["I_xy"], pi["I_yy"], pi["I_yz"]],
            [pi["I_xz"], pi["I_yz"], pi["I_zz"]],
        ]
    )
    return IdentifiedInertia(pi["m"], center, about_origin - mass * steiner)


def _motion(model: RobotModel, data: WrenchData) -> tuple[Array, Array, Array]:
    """Motion q, v, a (N, n) of the data."""
    x = fitting_data(model, data, "q", "v", "a", "rotation")
    return x["q"], x["v"], x["a"]


def _joint_wrenches(model: RobotModel, data: WrenchData) -> Array:
    """Force and moment on body j at O_j, from world axes to link axes (N, n, 6)."""
    x = fitting_data(model, data, "rotation", "joint_forces", "joint_moments")
    parts = [np.einsum("...iba,...ib->...ia", x["rotation"], x[name]) for name in ("joint_forces", "joint_moments")]
    return np.concatenate(parts, axis=-1)
