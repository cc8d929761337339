"""Noise on both sides: a second solver for the minimum, simulated recordings for bias and standard deviations."""

from dataclasses import replace

import numpy as np
import pytest
from identified import torque_data
from scipy.optimize import least_squares

import graphdyn
from crosscheck.recordings.preparation.filtering import TorqueFilter
from graphdyn import EstimationFailed, InvalidInput
from graphdyn.identification import MaximumLikelihood, Problem, Samples, TorqueModel, WeightedLeastSquares
from graphdyn.identification.estimators.maximum_likelihood import joined, measured_motion
from graphdyn.identification.problem.slopes import torque_slopes
from graphdyn.identification.terms import Drift, MaxwellSlip, RigidBodies, Viscous
from graphdyn.motion_laws import FourierSeries

RUNS = 15

CALIBRATED = 0.5
"""Of the mean of (error / σ)² less 1, which RUNS recordings of four parameters know to sqrt(2 / 4 RUNS) = 0.18."""

NOISE = np.array([1.0, 2.0])
"""[N m] Of the torques."""

ERRORS = np.array([[4e-6, 0, -6e-5], [0, 1e-4, 0], [-6e-5, 0, 0.01]]) * np.array([1.0, 2.0])[:, None, None]
"""Covariance of the errors of q, v and a: 2 mrad, 0.01 rad/s, 0.1 rad/s²; q and a share theirs."""


def measured(exact, rng, errors=ERRORS, noise=NOISE):
    """With errors on q, v, a and the torques."""
    root = np.linalg.cholesky(errors + 1e-30 * np.eye(3))
    q, v, a = np.einsum("jde,tje->dtj", root, rng.normal(size=(*exact.q.shape, 3)))
    tau = exact.tau + noise * rng.normal(size=exact.tau.shape)
    return Samples(exact.q + q, exact.v + v, exact.a + a, tau, motion_covariance=errors)


def values(problem, method):
    return problem.base.values(method.estimate(problem).parameters)


def test_without_errors_of_the_motion_it_is_wls():
    samples = measured(torque_data.small_samples(), np.random.default_rng(0), 0 * ERRORS)
    problem = Problem(torque_data.small_arm(), samples, min_speed=0.1)
    wls = WeightedLeastSquares().estimate(problem)
    ml = MaximumLikelihood(torque_noise=wls.noise).estimate(problem)
    assert ml.parameters == pytest.approx(wls.parameters, rel=1e-9)
    assert ml.covariance == pytest.approx(wls.covariance, rel=1e-9)
    assert ml.block_covariance == pytest.approx(wls.block_covariance, rel=1e-6)


def test_of_decimated_equations_every_fifth_motion_counts():
    samples = measured(torque_data.small_samples(600), np.random.default_rng(0))
    problem = Problem(torque_data.small_arm(), replace(samples, row_filter=TorqueFilter(factors=(5,))))
    motion = [part.motion.q for part in measured_motion(problem)]
    assert np.array_equal(np.concatenate(motion), samples.q[::5])


def test_slopes():
    """Those of the bodies are the derivatives of inverse dynamics; viscous friction adds to those by v."""
    model, exact = torque_data.small_arm(), torque_data.small_samples()
    x = torque_data.small_parameters()
    slopes = torque_slopes(model, x, exact[10:12], np.full((3, 2), 1e-4))
    known = graphdyn.inverse_dynamics_derivatives(model.model, exact.q[10:12], exact.v[10:12], exact.a[10:12])
    dv = known.dtau_dv + np.diag(x[20:22])
    expected = np.concatenate([known.dtau_dq, dv, known.dtau_da], axis=-1)
    assert slopes == pytest.approx(expected, rel=1e-6, abs=1e-6 * np.abs(expected).max())


def test_minimum_against_a_second_solver():
    """All parameters and the true motion of every sample together."""
    arm, exact = torque_data.small_arm().model, torque_data.small_samples()[::6]
    model, count = TorqueModel(arm, (RigidBodies(), Viscous())), len(exact)
    exact = replace(exact, tau=model.torque(exact, torque_data.small_parameters()[:22]))
    samples = measured(exact, np.random.default_rng(1), ERRORS / 100)
    problem = Problem(model, samples)
    independent = problem.base.independent
    white = np.linalg.inv(np.linalg.cholesky(joined(samples.motion_covariance)))
    seen = np.hstack([samples.q, samples.v, samples.a])

    def residuals(unknown):
        x, shift = np.split(unknown, [problem.base.rank])
        shift = shift.reshape(count, -1)
        q, v, a = np.split(seen + shift, 3, axis=1)
        w = model.rows(Samples(q, v, a, samples.tau), independent)
        return np.concatenate([((samples.tau - w @ x) / NOISE).ravel(), (shift @ white.T).ravel()])

    found = MaximumLikelihood(torque_noise=NOISE).estimate(problem)
    start = np.concatenate([values(problem, WeightedLeastSquares()), np.zeros(seen.size)])
    expected = least_squares(residuals, start, x_scale="jac", xtol=1e-12, ftol=1e-12).x[: problem.base.rank]
    deviations = np.sqrt(np.diag(found.covariance))
    assert np.all(np.abs(problem.base.values(found.parameters) - expected) < 0.01 * deviations)


def test_no_bias_and_standard_deviations():
    """A pendulum with viscous friction; the errors are a tenth of its velocities and accelerations."""
    body = graphdyn.Body("B", 5.0, [0.1, 0.0, 0.3], 0.8 * np.eye(3))
    joint = graphdyn.Joint("J", "revolute", 0, graphdyn.Placement(), [0.0, 1.0, 0.0])
    model = TorqueModel(graphdyn.RobotModel("pendulum", (body,), (joint,)), (RigidBodies(), Viscous()))
    truth, rng = np.append(model.model.inertial_parameters, 4.0), np.random.default_rng(2)
    a, b = 0.2 * rng.normal(size=(2, 8))
    motion = graphdyn.simulate_recording(model.model, np.linspace(0.0, 10.0, 1200), [FourierSeries(0.1, a, b)])
    exact = Samples(motion.q, motion.v, motion.a, motion.tau)
    exact = replace(exact, tau=model.torque(exact, truth))
    errors = np.array([[[3e-5, 0, -3e-4], [0, 3e-3, 0], [-3e-4, 0, 0.03]]])
    scores, noises = {"ML": [], "WLS": []}, []
    for _ in range(RUNS):
        problem = Problem(model, measured(exact, rng, errors, 0.5))
        for name, method in (("ML", MaximumLikelihood()), ("WLS", WeightedLeastSquares())):
            found = method.estimate(problem)
            error = problem.base.values(found.parameters) - problem.base.values(truth)
            scores[name].append(error**2 / np.diag(found.covariance))
            noises += [found.noise] if name == "ML" else []
    assert abs(np.mean(scores["ML"]) - 1) < CALIBRATED
    assert np.mean(scores["WLS"]) > 2
    assert np.mean(noises) == pytest.approx(0.5, rel=0.1), "of the torque alone, without what the motion explains"


def test_torques_without_noise_keep_a_tenth_of_the_residual():
    """Errors of the motion are never exact: they explain at most 99 % of its square."""
    problem = Problem(torque_data.small_arm(), measured(torque_data.small_samples(), np.random.default_rng(4), noise=0))
    wls, ml = (method.estimate(problem) for method in (WeightedLeastSquares(), MaximumLikelihood()))
    assert ml.noise / wls.noise == pytest.approx(0.1, rel=0.3)


def test_some_rows_with_a_drift():
    """As of those rows alone, and the drift moves with its time."""
    exact = torque_data.small_samples()
    time = np.linspace(0.0, 10.0, len(exact))
    samples = replace(measured(exact, np.random.default_rng(3), ERRORS / 100), time=time)
    model = TorqueModel(torque_data.small_arm().model, (RigidBodies(), Viscous(), Drift(Viscous())))
    used = np.arange(len(exact)) >= len(exact) // 4
    found = values(Problem(model, samples).part(used), MaximumLikelihood(torque_noise=NOISE))
    alone = values(Problem(model, samples[len(exact) // 4 :]), MaximumLikelihood(torque_noise=NOISE))
    assert found == pytest.approx(alone, rel=1e-6, abs=1e-6 * np.abs(alone).max())


def test_refusals():
    exact = torque_data.small_samples()
    with pytest.raises(EstimationFailed, match=r"needs the errors of q, v and a \(motion_covariance of the samples\)"):
        MaximumLikelihood().estimate(Problem(torque_data.small_arm(), exact))
    with pytest.raises(InvalidInput, match=r"torque_noise is 0\.; give one positive number, or 2"):
        MaximumLikelihood(torque_noise=0.0).estimate(Problem(torque_data.small_arm(), exact))
    with pytest.raises(InvalidInput, match=r"motion_covariance of the samples has shape \(3, 3\), expected \(2"):
        replace(exact, motion_covariance=np.eye(3))
    noisy = Problem(torque_data.small_arm(), measured(exact, np.random.default_rng(0)))
    with pytest.raises(EstimationFailed, match="diverged: after 1 iterations the estimate still moves by"):
        MaximumLikelihood(most=1).estimate(noisy)
    base = graphdyn.BaseMotion(translation=np.zeros(3))
    moving = Problem(torque_data.small_arm(), replace(exact, base=base, motion_covariance=ERRORS))
    with pytest.raises(EstimationFailed, match="the base of the recording moves; errors of the motion know a base at"):
        MaximumLikelihood().estimate(moving)
    slipping = TorqueModel(torque_data.small_arm().model, (RigidBodies(), MaxwellSlip()))
    with pytest.raises(EstimationFailed, match="friction with memory takes all rows together"):
        MaximumLikelihood().estimate(Problem(slipping, replace(exact, motion_covariance=ERRORS)))
