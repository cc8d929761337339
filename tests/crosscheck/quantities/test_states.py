"""The states of the comparison are what their names say."""

import itertools

import numpy as np
import pytest
from planting import mixed_tree
from random_trees import random_placement
from robots.mechanisms import four_bar

import urdf
from crosscheck.comparing.coupled import coupled_case
from crosscheck.comparing.looped import looped_case
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities.states import ACCELERATION_RANGE, AWKWARD, FAST, cases, turned, unit_turn
from graphdyn import inverse_dynamics, kr500, maximal_state
from graphdyn.equations.kinematics import joint_axes
from graphdyn.identification import TorqueModel
from graphdyn.identification.problem.torque_model import random_samples
from graphdyn.identification.terms import RigidBodies
from graphdyn.model.spatial import cos_beta

ALIGNED = 1e-14
"""The world is turned by one product of rotations: some eps. Cosines of angles that should be right."""

INVARIANT = 1e-12
"""Torques before and after a turn of the world: two recursions of some ten products, on the scale of the wrenches."""

ROBOTS = {"kr500": kr500(), "kinova": urdf.load("kinova"), "tree": mixed_tree()}
SAMPLES = 4


def by_name(model, samples=SAMPLES, seed=0):
    every = list(cases(model, samples, seed))
    named = {case.name: case for case in every}
    assert len(named) == len(every)
    return named


@pytest.fixture(params=ROBOTS)
def model(request):
    return ROBOTS[request.param]


def test_all_cases(model):
    assert list(by_name(model)) == [
        "random",
        "zero pose at rest",
        "zero pose",
        "fast",
        "zero gravity",
        "torques of a",
        *(f"gimbal lock of {name}" for name in model.body_names),
        *(f"horizontal axis of {name}" for name in model.joint_names),
    ]


@pytest.mark.parametrize("samples", [1, AWKWARD + 5])
def test_how_many(samples):
    """All the random ones; of the awkward kinds never more than AWKWARD, and one per body and joint."""
    model = ROBOTS["tree"]
    few = min(samples, AWKWARD)
    expected = {"random": samples, "zero pose": few, "fast": few, "zero gravity": few, "torques of a": few}
    for name, case in by_name(model, samples).items():
        n = expected.get(name, 1)
        assert case.q.shape == case.v.shape == case.a.shape == (n, model.n_bodies)
        assert case.external_wrenches.shape == (n, model.n_bodies, 6)
        assert np.abs(case.external_wrenches).min() > 0
        assert (case.tau is None) == (name == "torques of a")
        assert case.tau is None or case.tau.shape == case.q.shape


def test_gimbal_lock(model):
    named = by_name(model)
    for i, name in enumerate(model.body_names):
        case = named[f"gimbal lock of {name}"]
        assert cos_beta(maximal_state(case.model, case.q).rotation[0, i]) <= ALIGNED


def test_horizontal_axes(model):
    named = by_name(model)
    for j, name in enumerate(model.joint_names):
        case = named[f"horizontal axis of {name}"]
        axis = joint_axes(maximal_state(case.model, case.q))[0, j]
        assert np.abs(axis[2]) <= ALIGNED
        # the x row and the y row of Eq. (71), (72) are p_y and p_x times the same vector: proportional, here exactly
        assert np.abs(axis[1]) <= ALIGNED


def test_turning_the_world_changes_no_torque(model):
    """Base and gravity turn together: the awkward states are states of the same robot, seen from elsewhere."""
    for name, case in by_name(model).items():
        assert np.abs(case.turn.rotation @ model.gravity - case.model.gravity).max() <= ALIGNED * 10 or (
            name == "zero gravity"
        )
        if name == "zero gravity":
            continue
        here, there = (inverse_dynamics(m, case.q, case.v, case.a) for m in (case.model, model))
        assert np.abs(here.tau - there.tau).max() <= INVARIANT * np.abs(there.joint_wrenches).max()


def test_special_states(model):
    named = by_name(model)
    rest = named["zero pose at rest"]
    assert not rest.q.any()
    assert not rest.v.any()
    assert not rest.a.any()
    zero = named["zero pose"]
    assert not zero.q.any()
    assert zero.v.all()
    assert not named["zero gravity"].model.gravity.any()
    assert model.gravity.any()


def test_ranges(model):
    named = by_name(model, samples=40)
    usual, fast = named["random"], named["fast"]
    assert np.abs(usual.a).max() <= ACCELERATION_RANGE < np.abs(fast.a).max() <= FAST * ACCELERATION_RANGE
    assert np.abs(fast.v).max() > np.abs(usual.v).max()
    for k, joint in enumerate(model.joints):
        lower, upper = joint.limits.lower, joint.limits.upper
        if joint.kind != "continuous" and lower is not None and upper is not None and lower < upper:
            assert lower <= usual.q[:, k].min()
            assert usual.q[:, k].max() <= upper


def test_seed(model):
    """The same seed draws the same states, another seed others."""

    def drawn(seed):
        named = by_name(model, seed=seed)
        return {name: (case.q, case.v, case.a, case.external_wrenches) for name, case in named.items()}

    first, again, other = drawn(5), drawn(5), drawn(6)
    for name in first:
        assert all(np.array_equal(x, y) for x, y in zip(first[name], again[name], strict=True))
        assert not np.array_equal(first[name][3], other[name][3])
    assert not np.array_equal(first["random"][0], other["random"][0])


@pytest.mark.parametrize(
    "draw",
    [
        lambda seed: looped_case(four_bar(), 4, seed),
        lambda seed: coupled_case(ROBOTS["tree"], 4, seed),
        lambda seed: JudgedStates.draw(ROBOTS["tree"], 4, seed, needs_tau=False, beyond_limits=True),
        lambda seed: random_samples(TorqueModel(ROBOTS["tree"], (RigidBodies(),)), 4, seed),
    ],
    ids=["loops", "couplings", "judged", "identification"],
)
def test_seed_of_further_states(draw):
    first, again, other = (draw(seed).q[:4] for seed in (3, 3, 4))
    assert np.array_equal(first, again)
    assert not np.isclose(first, other).all(axis=1).any()


def test_cases_are_independent_draws(model):
    drawn = [case.q for case in by_name(model).values() if case.q.any() and len(case.q) == SAMPLES]
    assert len(drawn) > 2
    assert not any(np.array_equal(x, y) for x, y in itertools.combinations(drawn, 2))


def test_unit_turn():
    rng = np.random.default_rng(0)
    for direction in [*np.eye(3), *-np.eye(3), *rng.normal(size=(20, 3))]:
        unit = direction / np.linalg.norm(direction)
        turn = unit_turn(unit)  # Placement refuses what is no rotation
        assert np.abs(turn.rotation @ unit - [1, 0, 0]).max() <= ALIGNED


def test_turned_moves_base_and_gravity():
    model, turn = ROBOTS["tree"], random_placement(np.random.default_rng(1))
    moved = turned(model, turn)
    assert np.allclose(moved.gravity, turn.rotation @ model.gravity, rtol=0, atol=10 * ALIGNED)
    assert np.allclose(moved.base.rotation, turn.rotation @ model.base.rotation, rtol=0, atol=ALIGNED)
    assert np.allclose(
        moved.base.translation, turn.rotation @ model.base.translation + turn.translation, rtol=0, atol=ALIGNED
    )
