"""Scatter and bias of a plan with noise of positions, against other draws and against what theory says of a slide."""

from dataclasses import replace

import numpy as np
import pytest
from robots.moving_robots import slider

from crosscheck.exciting.encoder_noise import EncoderNoise, encoder_plan
from crosscheck.identifying import Preparation
from crosscheck.recordings import Recording
from graphdyn.excitation import (
    ExcitationProblem,
    FourierBasis,
    MotionLimits,
    excitation_plan,
    frame_origins,
    random_trajectory,
)
from graphdyn.identification import TorqueModel
from graphdyn.identification.terms import RigidBodies, Viscous

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
