"""Couplings: the robot without them, projected by K, is the reference; closed forms, states, refusals."""

from dataclasses import replace
from itertools import cycle, product

import numpy as np
import pytest
from long_check import few
from random_trees import NAMED, body_of_points, random_base_motion, random_state, random_tree, random_wrenches
from witnesses import relative_error

import graphdyn
from graphdyn import (
    Coupling,
    InconsistentState,
    InvalidInput,
    InvalidModel,
    Joint,
    Placement,
    RobotModel,
    identification,
)
from graphdyn.motion_laws import FourierSeries
from graphdyn.verbs import VERBS

ROUNDING = 1e-13
"""Against the projection by K, relative to the largest term: measured 4e-15."""

METHODS = ("dense", "projected", "recursive")
methods = pytest.mark.parametrize("method", METHODS)


def coupled(model):
    """Two joints driven, one of them by the other and a further one, which comes later in the order of the robot."""
    n = model.joint_names
    return replace(
        model, couplings=(Coupling(n[1], {n[3]: 1.5, n[0]: -0.5}, 0.3), Coupling(n[3], {n[2]: -1.0}, offset=-0.1))
    )


ROBOT = coupled(NAMED["branched"])


def randomly_coupled(seed):
    """A tree of up to eight bodies with up to three couplings, with chains, several drivers and offsets."""
    rng = np.random.default_rng(seed)
    n = int(rng.integers(3, 9))
    inside = [int(rng.integers(0, j)) for j in range(1, n + 1)]
    model = random_tree(seed, inside, [str(rng.choice(["revolute", "prismatic"])) for _ in range(n)])
    order = [model.joint_names[k] for k in rng.permutation(n)]  # each may be driven by earlier ones only: no circles
    driven = rng.permutation(np.arange(1, n))[: int(rng.integers(1, min(4, n)))]
    couplings = []
    for k in driven:
        by = rng.permutation(k)[: int(rng.integers(1, 3))]
        couplings.append(Coupling(order[k], {order[i]: rng.uniform(0.3, 2) for i in by}, rng.normal()))
    return replace(model, couplings=tuple(couplings))


@pytest.mark.parametrize("seed", range(20))
def test_driven_joints_are_where_their_couplings_say(seed):
    """Joint by joint, as each coupling states it: behind others that are driven, with their offsets, too."""
    model = ROBOT if seed == 0 else randomly_coupled(seed)
    q = np.random.default_rng(seed).normal(size=model.nv)
    where = dict(zip(model.joint_names, model.joint_positions(q).tolist(), strict=True))
    for coupling in model.couplings:
        wanted = coupling.offset + sum(ratio * where[name] for name, ratio in coupling.ratios.items())
        assert where[coupling.joint] == pytest.approx(wanted, abs=1e-12)
    assert [where[name] for name in model.independent_joints] == q.tolist()


def of_all_joints(model, q, v, a):
    k = model.degrees_of_freedom.matrix.T
    return model.joint_positions(q), v @ k, a @ k


@pytest.mark.parametrize("seed", few(range(100), *range(30)))
def test_random_trees_against_the_projected_robot_without_couplings(seed):
    model = randomly_coupled(seed)
    rng = np.random.default_rng(seed)
    q, v, a = rng.normal(size=(3, 2, model.nv))
    wrenches, base = random_wrenches(model, seed, (2,)), random_base_motion(seed)
    free, k = model.uncoupled, model.degrees_of_freedom.matrix
    for method in ("dense", "projected"):
        found = graphdyn.inverse_dynamics(model, q, v, a, wrenches, base=base, method=method)
        expected = graphdyn.inverse_dynamics(free, *of_all_joints(model, q, v, a), wrenches, base=base)
        assert relative_error(found.tau, expected.tau @ k, expected.joint_wrenches) < ROUNDING
        assert relative_error(found.joint_wrenches, expected.joint_wrenches) < ROUNDING
        assert relative_error(found.multipliers, expected.multipliers) < ROUNDING
        supplied = found.coupling_multipliers @ model.degrees_of_freedom.rows
        supplied[:, list(model.degrees_of_freedom.independent)] += found.tau
        assert relative_error(supplied, expected.tau, expected.joint_wrenches) < ROUNDING

        mass = graphdyn.mass_matrix(free, model.joint_positions(q))
        assert relative_error(graphdyn.mass_matrix(model, q, method=method), k.T @ mass @ k, mass) < ROUNDING
        back = graphdyn.forward_dynamics(model, q, v, found.tau, wrenches, base=base, method=method)
        condition = np.linalg.cond(k.T @ mass @ k).max()
        assert relative_error(back.a, a) < ROUNDING * condition
        assert relative_error(back.coupling_multipliers, found.coupling_multipliers, expected.joint_wrenches) < (
            ROUNDING * condition
        )


BASES = {"fixed": None, "moving": random_base_motion(3)}
FOR_FIXED_BASES = ("coriolis_matrix", "frame_jacobian_derivative")


@pytest.mark.parametrize(
    ("name", "base"),
    few([*product(VERBS, BASES)], *zip(VERBS, cycle(BASES), strict=False), *product(FOR_FIXED_BASES, ["fixed"])),
)
def test_methods_agree(name, base, monkeypatch):
    """Compiled where joints are eliminated together and where columns are projected; the others are interpreted."""
    if name not in ("forward_dynamics", "joint_torque_regressor"):
        monkeypatch.setenv("GRAPHDYN_BACKEND", "numpy")
    base = BASES[base]
    if name in FOR_FIXED_BASES and base is not None:
        pytest.skip("refuses a base that moves")
    arguments = np.random.default_rng(2).normal(size=(3, 2, ROBOT.nv))[: len(VERBS[name].inputs)]
    frame = {"frame": ROBOT.body_names[-1], "reference": "local"} if VERBS[name].of_frame else {}
    plain, compiled = (
        getattr(graphdyn, name)(ROBOT, *arguments, base=base, method=method, **frame)
        for method in ("dense", "recursive")
    )
    for x, y in zip(parts(compiled), parts(plain), strict=True):
        assert relative_error(x, y) < ROUNDING


def parts(answer):
    return (
        [answer] if isinstance(answer, np.ndarray) else answer if isinstance(answer, tuple) else vars(answer).values()
    )


@methods
def test_a_gear_in_closed_form(method):
    """A wheel that another drives r times as fast: τ = (J₁ + r² J₂) a, and the gear supplies J₂ r a to the second."""
    inertia, ratio = (0.7, 0.2), -3.0
    wheels = [
        body_of_points(
            f"wheel{i}", [1, 1, 1, 1], np.sqrt(j / 4) * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0]])
        )
        for i, j in enumerate(inertia, start=1)
    ]
    joints = [Joint(f"joint{i}", "revolute", 0, Placement(), np.array([0.0, 0, 1])) for i in (1, 2)]
    model = RobotModel("gear", tuple(wheels), tuple(joints), couplings=(Coupling("joint2", {"joint1": ratio}),))
    found = graphdyn.inverse_dynamics(model, [0.3], [2.0], [5.0], method=method)
    assert found.tau == pytest.approx([(inertia[0] + ratio**2 * inertia[1]) * 5.0], rel=1e-14)
    assert found.coupling_multipliers == pytest.approx([inertia[1] * ratio * 5.0], rel=1e-14)
    assert graphdyn.joint_accelerations(model, [0.3], [2.0], found.tau, method=method) == pytest.approx(
        [5.0], rel=1e-14
    )
    assert graphdyn.power(model, [0.3], [2.0], [5.0], method=method) == pytest.approx(found.tau * 2.0, rel=1e-14)


def test_what_depends_on_the_number_of_freedoms():
    n = ROBOT.nv
    assert (n, ROBOT.n_bodies) == (4, 6)
    assert ROBOT.independent_joints == ("joint1", "joint3", "joint5", "joint6")
    q, v = ROBOT.random_state(np.random.default_rng(1), (5,))
    assert q.shape == v.shape == (5, n)
    assert ROBOT.joint_positions(q)[:, 3] == pytest.approx(-q[:, 1] - 0.1)
    assert ROBOT.joint_positions(q)[:, 1] == pytest.approx(1.5 * (-q[:, 1] - 0.1) - 0.5 * q[:, 0] + 0.3)
    answer = graphdyn.inverse_dynamics(ROBOT, q, v, v)
    assert answer.multipliers.shape == (5, 6, 5)
    assert answer.coupling_multipliers.shape == (5, 2)
    assert graphdyn.inverse_dynamics(ROBOT.uncoupled, *np.zeros((3, 6))).coupling_multipliers.shape == (0,)
    single = graphdyn.compile(ROBOT, "joint_torques").joint_torques(q[0], v[0], v[0])
    assert relative_error(single, graphdyn.joint_torques(ROBOT, q[0], v[0], v[0])) < ROUNDING
    with pytest.raises(InvalidInput, match="for the 4 joints that no others drive of robot"):
        graphdyn.joint_torques(ROBOT, np.zeros(6), v[0], v[0])
    with pytest.raises(InvalidInput, match=r"q contains nan at joint 'joint6'"):
        graphdyn.joint_torques(ROBOT, [0, 0, 0, np.nan], v[0], v[0])


def test_many_turns():
    q = np.array([3e7, 0.0, 0.0, 0.0])
    with pytest.raises(
        InvalidInput, match=r"is beyond 1e\+06 rad, and some joints drive others; give smaller angles, or"
    ):
        graphdyn.gravity_torque(ROBOT, q, method="recursive")
    assert np.isfinite(graphdyn.gravity_torque(ROBOT, q, method="projected")).all()


def test_the_equations_of_one_state():
    q, v, tau = random_state(ROBOT.uncoupled, 4)[0][: ROBOT.nv], *np.ones((2, ROBOT.nv))
    system = graphdyn.kkt_system(ROBOT, q, v, tau)
    assert system.matrix.shape == (11 * 6 + 2, 11 * 6 + 2)
    solution, found = system.solve(), graphdyn.forward_dynamics(ROBOT, q, v, tau)
    assert relative_error(solution.multipliers, found.multipliers) < ROUNDING
    assert relative_error(solution.coupling_multipliers, found.coupling_multipliers) < ROUNDING


def test_states_there_and_back():
    q, v, a = np.random.default_rng(5).uniform(-0.5, 0.5, (3, 4, ROBOT.nv))
    state = graphdyn.maximal_state(ROBOT, q, v, a)
    for found, expected in zip(graphdyn.joint_state(ROBOT, state), (q, v), strict=True):
        assert relative_error(found, expected) < ROUNDING
    assert relative_error(graphdyn.joint_acceleration(ROBOT, state), a) < ROUNDING

    positions, rates = of_all_joints(ROBOT, q, v, a)[:2]
    off = positions + np.array([0, 1e-3, 0, 0, 0, 0])
    open_state = graphdyn.maximal_state(ROBOT.uncoupled, off, rates)
    with pytest.raises(
        InconsistentState, match=r"the position of joint 'joint2' is off its coupling by 0\.001 rad or m"
    ):
        graphdyn.joint_state(ROBOT, open_state)
    fast = graphdyn.maximal_state(ROBOT.uncoupled, positions[0], rates[0] + np.array([0, 0, 0, 1e-2, 0, 0]))
    with pytest.raises(InconsistentState, match=r"the velocity of joint 'joint[24]' is off its coupling by 0.01"):
        graphdyn.joint_state(ROBOT, fast)


@pytest.mark.parametrize(
    ("couplings", "said"),
    [
        (
            lambda n: [Coupling("elbow", {n[0]: 1.0})],
            "the coupling of joint 'elbow' names joint 'elbow', which it lacks",
        ),
        (lambda n: [Coupling(n[0], {"x": 1.0})], "the coupling of joint 'joint1' names joint 'x', which it lacks"),
        (lambda n: [Coupling(n[0], {n[1]: 1.0})] * 2, "joint 'joint1' is driven by more than one coupling"),
        (lambda n: [Coupling(n[0], {n[0]: 1.0})], "joints drive each other in a circle: joint1 → joint1"),
        (lambda n: [Coupling(n[0], {n[1]: 1.0}), Coupling(n[1], {n[0]: 1.0})], "joints drive each other in a circle"),
    ],
)
def test_models_that_cannot_be(couplings, said):
    model = NAMED["branched"]
    with pytest.raises(InvalidModel, match=said):
        replace(model, couplings=tuple(couplings(model.joint_names)))


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("a", {}), "coupling of joint 'a': no joint drives it; lock it at its offset instead"),
        (("a", {"b": np.nan}), "coupling of joint 'a': ratio to 'b' is nan; give a finite number"),
        (("a", {"b": 0.0}), "coupling of joint 'a': ratio to 'b' is 0; leave that joint out"),
        (("a", {"b": 1.0}, np.inf), "coupling of joint 'a': offset is inf; give a finite number"),
    ],
)
def test_couplings_that_cannot_be(arguments, said):
    with pytest.raises(InvalidModel, match=said):
        Coupling(*arguments)


def test_a_recording_has_all_joints_and_torques_of_the_free_ones():
    times, laws = (
        np.linspace(0, 1, 50),
        {"joint1": FourierSeries(1.0, [0.3], [0.1]), "joint5": FourierSeries(1.0, [0.2], [0.4])},
    )
    recording = graphdyn.simulate_recording(ROBOT, times, laws)
    free = list(ROBOT.degrees_of_freedom.independent)
    assert recording.joint_names == ROBOT.joint_names
    assert relative_error(recording.q, ROBOT.joint_positions(recording.q[:, free])) < ROUNDING
    given = (getattr(recording, name)[:, free] for name in "qva")
    assert relative_error(recording.tau[:, free], graphdyn.joint_torques(ROBOT, *given)) < ROUNDING
    assert not recording.tau[:, [1, 3]].any()
    with pytest.raises(InvalidInput, match="no joint 'joint2'; joints of robot 'tree6': joint1, joint3, joint5"):
        graphdyn.simulate_recording(ROBOT, times, {"joint2": laws["joint1"]})


def test_identified_from_the_free_joints():
    rng = np.random.default_rng(6)
    q, v, a = rng.normal(size=(3, 400, ROBOT.nv))
    terms = (identification.terms.RigidBodies(), identification.terms.Viscous())
    tau = graphdyn.joint_torques(ROBOT, q, v, a) + v * np.array([1.0, 2.0, 3.0, 4.0])
    problem = identification.Problem(identification.TorqueModel(ROBOT, terms), identification.Samples(q, v, a, tau))
    found = identification.OrdinaryLeastSquares().estimate(problem)
    names = [column.name for column in problem.torque_model.columns[-4:]]
    assert names == [f"{joint} viscous friction" for joint in ROBOT.independent_joints]
    assert found.parameters[-4:] == pytest.approx([1.0, 2.0, 3.0, 4.0], rel=1e-9)
    again = ROBOT.with_inertial_parameters(found.parameters[:-4])
    assert relative_error(graphdyn.joint_torques(again, q, v, a), graphdyn.joint_torques(ROBOT, q, v, a)) < 1e-9
