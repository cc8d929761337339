"""The dense 11n equations are the specification; the fast forms, batches and round trips agree with them."""

import functools
from math import fsum

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from random_trees import NAMED, SEEDS, body_of_points, random_state, random_tree, random_wrenches, robots
from witnesses import acceleration_scale, derivative, relative_error

import graphdyn
from graphdyn import Body, MaximalState, RobotModel
from graphdyn.equations.projected import singular

EPS = np.finfo(float).eps

ACCELERATION = 10 * EPS
"""Times acceleration_scale, what one eps of rounding in M, τ and the wrenches does: measured 1.8 over 300 trees."""

BODY_ACCELERATION = 10 * ACCELERATION
"""The same for bodies: joint accelerations times levers, of which a tree of eight sums some meters. Measured 6 eps."""

WRENCH = 50 * EPS
"""Times cond(M), relative to the largest wrench, since wrenches carry the error of the accelerations: measured 4.9."""

SUM = 1e-13
"""The same sum in another order, relative to its largest term: measured 2.5e-15."""

RESIDUAL = 1e-13
"""Of Eq. (111) after solving, relative to the largest term that is summed: measured 6e-16."""

STATICS = 1e-11
"""Sixth-order differences of the pose of a link, relative to the largest wrench: measured 2e-14."""

BATCH = 20 * EPS
"""A batch against its rows: einsum and BLAS sum in another order. Measured 2; forward dynamics times cond(M)."""


def forward_differences(model, q, v, tau, wrenches):
    """Dense against projected, as parts of what the tolerances allow: a, body accelerations, multipliers, wrenches."""
    fast = graphdyn.forward_dynamics(model, q, v, tau, wrenches)
    dense = graphdyn.forward_dynamics(model, q, v, tau, wrenches, method="dense")
    m = graphdyn.mass_matrix(model, q)
    condition = np.linalg.cond(m)
    scale = acceleration_scale(m, dense.a, tau, dense.joint_wrenches)
    return [
        np.abs(fast.a - dense.a).max() / (ACCELERATION * scale),
        np.abs(fast.body_accelerations - dense.body_accelerations).max() / (BODY_ACCELERATION * scale),
        relative_error(fast.multipliers, dense.multipliers, dense.joint_wrenches) / (WRENCH * condition),
        relative_error(fast.joint_wrenches, dense.joint_wrenches) / (WRENCH * condition),
    ]


@given(robots(), SEEDS)
def test_forward_dynamics_dense_and_projected(model, seed):
    differences = forward_differences(model, *random_state(model, seed), random_wrenches(model, seed + 1))
    assert max(differences) < 1


def test_forward_dynamics_of_the_named_robots(robot):
    assert max(forward_differences(robot, *random_state(robot, 50), random_wrenches(robot, 51))) < 1


@given(robots(), SEEDS)
def test_inverse_dynamics_dense_and_projected(model, seed):
    q, v, a = random_state(model, seed)
    wrenches = random_wrenches(model, seed + 1)
    fast = graphdyn.inverse_dynamics(model, q, v, a, wrenches)
    dense = graphdyn.inverse_dynamics(model, q, v, a, wrenches, method="dense")
    size = dense.joint_wrenches
    assert relative_error(fast.tau, dense.tau, size) < SUM
    assert relative_error(fast.multipliers, dense.multipliers, size) < SUM
    assert relative_error(fast.joint_wrenches, dense.joint_wrenches) < SUM
    assert np.array_equal(fast.body_accelerations, dense.body_accelerations)


@pytest.mark.parametrize("method", ["projected", "dense", "recursive, NumPy"], indirect=True)
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])  # one method for all examples
@given(robots(), SEEDS)
def test_inverse_dynamics_undoes_forward_dynamics(method, model, seed):
    q, v, tau = random_state(model, seed)
    wrenches = random_wrenches(model, seed + 1)
    f = graphdyn.forward_dynamics(model, q, v, tau, wrenches, method=method)
    i = graphdyn.inverse_dynamics(model, q, v, f.a, wrenches, method=method)
    condition = np.linalg.cond(graphdyn.mass_matrix(model, q))
    size = f.joint_wrenches
    assert relative_error(i.tau, tau, size) < WRENCH * condition
    assert relative_error(i.multipliers, f.multipliers, size) < WRENCH * condition
    assert relative_error(i.joint_wrenches, f.joint_wrenches) < WRENCH * condition
    assert relative_error(i.body_accelerations, f.body_accelerations) < WRENCH * condition


@given(robots(), SEEDS)
def test_mass_matrix_and_bias_torque_make_the_inverse_dynamics(model, seed):
    q, v, a = random_state(model, seed)
    i = graphdyn.inverse_dynamics(model, q, v, a)
    torque = graphdyn.mass_matrix(model, q) @ a + graphdyn.bias_torque(model, q, v)
    assert relative_error(torque, i.tau, i.joint_wrenches) < SUM


# External wrenches


def with_load(model, j, mass, point):
    """The robot with a point mass fixed in the link frame of body j."""
    load = body_of_points("load", [mass], [point])
    loaded = Body.from_parameters(model.bodies[j - 1].name, model.bodies[j - 1].parameters + load.parameters)
    bodies = list(model.bodies)
    bodies[j - 1] = loaded
    return RobotModel(model.name, tuple(bodies), model.joints, gravity=model.gravity, base=model.base)


def test_weight_of_a_load_is_an_external_wrench(robot, rng, method):
    q, v, _ = random_state(robot, 52)
    mass, point = 12.0, rng.uniform(-0.5, 0.5, 3)
    rotations = graphdyn.maximal_state(robot, q).rotation
    for j in range(1, robot.n_bodies + 1):
        force = rotations[j - 1].T @ (mass * robot.gravity)
        wrenches = np.zeros((robot.n_bodies, 6))
        wrenches[j - 1] = np.concatenate([force, np.cross(point, force)])
        pushed = graphdyn.inverse_dynamics(robot, q, 0 * v, 0 * v, wrenches, method=method)
        loaded = graphdyn.inverse_dynamics(with_load(robot, j, mass, point), q, 0 * v, 0 * v, method=method)
        size = loaded.joint_wrenches
        assert relative_error(pushed.tau, loaded.tau, size) < SUM
        # the wrench of the inside body carries the load too, whether it is part of the body or pushes on it
        assert relative_error(pushed.joint_wrenches, loaded.joint_wrenches) < SUM
        assert relative_error(pushed.multipliers, loaded.multipliers, size) < SUM


@functools.cache
def link_jacobians(model):
    """At the state of the test below, which asks several methods."""
    q, *_ = random_state(model, 53)
    return [link_jacobian(model, q, name) for name in model.body_names]


def link_jacobian(model, q, name):
    """Twist of a link frame at its origin, in its own axes (6, n), by differences of its pose."""
    rotation, _ = graphdyn.frame_placement(model, q, name)
    columns = []
    for e in np.eye(model.n_bodies):
        linear = derivative(lambda h, e=e: graphdyn.frame_placement(model, q + h * e, name)[1])
        turning = derivative(lambda h, e=e: graphdyn.frame_placement(model, q + h * e, name)[0])
        omega = rotation.T @ turning
        columns.append(np.concatenate([rotation.T @ linear, [omega[2, 1], omega[0, 2], omega[1, 0]]]))
    return np.stack(columns, axis=-1)


@pytest.mark.usefixtures("default_method")
def test_external_wrenches_reach_the_joints_through_the_transposed_jacobian(robot):
    q, v, a = random_state(robot, 53)
    wrenches = random_wrenches(robot, 54)
    free = graphdyn.inverse_dynamics(robot, q, v, a)
    pushed = graphdyn.inverse_dynamics(robot, q, v, a, wrenches)
    carried = sum(j.T @ wrench for j, wrench in zip(link_jacobians(robot), wrenches, strict=True))
    assert relative_error(free.tau - pushed.tau, carried, free.joint_wrenches, pushed.joint_wrenches) < STATICS


@pytest.mark.usefixtures("default_method")
def test_dynamics_do_not_depend_on_where_the_robot_stands(robot):
    """Not by a bit: large positions would cost digits in the differences that give the levers."""
    far = robot.with_base(graphdyn.Placement(robot.base.rotation, [1e5, -3e5, 2e5]))
    q, v, x = random_state(robot, 59)
    for verb in (graphdyn.forward_dynamics, graphdyn.inverse_dynamics):
        here, there = verb(robot, q, v, x), verb(far, q, v, x)
        for name in ("multipliers", "joint_wrenches", "body_accelerations"):
            assert np.array_equal(getattr(here, name), getattr(there, name))
    assert np.array_equal(graphdyn.mass_matrix(robot, q), graphdyn.mass_matrix(far, q))
    shift = graphdyn.maximal_state(far, q, v).position - graphdyn.maximal_state(robot, q, v).position
    np.testing.assert_allclose(shift, np.broadcast_to(far.base.translation - robot.base.translation, shift.shape))


# Eq. (111) itself


@given(robots(), SEEDS)
def test_kkt_system_is_symmetric_of_full_rank_and_solves_the_forward_dynamics(model, seed):
    q, v, tau = random_state(model, seed)
    wrenches = random_wrenches(model, seed + 1)
    k = graphdyn.kkt_system(model, q, v, tau, wrenches)
    n = model.n_bodies
    assert k.matrix.shape == (11 * n, 11 * n)
    assert k.rhs.shape == (11 * n,)
    assert np.array_equal(k.matrix, k.matrix.T)
    assert np.all(k.matrix[6 * n :, 6 * n :] == 0)
    assert k.rank() == 11 * n
    assert k.constraint_rank() == 5 * n
    solution = k.solve()
    assert solution.dynamics_residual() <= RESIDUAL
    assert solution.constraint_residual() <= RESIDUAL
    f = graphdyn.forward_dynamics(model, q, v, tau, wrenches)
    mass = graphdyn.mass_matrix(model, q)
    condition = np.linalg.cond(mass)
    assert solution.multipliers.shape == f.multipliers.shape == (n, 5)
    pushed = (
        np.linalg.norm(np.linalg.inv(mass), np.inf) * f.joint_wrenches
    )  # large forces may leave little acceleration
    assert relative_error(solution.acceleration.reshape(n, 6), f.body_accelerations, pushed) < WRENCH * condition
    assert relative_error(solution.multipliers, f.multipliers, f.joint_wrenches) < WRENCH * condition


def test_solution_satisfies_the_equations_as_the_paper_writes_them(robot):
    """A q̈ - B + φ_qᵀλ = 0 (Eq. 110), φ_q q̈ = ζ (Eq. 108), with residuals computed here."""
    q, v, tau = random_state(robot, 55)
    k = graphdyn.kkt_system(robot, q, v, tau)
    s = k.solve()
    pulled = k.constraint_jacobian.T @ s.multipliers.ravel()
    assert relative_error(k.mass @ s.acceleration + pulled, k.force, pulled) < RESIDUAL
    assert relative_error(k.constraint_jacobian @ s.acceleration, k.zeta, s.acceleration) < RESIDUAL


def test_residuals_of_wrong_answers_are_the_largest_error_over_the_largest_sum_of_terms(robot):
    """Row by row, with math.fsum."""
    k = graphdyn.kkt_system(robot, *random_state(robot, 55))
    s, rng = k.solve(), np.random.default_rng(0)
    a, multipliers = (x + 0.01 * rng.normal(size=x.shape) for x in (s.acceleration, s.stacked_multipliers))
    wrong = graphdyn.KKTSolution(k, a, multipliers)

    def errors_and_terms(matrix, x, right):
        terms = [[*(row * x).tolist(), -wanted] for row, wanted in zip(matrix, right.tolist(), strict=True)]
        return [abs(fsum(row)) for row in terms], [fsum(map(abs, row)) for row in terms]

    both = np.hstack([k.mass, k.constraint_jacobian.T]), np.concatenate([a, multipliers])
    errors, terms = errors_and_terms(*both, k.force)
    assert wrong.dynamics_residual() == pytest.approx(max(errors) / max(terms), rel=SUM)
    errors, terms = errors_and_terms(k.constraint_jacobian, a, k.zeta)
    assert wrong.constraint_residual() == pytest.approx(max(errors) / max(*terms, np.abs(a).max()), rel=SUM)


@pytest.mark.parametrize("seed", [3, 8])
def test_every_row_balances_on_its_own_scale(seed):
    """Masses from 1e-6 to 1e6 in a chain: without iterative refinement, rows of light bodies are off by up to 1e-13."""
    chain = random_tree(seed, range(6), ["revolute"] * 6)
    sizes = 10.0 ** np.random.default_rng(seed).uniform(-6, 6, 6)
    chain = chain.with_inertial_parameters((chain.inertial_parameters.reshape(6, 10) * sizes[:, None]).ravel())
    k = graphdyn.kkt_system(chain, *random_state(chain, seed))
    s = k.solve()
    unknowns = np.concatenate([s.acceleration, s.stacked_multipliers])
    terms = np.abs(k.matrix) @ np.abs(unknowns) + np.abs(k.rhs)
    assert (np.abs(k.matrix @ unknowns - k.rhs) / terms).max() < 4 * EPS


def test_constraints_have_the_scale_of_the_accelerations():
    """A row whose terms all vanish beside large accelerations: φ_q q̈ = ζ is as exact as q̈ is."""
    a = np.array([1e6, 0.0, 0.0, 0.0, 0.0, 1.0])
    rows = np.eye(6)[1:]
    k = graphdyn.KKTSystem(np.eye(6), rows, np.zeros(6), np.array([1e-10, 0, 0, 0, 1.0]))
    residual = graphdyn.KKTSolution(k, a, np.zeros(5)).constraint_residual()
    assert residual == pytest.approx(1e-16)


@pytest.mark.parametrize(
    ("eigenvalue", "is_singular"), [(1e-14, False), (2e-15, False), (7e-16, True), (3e-16, True), (0.0, True)]
)
def test_where_a_mass_matrix_counts_as_singular(eigenvalue, is_singular):
    """Scaled to unit diagonal, at n eps of the largest eigenvalue, here 2 × 2.2e-16 of 2: whatever the units."""
    mass = np.array([[1.0, 1.0 - eigenvalue], [1.0 - eigenvalue, 1.0]])
    for unit in (1.0, 1e-9, 1e9):
        units = np.diag([1.0, unit])
        assert bool(singular(units @ mass @ units)) is is_singular


@pytest.mark.parametrize("size", [2, 3, 5, 10])
def test_what_has_a_lower_rank_counts_as_singular(size):
    """Sums of fewer squares than rows, whatever rounding leaves of the zero among the eigenvalues; full sums do not."""
    factors = np.random.default_rng(size).normal(size=(500, size, size))
    factors[::2] = 1 + 0.1 * factors[::2]  # joints that move nearly the same bodies
    assert singular(factors[..., 1:] @ np.swapaxes(factors[..., 1:], -1, -2)).all()
    assert singular(factors[..., :1] @ np.swapaxes(factors[..., :1], -1, -2)).all()
    whole = factors @ np.swapaxes(factors, -1, -2)
    assert not singular(whole[np.linalg.cond(whole) < 1e12]).any()


def test_condition_number_is_the_ratio_of_the_extreme_singular_values(robot):
    q, v, tau = random_state(robot, 56)
    k = graphdyn.kkt_system(robot, q, v, tau)
    sizes = np.abs(np.linalg.eigvalsh(k.matrix))  # symmetric: singular values are |eigenvalues|
    assert k.condition_number() == pytest.approx(sizes.max() / sizes.min(), rel=EPS * k.condition_number() * 10)


def test_kkt_system_carries_the_batch_dimensions_of_its_parts(robot):
    """A is constant: one (6n, 6n) matrix serves a batch of Jacobians."""
    states = [random_state(robot, seed) for seed in (57, 58)]
    one_by_one = [graphdyn.kkt_system(robot, *state) for state in states]
    batch = graphdyn.KKTSystem(
        one_by_one[0].mass,
        *(np.stack([getattr(k, x) for k in one_by_one]) for x in ("constraint_jacobian", "force", "zeta")),
    )
    n = robot.n_bodies
    assert batch.matrix.shape == (2, 11 * n, 11 * n)
    assert np.array_equal(batch.rank(), [11 * n, 11 * n])
    solution = batch.solve()
    for row, k in enumerate(one_by_one):
        condition = np.linalg.cond(graphdyn.mass_matrix(robot, states[row][0]))
        alone = k.solve()
        assert relative_error(solution.multipliers[row], alone.multipliers) < WRENCH * condition
        assert relative_error(solution.acceleration[row], alone.acceleration) < WRENCH * condition
    assert solution.dynamics_residual().shape == (2,)


# Round trips between joint space and maximal space


@given(robots(), SEEDS)
def test_joint_state_undoes_maximal_state(model, seed):
    q, v, a = random_state(model, seed, size=(3,))
    state = graphdyn.maximal_state(model, q, v, a)
    q_back, v_back = graphdyn.joint_state(model, state)
    assert relative_error(q_back, q) < SUM
    assert relative_error(v_back, v, state.velocity) < SUM
    assert relative_error(graphdyn.joint_acceleration(model, state), a, state.acceleration) < SUM


def test_joint_angles_come_back_without_full_turns():
    robot = NAMED["revolute_chain"]
    q = np.array([np.pi + 0.5, -7.0, 3.0, 20.0])
    back, _ = graphdyn.joint_state(robot, graphdyn.maximal_state(robot, q))
    np.testing.assert_allclose(back, np.arctan2(np.sin(q), np.cos(q)), rtol=0, atol=SUM)


def test_accelerations_of_the_bodies_are_those_of_the_joints(robot, method):
    q, v, tau = random_state(robot, 59)
    f = graphdyn.forward_dynamics(robot, q, v, tau, method=method)
    s = graphdyn.maximal_state(robot, q, v)
    with_bodies = MaximalState(robot, s.position, s.rotation, s.velocity, f.body_accelerations)
    condition = np.linalg.cond(graphdyn.mass_matrix(robot, q))
    assert relative_error(graphdyn.joint_acceleration(robot, with_bodies), f.a, f.body_accelerations) < SUM * condition


# Leading dimensions


def verbs(model, q, v, x, wrenches):
    """Every public verb on the same arguments, as arrays by name."""
    results = {}
    for method in ("projected", "dense"):
        f = graphdyn.forward_dynamics(model, q, v, x, wrenches, method=method)
        i = graphdyn.inverse_dynamics(model, q, v, x, wrenches, method=method)
        for answer, label in ((f, "forward"), (i, "inverse")):
            results |= {f"{label} {method} {name}": value for name, value in vars(answer).items()}
    s = graphdyn.maximal_state(model, q, v, x)
    results |= {name: getattr(s, name) for name in ("position", "rotation", "velocity", "acceleration", "cardano")}
    results["residual"] = s.constraint_residual()
    results["q"], results["v"] = graphdyn.joint_state(model, s)
    results["a"] = graphdyn.joint_acceleration(model, s)
    results["mass matrix"] = graphdyn.mass_matrix(model, q)
    results["bias torque"] = graphdyn.bias_torque(model, q, v)
    results["torque regressor"] = graphdyn.joint_torque_regressor(model, q, v, x)
    results["body regressor"] = graphdyn.body_regressor(model, q, v, x)
    results["frame rotation"], results["frame position"] = graphdyn.frame_placement(model, q, model.body_names[-1])
    return results


@pytest.mark.parametrize("size", [(3,), (2, 3), (1,)])
def test_a_batch_is_its_rows_one_by_one(robot, size):
    q, v, x = random_state(robot, 60, size)
    wrenches = random_wrenches(robot, 61, size)
    batch = verbs(robot, q, v, x, wrenches)
    condition = np.linalg.cond(graphdyn.mass_matrix(robot, q)).max()
    for row in np.ndindex(*size):
        alone = verbs(robot, q[row], v[row], x[row], wrenches[row])
        for name, value in alone.items():
            assert batch[name].shape == (*size, *value.shape), name
            tolerance = BATCH * (condition if "forward" in name else 1)
            scale = 1.0 if name in ("residual", "cardano") else 0.0
            if "regressor" in name:  # the column of a mass is a difference with gravity
                scale = np.linalg.norm(robot.gravity)
            assert relative_error(batch[name][row], value, scale) <= tolerance, name


@pytest.mark.usefixtures("default_method")
def test_an_empty_batch_gives_empty_answers(robot):
    nothing = np.zeros((0, robot.n_bodies))
    alone = verbs(robot, *(nothing[:0].sum(axis=0),) * 3, np.zeros((robot.n_bodies, 6)))
    for name, value in verbs(robot, nothing, nothing, nothing, np.zeros((0, robot.n_bodies, 6))).items():
        assert value.shape == (0, *alone[name].shape), name


@pytest.mark.usefixtures("default_method")
def test_leading_dimensions_broadcast(robot):
    q, _, _ = random_state(robot, 62)
    _, v, tau = random_state(robot, 63, size=(5,))
    wrenches = random_wrenches(robot, 64, size=(2, 1))
    f = graphdyn.forward_dynamics(robot, q, v, tau[0], wrenches)
    assert f.a.shape == (2, 5, robot.n_bodies)
    assert f.joint_wrenches.shape == (2, 5, robot.n_bodies, 6)
    condition = np.linalg.cond(graphdyn.mass_matrix(robot, q))
    for row in np.ndindex(2, 5):
        alone = graphdyn.forward_dynamics(robot, q, v[row[1]], tau[0], wrenches[row[0], 0])
        assert relative_error(f.a[row], alone.a) < BATCH * condition
        assert relative_error(f.multipliers[row], alone.multipliers, alone.joint_wrenches) < BATCH * condition
    assert graphdyn.mass_matrix(robot, q).shape == (robot.n_bodies, robot.n_bodies)
    assert graphdyn.bias_torque(robot, q, v).shape == (5, robot.n_bodies)
    assert graphdyn.body_regressor(robot, q, v, tau).shape == (5, robot.n_bodies, 6, 10)
    assert graphdyn.joint_torque_regressor(robot, q, v, tau).shape == (5, robot.n_bodies, 10 * robot.n_bodies)


@pytest.mark.usefixtures("default_method")
def test_lists_and_integers_are_as_good_as_arrays():
    robot = NAMED["one_revolute"]
    one = graphdyn.forward_dynamics(robot, [1], [2], [3])
    assert np.array_equal(one.a, graphdyn.forward_dynamics(robot, np.array([1.0]), [2.0], [3.0]).a)


@pytest.mark.usefixtures("default_method")
def test_arguments_are_not_changed(robot):
    q, v, tau = random_state(robot, 65, size=(2,))
    wrenches = random_wrenches(robot, 66, size=(2,))
    before = [x.copy() for x in (q, v, tau, wrenches)]
    verbs(robot, q, v, tau, wrenches)
    for now, then in zip((q, v, tau, wrenches), before, strict=True):
        assert np.array_equal(now, then)
