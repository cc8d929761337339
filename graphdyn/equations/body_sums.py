"""Center of mass and momentum as the equations read: sums over the bodies.

Specifications in the manner of graphdyn.equations.projected. There is no dense form: no multipliers are solved for.
"""

from __future__ import annotations

import numpy as np

from graphdyn.equations.kinematics import MaximalState, null_space
from graphdyn.equations.projected import inertial_terms
from graphdyn.equations.specification import Arguments
from graphdyn.layout import ANGULAR, BODY_DOF, LINEAR, Array
from graphdyn.model.robot_model import RobotModel, total_mass
from graphdyn.model.spatial import cross


def center_of_mass(x: Arguments) -> dict[str, Array]:
    """c = Σ m r / Σ m (…, 3) at x["q"]."""
    return {"center_of_mass": _mean(x.model, x.state().position)}


def center_of_mass_velocity(x: Arguments) -> dict[str, Array]:
    """ċ = Σ m ṙ / Σ m (…, 3) at x["q"], x["v"]."""
    velocity = x.rooted_state().velocity
    return {"center_of_mass_velocity": _mean(x.model, velocity[..., LINEAR])}


def center_of_mass_jacobian(x: Arguments) -> dict[str, Array]:
    """Σ m ∂ṙ/∂v / Σ m (…, 3, n) at x["q"]."""
    velocities = _per_unit_rate(x.rooted_state())
    return {"center_of_mass_jacobian": np.moveaxis(_mean(x.model, velocities[..., LINEAR]), 0, -1)}


def momentum(x: Arguments) -> dict[str, Array]:
    """Σ m ṙ, and Σ (r - c) × m ṙ + R J ω about the center of mass, Σ r × m ṙ + R J ω about the origin (…, 6 each)."""
    here, there = x.rooted_state(), x.state()
    center = _mean(x.model, here.position)[..., None, :]
    return {
        "about_center_of_mass": _momentum(here, here.position - center, here.velocity),
        "about_origin": _momentum(here, there.position, here.velocity),
    }


def centroidal_map(x: Arguments) -> dict[str, Array]:
    """(…, 6, n) at x["q"]: column j is the momentum about the center of mass that a unit velocity of joint j gives."""
    state = x.rooted_state()
    lever = state.position - _mean(x.model, state.position)[..., None, :]
    return {"centroidal_map": np.moveaxis(_momentum(state, lever, _per_unit_rate(state)), 0, -1)}


def _mean(model: RobotModel, of_bodies: Array) -> Array:
    """Σ m x / Σ m (…, 3) of a vector x of each body (…, n, 3)."""
    masses = np.array([body.mass for body in model.bodies])
    mean: Array = np.einsum("i,...ia->...a", masses, of_bodies) / total_mass(model)
    return mean


def _per_unit_rate(state: MaximalState) -> Array:
    """(freedom, …, body, 6): the body velocities that a unit velocity of each joint gives."""
    columns = null_space(state).reshape(*state.position.shape[:-1], BODY_DOF, state.model.nv)
    return np.moveaxis(columns, -1, 0)


def _momentum(state: MaximalState, lever: Array, velocity: Array) -> Array:
    """Σ m ṙ, Σ lever × m ṙ + R J ω (…, 6) of body velocities (…, n, 6)."""
    of_bodies = inertial_terms(state, velocity)
    linear, spin = of_bodies[..., LINEAR], np.einsum("...iab,...ib->...ia", state.rotation, of_bodies[..., ANGULAR])
    total: Array = np.concatenate([linear, cross(lever, linear) + spin], axis=-1).sum(axis=-2)
    return total
