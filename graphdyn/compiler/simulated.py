"""Programs that a simulation runs at every step: the accelerations of a robot with its drives, and control laws.

What other simulations of the same robot may choose otherwise is an input here, so that it needs no compiling.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from graphdyn.compiler.programs import Request, Sample
from graphdyn.layout import BODY_PARAMETERS, Array
from graphdyn.model.robot_model import RobotModel
from graphdyn.recursions.forward import Drives, forward_dynamics
from graphdyn.recursions.inverse import inverse_dynamics
from graphdyn.recursions.loops.chords import rows_of_chords
from graphdyn.recursions.loops.closed_motions import closed_accelerations, closed_motions
from graphdyn.recursions.loops.couplings import driven, everywhere, projected
from graphdyn.recursions.mechanism.mechanism import Link, links
from graphdyn.scalars.expressions import Expression, Program
from graphdyn.scalars.vectors import scalars

Law = Literal["pd", "computed_torque"]

TENSOR_INDEX = ((0, 1, 3), (1, 2, 4), (3, 4, 5))
"""Indices of the tensor's entries among I_xx, I_xy, I_yy, I_xz, I_yz, I_zz."""


@dataclass(frozen=True)
class Inputs:
    """Which inputs the accelerations have beside q, v and tau, the torque on the bodies.

    external: external_wrenches (6 n); moving_base: ground
    parameters: the ten of each body in joint axes (10 n), see in_joint_axes
    rotor: inertia of each rotor (n)
    free: 1 or 0 per joint, 0 where friction holds it (n)
    """

    external: bool = False
    moving_base: bool = False
    parameters: bool = False
    rotor: bool = False
    free: bool = False


def record_accelerations(model: RobotModel, inputs: Inputs, least_distance: float = 0.0) -> Program:
    """a (n), and required (n): the torque that holds the joints that are not free, tau elsewhere.

    With loops a, and certain, which is above zero where the distance from a singular pose is above the least.
    """
    outputs = ("a", "required")  # of links that are not reduced, whose errors over long motions are documented
    sample = Sample(model, Request("forward_dynamics", outputs, inputs.external, inputs.moving_base))
    n = sample.n
    bodies = sample.links
    if inputs.parameters:
        columns = sample.input("parameters", BODY_PARAMETERS * model.n_bodies)
        bodies = tuple(
            _with_parameters(link, columns[BODY_PARAMETERS * i : BODY_PARAMETERS * (i + 1)])
            for i, link in enumerate(bodies)
        )
    drives = Drives(
        sample.input("rotor") if inputs.rotor else [0.0] * n, sample.input("free") if inputs.free else [1.0] * n
    )
    v, tau = sample.of_joints("v"), sample.input("tau")
    if model.chords:
        a, held = closed_accelerations(model, bodies, sample.root, sample.q, v, tau, sample.external, drives.rotor)
        return _program(sample, {"a": list(a), "certain": held.certain(least_distance)})
    if model.couplings:
        found = driven(bodies, sample.root, model.degrees_of_freedom, sample.q, v, tau, sample.external, drives=drives)
    else:
        found = forward_dynamics(bodies, sample.root, sample.q, v, tau, sample.external, drives=drives)
    return _program(sample, {name: found[name] for name in ("a", "required")})


def record_rows(model: RobotModel) -> Program:
    """The rows of all chords that some joint moves, in their units: jacobian (k n), bias (k), gaps (k) at q and v.

    agreeing: above zero unless an end is flipped
    """
    sample = Sample(model, Request("forward_dynamics", ("a",)))
    rows = rows_of_chords(model, sample.links, sample.q, sample.of_joints("v"))
    jacobian = np.concatenate([row.jacobian for row in rows]) @ scalars(model.degrees_of_freedom.matrix)
    outputs = {
        "jacobian": list(jacobian.ravel()),
        "bias": [x for row in rows for x in row.bias],
        "gaps": [x for row in rows for x in row.gap],
        "agreeing": [x for row in rows for x in row.agreeing],
    }
    return _program(sample, outputs)


def record_closing(model: RobotModel, least_distance: float, last_gap: float) -> tuple[Program, Program]:
    """The programs of a ClosingCode: Newton steps from gaps below the last one leave rounding."""
    request = Request("forward_dynamics", ("a",))
    sample = Sample(model, request)
    held = closed_motions(model, sample.links, sample.q, sample.zeros)
    gaps = np.concatenate([rows.gap for rows in held.rows])
    step = held.particular(gaps)
    position = {
        "q": list(np.array(sample.recorder.inputs("q", sample.n), dtype=object) - (step - held.nearest(step))),
        "closed": [1.0 - gap * gap * (1.0 / last_gap**2) for gap in gaps],
        "certain": [
            *held.certain(least_distance),
            *(x for rows in held.rows for x in rows.agreeing if isinstance(x, Expression)),
        ],
    }
    of_velocities = Sample(model, request)
    held = closed_motions(model, of_velocities.links, of_velocities.q, of_velocities.zeros)
    velocity = {
        "v": list(held.nearest(np.array(of_velocities.input("v"), dtype=object))),
        "certain": held.certain(least_distance),
    }
    return _program(sample, position), _program(of_velocities, velocity)


def _program(sample: Sample, outputs: dict[str, list[Any]]) -> Program:
    return sample.recorder.program(sample.of_degrees_of_freedom(outputs, {}), {})


def record_law(model: RobotModel, law: Law) -> Program:
    """tau (n) of measured q and v, the reference (q, v, a or torque; 3 n) and the gains K_p, K_d (2 n).

    "pd": K_p (q_d - q) + K_d (v_d - v) + the torque of the reference
    "computed_torque": the inverse dynamics of a_d + K_p (q_d - q) + K_d (v_d - v)
    """
    sample = Sample(model, Request("inverse_dynamics", ("tau",)))
    n, v, degrees_of_freedom = sample.n, sample.of_joints("v"), model.degrees_of_freedom if model.couplings else None
    reference, gains = sample.input("reference", 3 * n), sample.input("gains", 2 * n)
    wanted = [
        reference[2 * n + j] + gains[j] * (reference[j] - sample.q[k]) + gains[n + j] * (reference[n + j] - v[k])
        for j, k in enumerate(model.degrees_of_freedom.independent)
    ]
    if law == "computed_torque":
        a = everywhere(np.array(wanted, dtype=object), degrees_of_freedom)
        tau = np.array(inverse_dynamics(sample.links, sample.root, sample.q, v, a)["tau"], dtype=object)
        wanted = list(projected(tau, ("n",), degrees_of_freedom))
    return _program(sample, {"tau": wanted})


def in_joint_axes(model: RobotModel, parameters: Array) -> Array:
    """Inertial parameters (…, 10 n) as the program takes them: m, m c, I about O_j, in joint axes of each body."""
    bodies = parameters.reshape(*parameters.shape[:-1], model.n_bodies, BODY_PARAMETERS)
    turned = bodies.copy()
    for i, link in enumerate(links(model)):
        axes = link.link_axes.astype(float)
        tensor = axes.T @ bodies[..., i, 4:][..., np.array(TENSOR_INDEX)] @ axes
        turned[..., i, 1:4] = bodies[..., i, 1:4] @ axes
        turned[..., i, 4:] = tensor[..., [0, 0, 1, 0, 1, 2], [0, 1, 1, 2, 2, 2]]
    return turned.reshape(parameters.shape)


def _with_parameters(link: Link, columns: Sequence[Any]) -> Link:
    """The body with expressions as parameters. Its center of mass is not there: no acceleration of it is asked for."""
    moment = np.array(columns[1:4], dtype=object)
    tensor = np.array([[columns[4 + k] for k in row] for row in TENSOR_INDEX], dtype=object)
    return replace(link, mass=columns[0], first_moment=moment, tensor=tensor)
