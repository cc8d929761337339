"""The extended Kalman filter: where the robot is linear, least squares over everything; parameters of an arm found."""

import numpy as np
import pytest
from identified import torque_data

import graphdyn
from graphdyn import EstimationFailed, InvalidInput
from graphdyn.identification import ExtendedKalmanFilter, Samples, TorqueModel
from graphdyn.identification.problem.torque_model import structure
from graphdyn.identification.terms import Drift, KnownBodies, MaxwellSlip, Offset, RigidBodies, Viscous
from graphdyn.motion_laws import FourierSeries

PERIOD = 1e-2


def slide(mass):
    body = graphdyn.Body("M", mass, np.zeros(3), np.eye(3))
    return graphdyn.RobotModel(
        "slide", (body,), (graphdyn.Joint("S", "prismatic", 0, graphdyn.Placement(), [1.0, 0, 0]),)
    )


def test_a_linear_robot_against_least_squares():
    """A known mass under an unknown force: the noise of every torque, first state and offset, all at once."""
    mass, count, rng = 2.0, 30, np.random.default_rng(0)
    position, torque, spread = 1e-3, 0.5, 3.0
    tau, q = rng.normal(size=(2, count, 1))
    running = ExtendedKalmanFilter(
        TorqueModel(slide(mass), (Offset(),), known=(KnownBodies(),)),
        PERIOD,
        position_noise=position,
        torque_noise=torque,
        spread=spread,
    )
    running.update(Samples(q, np.zeros((count, 1)), q, tau))

    # state (q, v, offset, noise of the torques) at the first sample → positions and velocities at all later ones
    later = np.zeros((count, 2, 3 + count))
    later[0, 0, 0] = later[0, 1, 1] = 1.0
    known = np.zeros((count, 2))
    for k in range(count - 1):
        force = np.zeros(3 + count)
        force[2], force[3 + k] = -1.0, 1.0
        for change, size in ((later[k + 1], force), (known[k + 1], tau[k, 0])):
            before = later[k] if size is force else known[k]
            change[0] = before[0] + PERIOD * before[1] + PERIOD**2 / 2 / mass * size
            change[1] = before[1] + PERIOD / mass * size
    deviations = np.concatenate([[position, np.sqrt(2) * position / PERIOD, spread], np.full(count, torque)])
    rows = np.vstack([later[1:, 0] / position, np.diag(1 / deviations)])
    right = np.concatenate([(q[1:, 0] - known[1:, 0]) / position, np.zeros(3 + count)])
    right[count - 1] = q[0, 0] / position
    expected = np.linalg.lstsq(rows, right, rcond=None)[0]
    assert running.values == pytest.approx(expected[2], rel=1e-6)
    assert running.covariance == pytest.approx(np.linalg.inv(rows.T @ rows)[2, 2], rel=1e-6)


def test_drift_is_a_random_walk():
    """Where positions say nothing, the variance grows by drift² in every second, whatever the period is."""
    for period in (PERIOD, 4 * PERIOD):
        running = ExtendedKalmanFilter(
            TorqueModel(slide(2.0), (Offset(),), known=(KnownBodies(),)), period,
            position_noise=1e9, torque_noise=1e-9, spread=3.0, drift=0.7,
        )  # fmt: skip
        count = round(0.24 / period) + 1
        running.update(Samples(*np.zeros((4, count, 1))))
        assert running.covariance == pytest.approx(3.0**2 + 0.7**2 * 0.24, rel=1e-9)


def test_parameters_of_an_arm():
    """From 15 % beside the truth, with noise on positions and torques; a torque that is held between the samples."""
    arm, rng = torque_data.small_arm().model, np.random.default_rng(1)
    model = TorqueModel(arm, (RigidBodies(), Viscous()))
    truth = np.append(arm.inertial_parameters, [20.0, 15.0])
    laws = [FourierSeries(0.25, *rng.normal(size=(2, 3)) * 0.3) for _ in range(2)]
    control = graphdyn.PDControl([2e4, 2e4], [2e3, 2e3], laws, period=4e-3)
    start = [[law(np.zeros(1))[k][0] for law in laws] for k in (0, 1)]
    friction = graphdyn.Friction(viscous=truth[-2:])
    run = graphdyn.rollout(arm, *start, control, step=4e-3, duration=0.8, friction=friction)
    q = run.q[0] + 1e-4 * rng.normal(size=run.q[0].shape)
    tau = run.tau[0] + 1.0 * rng.normal(size=run.q[0].shape)
    running = ExtendedKalmanFilter(
        model,
        4e-3,
        position_noise=1e-4,
        torque_noise=1.0,
        start=0.85 * truth,
        spread=0.15 * np.abs(truth) + 0.1,
    )
    running.update(Samples(q, run.v[0], run.a[0], tau))
    base = structure(model).base
    error = running.values - base.values(truth)
    w = model.rows(Samples(run.q[0], run.v[0], run.a[0], run.tau[0]), base.independent)
    assert np.linalg.norm(w @ error) < 0.2 * np.linalg.norm(w @ base.values(0.15 * truth))
    assert np.mean(error**2 / np.diag(running.covariance)) < 3
    assert base.values(running.parameters) == pytest.approx(running.values, rel=1e-9)


def test_refusals():
    model = torque_data.small_arm()
    good = {"position_noise": 1e-4, "torque_noise": 1.0, "spread": 1.0}
    for wrong, message in (
        ({"position_noise": 0.0}, r"position_noise is 0\.; give one positive number, or 2"),
        ({"velocity_noise": -1.0}, r"velocity_noise is -1\.; give one positive number, or 2"),
        ({"spread": [1.0, 2.0]}, r"spread is \[1\. 2\.\]; give one positive number, or 24"),
        ({"start": np.ones(3)}, r"start has shape \(3,\), expected \(24,\) finite numbers"),
        ({"start": np.full(24, np.nan)}, r"start has shape \(24,\), expected \(24,\) finite numbers"),
        ({"drift": [1.0, 2.0]}, r"drift is \[1\. 2\.\]; give one number that is not negative, or 24"),
        ({"drift": -1.0}, r"drift is -1\.; give one number that is not negative"),
    ):
        with pytest.raises(InvalidInput, match=message):
            ExtendedKalmanFilter(model, 1e-3, **(good | wrong))
    with pytest.raises(InvalidInput, match=r"period is 0\.0; give seconds above zero"):
        ExtendedKalmanFilter(model, 0.0, **good)
    for term in (MaxwellSlip(), Drift(Viscous())):
        with pytest.raises(InvalidInput, match="a function of q, v and a; leave friction with memory and drifts out"):
            ExtendedKalmanFilter(TorqueModel(model.model, [RigidBodies(), term]), 1e-3, **good)
    running = ExtendedKalmanFilter(model, 1e-3, **good)
    with pytest.raises(EstimationFailed, match="no sample has arrived yet"):
        _ = running.covariance
    exact = torque_data.small_samples()
    with pytest.raises(InvalidInput, match="still have to go through a filter; the filter of Kalman needs raw ones"):
        running.update(Samples(exact.q, exact.v, exact.a, exact.tau, row_filter=abs))
    base = graphdyn.BaseMotion(translation=np.zeros(3))
    with pytest.raises(InvalidInput, match="the base of the samples moves; the filter of Kalman knows a base at rest"):
        running.update(Samples(exact.q, exact.v, exact.a, exact.tau, base=base))
    lighter = ExtendedKalmanFilter(model, 1e-3, **good, start=-torque_data.small_parameters())
    with pytest.raises(EstimationFailed, match="the mass matrix of its parameters is not positive definite; give a"):
        lighter.update(exact[:2])
