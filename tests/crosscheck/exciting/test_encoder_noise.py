"""Scatter and bias of a plan with noise of positions, against other draws and against what theory says of a slide."""

from dataclasses import replace

import numpy as np
import pytest
from identified.small_study import ARM
from robots.moving_robots import slider

import urdf
from crosscheck.exciting.encoder_noise import EncoderNoise, encoder_plan
from crosscheck.identifying import Preparation
from crosscheck.recordings import Recording
from graphdyn.excitation import (
    ExcitationProblem,
    FourierBasis,
    MotionLimits,
    excitation_plan,
    expected_parameters,
    frame_origins,
    prior_spread,
    random_trajectory,
)
from graphdyn.identification import Problem, Samples, TorqueModel, WeightedLeastSquares
from graphdyn.identification.terms import RigidBodies, RotorInertia, Viscous

MASS = 2.0
"""[kg] Of the slide."""


@pytest.fixture(scope="module")
def planned():
    """A problem of a mass on a rail with viscous friction, a motion, and its plan without noise of positions."""
    model = slider()
    limits = MotionLimits.of_model(model, lower=-1.0, upper=1.0, velocity=2.0, acceleration=10.0)
    torque_model = TorqueModel(model, (RigidBodies(), Viscous()))
    problem = ExcitationProblem(torque_model, limits, FourierBasis(4.0, 3), 0.5, 500.0)
    course = random_trajectory(model, limits, frame_origins(model), problem.basis, np.random.default_rng(0))
    return problem, course, excitation_plan(problem.torque_model, problem.total_information(course))


def test_exact_positions_give_the_plan(planned):
    """Within what 60 draws know, and without bias."""
    problem, course, plan = planned
    found = encoder_plan(problem, [course], plan, EncoderNoise(0.0, None), draws=60)
    assert found.sigma == pytest.approx(plan.sigma, rel=0.35)
    assert np.all(np.abs(found.bias) < 4 * plan.sigma / np.sqrt(60))


def test_bias_of_a_slide(planned):
    """Errors of a, of variance s_a², and of v shrink mass and friction by F⁻¹ N diag(s_a², s_v²) / s² x."""
    problem, course, plan = planned
    noise = EncoderNoise(2e-4, 50.0)
    found = encoder_plan(problem, [course], plan, noise, draws=40)
    still = replace(course, coefficients=0.0 * course.coefficients)
    assert plan.names == ("M_1", "FV_1")
    truth = np.array([MASS, plan.spread[1]])
    # the same noise at rest: acceleration and velocity are the errors, and pass the filter of the equations
    preparation = Preparation(noise.cutoff)
    rng, rows = np.random.default_rng(1), round(problem.samples) + 1
    q = noise.position * rng.standard_normal((rows, 1)) + still.motion(np.zeros(1)).q[0]
    seen = preparation.differentiated(Recording(("rail",), np.arange(rows) / 500.0, q, tau=0.0 * q))
    (samples,) = preparation.samples(seen)
    v, a = (samples.row_filter(array) for array in (samples.v, samples.a))
    errors = rows * np.diag([np.var(a), np.var(v)]) / problem.noise[0] ** 2
    expected = -np.linalg.solve(plan.information + errors, errors @ truth)
    assert abs(expected[0]) > 20 * plan.sigma[0], "noise that matters"
    assert found.bias[0] == pytest.approx(expected[0], rel=0.1)


def test_other_draws_agree(planned):
    """Found over promised, as 60 further recordings have it."""
    problem, course, plan = planned
    noise = EncoderNoise(1e-4, 50.0)
    promised, found = (encoder_plan(problem, [course], plan, noise, 60, seed) for seed in (0, 1))
    assert found.sigma / promised.sigma == pytest.approx(np.ones(2), abs=0.4)
    assert found.bias == pytest.approx(promised.bias, abs=0.8 * promised.sigma.max())
    assert promised.mean_error(plan.spread) > np.log(plan.sigma / plan.spread).mean()


def test_joints_weigh_what_their_residuals_say():
    """As in identify, which knows no noise of the torques: the noise of one encoder fills the torque of one joint alone
    where the motion of the other is filtered away, and the bias depends on the weights."""
    model = urdf.load(ARM)
    limits = MotionLimits.of_model(model, lower=-2.0, upper=2.0, velocity=2.0, acceleration=10.0)
    torque_model = TorqueModel(model, (RigidBodies(), Viscous()))
    problem = ExcitationProblem(torque_model, limits, FourierBasis(3.0, 3), np.array([0.01, 5.0]), 200.0)
    course = random_trajectory(model, limits, frame_origins(model), problem.basis, np.random.default_rng(0))
    plan = excitation_plan(torque_model, problem.total_information(course))
    promised = encoder_plan(problem, [course], plan, EncoderNoise(1e-4, None), draws=30)
    truth = expected_parameters(torque_model)
    exact = course.motion(np.arange(601) / 200.0)
    tau = torque_model.torque(Samples(exact.q, exact.v, exact.a, 0 * exact.q), truth)
    rng, found = np.random.default_rng(1), []
    for _ in range(30):
        q, measured = (x + s * rng.standard_normal(x.shape) for x, s in ((exact.q, 1e-4), (tau, problem.noise)))
        recording = Recording(model.independent_joints, np.arange(601) / 200.0, q, tau=measured)
        fit = Problem(torque_model, Preparation(None).samples(Preparation(None).differentiated(recording)))
        found.append(fit.structure.base.values(WeightedLeastSquares().estimate(fit).parameters))
    bias = np.mean(found, axis=0) - plan.base.values(truth)
    assert np.abs(bias / promised.sigma).max() > 5, "bias that matters"
    assert (bias - promised.bias) / promised.sigma == pytest.approx(np.zeros(len(bias)), abs=4 * np.sqrt(2 / 30))


def test_drives_are_as_large_as_expected():
    """Rotors too, though their unit is that of bodies; bodies are those of the model."""
    torque_model = TorqueModel(slider(), (RigidBodies(), Viscous(), RotorInertia()))
    x = expected_parameters(torque_model)
    assert np.array_equal(x[:10], slider().inertial_parameters)
    assert np.all(x[10:] > 0)
    plan = excitation_plan(torque_model, np.eye(len(prior_spread(torque_model))))
    assert plan.prior[plan.names.index("FV_1")] == 0.0
