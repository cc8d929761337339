"""Neutral witnesses: finite differences, energy and momentum from masses and velocities; no dynamics is solved here."""

import numpy as np
from scipy.spatial.transform import Rotation

from graphdyn import MaximalState, maximal_state

STEP = 1e-3
"""Of first differences: truncation h⁶f⁽⁷⁾/140 and rounding eps·f/h meet near 1e-13 for motions of some rad/s."""

STEP_OF_SECOND = 5e-3
"""Of second differences: truncation h⁶f⁽⁸⁾/560 and rounding eps·f/h² meet near 5e-11 for motions of some rad/s."""


def derivative(f, step=STEP):
    """f'(0) with the central difference of sixth order."""
    d1, d2, d3 = (np.asarray(f(k * step)) - np.asarray(f(-k * step)) for k in (1, 2, 3))
    return (45 * d1 - 9 * d2 + d3) / (60 * step)


def second_derivative(f, step=STEP_OF_SECOND):
    """f''(0) with the central difference of sixth order."""
    s1, s2, s3 = (np.asarray(f(k * step)) + np.asarray(f(-k * step)) for k in (1, 2, 3))
    return (2 * s3 - 27 * s2 + 270 * s1 - 490 * np.asarray(f(0.0))) / (180 * step**2)


def relative_error(value, reference, *sizes):
    """‖value - reference‖∞ by the largest entry of the reference or of the terms that were summed."""
    value, reference = np.asarray(value), np.asarray(reference)
    assert value.shape == reference.shape
    scale = max(float(np.abs(x).max(initial=0.0)) for x in (reference, *sizes))
    return float(np.abs(value - reference).max(initial=0.0)) / (scale or 1.0)


def axial(matrix):
    """a of the skew part of a matrix: the inverse of ã. (…, 3, 3) → (…, 3)."""
    skew = (matrix - np.swapaxes(matrix, -1, -2)) / 2
    return np.stack([skew[..., 2, 1], skew[..., 0, 2], skew[..., 1, 0]], axis=-1)


def exponential(vectors):
    """exp(ã) of vectors (n, 3), by scipy."""
    return Rotation.from_rotvec(vectors).as_matrix()


def displaced(state, shift, turn, velocity=None):
    """The state with every body moved by shift (n, 3), world axes, and turned by exp(turn) (n, 3), body axes."""
    return MaximalState(
        state.model,
        state.position + shift,
        state.rotation @ exponential(turn),
        state.velocity if velocity is None else velocity,
    )


def off_manifold(state, seed):
    """Bodies torn out of their joints and given velocities that the joints do not allow."""
    rng, n = np.random.default_rng(seed), state.model.n_bodies
    shift, turn = rng.uniform(-0.3, 0.3, (2, n, 3))
    return displaced(state, shift, turn, rng.uniform(-1, 1, (n, 6)))


def world_wrenches(state, in_link_axes):
    """Forces and moments (…, n, 6) from link axes to world axes."""
    parts = np.split(in_link_axes, 2, axis=-1)
    return np.concatenate([np.einsum("...iab,...ib->...ia", state.rotation, x) for x in parts], axis=-1)


def origins(state):
    """O_j = r_j - R_j c_j (…, n, 3)."""
    centers = np.stack([body.center_of_mass for body in state.model.bodies])
    return state.position - np.einsum("...iab,ib->...ia", state.rotation, centers)


def twists_at_origins(state):
    """Velocity of O_j and ω_j in link axes (…, n, 6): what the power of a wrench at O_j is measured with."""
    centers = np.stack([body.center_of_mass for body in state.model.bodies])
    linear = np.einsum("...iba,...ib->...ia", state.rotation, state.velocity[..., :3])
    omega = state.velocity[..., 3:]
    return np.concatenate([linear - np.cross(omega, centers), omega], axis=-1)


def masses(model):
    return np.array([body.mass for body in model.bodies])


def kinetic_energy(model, q, v):
    """½ Σ m |ṙ|² + ωᵀJω (…) [J]."""
    twist = maximal_state(model, q, v).velocity
    linear, omega = twist[..., :3], twist[..., 3:]
    tensors = np.stack([body.inertia for body in model.bodies])
    turning = np.einsum("...ia,iab,...ib->...", omega, tensors, omega)
    return (np.einsum("i,...ia,...ia->...", masses(model), linear, linear) + turning) / 2


def potential_energy(model, q):
    """-Σ m g·r (…) [J]."""
    return -np.einsum("i,...ia,a->...", masses(model), maximal_state(model, q).position, model.gravity)


def momenta(model, q, v):
    """m ṙ and r × m ṙ + R J ω of each body (n, 6): linear momentum, angular momentum about the world origin."""
    s = maximal_state(model, q, v)
    tensors = np.stack([body.inertia for body in model.bodies])
    linear = masses(model)[:, None] * s.velocity[:, :3]
    spin = np.einsum("iab,ibc,ic->ia", s.rotation, tensors, s.velocity[:, 3:])
    return np.concatenate([linear, np.cross(s.position, linear) + spin], axis=-1)


def outside_of(model, j):
    """Numbers of the bodies that joint j carries, body j included: by walking, without the path matrix."""
    carried = {j}
    for k, joint in enumerate(model.joints, start=1):
        if joint.inside in carried:
            carried.add(k)
    return sorted(carried)


def acceleration_scale(mass_matrix, a, tau, wrenches):
    """What one eps of rounding in M, τ and the wrenches does to the accelerations: cond(M)‖a‖ + ‖M⁻¹‖(‖τ‖ + ‖w‖)."""
    inverse = np.abs(np.linalg.inv(mass_matrix)).sum(axis=-1).max()
    forces = np.abs(tau).max() + np.abs(wrenches).max()
    return np.linalg.cond(mass_matrix) * np.abs(a).max() + inverse * forces
