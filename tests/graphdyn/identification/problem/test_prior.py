"""Values that are known beforehand, and given noise: against the whole least squares problem, written out."""

from dataclasses import replace

import numpy as np
import pytest
from identified import closed_loop_data, torque_data

from graphdyn import Body, InvalidInput, Joint, Placement, RobotModel
from graphdyn.identification import (
    ClosedLoopOutputError,
    ConsistentLeastSquares,
    DirectInverse,
    InstrumentalVariables,
    MaximumLikelihood,
    OrdinaryLeastSquares,
    Problem,
    Ridge,
    TorqueModel,
    WeightedLeastSquares,
    compare_methods,
    model_prior,
)
from graphdyn.identification.terms import RigidBodies, Viscous

ROUNDING = 1e-9
"""Of parameters, relative to the largest: condition number times eps."""

NOISE = np.array([2.0, 3.0, 1.0, 0.5, 0.4, 0.2])
EXPECTED = {"FC_3": (1.9, 0.05), "FV_5": (3.7, 0.02)}
"""The recording alone has 1.73 ± 0.08 and 3.77 ± 0.05."""


@pytest.fixture(scope="module")
def problem():
    model = replace(torque_data.torque_model(), expected=EXPECTED, noise=NOISE)
    return Problem(model, torque_data.noisy_samples())


def dense(problem):
    """Base parameters that minimize all squares together, and their covariance."""
    samples, model, base = problem.data, problem.torque_model, problem.base
    w = model.rows(samples)[..., base.independent] / NOISE[:, None]
    right = (samples.tau - model.known_torque(samples)) / NOISE
    symbols = [model.columns[k].symbol for k in base.independent]
    rows = np.array([np.eye(base.rank)[symbols.index(name)] / deviation for name, (_, deviation) in EXPECTED.items()])
    a = np.concatenate([w.reshape(-1, base.rank), rows])
    b = np.concatenate([right.ravel(), [value / deviation for value, deviation in EXPECTED.values()]])
    return np.linalg.lstsq(a, b, rcond=None)[0], np.linalg.inv(a.T @ a)


def test_scale_of_bodies():
    """Of two bodies of 2 and 4 kg, with joints 0.3 and 0.5 m apart: 3 kg, 1.2 kg m, 0.48 kg m²; friction has none."""
    bodies = [Body(name, mass, np.zeros(3), np.eye(3)) for name, mass in (("A", 2.0), ("B", 4.0))]
    joints = [
        Joint(f"J{k}", "revolute", k, Placement(np.eye(3), np.array([0.0, size, 0.0])), [0.0, 0.0, 1.0])
        for k, size in enumerate((0.3, 0.5))
    ]
    arm = RobotModel("arm", tuple(bodies), tuple(joints))
    scale = model_prior(TorqueModel(arm, (RigidBodies(), Viscous()))).scale
    assert scale[:10] == pytest.approx([3.0, *[1.2] * 3, *[0.48] * 6])
    assert np.array_equal(scale[10:20], scale[:10])
    assert np.isinf(scale[20:]).all()


def test_weighted_against_the_recording(problem):
    x, covariance = dense(problem)
    estimate = WeightedLeastSquares().estimate(problem)
    found = problem.base.values(estimate.parameters)
    assert np.abs(found - x).max() <= ROUNDING * np.abs(x).max()
    assert np.abs(estimate.covariance - covariance).max() <= ROUNDING * np.abs(covariance).max()
    assert np.array_equal(estimate.noise, NOISE)
    plain = Problem(replace(problem.torque_model, expected={}), problem.data)
    k = [plain.torque_model.columns[k].symbol for k in plain.base.independent].index("FC_3")
    alone = plain.base.values(WeightedLeastSquares().estimate(plain).parameters)
    assert alone[k] < found[k] < 1.9
    assert problem.without_effect == ()


def test_every_weighing_method_takes_the_noise():
    """Also where it would estimate it again in each iteration."""
    run = closed_loop_data.two_axes().record(1.0)
    errors = np.tile(np.diag([1e-12, 1e-12, 1e-12]), (2, 1, 1))
    model = replace(run.torque_model, noise=[3.0, 7.0])
    problem = Problem(model, replace(run.exact, motion_covariance=errors), min_speed=1e-9)
    start = {"loop": run.loop, "start": run.truth}
    methods = [
        MaximumLikelihood(),
        InstrumentalVariables(**start),
        DirectInverse(**start),
        ClosedLoopOutputError("torque", **start),
    ]
    for method in methods:
        assert np.array_equal(method.estimate(problem).noise, [3.0, 7.0]), method.name


@pytest.mark.parametrize("method", [Ridge(strength=1e-12), ConsistentLeastSquares()])
def test_other_methods(method, problem):
    """Real bodies are among the best fits here."""
    x, _ = dense(problem)
    found = problem.base.values(method.estimate(problem).parameters)
    assert np.abs(found - x).max() <= ROUNDING * np.abs(x).max()


def test_methods_that_take_none(problem):
    found = compare_methods(problem, [OrdinaryLeastSquares(), WeightedLeastSquares()], poses=1)
    assert "takes no expected values; use one that does" in found.of("OLS").failure
    assert found.of("WLS").failure is None


def test_parameters_that_show_in_sums(problem):
    model = replace(problem.torque_model, expected={"M_2": (50.0, 1.0)})
    summed = Problem(model, problem.data)
    assert summed.without_effect == ("M_2",)
    assert summed.equations.expected is None


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"expected": {"FX_1": (1.0, 1.0)}}, "'FX_1' is expected, but there is no such parameter; known: M_1, MX_1"),
        ({"expected": {"FC_1": (1.0, 0.0)}}, "'FC_1' is expected to be 1 ± 0; give a deviation above zero"),
        ({"noise": [1.0, 2.0]}, r"noise of the torques is \[1\. 2\.\]; give one positive number, or 6"),
    ],
)
def test_refusals(changed, message):
    with pytest.raises(InvalidInput, match=message):
        replace(torque_data.torque_model(), **changed)
