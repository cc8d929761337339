"""Sizes of faults: mounting, zeros, gear ratios, the clock, what changes in between; and the smallest that shows."""

import functools
from dataclasses import replace

import numpy as np
import pytest
from long_check import LONG

import graphdyn
from graphdyn import Body
from graphdyn.identification import Samples, TorqueModel
from graphdyn.identification.data_quality import Change, Piece, assess_recording, found_gravity
from graphdyn.identification.data_quality.causes.additions import additions
from graphdyn.identification.data_quality.causes.gravity import GravityFit
from graphdyn.identification.data_quality.fits.bounded_fit import BoundedFit
from graphdyn.identification.data_quality.fits.free_fit import free_misfits, gram_misfit, grams
from graphdyn.identification.data_quality.visible import first_crossing
from graphdyn.identification.terms import Coulomb, LoadFriction, Offset, RigidBodies, Viscous
from graphdyn.motion_laws import FourierSeries

PERIOD, ROWS, NOISE = 0.01, 1000, 0.01
"""[s]; noise relative to the root mean square of each torque."""

FOUR_SIGMA = 4.0
"""Standard deviations within which a size of a fixed seed is found."""

N = 3


@functools.cache
def robot():
    """The first three links of the KR500."""
    whole = graphdyn.kr500()
    return replace(whole, bodies=whole.bodies[:N], joints=whole.joints[:N])


@functools.cache
def torque_model():
    return TorqueModel(robot(), (RigidBodies(), Viscous(), Coulomb(0.05), Offset()))


@functools.cache
def clean():
    rng = np.random.default_rng(3)
    laws = [FourierSeries(0.2, *0.4 * rng.normal(size=(2, 5)), 0.3 * j) for j in range(N)]
    t = np.arange(ROWS) * PERIOD
    q, v, a = (np.stack(part, axis=1) for part in zip(*(law(t) for law in laws), strict=True))
    x = torque_model().prior()
    x[-3 * N :] = np.repeat([300.0, 200.0, 0.0], N)
    samples = Samples(q, v, a, np.zeros_like(q))
    return replace(samples, tau=noisy(torque_model().torque(samples, x)))


def with_wrong_links():
    """The torque model of a file whose links weigh too little or too much."""
    pairs = zip(robot().bodies, (0.8, 0.7, 1.3), strict=True)
    bodies = tuple(Body.from_parameters(body.name, factor * body.parameters) for body, factor in pairs)
    return replace(torque_model(), model=replace(robot(), bodies=bodies))


def noisy(tau):
    return tau + NOISE * np.sqrt(np.mean(tau**2, axis=0)) * np.random.default_rng(0).normal(size=tau.shape)


def assessed(samples, model=None):
    return assess_recording(model or torque_model(), [Piece(samples, PERIOD)])


@functools.cache
def of_clean():
    """What is found in the clean recording."""
    return assessed(clean())


def tilted(degrees):
    angle = np.deg2rad(degrees)
    return 9.81 * np.array([0.0, np.sin(angle), -np.cos(angle)])


class TestFaults:
    def test_none_in_a_clean_recording(self):
        assert of_clean().faults == of_clean().hints == ()

    def test_the_mounting(self):
        model = replace(torque_model(), model=robot().with_gravity(tilted(25.0)))
        (fault,) = assessed(clean(), model).faults
        assert fault.change.kind == "gravity"
        angle = np.rad2deg(np.arccos(fault.change.gravity @ tilted(0.0) / 9.81**2))
        assert angle < FOUR_SIGMA * fault.deviation
        found = found_gravity(model, [Piece(clean(), PERIOD)])
        assert found.gravity == pytest.approx(fault.change.gravity, rel=0.01, abs=0.1)
        assert np.all(found.after < found.before)

    @LONG
    def test_gravity_in_another_unit(self):
        model = replace(torque_model(), model=robot().with_gravity([0, 0, -1.0]))
        (fault,) = assessed(clean(), model).faults
        assert fault.change.kind == "gravity"
        assert fault.change.gravity == pytest.approx([0, 0, -9.81], abs=0.1)

    def test_any_zero(self):
        samples = replace(clean(), q=clean().q + np.deg2rad([0.0, 17.0, 0.0]))
        (fault,) = assessed(samples).faults
        assert (fault.change.kind, fault.change.joints) == ("zero", (1,))
        assert abs(np.rad2deg(fault.change.zero[1]) + 17.0) < FOUR_SIGMA * fault.deviation < 5.0

    def test_a_gear_ratio(self):
        scale = np.array([1.0, 1.0, 101 / 81])
        samples = replace(clean(), q=clean().q * scale, v=clean().v * scale, a=clean().a * scale)
        (fault,) = assessed(samples).faults
        assert (fault.change.kind, fault.change.joints) == ("gear ratio", (2,))
        assert abs(fault.change.factor - 81 / 101) < FOUR_SIGMA * fault.deviation < 0.1

    def test_the_clock(self):
        """Stamps 1.5 times too far apart, with velocities from positions."""
        samples = replace(clean(), v=clean().v / 1.5, a=clean().a / 1.5**2)
        found = assess_recording(torque_model(), [Piece(samples, 1.5 * PERIOD)])
        assert [fault.change.kind for fault in found.faults] == ["time scale"]
        assert abs(found.faults[0].change.factor - 1 / 1.5) < max(0.01, FOUR_SIGMA * found.faults[0].deviation)

    def test_a_load_attached(self):
        model, bodies = torque_model(), torque_model().slice_of(RigidBodies)
        load = model.rows(clean())[..., bodies.stop - 10] * 200.0
        after = (np.arange(ROWS) >= 0.6 * ROWS)[:, None]
        (fault,) = assessed(replace(clean(), tau=clean().tau + load * after)).faults
        assert fault.change.kind == "attached load"
        assert fault.change.instant == pytest.approx(0.6, abs=0.06)
        assert fault.parameters[0] == pytest.approx(200.0, abs=FOUR_SIGMA * fault.deviation + 20.0)

    def test_a_torque_that_drifts(self):
        growing = 1 + 0.4 * np.linspace(-0.5, 0.5, ROWS)
        tau = clean().tau * np.stack([np.ones(ROWS), growing, np.ones(ROWS)], axis=1)
        (fault,) = assessed(replace(clean(), tau=tau)).faults
        assert (fault.change.kind, fault.change.joints) == ("torque drift", (1,))
        assert fault.parameters[0] == pytest.approx(-0.4, abs=0.05)

    def test_a_torque_whose_gain_jumps(self):
        jump = np.where(np.arange(ROWS) < 0.4 * ROWS, 1.0, 1.5)
        tau = clean().tau * np.stack([np.ones(ROWS), np.ones(ROWS), jump], axis=1)
        (fault,) = assessed(replace(clean(), tau=tau)).faults
        assert (fault.change.kind, fault.change.joints) == ("gain jump", (2,))
        assert fault.change.instant == pytest.approx(0.4, abs=0.06)

    def test_a_torque_in_any_unit(self):
        (fault,) = assessed(replace(clean(), tau=clean().tau * np.array([1.0, 1.3, 1.0]))).faults
        assert (fault.change.kind, fault.change.joints) == ("scaled torque", (1,))
        assert abs(fault.change.factor - 1.3) < FOUR_SIGMA * fault.deviation < 0.2

    def test_gravity_that_a_wrong_model_subtracted(self):
        """What is left looks like other links; CAD tells it, but not whose unit is another one."""
        wrong = with_wrong_links()
        rest = replace(clean(), v=0 * clean().v, a=0 * clean().a)
        samples = replace(clean(), tau=clean().tau - wrong.rows(rest) @ wrong.prior())
        faults = assessed(samples, wrong).faults
        assert faults[0].change.kind == "gravity subtracted"
        in_another_unit = assessed(replace(clean(), tau=clean().tau / 10), wrong).faults
        assert not any(fault.change.kind == "gravity subtracted" for fault in in_another_unit)

    def test_a_torque_of_cad(self):
        """It is left out of the search, and the other torques are searched."""
        wrong = with_wrong_links()
        tau = np.array(clean().tau)
        tau[:, 1] = (wrong.rows(clean()) @ wrong.prior())[:, 1]
        tau[:, 2] *= -1
        found = assessed(replace(clean(), tau=tau), wrong)
        assert found.modeled == (1,)
        assert [(fault.change.kind, fault.change.joints) for fault in found.faults] == [("reversed torque", (2,))]

    def test_a_torque_through_a_low_pass(self):
        share, tau = 1 - np.exp(-PERIOD / 0.1), np.array(clean().tau)
        for k in range(1, ROWS):
            tau[k] = tau[k - 1] + share * (tau[k] - tau[k - 1])
        (fault,) = assessed(replace(clean(), tau=tau)).faults
        assert fault.change.kind == "filtered torque"
        assert fault.parameters[0] == pytest.approx(0.1, abs=0.02)

    def test_subtracted_friction(self):
        v = clean().v
        friction = 300.0 * v + 200.0 * np.tanh(v / 0.05)
        (fault,) = assessed(replace(clean(), tau=clean().tau - 2 * friction)).faults
        assert fault.change.kind == "friction subtracted"


class TestVisibleSizes:
    def test_planted_ones_show(self):
        """A zero half as large as the smallest visible one gains too little; one twice as large enough."""
        found = of_clean()
        assert np.isinf(found.visible.zeros[0])  # the first axis is vertical
        size = np.deg2rad(found.visible.zeros[1])
        for factor, shows in ((0.5, False), (2.0, True)):
            samples = replace(clean(), q=clean().q + np.array([0.0, factor * size, 0.0]))
            assert bool(assessed(samples).faults) is shows
        for sizes in (found.visible.gear_ratios, found.visible.torque_drifts, found.visible.delays):
            assert np.all(sizes > 0)
        assert 0 < found.visible.tilt < 10
        assert 0 < found.visible.load < 100

    def test_first_crossing(self):
        assert first_crossing([(1.0, 0.1), (2.0, 0.4), (4.0, 0.8)], 0.5) == pytest.approx(2.5)
        assert first_crossing([(1.0, 0.6), (2.0, 3.0)], 0.5) == pytest.approx(0.5 / 0.6)
        assert first_crossing([(1.0, 0.1), (2.0, 0.2)], 0.5) == np.inf


class TestFreeFit:
    def test_is_that_of_the_bounded_fit_without_bounds(self):
        samples = clean()[slice(None, None, 4)]
        kept = np.ones(samples.q.shape, dtype=bool)
        fit = BoundedFit.of(torque_model(), samples, kept)
        free = np.sum(np.log(fit.errors(samples.tau, bounded=False)))
        assert free_misfits([(torque_model(), samples, kept)]) == pytest.approx([free], abs=1e-5)

    def test_impossible_motions_have_no_fit(self):
        samples = clean()[slice(None, None, 4)]
        kept = np.ones(samples.q.shape, dtype=bool)
        refused = (torque_model(), replace(samples, q=samples.q * np.nan), kept)
        good, bad = free_misfits([(torque_model(), samples, kept), refused])
        assert np.isfinite(good)
        assert bad == np.inf


class TestGravity:
    def test_the_criterion_of_any_gravity(self):
        """Computed from four parts, also beside friction that grows with the load, which is held as it is."""
        model = replace(torque_model(), terms=(*torque_model().terms, LoadFriction()))
        samples = clean()[slice(None, None, 4)]
        kept = np.ones(samples.q.shape, dtype=bool)
        search = GravityFit(model, samples, kept)
        now = model.rows(samples)
        for gravity in (tilted(0.0), tilted(70.0), np.array([3.0, -2.0, 1.0])):
            matrix = replace(model, model=robot().with_gravity(gravity)).rows(samples)
            load = model.slice_of(LoadFriction)
            matrix[..., load] = now[..., load]
            expected = gram_misfit(grams(matrix, samples.tau, samples.tau, kept))
            assert search.misfit(gravity) == pytest.approx(expected, abs=1e-4)


class TestAdditions:
    def test_a_drift_is_measured_in_recorded_torques(self):
        """Torques that are made small by a drift are no better explained."""
        fit = BoundedFit.of(torque_model(), clean(), np.ones(clean().q.shape, dtype=bool))
        drifts = [a for a in additions(torque_model(), fit, clean().tau) if a.kind == "torque drift"][:3]
        for right_at, drift in zip((0.0, 0.5, 1.0), drifts, strict=True):
            u = np.linspace(0, 1, ROWS) - right_at
            assert drift.spread(np.array([0.8])) == pytest.approx(N * np.mean(np.log(1 + 0.8 * u)))
        jump = next(a for a in additions(torque_model(), fit, clean().tau) if a.kind == "torque jump")
        assert jump.spread(np.array([0.8])) == 0.0

    def test_none_of_friction_without_friction(self):
        model = TorqueModel(robot(), (RigidBodies(), Offset()))
        fit = BoundedFit.of(model, clean(), np.ones(clean().q.shape, dtype=bool))
        kinds = {addition.kind for addition in additions(model, fit, clean().tau)}
        assert kinds == {"torque drift", "torque jump", "attached load", "detached load", "gain jump"}


def test_rows_that_count_follow_a_change():
    """Standstill moves with exchanged columns, a torque that is left out does not; a coupled joint keeps its own."""
    kept = np.ones((4, 3), dtype=bool)
    kept[0, 1] = False
    swap, coupled = np.eye(3)[[0, 2, 1]], np.eye(3) + np.eye(3, k=-1)
    exchanged = Change("exchanged positions", (1, 2), position=swap, velocity=swap)
    assert np.array_equal(exchanged.followed(kept), kept[:, [0, 2, 1]])
    assert np.array_equal(Change("coupled positions", (2, 1), velocity=coupled).followed(kept), kept)
    kept[:, 2] = False
    assert np.array_equal(exchanged.followed(kept), kept)


def test_a_change_of_gravity_leaves_the_columns():
    change = Change("gravity", (0, 1, 2), gravity=tilted(10.0))
    assert change.moves
    assert change.under_gravity(torque_model()).model.gravity == pytest.approx(tilted(10.0))
