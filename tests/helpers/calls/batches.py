"""Batches whose rows are mixed, calls that are late, velocities in degrees per second."""

import numpy as np
from calls.planted import frame_of, plant

import graphdyn

KIND = "batches"


def _torques(model):
    return lambda q, v, a: graphdyn.inverse_dynamics(model, q, v, a).tau


for name, truth, aside, mixed in (
    ("first row of q", "first row", False, lambda f, q, v, a: f(np.broadcast_to(q[:1], q.shape), v, a)),
    ("first row of v", "first row", True, lambda f, q, v, a: f(q, np.broadcast_to(v[:1], q.shape), a)),
    ("row before", "row before", False, lambda f, q, v, a: f(np.roll(q, 1, axis=0), v, a)),
    ("row behind of v", "row (behind|after)", True, lambda f, q, v, a: f(q, np.roll(v, -1, axis=0), a)),
    ("answers of the row before", "row before", True, lambda f, q, v, a: np.roll(f(q, v, a), 1, axis=0)),
    ("reversed", "(reverse|opposite) order", False, lambda f, q, v, a: f(q, v, a)[::-1]),
    ("last row of a", "last row", True, lambda f, q, v, a: f(q, v, np.broadcast_to(a[-1:], q.shape))),
    ("sorted", "other rows of its batch", True, lambda f, q, v, a: np.sort(f(q, v, a), axis=0)),
    ("column by column", "other rows of its batch", False,
     lambda f, q, v, a: f(q, v, a).T.reshape(q.shape)),
    ("mean taken away", "other rows of its batch", False, lambda f, q, v, a: f(q, v - v.mean(axis=0), a)),
    ("scaled by the largest", "other rows of its batch", True,
     lambda f, q, v, a: f(q, v, np.clip(a, -np.abs(a).mean(), None))),
):  # fmt: skip

    @plant(KIND, name, "inverse_dynamics", truth, aside=aside, batched=True)
    def _mixed(model, mixed=mixed):
        f = _torques(model)
        return lambda q, v, a: mixed(f, q, v, a)


@plant(KIND, "mass matrix of the first", "mass_matrix", "first row", aside=True, batched=True)
def _first_matrix(model):
    return lambda q: np.broadcast_to(graphdyn.mass_matrix(model, q[:1]), (len(q), q.shape[1], q.shape[1]))


@plant(KIND, "inertia of the first in forward dynamics", "forward_dynamics", "first row|other rows", batched=True)
def _first_inertia(model):
    def forward_dynamics(q, v, tau):
        return np.linalg.solve(graphdyn.mass_matrix(model, q[0]), (tau - graphdyn.bias_torque(model, q, v)).T).T

    return forward_dynamics


@plant("delay", "one call", "inverse_dynamics", "call before")
def _delayed(model):
    kept = []

    def inverse_dynamics(q, v, a):
        kept.append(graphdyn.inverse_dynamics(model, q, v, a).tau)
        return kept[-2 if len(kept) > 1 else -1]

    return inverse_dynamics


@plant("delay", "two calls of a Jacobian", "center_of_mass_jacobian", "call(s)? before", aside=True)
def _delayed_jacobian(model):
    kept = []

    def center_of_mass_jacobian(q):
        kept.append(graphdyn.center_of_mass_jacobian(model, q))
        return kept[-3 if len(kept) > 2 else -1]

    return center_of_mass_jacobian


@plant("delay", "filtered velocities", "frame_velocity", "calls? before|earlier calls", aside=True)
def _filtered(model):
    frame = frame_of(model)
    kept = [np.zeros(model.n_bodies)]

    def frame_velocity(q, v):
        kept[0] = 0.5 * kept[0] + 0.5 * v
        return graphdyn.frame_velocity(model, q, kept[0], frame, reference="local")

    return frame_velocity


def _moving(model):
    frame = frame_of(model)
    return {
        "inverse_dynamics": lambda q, v, a: graphdyn.inverse_dynamics(model, q, v, a).tau,
        "forward_dynamics": lambda q, v, tau: graphdyn.forward_dynamics(model, q, v, tau).a,
        "bias_torque": lambda q, v: graphdyn.bias_torque(model, q, v),
        "power": lambda q, v, a: graphdyn.inverse_dynamics(model, q, v, a).tau * v,
        "joint_wrenches": lambda q, v, a: graphdyn.inverse_dynamics(model, q, v, a).joint_wrenches,
        "coriolis_matrix": lambda q, v: graphdyn.coriolis_matrix(model, q, v),
        "frame_velocity": lambda q, v: graphdyn.frame_velocity(model, q, v, frame, reference="local"),
        "frame_acceleration": lambda q, v, a: graphdyn.frame_acceleration(model, q, v, a, frame, reference="local"),
        "frame_jacobian_derivative": lambda q, v: graphdyn.frame_jacobian_derivative(
            model, q, v, frame, reference="local"
        ),
        "center_of_mass_velocity": lambda q, v: graphdyn.center_of_mass_velocity(model, q, v),
        "momentum": lambda q, v: graphdyn.momentum(model, q, v).about_center_of_mass,
        "kinetic_energy": lambda q, v: graphdyn.kinetic_energy(model, q, v),
        "dtau_dq": lambda q, v, a: graphdyn.inverse_dynamics_derivatives(model, q, v, a).dtau_dq,
        "dtau_dv": lambda q, v, a: graphdyn.inverse_dynamics_derivatives(model, q, v, a).dtau_dv,
        "joint_torque_regressor": lambda q, v, a: graphdyn.joint_torque_regressor(model, q, v, a),
        "body_regressor": lambda q, v, a: graphdyn.body_regressor(model, q, v, a),
        "momentum_regressor": lambda q, v: graphdyn.momentum_regressor(model, q, v),
        "kinetic_energy_regressor": lambda q, v: graphdyn.energy_regressor(model, q, v).kinetic,
    }


for number, name in enumerate(
    ("inverse_dynamics", "forward_dynamics", "bias_torque", "power", "joint_wrenches", "coriolis_matrix",
     "frame_velocity", "frame_acceleration", "frame_jacobian_derivative", "center_of_mass_velocity", "momentum",
     "kinetic_energy", "dtau_dq", "dtau_dv", "joint_torque_regressor", "body_regressor", "momentum_regressor",
     "kinetic_energy_regressor")
):  # fmt: skip
    for way, change in (("taken as degrees", np.deg2rad), ("turned into degrees", np.rad2deg)):

        @plant("degrees per second", way, name, "degree", aside=number % 3 == 2)
        def _degrees(model, name=name, change=change):
            f = _moving(model)[name]
            return lambda q, v, *x: f(q, change(v), *x)
