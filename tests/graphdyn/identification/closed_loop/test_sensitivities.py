"""Sensitivities of the simulated loop against complex steps of a closed form, and against whole simulations."""

from dataclasses import replace

import numpy as np
import pytest
from identified import closed_loop_data
from robots.mechanisms import four_bar

import graphdyn
from graphdyn import EstimationFailed
from graphdyn.identification import ClosedLoop, ClosedLoopOutputError, Problem, Samples, TorqueModel
from graphdyn.identification.closed_loop import SimulatedLoop
from graphdyn.identification.closed_loop import sensitivities as of_loops
from graphdyn.identification.closed_loop.sensitivities import sensitivities
from graphdyn.identification.problem.prior import model_prior
from graphdyn.identification.terms import RigidBodies

TRAPEZOIDAL = 2e-4
"""Error of steps of a millisecond, for a loop whose fastest time constant is 100 ms."""

AGAINST_SIMULATIONS = 0.01
"""Of all rows that move, which the fast poles of the loop and the instants of sticking set."""

MOVING = 0.05
"""[rad/s] Rows of slower joints are left out where methods are compared."""


def central_differences(loop, x, k):
    """δq and δτ of base parameter k, of two simulations."""
    prior, base = model_prior(loop.problem.torque_model), loop.problem.base
    step = 1e-4 * np.linalg.norm(loop.problem.equations.measured_squares) ** 0.5
    step /= np.linalg.norm(loop.problem.equations.factors[..., k])
    (up,), (down,) = (loop.samples(prior.nearest(base, x + sign * step * np.eye(len(x))[k])) for sign in (1, -1))
    return (up.q - down.q) / (2 * step), (up.tau - down.tau) / (2 * step)


def worst_difference(loop, truth):
    """Of the rows that move, relative to their size: over both outputs and all base parameters."""
    x = loop.problem.base.values(truth)
    moving = np.abs(loop.samples(truth)[0].v) > MOVING
    ((by_q, by_tau),) = sensitivities(loop, x)
    errors = []
    for k in range(len(x)):
        for found, expected in zip((by_q[..., k], by_tau[..., k]), central_differences(loop, x, k), strict=True):
            errors.append(np.linalg.norm((found - expected)[moving]) / np.linalg.norm(expected[moving]))
    return max(errors)


def test_against_complex_steps():
    """A mass m on a slide, drawn to the position u by a force K_p (u - q) - K_d v that is held for a millisecond."""
    slide = graphdyn.RobotModel(
        "slide",
        (graphdyn.Body("M", 2.0, np.zeros(3), np.eye(3)),),
        (graphdyn.Joint("S", "prismatic", 0, graphdyn.Placement(), [1.0, 0, 0]),),
    )
    hold, rows = 1e-3, 501

    def course(m):
        q, v, found = 0.0 * m, 0.0 * m, []
        for _ in range(rows):
            force = 50.0 * (0.3 - q) - 4.0 * v
            found.append((q, force))
            q, v = q + hold * v + hold**2 / 2 * force / m, v + hold * force / m
        return np.array(found)

    expected = course(2.0 + 1e-20j).imag / 1e-20
    q = course(2.0)[:, :1]
    v = np.gradient(q, hold, axis=0)
    v[0] = 0.0
    a = np.gradient(v, hold, axis=0)
    problem = Problem(TorqueModel(slide, (RigidBodies(),)), Samples(q, v, a, 2 * a, time=hold * np.arange(rows)))
    loop = SimulatedLoop(problem, ClosedLoop(graphdyn.PDControl(50.0, 4.0, [0.3], period=hold)))
    for found, column in zip(*sensitivities(loop, np.array([2.0])), expected.T, strict=True):
        assert found[:, 0, 0] == pytest.approx(column, abs=TRAPEZOIDAL * np.abs(column).max())


@pytest.mark.parametrize(("period", "control_period"), [(1e-3, 1e-3), (4e-3, 1e-3)])
def test_against_simulations(period, control_period):
    """Two axes of a big arm with dry friction, whose velocities pass zero and stick there."""
    run = closed_loop_data.two_axes().record(2.0, period=period, control_period=control_period)
    loop = SimulatedLoop(Problem(run.torque_model, run.exact), run.loop)
    assert worst_difference(loop, run.truth) < AGAINST_SIMULATIONS


def test_computed_torque():
    run = closed_loop_data.two_axes().record(1.0)
    control = graphdyn.ComputedTorqueControl(900.0, 60.0, run.exact.q[0] + 0.2, period=1e-3)
    loop = SimulatedLoop(Problem(run.torque_model, run.exact), ClosedLoop(control))
    assert worst_difference(loop, run.truth) < AGAINST_SIMULATIONS


def test_a_function_as_controller():
    """That of the recording, in Python: the same sensitivities."""
    plant = closed_loop_data.two_axes()
    run = plant.record(0.05)
    problem, laws = Problem(run.torque_model, run.exact), plant.laws

    def law(t, q, v):
        target = np.array([[part[0] for part in one(np.array([t - plant.start]))] for one in laws])
        return plant.position_gain * (target[:, 0] - q) + plant.velocity_gain * (target[:, 1] - v)

    x = problem.base.values(run.truth)
    loops = (SimulatedLoop(problem, loop) for loop in (run.loop, ClosedLoop(law, period=1e-3)))
    for compiled, python in zip(*(next(sensitivities(loop, x)) for loop in loops), strict=True):
        np.testing.assert_allclose(python, compiled, rtol=1e-6, atol=1e-6 * np.abs(compiled).max())


def test_what_is_refused(monkeypatch):
    run = closed_loop_data.two_axes().record(0.2)
    problem = Problem(run.torque_model, run.exact)
    monkeypatch.setattr(of_loops, "MAX_SENSITIVITY_BYTES", 1e4)
    with pytest.raises(EstimationFailed, match=r"the sensitivities of 201 rows take 0\.0 GB; give a shorter part"):
        ClosedLoopOutputError(loop=run.loop).estimate(problem)
    loops = replace(run.torque_model, model=four_bar(), terms=(RigidBodies(),))
    with pytest.raises(EstimationFailed, match="knows no robots with loops; DIDIM and IDIM-IV do"):
        next(sensitivities(SimulatedLoop(Problem(loops, run.exact), run.loop), np.zeros(1)))
