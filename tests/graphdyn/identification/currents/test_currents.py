"""Gains and loads from currents: planted ones are found within their deviations; what nothing determines is said."""

import numpy as np
import pytest
from identified.loaded_arm import WANTED, WEIGHED, LoadedArm, random_gains, robot
from long_check import few

from graphdyn import InvalidInput
from graphdyn.identification.currents import IdentifiedLoad, JointGains, KnownLoad, TrustedGravity, fit_currents
from graphdyn.model import parameters_from_inertia

SECONDS = 20.0
EXACT = 1e-6
"""Relative: the fit ends where the squares decrease by 1e-10 of themselves."""

FOUR_SIGMA = 4.0
"""Standard deviations within which all of ten numbers of a fixed seed are."""


@pytest.fixture(scope="module")
def arm():
    return LoadedArm.of(robot(), np.random.default_rng(3))


@pytest.fixture(scope="module")
def motions(arm):
    rng = np.random.default_rng(4)
    return {name: arm.motion(rng, SECONDS, load) for name, load in (("empty", None), ("w", WEIGHED), ("x", WANTED))}


@pytest.fixture(scope="module")
def gains():
    return random_gains(np.random.default_rng(5), 6)


@pytest.fixture(scope="module")
def recorded(arm, motions, gains):
    """recorded(residual) → the recordings without a load, with the weighed one, and with the wanted one."""

    def record(residual):
        rng = np.random.default_rng(6)
        loads = {"empty": None, "w": "weighed", "x": "wanted"}
        return [arm.recorded(motions[name], gains, rng, load, residual) for name, load in loads.items()]

    return record


def test_a_known_mass_gives_gains_and_the_other_load(arm, recorded, gains):
    fit = fit_currents(arm.torque_model, recorded(1e-9), known_loads={"weighed": KnownLoad(WEIGHED[0])})
    assert np.abs(fit.gains.values / gains - 1).max() < EXACT
    assert np.abs(fit.loads["wanted"].parameters - WANTED).max() < EXACT
    assert np.abs(fit.loads["weighed"].parameters - WEIGHED).max() < EXACT


def test_with_noise_within_the_deviations(arm, recorded, gains):
    fit = fit_currents(arm.torque_model, recorded(0.05), known_loads={"weighed": KnownLoad(WEIGHED[0])})
    load = fit.loads["wanted"]
    off = np.abs(load.parameters - WANTED) / np.sqrt(np.diag(load.covariance))
    assert off.max() < FOUR_SIGMA
    assert (np.abs(np.log(fit.gains.values / gains)) < FOUR_SIGMA * fit.gains.relative_deviations).all()
    assert 0.002 < load.mass_deviation / load.mass < 0.1
    assert load.determined


def test_all_scales_with_the_known_mass(arm, recorded):
    """JointGains and loads alike: currents know no size."""
    one, two = (
        fit_currents(arm.torque_model, recorded(0.05), known_loads={"weighed": KnownLoad(mass)})
        for mass in (WEIGHED[0], 2 * WEIGHED[0])
    )
    assert np.abs(two.gains.values / one.gains.values - 2).max() < EXACT
    assert np.abs(two.loads["wanted"].parameters / one.loads["wanted"].parameters - 2).max() < 1e-4


def test_gains_that_are_stated_and_links_that_are_trusted(arm, recorded, gains):
    pair = recorded(1e-9)[::2]
    stated = fit_currents(arm.torque_model, pair, gains=JointGains.stated(gains, 0.03)).loads["wanted"]
    assert abs(stated.mass - WANTED[0]) < 1e-3 * WANTED[0]
    assert 0.005 < stated.mass_deviation / stated.mass < 0.03  # the gains of several joints carry it
    trusted = fit_currents(arm.torque_model, pair, gravity=TrustedGravity(0.05)).loads["wanted"]
    assert abs(trusted.mass - WANTED[0]) < 2 * trusted.mass_deviation
    assert 0.005 < trusted.mass_deviation / trusted.mass < 0.08


def test_a_known_center_narrows_the_gains(arm, recorded):
    place = tuple(WEIGHED[1:4] / WEIGHED[0])
    sigmas = [
        fit_currents(arm.torque_model, recorded(0.05), known_loads={"weighed": known}).gains.relative_deviations
        for known in (KnownLoad(WEIGHED[0]), KnownLoad(WEIGHED[0], place))
    ]
    assert sigmas[1].sum() < 0.9 * sigmas[0].sum()


def test_a_joint_without_motion_has_no_gain(arm, gains):
    """The last joint holds still, and no load acts on it that the others show alone."""
    rng = np.random.default_rng(8)
    still = [arm.motion(rng, SECONDS, load, amplitude=0.0) for load in (None, WEIGHED)]
    blocks = [arm.recorded(one, gains, rng, name) for one, name in zip(still, (None, "weighed"), strict=True)]
    fit = fit_currents(arm.torque_model, blocks, known_loads={"weighed": KnownLoad(WEIGHED[0])})
    assert not fit.gains.determined.all()
    assert np.isnan(fit.gains.values[~fit.gains.determined]).all()


@pytest.mark.parametrize("joint", few([1, 4], 1))
def test_a_current_that_runs_against_its_torque(arm, motions, gains, joint):
    """The gain is that of the reversed column, and nothing else changes."""
    rng = np.random.default_rng(6)
    signs = np.where(np.arange(6) == joint, -1.0, 1.0)
    blocks = [arm.recorded(motions[name], signs * gains, rng, load) for name, load in (("empty", None), ("w", "w"))]
    fit = fit_currents(arm.torque_model, blocks, known_loads={"w": KnownLoad(WEIGHED[0])})
    assert np.flatnonzero(fit.reversed).tolist() == [joint]
    assert (np.abs(np.log(fit.gains.values / gains)) < FOUR_SIGMA * fit.gains.relative_deviations).all()


def test_a_dead_channel_is_left_out(arm, motions, gains):
    """Its gain is undetermined; the others are found."""
    rng = np.random.default_rng(6)
    dead = np.where(np.arange(6) == 2, np.inf, gains)
    blocks = [arm.recorded(motions[name], dead, rng, load) for name, load in (("empty", None), ("w", "w"))]
    fit = fit_currents(arm.torque_model, blocks, known_loads={"w": KnownLoad(WEIGHED[0])})
    assert np.isinf(fit.noise[:, 2]).all()
    assert np.flatnonzero(~fit.gains.determined).tolist() == [2]
    found = fit.gains.determined
    off = np.log(fit.gains.values[found] / gains[found])
    assert (np.abs(off) < FOUR_SIGMA * fit.gains.relative_deviations[found]).all()


class TestLoad:
    def test_parameters_and_their_deviations(self):
        """Against differences of the same formulas."""
        tensor, center = np.diag([0.02, 0.03, 0.015]), np.array([0.03, -0.02, 0.1])
        pi = parameters_from_inertia(2.0, center, tensor)
        rng = np.random.default_rng(0)
        root = 1e-3 * rng.normal(size=(10, 10))
        load = IdentifiedLoad(pi, root @ root.T)
        assert (load.mass, load.determined, load.consistent) == (2.0, True, True)
        np.testing.assert_allclose(load.center_of_mass, center, atol=1e-15)
        np.testing.assert_allclose(load.inertia, tensor, atol=1e-15)
        samples = pi + rng.normal(size=(20_000, 10)) @ root.T
        drawn = [IdentifiedLoad(one, load.covariance) for one in samples]
        for name, of in (("center_of_mass", "center_deviations"), ("inertia", "inertia_deviations")):
            spread = np.std([getattr(one, name) for one in drawn], axis=0)
            np.testing.assert_allclose(getattr(load, of), spread, rtol=0.03)

    def test_what_is_hardly_known(self):
        pi = parameters_from_inertia(1.0, np.zeros(3), np.eye(3))
        assert not IdentifiedLoad(pi, np.eye(10)).determined
        assert not IdentifiedLoad(np.where(np.arange(10) == 4, -1.0, pi), np.eye(10)).consistent
        assert np.isinf(IdentifiedLoad(pi, np.diag([np.inf] * 10)).center_deviations).all()


class TestBadInput:
    def test_nothing_is_known(self, arm, recorded):
        with pytest.raises(
            InvalidInput, match="currents alone determine no gain: gains, links and loads scale together"
        ):
            fit_currents(arm.torque_model, recorded(0.05))

    def test_odd_knowledge(self, arm, recorded):
        blocks = recorded(0.05)
        with pytest.raises(InvalidInput, match="there are 5 gains for 6 joints; give one per joint"):
            fit_currents(arm.torque_model, blocks, gains=JointGains.stated(np.ones(5), 0.1))
        with pytest.raises(InvalidInput, match="no recording carries the load 'other'; those carried: weighed, wanted"):
            fit_currents(arm.torque_model, blocks, known_loads={"other": KnownLoad(1.0)})

    def test_nothing_but_dead_channels(self, arm, motions):
        rng = np.random.default_rng(6)
        dead = arm.recorded(motions["empty"], np.full(6, np.inf), rng)
        with pytest.raises(InvalidInput, match="no current changes in any recording; record a motion of all joints"):
            fit_currents(arm.torque_model, [dead], gains=JointGains.stated(np.ones(6), 0.1))

    @pytest.mark.parametrize(
        ("make", "message"),
        [
            (lambda: KnownLoad(0.0), "the mass of the known load is 0 kg; give one above zero"),
            (lambda: TrustedGravity(0.0), "the error of trusted links is 0; give one above zero"),
            (lambda: JointGains.stated([1.0, -1.0], 0.1), r"the gains are \[ 1. -1.\]; give one above zero per joint"),
            (lambda: JointGains(np.ones(2), np.eye(3)), r"the covariance of 2 gains has shape \(3, 3\)"),
        ],
    )
    def test_numbers(self, make, message):
        with pytest.raises(InvalidInput, match=message):
            make()
