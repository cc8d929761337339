"""Methods that simulate the loop of the recording: exact data, noise in the loop, what they refuse."""

import functools
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.stats
from identified import closed_loop_data

from crosscheck.identifying import Preparation
from graphdyn import EstimationFailed, InvalidInput
from graphdyn.identification import (
    ClosedLoop,
    ClosedLoopOutputError,
    DirectInverse,
    InstrumentalVariables,
    Problem,
    Samples,
    TorqueModel,
    WeightedLeastSquares,
)
from graphdyn.identification.closed_loop import Exogeneity, SimulatedLoop, held_torque, iterating
from graphdyn.identification.closed_loop.equations import CrossedEquations, LoopSolution, beside
from graphdyn.identification.closed_loop.exogeneity_test import exogeneity
from graphdyn.identification.closed_loop.loop import DrivenRobot
from graphdyn.identification.closed_loop.simulated_loop import _Later
from graphdyn.identification.estimators.closed_loop import outputs
from graphdyn.identification.terms import Coulomb, Drift, MaxwellSlip, RigidBodies, RotorInertia, Viscous

EXACT = 1e-7
"""Relative error of every base parameter from exact data, which the steps of the simulation reproduce."""

STICKING = 1e-9
"""[rad/s] A joint that dry friction holds is at rest exactly, and says nothing about that friction."""

NOISE = {"position": 2e-4, "velocity": 1e-3, "torque": 1.0}
SECONDS = 4.0
PREPARATION = Preparation(cutoff=50.0, min_speed=0.05, torque_hold=1e-3)

METHODS = [
    InstrumentalVariables,
    DirectInverse,
    functools.partial(ClosedLoopOutputError, "position"),
    functools.partial(ClosedLoopOutputError, "torque"),
]


@pytest.fixture(scope="module")
def exact():
    run = closed_loop_data.two_axes().record(SECONDS)
    return run, Problem(run.torque_model, run.exact, min_speed=STICKING)


@pytest.fixture(scope="module")
def noisy():
    """Filtered and differentiated as a recording is, slow rows left out."""
    run = closed_loop_data.two_axes().record(SECONDS, **NOISE)
    return run, *run.prepared(PREPARATION)


def values(problem, estimate):
    return problem.base.values(estimate.parameters)


def test_a_motion_that_begins_later_is_asked_once_for_the_same_times():
    """And again for others of the same number, and where the array of the times has been changed."""
    asked = []

    def law(times):
        asked.append(times)
        return times, 2 * times, 0 * times

    later, times = _Later(law, 3.0), np.array([0.0, 0.5, 1.0])
    for shift, count in ((0.0, 1), (0.0, 1), (0.25, 2), (0.0, 2)):
        q, v, _ = later(times + shift)
        assert np.array_equal((q, v), (times + shift + 3.0, 2 * (times + shift + 3.0)))
        assert len(asked) == count
    times += 1.0
    assert later(times)[0].tolist() == [4.0, 4.5, 5.0]


@pytest.mark.parametrize("method", METHODS)
def test_exact_data(method, exact):
    """From 15 % beside the truth: the loop simulates the recording itself in the end."""
    run, problem = exact
    true = problem.base.values(run.truth)
    size = np.linalg.norm(problem.equations.factors[..., :-1], axis=(0, 1))
    estimate = method(loop=run.loop, start=0.85 * run.truth).estimate(problem)
    error = size * (values(problem, estimate) - true)
    assert np.abs(error).max() <= EXACT * np.abs(size * true).max()
    assert 1 < estimate.iterations <= 8


@pytest.mark.parametrize("over", ["time", "temperature"])
def test_a_drift_that_is_not_there(over, exact):
    """Simulated motions have a time and temperatures, too; the friction of the recording does not drift."""
    run, _ = exact
    model = TorqueModel(run.torque_model.model, (*run.torque_model.terms, Drift(Viscous(), over)))
    warming = replace(run.exact, temperature=np.outer(run.exact.time, [1.0, 2.0]))
    problem = Problem(model, warming, min_speed=STICKING)
    truth = np.concatenate([run.truth, np.zeros(2)])
    found = values(problem, InstrumentalVariables(loop=run.loop).estimate(problem))
    size = np.linalg.norm(problem.equations.factors[..., :-1], axis=(0, 1))
    true = size * problem.base.values(truth)
    assert np.abs(size * found - true).max() <= EXACT * np.abs(true).max()


def test_parts_have_the_rows_of_the_whole(noisy):
    """What is simulated stands beside the same rows, whether or not all of them count."""
    run, problem, loop = noisy
    used = np.isin(np.arange(sum(map(len, problem.rows()))), [*range(300, 700), *range(1100, 1900)])
    whole, part = (SimulatedLoop(some, loop) for some in (problem, problem.part(used)))
    simulated = whole.samples(run.truth)

    def rows_of(parts):
        parts = list(parts)
        return [np.concatenate([getattr(here, name) for here in parts]) for name in ("regressor", "output")]

    x = problem.base.values(run.truth)
    for rows in (
        lambda some: beside(some.problem, simulated),
        lambda some: outputs(some, x, simulated, "position"),
        lambda some: outputs(some, x, simulated, "torque"),
    ):
        (regressor, output), (own_regressor, own_output) = (rows_of(rows(some)) for some in (whole, part))
        assert np.array_equal(output[used], own_output)
        assert np.array_equal(regressor[used], own_regressor)


@pytest.mark.parametrize("decimate", [(), (4,)])
@pytest.mark.parametrize("name", ["position", "torque"])
def test_outputs_of_the_true_robot_are_those_that_were_measured(name, decimate):
    """In the rows that the filter keeps, and filtered as the measured torques are, far from both ends."""
    run = closed_loop_data.two_axes().record(1.0)
    problem, loop = run.prepared(Preparation(cutoff=50.0, decimate=decimate, torque_hold=1e-3))
    whole = SimulatedLoop(problem, loop)
    parts = list(outputs(whole, problem.base.values(run.truth), whole.samples(run.truth), name))
    output, measured = (
        np.concatenate([getattr(part, name) for part in found])
        for name, found in (("output", parts), ("measured", [part.measured for part in parts]))
    )
    inner = slice(len(output) // 2, -len(output) // 5)
    assert np.abs(output - measured)[inner].max() < 1e-6 * np.abs(measured).max()


def test_simulates_the_recording(exact):
    run, problem = exact
    (motion,) = SimulatedLoop(problem, run.loop).samples(run.truth)
    for name in ("q", "v", "a", "tau"):
        there = getattr(run.exact, name)
        assert getattr(motion, name) == pytest.approx(there, rel=1e-9, abs=1e-9 * np.abs(there).max())


def test_a_function_as_controller(exact):
    """The same law in Python, asked once in a period of two samples."""
    plant = closed_loop_data.two_axes()
    run = plant.record(0.2, period=1e-3, control_period=1e-3)
    laws, later = plant.laws, plant.start

    def law(t, q, v):
        target = np.array([[part[0] for part in one(np.array([t - later]))] for one in laws])
        return plant.position_gain * (target[:, 0] - q) + plant.velocity_gain * (target[:, 1] - v)

    problem = Problem(run.torque_model, run.exact)
    held = ClosedLoop(plant.controller(2e-3, later)), ClosedLoop(law, period=2e-3)
    compiled, python = (SimulatedLoop(problem, loop).samples(run.truth)[0] for loop in held)
    assert python.tau == pytest.approx(compiled.tau, abs=1e-9)
    assert np.all(python.tau[2:-1:2] == python.tau[3::2])


def torque_error(run, problem, estimate):
    """Of the noiseless motion, relative."""
    true = problem.base.values(run.truth)
    w = run.torque_model.rows(run.exact, problem.base.independent)
    return np.linalg.norm(w @ (values(problem, estimate) - true)) / np.linalg.norm(w @ true)


@pytest.mark.parametrize("method", METHODS)
def test_no_bias(method, noisy):
    """Least squares is 12 % wrong. The error without bias is as large as its standard deviations say."""
    run, problem, loop = noisy
    found = method(loop=loop).estimate(problem)
    assert torque_error(run, problem, WeightedLeastSquares().estimate(problem)) > 0.1
    assert torque_error(run, problem, found) < 0.01
    error = values(problem, found) - problem.base.values(run.truth)
    assert np.mean(error**2 / np.diag(found.block_covariance)) < 2
    of_positions = getattr(method(), "output", "torque") == "position"
    assert (found.noise is None) == of_positions, "noise of positions is no noise of torques"


def test_drives_that_would_drive_count_as_none():
    run = closed_loop_data.two_axes()
    parameters = np.array([run.torque_model.prior(), run.torque_model.prior()])
    columns = run.torque_model.slice_of(Viscous)
    parameters[:, columns] = [[-3.0, 2.0], [1.0, -1e-9]]
    assert DrivenRobot.of(run.torque_model, parameters).friction.viscous.tolist() == [[0.0, 2.0], [1.0, 0.0]]


def test_simulated_motions_are_differentiated_at_their_rate():
    """Of 101 rows in two seconds: 50 Hz."""
    rates, time = [], 7.0 + np.linspace(0.0, 2.0, 101)

    def differentiation(q, v, rate):
        rates.append(rate)
        return q, v, v

    samples = Samples(*np.zeros((4, 101, 1)), time=time)
    ClosedLoop(lambda t, q, v: q, differentiation=differentiation).seen(samples)
    assert rates == pytest.approx([50.0])


def test_steps_are_halved_until_the_loop_holds(monkeypatch):
    """From 0 to 1, held below a fifth: at an eighth."""

    def simulated(loop, x):
        if x[0] > 0.2:
            raise EstimationFailed("runs away")
        return []

    monkeypatch.setattr(iterating, "_simulated", simulated)
    assert iterating._as_far_as_held(None, np.zeros(1), np.ones(1))[0] == 0.125


@pytest.mark.parametrize(("blocks", "iterations"), [(None, 2), (0.1, 3)])
def test_converged_within_the_deviations_of_blocks(blocks, iterations, monkeypatch):
    """Steps of 0.5, 0.05, 0.005: a tenth of 1 after the second, of the 0.1 that time blocks state after the third."""
    steps = iter([0.5, 0.05, 0.005])
    arm = SimpleNamespace(torque_model=SimpleNamespace(model=SimpleNamespace(independent_joints=("a",))))
    loop = SimpleNamespace(problem=arm, simulations=1)
    for name, value in {
        "starts": lambda *_: [],
        "_begun": lambda *_: (np.zeros(1), [], ()),
        "_resolved": lambda _: np.array([1e-9]),
        "_as_far_as_held": lambda _, before, wanted: (wanted, []),
        "exogeneity": lambda *_: Exogeneity(np.array([0.5]), np.array([10])),
        "base_estimate": lambda *_, iterations, **__: iterations,
    }.items():
        monkeypatch.setattr(iterating, name, value)

    def step(x, _):
        over_blocks = None if blocks is None else np.array([[blocks**2]])
        return LoopSolution(x + next(steps), np.eye(1), over_blocks, np.ones(1))

    assert iterating.iterated(loop, "wls", step) == iterations


def test_covariance_of_instrumental_variables():
    """For white noise: of a solution that is linear in the torques, by its derivative by every one of them."""
    rng, noise = np.random.default_rng(0), np.array([0.5, 3.0])
    z, w = rng.normal(size=(2, 2, 20, 3))
    w += 2 * z

    def solved(tau):
        products = np.array([z[g].T @ np.column_stack([w[g], tau[g]]) for g in range(2)])
        return CrossedEquations(products[None], np.einsum("gtk,gtl->gkl", z, z)).solve(noise)

    units = np.eye(40).reshape(40, 2, 20)
    by_torque = np.array([solved(unit).x for unit in units]) * np.repeat(noise, 20)[:, None]
    np.testing.assert_allclose(solved(units[0]).covariance, by_torque.T @ by_torque, rtol=1e-9)


def test_instruments_that_show_nothing():
    """A base parameter whose instrument is zero, and instruments that are not independent in the recording."""
    products, squares = np.zeros((1, 1, 2, 3)), np.eye(2)[None]
    for instruments, said in (
        (np.diag([1.0, 0.0])[None], "the simulated motion does not excite base parameter 2"),
        (squares, "the instruments do not determine the parameters: the simulated motion is another"),
    ):
        with pytest.raises(EstimationFailed, match=said):
            CrossedEquations(products + np.array([1.0, 1.0, 0.0]), instruments).solve(np.ones(1))


class TestExogeneity:
    def p(self, run, **noise):
        problem, loop = run.prepared(PREPARATION)
        estimate = InstrumentalVariables(loop).estimate(problem)
        return estimate.settings["exogeneity p"], estimate.remarks[-1]

    def test_noise_of_the_torque_alone(self):
        """Six recordings: p is at most 1/4 in a quarter of them, in five or six with a probability of 0.5 %."""
        plant = closed_loop_data.two_axes()
        found = [self.p(plant.record(2.0, torque=1.0, seed=seed)) for seed in range(6)]
        assert sum(p <= 0.25 for p, _ in found) <= 4
        assert any(said.startswith("the regressor looks exogenous (Durbin-Wu-Hausman, p = ") for _, said in found)

    def test_noise_that_the_controller_sees(self):
        """A fortieth of the noise that makes least squares 12 % wrong."""
        p, said = self.p(closed_loop_data.two_axes().record(2.0, position=5e-6, velocity=2.5e-5, torque=1.0))
        assert p < 1e-6
        assert said.startswith("the regressor is not exogenous at O1, O2 (Durbin-Wu-Hausman, p = ")

    def test_few_rows(self):
        short = closed_loop_data.two_axes().record(0.3, torque=1.0)
        assert "too few independent rows" in self.p(short)[1]


class TestHeldTorque:
    def test_ramp(self):
        ramp = np.arange(6.0)[:, None] * [1.0, -2.0]
        assert held_torque(ramp, 0.01, 0.01)[1:] == pytest.approx(ramp[1:] - [0.5, -1.0])
        assert held_torque(ramp, 0.01, 0.002)[1:] == pytest.approx(ramp[1:] - [0.1, -0.2])
        assert np.array_equal(held_torque(ramp, 0.01, 0.0), ramp)

    def test_nothing_is_known_before_the_first_sample(self):
        assert held_torque(np.array([[3.0], [5.0]]), 0.01, 0.01)[0] == 3.0


class TestRefusals:
    def failure(self, problem, loop, **options):
        with pytest.raises(EstimationFailed) as caught:
            InstrumentalVariables(loop, **options).estimate(problem)
        return str(caught.value)

    def test_no_loop(self, exact):
        assert "needs the controller of the loop" in self.failure(exact[1], None)

    def test_no_time(self, exact):
        run, problem = exact
        assert "needs the time of every sample" in self.failure(
            replace(problem, data=replace(run.exact, time=None)), run.loop
        )

    def test_uneven_time(self, exact):
        run, problem = exact
        time = run.time.copy()
        time[5] += 3e-4
        assert "not evenly spaced" in self.failure(replace(problem, data=replace(run.exact, time=time)), run.loop)

    def test_loop_that_does_not_hold(self, exact):
        run, problem = exact
        away = replace(run.loop, controller=replace(run.loop.controller, position_gain=-2e4, velocity_gain=-2e3))
        said = self.failure(problem, away)
        assert said.startswith("from WLS: the simulated loop does not hold the robot")
        assert "from CAD" in said

    def test_terms_that_are_not_simulated(self, exact):
        run, problem = exact
        smooth = replace(run.torque_model, terms=(RigidBodies(), Coulomb(width=0.1)))
        with pytest.raises(EstimationFailed, match="a simulation does not know Coulomb; DIDIM and IDIM-IV need not"):
            ClosedLoopOutputError(loop=run.loop).estimate(replace(problem, torque_model=smooth))

        geared = replace(run.torque_model, terms=(RigidBodies(), RotorInertia(gears=[50.0, 50.0])))
        with pytest.raises(EstimationFailed, match="a simulation does not know RotorInertia"):
            ClosedLoopOutputError(loop=run.loop).estimate(replace(problem, torque_model=geared))

    def test_friction_with_memory(self, exact):
        """What stands beside its rows is computed for some rows at a time."""
        run, problem = exact
        slipping = TorqueModel(run.torque_model.model, [RigidBodies(), MaxwellSlip()])
        for method in METHODS:
            with pytest.raises(
                EstimationFailed, match="the simulated loop knows no friction with memory; leave it out"
            ):
                method(loop=run.loop).estimate(replace(problem, torque_model=slipping))

    def test_too_few_iterations(self, noisy):
        _, problem, loop = noisy
        assert "diverged: after 1 simulations of the loop" in self.failure(problem, loop, start="cad", most=1)

    def test_periods(self, exact):
        run, problem = exact
        odd = replace(run.loop, controller=replace(run.loop.controller, period=0.7e-3))
        with pytest.raises(InvalidInput, match=r"0\.0007 s, and that of the recording, 0\.001 s, are no"):
            InstrumentalVariables(odd).estimate(problem)

    def test_arguments(self, exact):
        run, problem = exact
        with pytest.raises(InvalidInput, match="start is 'ols'"):
            InstrumentalVariables(run.loop, start="ols").estimate(problem)
        with pytest.raises(InvalidInput, match=r"start has shape \(3,\), expected \(26,\)"):
            InstrumentalVariables(run.loop, start=np.ones(3)).estimate(problem)
        with pytest.raises(InvalidInput, match="output is 'velocity'"):
            ClosedLoopOutputError("velocity")
        with pytest.raises(InvalidInput, match="controller has a period of its own"):
            ClosedLoop(run.loop.controller, period=1e-3)
        with pytest.raises(InvalidInput, match="step of the closed loop is 0"):
            ClosedLoop(run.loop.controller, step=0.0)
        with pytest.raises(InvalidInput, match=r"time of the samples has shape \(3,\), expected \(4001,\)"):
            Samples(run.exact.q, run.exact.v, run.exact.a, run.exact.tau, time=np.zeros(3))


def test_probability_of_an_exogenous_regressor():
    """F of what the unexplained regressor adds, over the rows that are independent: every one, or every third."""
    rng, support = np.random.default_rng(0), np.array([[1, 1, 0, 0, 0], [1, 1, 1, 1, 1], [0, 0, 1, 1, 1]], dtype=bool)
    z = rng.normal(size=(900, 3, 5)) * support
    w = z + 0.3 * rng.normal(size=z.shape) * support
    noise = rng.normal(size=(900, 3))
    noise[:, 1] = np.repeat(noise[:300, 1], 3)
    noise[:, 2] = np.repeat(noise[:300, 2], 3) * (-1.0) ** np.arange(900)
    x = np.array([1.0, -2.0, 0.5, 3.0, 0.1])

    class Equations:
        def __init__(self, matrix):
            self.matrix, self.right, self.kept = matrix, w @ x + noise, np.ones((900, 3), dtype=bool)

        def __len__(self):
            return 900

        def rows(self):
            return [self]

    problem = SimpleNamespace(
        n_joints=3,
        rows=Equations(w).rows,
        reduced=lambda rows: rows.matrix,
        support=[np.flatnonzero(s) for s in support],
    )
    found = exogeneity(SimpleNamespace(problem=problem, as_measured=lambda simulated: Equations(z)), x, [])
    assert found.rows.tolist() == [900, 300, 300]
    for g, own in enumerate(problem.support):
        every = slice(None, None, 900 // found.rows[g])
        regressor, instruments, tau = w[every, g][:, own], z[every, g][:, own], (w @ x + noise)[every, g]
        unexplained = regressor - instruments @ np.linalg.lstsq(instruments, regressor, rcond=None)[0]
        both = np.hstack([regressor, unexplained])
        without, squares = (np.linalg.lstsq(matrix, tau, rcond=None)[1][0] for matrix in (regressor, both))
        degrees = len(own), len(tau) - 2 * len(own)
        ratio = (without - squares) / degrees[0] / (squares / degrees[1])
        assert found.p[g] == pytest.approx(scipy.stats.f(*degrees).sf(ratio), rel=1e-6)


def test_which_joints_are_not_exogenous():
    """p of each joint three times, as Bonferroni has it: 0.004 of one of three is 0.012, more than 0.01."""
    found = Exogeneity(np.array([1e-3, 4e-3, 0.9]), np.array([100, 100, 100]))
    assert found.in_words(("a", "b", "c")) == (
        "the regressor is not exogenous at a (Durbin-Wu-Hausman, p = 0.003): least squares is biased"
    )
