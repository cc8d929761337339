"""Settings of terms that the torque is not linear in, found by variable projection."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.optimize
from identified import torque_data

from graphdyn import InvalidInput
from graphdyn.identification import Problem, Samples, TorqueModel, Tunable, tuned
from graphdyn.identification.terms import Coulomb, MaxwellSlip, Offset, RigidBodies, Stribeck, Viscous

FOUND = 0.01
"""Relative error of a setting from exact data: the search ends when the sum of squares falls by less than 1e-4."""

NOISE_SCATTER = 4.0
"""Standard deviations by which an estimate may be beside the truth."""


@pytest.fixture(scope="module")
def arm():
    """Two axes that go back and forth, slowly enough for all of a friction curve."""
    model = torque_data.small_arm().model
    t = np.linspace(0, 20, 1500)
    phases = np.outer(t, [0.9, 1.3])
    q = 0.6 * np.sin(phases) + 0.2 * np.cos(3.1 * phases)
    v, a = (np.gradient(x, t, axis=0) for x in (q, np.gradient(q, t, axis=0)))
    return model, Samples(q, v, a, np.zeros_like(q))


def recorded(model, samples, terms, x, noise=0.0):
    truth = TorqueModel(model, [RigidBodies(), *terms])
    tau = truth.torque(samples, np.concatenate([model.inertial_parameters, x]))
    return replace(samples, tau=tau + noise * np.random.default_rng(0).normal(size=tau.shape))


def one_slip(deflection):
    return MaxwellSlip([deflection])


@pytest.mark.parametrize(
    ("make", "true", "start", "strength"),
    [
        (lambda width: Coulomb(width), {"width": [0.03, 0.2]}, {"width": 0.06}, [30.0, 50.0]),
        (one_slip, {"deflection": [0.02, 0.1]}, {"deflection": 0.05}, [30.0, 50.0]),
        (
            lambda velocity, exponent: Stribeck(velocity, exponent, 0.02),
            {"velocity": [0.3, 0.15], "exponent": [1.0, 2.0]},
            {"velocity": 0.2, "exponent": 1.5},
            [20.0, 40.0],
        ),
    ],
    ids=["width", "deflection", "Stribeck"],
)
def test_exact_data(make, true, start, strength, arm):
    model, samples = arm
    true = {name: np.array(values) for name, values in true.items()}
    exact = recorded(model, samples, [Viscous(), make(**true)], [5.0, 7.0, *strength])
    term = Tunable("friction", make, start)
    found, settings = tuned(Problem(TorqueModel(model, [RigidBodies(), Viscous(), term]), exact, min_speed=0.001))
    for setting, (name, values) in zip(settings, true.items(), strict=True):
        assert setting.name == f"friction {name}"
        assert setting.values == pytest.approx(values, rel=FOUND)
        assert not setting.at_end.any()
    there = found.terms[2].rows(model, exact)
    assert np.array_equal(there, make(*[setting.values for setting in settings]).rows(model, exact))


def test_noise_and_what_is_not_there(arm):
    """The first axis has a curve of its own, the second no friction: its width is anything, and nothing is harmed."""
    model, samples = arm
    noisy = recorded(model, samples, [Coulomb([0.05, 0.05]), Offset()], [30.0, 0.0, 1.0, 1.0], noise=1.0)
    term = Tunable("coulomb", Coulomb, {"width": 0.1})
    found, (setting,) = tuned(Problem(TorqueModel(model, [RigidBodies(), term, Offset()]), noisy))
    slope = 30.0 / 0.05 / np.cosh(noisy.v[:, 0] / 0.05) ** 2 * noisy.v[:, 0]  # dτ / d log width
    deviation = 1.0 / np.linalg.norm(slope)  # of log width, where all else is known
    assert abs(np.log(setting.values[0] / 0.05)) < 2 * NOISE_SCATTER * deviation
    assert isinstance(found.terms[1], Coulomb)


def test_joints_count_in_units_of_their_noise(arm, monkeypatch):
    """Ten times the noise at one axis: the squares that are minimized have a mean of one on both."""
    model, samples = arm
    noisy = recorded(model, samples, [Coulomb([0.05, 0.05])], [30.0, 20.0], noise=np.array([1.0, 10.0]))
    seen = []

    def spied(residual, start, *_, **__):
        seen.append(residual(start).reshape(-1, 2))
        return SimpleNamespace(x=np.log(30) * ends)

    monkeypatch.setattr(scipy.optimize, "least_squares", spied)
    problem = Problem(TorqueModel(model, [RigidBodies(), Tunable("coulomb", Coulomb, {"width": 0.05})]), noisy)
    for ends in np.array([[-1.0, 0.5], [-0.5, 1.0]]):
        _, (setting,) = tuned(problem)
        assert setting.values == pytest.approx(0.05 * 30**ends)
        assert setting.at_end.tolist() == (np.abs(ends) == 1).tolist(), "at either end"
    assert np.mean(seen[0] ** 2, axis=0) == pytest.approx([1.0, 1.0], abs=0.1)


def test_a_joint_at_rest(arm):
    """Its columns of friction are zero, and its width is anything."""
    model, samples = arm
    resting = replace(samples, q=samples.q * [1, 0], v=samples.v * [1, 0], a=samples.a * [1, 0])
    noisy = recorded(model, resting, [Viscous(), Coulomb(0.05)], [5.0, 7.0, 30.0, 50.0], noise=1.0)
    term = Tunable("coulomb", Coulomb, {"width": 0.1})
    _, (setting,) = tuned(Problem(TorqueModel(model, [RigidBodies(), Viscous(), term]), noisy))
    assert setting.values[0] == pytest.approx(0.05, rel=0.1)


def test_a_model_without_settings_stays(arm):
    model, samples = arm
    plain = TorqueModel(model, [Viscous()])
    assert tuned(Problem(plain, samples)) == (plain, ())


def test_memory_is_that_of_the_term(arm):
    """Without it a run may come in pieces."""
    model, samples = arm
    pieces = [samples[:700], replace(samples[700:], continues=True)]
    plain, slip = Tunable("coulomb", Coulomb, {"width": 0.1}), Tunable("slip", one_slip, {"deflection": 0.1})
    counts = Problem(TorqueModel(model, [Offset(), plain]), pieces).equations.counts
    assert counts.tolist() == [1500, 1500]
    with pytest.raises(InvalidInput, match="friction with memory needs each run of the recording as one piece"):
        Problem(TorqueModel(model, [Offset(), slip]), pieces).equations  # noqa: B018


def test_too_large(arm, monkeypatch):
    model, samples = arm
    monkeypatch.setattr("graphdyn.identification.estimation.tuning.MAX_EQUATION_BYTES", 1e4)
    term = Tunable("coulomb", Coulomb, {"width": 0.1})
    with pytest.raises(InvalidInput, match="do not fit in memory for settings that are to be found; decimate more"):
        tuned(Problem(TorqueModel(model, [term, Offset()]), recorded(model, samples, [], [])))
