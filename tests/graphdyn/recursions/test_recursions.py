"""The recursive method on every back end agrees with the equations as they are written, for any tree."""

import numpy as np
import pytest
from back_ends import BACK_ENDS, LONG_ROBOTS, on
from examples import examples
from hypothesis import given
from long_check import LONG
from random_trees import (
    NAMED,
    SEEDS,
    random_base_motion,
    random_state,
    random_wrenches,
    robots,
)
from witnesses import acceleration_scale, relative_error

import graphdyn
from graphdyn.compiler.programs import Request
from graphdyn.compiler.running import run
from graphdyn.recursions import RECURSIONS

EPS = np.finfo(float).eps

ACCELERATION = 10 * EPS
"""Times acceleration_scale, what one eps of rounding in M, τ and the wrenches does: measured 3.9 eps over 300 trees."""

BODY_ACCELERATION = 10 * ACCELERATION
"""The same for bodies: joint accelerations times levers, of which a tree sums some meters. Measured 2.4 eps."""

WRENCH = 50 * EPS
"""Times cond(M), relative to the largest wrench, as wrenches carry the error of the accelerations: measured 13 eps."""

SUM = 1e-13
"""The same sum in another order, relative to its largest term: measured 3.7e-15."""

many = examples(15)
few = examples(2)
"""Compiling a robot's programs takes a second."""


def differences(model, seed, count):
    """Recursive against dense, every verb and every output, with external wrenches on a moving base.

    Yields (name, error, tolerance) for every sample.
    """
    q, v, a = random_state(model, seed, (count,))
    wrenches = random_wrenches(model, seed + 1, (count,))
    base = random_base_motion(seed + 2, (count,))
    found = every_output(model, q, v, a, wrenches, base, "recursive")
    for k in range(count):
        at = graphdyn.BaseMotion(**{name: getattr(base, name)[k] for name in MOTION})
        dense = every_output(model, q[k], v[k], a[k], wrenches[k], at, "dense")
        wrench = max(np.abs(x).max() for x in (dense["inverse joint_wrenches"], dense["free"], wrenches[k]))
        motion = np.abs(dense["inverse body_accelerations"]).max() + np.linalg.norm(model.gravity)
        solved = max(np.abs(x).max() for x in (dense["forward joint_wrenches"], wrenches[k]))
        scale = acceleration_scale(dense["mass"], dense["forward a"], a[k], solved)
        weak = WRENCH * np.linalg.cond(dense["mass"])
        for name, value in dense.items():
            if name == "forward a":
                size, tolerance = scale, ACCELERATION
            elif name == "forward body_accelerations":
                size, tolerance = scale + np.abs(value).max(), BODY_ACCELERATION
            elif name.startswith("forward"):
                size, tolerance = max(np.abs(value).max(initial=0.0), solved), weak
            elif name in ("bias", "free") or (name.startswith("inverse") and "accelerations" not in name):
                size, tolerance = wrench, SUM
            else:
                size, tolerance = max(np.abs(value).max(), 0.0 if name == "mass" else motion), SUM
            yield name, np.abs(found[name][k] - value).max(initial=0.0) / size, tolerance


MOTION = ("rotation", "translation", "velocity", "acceleration")


def every_output(model, q, v, a, wrenches, base, method):
    """Arrays by name; a serves as torque too."""
    how = {"base": base, "method": method}
    f = graphdyn.forward_dynamics(model, q, v, a, wrenches, **how)
    i = graphdyn.inverse_dynamics(model, q, v, a, wrenches, **how)
    s = graphdyn.maximal_state(model, q, v, a, **how)
    return {
        **{f"forward {name}": value for name, value in vars(f).items()},
        **{f"inverse {name}": value for name, value in vars(i).items()},
        **{name: getattr(s, name) for name in ("position", "rotation", "velocity", "acceleration")},
        "free": graphdyn.inverse_dynamics(model, q, v, a, **how).joint_wrenches,
        "mass": graphdyn.mass_matrix(model, q, **how),
        "bias": graphdyn.bias_torque(model, q, v, **how),
        "torque regressor": graphdyn.joint_torque_regressor(model, q, v, a, **how),
        "body regressor": graphdyn.body_regressor(model, q, v, a, **how),
    }


def assert_agrees(model, seed, count):
    for name, error, tolerance in differences(model, seed, count):
        assert error < tolerance, name


@many
@given(robots(), SEEDS)
def test_numpy_agrees_with_the_equations(model, seed):
    with on("numpy"):
        assert_agrees(model, seed, count=2)


WHOLE_ROBOT = (
    *("center_of_mass", "center_of_mass_velocity", "center_of_mass_jacobian", "momentum", "centroidal_map"),
    *("static_torque", "power", "energy_regressor", "momentum_regressor", "forward_dynamics_parameter_derivatives"),
)
"""Sums over all bodies, and columns of their parameters."""


@examples(10)
@given(robots(), SEEDS)
def test_answers_for_the_whole_robot_agree_with_the_equations(model, seed):
    state, base = random_state(model, seed), random_base_motion(seed + 1)
    condition = np.linalg.cond(graphdyn.mass_matrix(model, state[0]))
    for name in WHOLE_ROBOT:
        verb, arguments = getattr(graphdyn, name), state[: len(RECURSIONS[name].inputs)]
        with on("numpy"):
            found = verb(model, *arguments, base=base, method="recursive")
        plain = verb(model, *arguments, base=base, method="dense")
        of_mass = WRENCH * condition if name == "forward_dynamics_parameter_derivatives" else SUM
        for array, expected in zip(parts(found), parts(plain), strict=True):
            assert relative_error(array, expected) < of_mass, name


@examples(10)
@given(robots(), SEEDS)
def test_the_factors_of_the_mass_matrix_have_the_pivots_of_the_elimination(model, seed):
    """Featherstone, 2008, section 6.5: D of M = Lᵀ D L are the articulated inertias about the joints."""
    q, v, tau = np.atleast_2d(*random_state(model, seed)[:3])
    found, expected = np.empty((2, 1, model.n_bodies))
    with on("numpy"):
        run(model, Request("mass_matrix_inverse", ("pivots",)), {"q": q}, {"pivots": found})
        run(model, Request("forward_dynamics", ("pivots",)), {"q": q, "v": v, "tau": tau}, {"pivots": expected})
    assert np.allclose(found, expected, rtol=SUM * np.linalg.cond(graphdyn.mass_matrix(model, q[0])), atol=0)


def parts(answer):
    return [answer] if isinstance(answer, np.ndarray) else list(vars(answer).values())


@pytest.mark.parametrize("back_end", ["host", "2 lanes", pytest.param("4 lanes", marks=LONG), LONG_ROBOTS])
@few
@given(robots(max_bodies=4), SEEDS)
def test_compiled_code_agrees_with_the_equations(back_end, model, seed):
    with on(back_end):
        assert_agrees(model, seed, count=3)


def test_a_six_axis_arm_agrees_with_the_equations():
    """As many samples as lanes and one more."""
    with on("host"):
        assert_agrees(NAMED["kr500"], 5, count=9)


@pytest.mark.parametrize("back_end", BACK_ENDS)
def test_one_array_alone_is_that_of_the_whole_answer(back_end):
    """Programs that compute less compute it in the same way, so the differences are those of contraction alone."""
    model = NAMED["mixed_chain"]
    q, v, x = random_state(model, 7, (5,))
    wrenches, base = random_wrenches(model, 8, (5,)), random_base_motion(9, (5,))
    keywords = {"base": base, "method": "recursive"}
    with on(back_end):
        f = graphdyn.forward_dynamics(model, q, v, x, wrenches, **keywords)
        i = graphdyn.inverse_dynamics(model, q, v, x, wrenches, **keywords)
        a = graphdyn.joint_accelerations(model, q, v, x, wrenches, **keywords)
        tau = graphdyn.joint_torques(model, q, v, x, wrenches, **keywords)
    condition = np.linalg.cond(graphdyn.mass_matrix(model, q)).max()
    assert relative_error(a, f.a) < WRENCH * condition
    assert relative_error(tau, i.tau, i.joint_wrenches) < SUM


@many
@given(robots(), SEEDS)
def test_the_motion_of_a_base_that_rests_is_that_of_no_base(model, seed):
    """Programs with the ground as input against programs with the ground built in."""
    q, v, a = random_state(model, seed, (2,))
    with on("numpy"):
        fixed = graphdyn.inverse_dynamics(model, q, v, a, method="recursive")
        resting = graphdyn.inverse_dynamics(model, q, v, a, base=graphdyn.BaseMotion(), method="recursive")
    for name, value in vars(fixed).items():
        assert relative_error(getattr(resting, name), value, fixed.joint_wrenches) < SUM
