"""Recursive least squares: the same as all at once, and what forgetting does."""

import numpy as np
import pytest
from identified import torque_data

from graphdyn import EstimationFailed, InvalidInput
from graphdyn.identification import RecursiveLeastSquares, Samples, TorqueModel
from graphdyn.identification.terms import Drift, MaxwellSlip, RigidBodies


def noisy():
    exact = torque_data.small_samples()
    noise = np.random.default_rng(0).normal(size=(120, 2)) * [3.0, 8.0]
    return Samples(exact.q, exact.v, exact.a, exact.tau + noise)


@pytest.mark.parametrize("forgetting", [1.0, 0.97])
def test_all_at_once(forgetting):
    """Sample by sample, then in pieces, against weighted rows; slow rows left out."""
    samples, model = noisy(), torque_data.small_arm()
    running = RecursiveLeastSquares(model, [3.0, 8.0], forgetting=forgetting, min_speed=0.1)
    for piece in (*samples[:40].pieces(1), *samples[40:].pieces(30)):
        running.update(piece)
    problem = torque_data.small_problem(np.zeros((120, 2)))
    w = model.rows(samples, problem.structure.base.independent)
    weights = forgetting ** (np.arange(120)[::-1, None] / 2) / np.array([3.0, 8.0]) * (np.abs(samples.v) >= 0.1)
    rows, right = (w * weights[..., None]).reshape(240, -1), (samples.tau * weights).ravel()
    expected = np.linalg.lstsq(rows, right, rcond=None)[0]
    assert running.solution.x == pytest.approx(expected, rel=1e-9, abs=1e-9)
    assert running.solution.inverse == pytest.approx(np.linalg.inv(rows.T @ rows), rel=1e-7, abs=1e-9)
    assert problem.structure.base.values(running.parameters) == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_forgets_a_friction_that_changed():
    """Half of the recording with 30 N m, then 50: with a memory of 10 samples only the latter is left."""
    exact = torque_data.small_samples()
    later = exact.tau + np.array([20.0, 0.0]) * np.sign(exact.v)
    changed = Samples(exact.q, exact.v, exact.a, np.where(np.arange(120)[:, None] < 60, exact.tau, later))
    for forgetting, friction, within in ((0.9, 50.0, 1.0), (1.0, 40.0, 5.0)):
        running = RecursiveLeastSquares(torque_data.small_arm(), 1.0, forgetting=forgetting)
        running.update(changed)
        assert running.parameters[22] == pytest.approx(friction, abs=within)


def test_refusals():
    model = torque_data.small_arm()
    with pytest.raises(InvalidInput, match=r"noise is 0\.; give one positive number, or 2"):
        RecursiveLeastSquares(model, 0.0)
    with pytest.raises(InvalidInput, match=r"forgetting is 1\.1; give a factor above 0 and up to 1"):
        RecursiveLeastSquares(model, 1.0, forgetting=1.1)
    slipping = TorqueModel(model.model, [RigidBodies(), Drift(MaxwellSlip())])
    with pytest.raises(InvalidInput, match="friction with memory needs whole runs"):
        RecursiveLeastSquares(slipping, 1.0)
    running = RecursiveLeastSquares(model, 1.0)
    with pytest.raises(EstimationFailed, match="has no effect"):
        _ = running.solution
    exact = torque_data.small_samples()
    with pytest.raises(InvalidInput, match="still have to go through a filter"):
        running.update(Samples(exact.q, exact.v, exact.a, exact.tau, row_filter=abs))
