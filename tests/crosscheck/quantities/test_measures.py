"""What errors are relative to: for every quantity the scale that its row states in words, from the terms themselves."""

from dataclasses import replace

import numpy as np
import pytest
from planting import mixed_tree

from crosscheck.quantities import QUANTITIES
from crosscheck.quantities.measures import acceleration_bound, largest_wrench
from crosscheck.quantities.scaled_states import ScaledStates
from crosscheck.quantities.scales import acceleration_scale, term_sizes
from crosscheck.quantities.system import solution
from graphdyn import (
    Placement,
    forward_dynamics,
    inverse_dynamics,
    inverse_dynamics_derivatives,
    mass_matrix,
    maximal_state,
)
from graphdyn.equations import link_origins

ERROR = 1e-9

SHIFT = np.array([0.3, -0.7, 0.2])
"""[m] Of the base."""


class Terms:
    """The sizes of two states, one slow and one fast."""

    def __init__(self):
        self.model = model = mixed_tree().with_base(Placement(np.eye(3), SHIFT))
        rng = np.random.default_rng(0)
        q, v = model.random_state(rng, 2)
        a, tau = 3 * rng.normal(size=q.shape), 20 * rng.normal(size=q.shape)
        self.states = ScaledStates(model, q, v, a, tau, frame=model.body_names[-1])
        found = maximal_state(model, q, v, a)
        self.sizes = term_sizes(model, v, a, link_origins(found), found.velocity, found.acceleration)
        self.mass = sum(body.mass for body in model.bodies)
        self.tensor = max(np.abs(body.inertia).max() for body in model.bodies)
        self.matrix, self.speed = mass_matrix(model, q), np.abs(v).max(axis=1)
        self.entry = np.abs(self.matrix).max(axis=(1, 2))
        self.position = np.abs(link_origins(found)).max(axis=(1, 2))
        self.offset = max(np.abs(body.center_of_mass).max() for body in model.bodies)
        self.gravity = np.linalg.norm(model.gravity)
        self.solved = forward_dynamics(model, q, v, tau).a
        found = maximal_state(model, q, v, self.solved)
        self.solved_sizes = term_sizes(model, v, self.solved, link_origins(found), found.velocity, found.acceleration)

    def wrench(self, v=1.0, a=0.0):
        """Largest entry of the joint wrenches at these parts of the velocities and accelerations."""
        s = self.states
        return np.abs(inverse_dynamics(self.model, s.q, v * s.v, a * s.a).joint_wrenches).max(axis=(1, 2))

    def solution(self, a, tau):
        """Of accelerations, or their derivatives, through these torques, or their derivatives."""
        s = self.states
        wrenches = inverse_dynamics(self.model, s.q, s.v, self.solved).joint_wrenches
        return acceleration_scale(self.matrix, a, tau, wrenches)

    @property
    def solved_scale(self):
        return self.solution(self.solved, self.states.tau)

    def rate_scale(self, name):
        s = self.states
        rates = getattr(inverse_dynamics_derivatives(self.model, s.q, s.v, s.a), name)
        return self.solution(0 * rates, rates)


def of_reactions(t, by):
    o = t.sizes
    force, turning = {
        "q": (t.mass * np.maximum(o.compensated, o.turn * o.arm), o.spin),
        "v": (2 * t.mass * (o.omega * o.arm + o.slide_rate), 2 * o.omega * t.tensor),
        "a": (t.mass * o.arm, t.tensor),
    }[by]
    return force, force * o.arm + turning


def both(size):
    return lambda t: (size(t), size(t))


SCALES = {
    "inverse_dynamics": both(lambda t: np.maximum(t.wrench(1, 1), t.sizes.spin)),
    "forward_dynamics": both(lambda t: t.solved_scale),
    "bias_torque": both(lambda t: t.wrench()),
    "gravity_torque": both(lambda t: t.wrench(0)),
    "static_torque": both(lambda t: t.wrench(0)),
    "power": both(lambda t: np.maximum(t.wrench(1, 1), t.sizes.spin) * t.speed),
    "joint_wrenches": lambda t: (t.sizes.force, t.sizes.moment),
    "multipliers": both(lambda t: t.wrench(1, 1)),
    "forward_body_accelerations": both(lambda t: t.solved_scale * 3 * np.maximum(1, t.sizes.lever)),
    "link_placement": lambda t: (np.ones(2), np.maximum(t.position, t.offset)),
    "body_velocities": lambda t: (t.sizes.omega * t.sizes.lever + t.sizes.slide_rate, None),
    "body_accelerations": lambda t: (t.sizes.acceleration, t.sizes.turn),
    "mass_matrix": both(lambda t: np.full(2, t.tensor)),
    "coriolis_matrix": both(lambda t: t.entry * t.speed),
    "frame_jacobian": lambda t: (t.sizes.arm, np.ones(2)),
    "frame_jacobian_derivative": lambda t: (t.sizes.omega * t.sizes.arm + t.sizes.slide_rate, t.sizes.omega),
    "frame_velocity": lambda t: (t.sizes.omega * t.sizes.lever + t.sizes.slide_rate, None),
    "frame_acceleration": lambda t: (t.sizes.acceleration, t.sizes.turn),
    "frame_acceleration_spatial": lambda t: (t.sizes.acceleration, t.sizes.turn),
    "center_of_mass": both(lambda t: t.position + t.offset),
    "center_of_mass_velocity": both(lambda t: t.sizes.omega * t.sizes.lever + t.sizes.slide_rate),
    "center_of_mass_jacobian": both(lambda t: t.sizes.arm),
    "momentum": lambda t: momentum(t, t.sizes.lever),
    "momentum_about_origin": lambda t: momentum(t, t.sizes.lever + np.abs(SHIFT).max()),
    "centroidal_map": lambda t: (t.mass * t.sizes.arm, t.mass * t.sizes.arm * t.sizes.lever + t.tensor),
    "potential_energy": both(lambda t: t.mass * t.gravity * (t.position + t.offset)),
    "kinetic_energy_regressor": lambda t: (t.sizes.velocity**2, t.sizes.omega**2),
    "potential_energy_regressor": lambda t: (t.gravity * (t.position + t.offset), None),
    "dtau_dq": both(lambda t: np.maximum(t.wrench(1, 1), t.sizes.spin)),
    "dtau_dv": both(lambda t: t.entry * t.speed),
    "dtau_da": both(lambda t: np.full(2, t.tensor)),
    **{f"dmultipliers_d{by}": both(lambda t, by=by: of_reactions(t, by)[1]) for by in "qva"},
    **{f"dwrenches_d{by}": lambda t, by=by: of_reactions(t, by) for by in "qva"},
    "da_dq": both(lambda t: t.rate_scale("dtau_dq")),
    "da_dv": both(lambda t: t.rate_scale("dtau_dv")),
    "forward_joint_wrenches": lambda t: (t.solved_sizes.force, t.solved_sizes.moment),
    "forward_multipliers": both(lambda t: t.solved_sizes.moment),
    "d2tau_dqdq": both(lambda t: np.maximum(t.wrench(1, 1), t.sizes.spin)),
    "d2tau_dqdv": both(lambda t: t.entry * t.speed),
    "d2tau_dqda": both(lambda t: t.entry),
    "d2tau_dvdv": both(lambda t: t.entry * np.maximum(1, t.speed)),
    "joint_torque_regressor": lambda t: (t.sizes.compensated * t.sizes.lever, t.sizes.turn),
    "momentum_regressor": lambda t: ((t.sizes.omega * t.sizes.arm + t.sizes.slide_rate) * t.sizes.arm, t.sizes.omega),
    "body_regressor": lambda t: (t.sizes.compensated, t.sizes.turn),
}


def momentum(t, lever):
    linear = t.mass * t.sizes.velocity
    return linear, linear * lever + t.tensor * t.sizes.omega


@pytest.fixture(scope="module")
def terms():
    return Terms()


@pytest.mark.parametrize("name", SCALES)
def test_the_scale_is_the_one_that_is_told(terms, name):
    """Of an error in the first entry, and in the last one, where the reference is zero."""
    row, states = QUANTITIES[name], terms.states
    chosen = next(row.readings({}))
    zero = 0.0 * np.asarray(row.of_graphdyn(states, chosen))
    for place, expected in zip((0, -1), SCALES[name](terms), strict=True):
        wrong = zero.copy()
        wrong.reshape(2, -1)[:, place] = ERROR
        found = row.errors(wrong, zero, states, chosen)
        assert found == pytest.approx(ERROR / expected if expected is not None else [np.inf] * 2, rel=1e-9, abs=0)


def test_loads_are_among_the_summed_terms(terms):
    """At the given accelerations and at those that belong to the torques, which the loads change."""
    t, loads = terms, np.random.default_rng(1).normal(size=(2, 3, 6)) * 200
    states = replace(t.states, loads=loads)
    a = forward_dynamics(t.model, states.q, states.v, states.tau, loads).a
    found = maximal_state(t.model, states.q, states.v, a)
    solved = term_sizes(t.model, states.v, a, link_origins(found), found.velocity, found.acceleration)
    for sizes, expected in ((states.sizes, t.sizes.loaded(loads)), (states.solved_sizes, solved.loaded(loads))):
        for name, size in vars(expected).items():
            assert getattr(sizes, name) == pytest.approx(size, rel=1e-9), name
    wrenches = inverse_dynamics(t.model, states.q, states.v, states.a, loads).joint_wrenches
    assert largest_wrench(states) == pytest.approx(np.abs(wrenches).max(axis=(1, 2)))
    solution = inverse_dynamics(t.model, states.q, states.v, a, loads).joint_wrenches
    largest = np.maximum(np.abs(solution).max(axis=(1, 2)), np.abs(loads).max(axis=(1, 2)))
    assert acceleration_bound(states) == pytest.approx(acceleration_scale(t.matrix, a, states.tau, largest), rel=1e-6)


def test_the_system_is_solved_at_the_torques_of_the_states(terms):
    """Eq. (111) has the accelerations of the bodies that forward dynamics has."""
    s = terms.states
    expected = forward_dynamics(terms.model, s.q, s.v, s.tau).body_accelerations.reshape(2, -1)
    assert solution(s).acceleration == pytest.approx(expected, rel=1e-9, abs=1e-9 * np.abs(expected).max())
