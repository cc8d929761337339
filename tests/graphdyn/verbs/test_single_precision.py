"""dtype=numpy.float32: the same verbs with half as many digits, and nobody gets it without asking."""

from dataclasses import replace

import numpy as np
import pytest
from back_ends import LONG_ROBOTS, no_programs, on
from long_check import few
from random_trees import NAMED, random_base_motion, random_state, random_wrenches
from robots.mechanisms import four_bar

import crosscheck
import graphdyn
import urdf
from graphdyn import Coupling, InvalidInput
from graphdyn.compiler import running
from graphdyn.compiler.llvm.precision import SINGLE
from graphdyn.verbs import VERBS

MODEL = NAMED["mixed_chain"]
FLOAT = np.float32

AGREEMENT = 2e-5
"""Of all verbs with their answers in double precision at the same rounded arguments, relative to the largest entry:
measured 3.6e-6, where a mass matrix is inverted; 7e-7 elsewhere."""

OF_THE_SCALE = 1e-6
"""What the judge finds at random states, on the scale of each quantity: measured 4e-7 on six arms."""


def states(count, model=MODEL, seed=0):
    return *random_state(model, seed, (count,)), random_wrenches(model, seed + 1, (count,))


def answers(arrays, **keywords):
    """By name, narrow and wide, recursive."""
    q, v, x, wrenches = arrays
    return {
        **vars(graphdyn.forward_dynamics(MODEL, q, v, x, wrenches, **keywords)),
        "tau": graphdyn.joint_torques(MODEL, q, v, x, **keywords),
        "matrix": graphdyn.joint_torque_regressor(MODEL, q, v, x, **keywords),
    }


def arrays_of(answer):
    if isinstance(answer, np.ndarray):
        return [answer]
    return list(answer if isinstance(answer, tuple) else vars(answer).values())


def assert_near(found, expected):
    assert found.dtype == FLOAT
    assert found.shape == expected.shape
    assert np.abs(found - expected).max(initial=0.0) <= AGREEMENT * np.abs(expected).max(initial=0.0)


@pytest.mark.parametrize("name", VERBS)
def test_every_verb_has_half_as_many_digits(name, monkeypatch):
    monkeypatch.setenv("GRAPHDYN_BACKEND", "numpy")  # whose operations are rounded one by one
    arguments = [x.astype(FLOAT) for x in random_state(MODEL, 1, (3,))[: len(VERBS[name].inputs)]]
    frame = {"frame": "body3", "reference": "world"} if VERBS[name].of_frame else {}
    function = getattr(graphdyn, name)
    found = arrays_of(function(MODEL, *arguments, dtype=FLOAT, **frame))
    for single, double in zip(found, arrays_of(function(MODEL, *arguments, **frame)), strict=True):
        assert double.dtype == float  # whatever the arguments are
        assert_near(single, double)


@pytest.mark.parametrize("back_end", ["host", *few(("2 lanes", LONG_ROBOTS), LONG_ROBOTS)])
def test_compiled_code_answers_the_same_in_every_lane(back_end):
    """Below, at and above the numbers of lanes, and no multiples of them; bit for bit whatever is beside a sample."""
    arrays = [x.astype(FLOAT) for x in states(37)]
    with on(back_end):
        together = answers(arrays, dtype=FLOAT)
        for first, last in [(0, 1), (3, 7), (2, 18), (5, 37), (0, 33), (20, 36)]:
            part = answers([x[first:last] for x in arrays], dtype=FLOAT)
            assert all(np.array_equal(part[name], together[name][first:last]) for name in part)
    for name, expected in answers(arrays, method="projected").items():
        assert_near(together[name], expected)


def test_rows_that_are_long_or_go_past_the_caches():
    """Columns in memory, and a result larger than the caches keep, at any address."""
    q, v, a, _ = states(1703)
    expected = graphdyn.joint_torque_regressor(MODEL, q, v, a, dtype=FLOAT, threads=1)
    assert_near(expected, graphdyn.joint_torque_regressor(MODEL, *(x.astype(FLOAT) for x in (q, v, a))))
    for shift in (1, 7, 16):
        memory = np.full(expected.size + 32, 7, dtype=FLOAT)
        shifted = memory[shift : shift + expected.size].reshape(expected.shape)
        graphdyn.joint_torque_regressor(MODEL, q, v, a, dtype=FLOAT, out=shifted)
        assert np.array_equal(shifted, expected)
        assert np.all(memory[:shift] == 7)
        assert np.all(memory[shift + expected.size :] == 7)


@pytest.mark.parametrize("robot", few(("kr500", "ur3", "ur5", "ur10", "kinova", "z1"), "ur5"))
def test_the_judge_finds_them_good_to_a_millionth(robot):
    model = urdf.load(robot)
    judgment = crosscheck.judge(
        robot,
        samples=100,
        precision="single",
        tolerance=OF_THE_SCALE,
        batched=True,
        inverse_dynamics=lambda *x: graphdyn.joint_torques(model, *x, dtype=FLOAT),
        forward_dynamics=lambda *x: graphdyn.joint_accelerations(model, *x, dtype=FLOAT),
        mass_matrix=lambda *x: graphdyn.mass_matrix(model, *x, dtype=FLOAT),
    )
    assert judgment.agrees


def test_couplings_and_a_base_that_moves():
    coupled = replace(MODEL, couplings=(Coupling(MODEL.joint_names[2], {MODEL.joint_names[0]: -2.0}, 0.1),))
    for model in (coupled, MODEL):
        q, v, a = (x[:, : model.nv].astype(FLOAT) for x in random_state(MODEL, 0, (5,)))
        base = random_base_motion(3, (5,)) if model is MODEL else None
        found = graphdyn.joint_torques(model, q, v, a, base=base, dtype=FLOAT)
        assert_near(found, graphdyn.joint_torques(model, q, v, a, base=base))


def test_each_precision_has_a_program_of_its_own():
    with no_programs():
        for dtype in (float, FLOAT, "float32"):
            graphdyn.mass_matrix(MODEL, np.zeros(4), dtype=dtype, method="recursive")
        assert len(running.programs_of(MODEL).ready) == 2


@pytest.mark.parametrize("back_end", ["numpy", "host"])
def test_angles_beyond_the_reduction_are_brought_back(back_end):
    """As good as the number that the argument is rounded to."""
    q = np.full((9, 4), 0.3, FLOAT)
    q[4, 0], q[6, 2], q[7, 1] = 1.0001 * SINGLE.max_angle, -3e30, 2e5  # joint 2 slides
    with on(back_end):
        found = graphdyn.mass_matrix(MODEL, q, dtype=FLOAT)
    for single, double in zip(found, graphdyn.mass_matrix(MODEL, q), strict=True):
        assert_near(single, double)


def test_small_pivots_are_decided_in_double_precision():
    """Between the shares of both precisions, and zero: the last body has hardly any inertia about its joint."""

    def ending(mass, inertia):
        last = replace(MODEL.bodies[3], mass=mass, center_of_mass=0.1 * p, inertia=inertia)
        return replace(MODEL, bodies=(*MODEL.bodies[:3], last))

    p = MODEL.joints[3].axis
    q, v, tau = (x.astype(FLOAT) for x in random_state(MODEL, 2, (3,)))
    model = ending(1.0, np.eye(3) + (1e-6 - 1) * np.outer(p, p))
    found = graphdyn.joint_accelerations(model, q, v, tau, dtype=FLOAT)
    assert np.array_equal(found, graphdyn.joint_accelerations(model, q, v, tau, method="projected").astype(FLOAT))
    with pytest.raises(graphdyn.SingularMassMatrix, match="is singular in row 0"):
        graphdyn.joint_accelerations(ending(0.0, np.zeros((3, 3))), q, v, tau, dtype=FLOAT)


def test_refusals():
    zero, four = np.zeros((2, 4)), four_bar()
    for wrong, said in ((int, "<class 'int'>"), (None, "None"), ("f2", "'f2'"), ("fast", "'fast'")):
        with pytest.raises(InvalidInput, match=rf"dtype is {said}; give numpy.float64 or numpy.float32"):
            graphdyn.mass_matrix(MODEL, zero, dtype=wrong)
    for method in ("projected", "dense"):
        with pytest.raises(InvalidInput, match=f"the {method} method computes in float64; omit dtype=, or use"):
            graphdyn.mass_matrix(MODEL, zero, dtype=FLOAT, method=method)
    with pytest.raises(
        InvalidInput, match=r"out for mass_matrix is float64 \(2, 4, 4\); give a float32 array of shape"
    ):
        graphdyn.mass_matrix(MODEL, zero, dtype=FLOAT, out=np.empty((2, 4, 4)))
    with pytest.raises(
        InvalidInput, match=r"joint_torques of robot 'four-bar' with loops computes in float64 only; omit"
    ):
        graphdyn.joint_torques(four, *np.zeros((3, 3)), dtype=FLOAT)
    for value in (np.nan, 1e39):
        with pytest.raises(InvalidInput, match=r"q contains (nan|inf) at row 1, joint"):
            graphdyn.mass_matrix(MODEL, zero + np.array([[0.0], [value]]), dtype=FLOAT)
