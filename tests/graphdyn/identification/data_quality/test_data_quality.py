"""The data quality of a recording: planted faults are found and named, clean recordings have none, delays are exact."""

import functools
from dataclasses import replace

import numpy as np
import pytest
from long_check import LONG, few
from random_trees import body_of_points

import graphdyn
from graphdyn import Body, InvalidInput
from graphdyn.identification import Problem, Samples, TorqueModel
from graphdyn.identification.data_quality import (
    Change,
    DataFault,
    Piece,
    RecordedColumns,
    assess_recording,
    excitation,
)
from graphdyn.identification.data_quality.causes.changes import changes, scales
from graphdyn.identification.data_quality.channels.channels import channels, rate_gain
from graphdyn.identification.data_quality.channels.measured_torque import gains
from graphdyn.identification.data_quality.delays.delay_fit import FittedDelays
from graphdyn.identification.data_quality.delays.torque_delays import (
    MIN_CHANCE_SHARE,
    MIN_DISAGREEMENT,
    STUDENT,
    _common,
    _Mean,
    _of_both,
)
from graphdyn.identification.data_quality.fits.bounded_fit import BoundedFit
from graphdyn.identification.data_quality.fits.held_out import held_out_gain, held_out_squares
from graphdyn.identification.data_quality.fits.thinning import ThinnedRecording, TooShort
from graphdyn.identification.data_quality.recording_quality import groups
from graphdyn.identification.data_quality.search.examined import Examined
from graphdyn.identification.data_quality.search.halves import faults_by_halves, halved
from graphdyn.identification.terms import Coulomb, Offset, RigidBodies, Viscous
from graphdyn.motion_laws import FourierSeries

PERIOD, SECONDS, CUTOFF = 0.01, 10.0, 10.0
"""[s], [s], [Hz]"""
NOISE = 0.01
"""Of the torques, relative to their root mean square."""

WITHIN = 1e-3
"""[s] Largest error of a delay."""

WIDTH = 0.05
"""[rad/s] Of the smooth sign of Coulomb friction."""


N = 4
"""Joints: each more makes more changes to try, and each trial longer."""


@functools.cache
def robot():
    """An arm without the last two joints that holds a load beside its forearm, so that every joint feels gravity."""
    whole, load = graphdyn.kr500(), body_of_points("load", [300.0], [[0.5, 0.6, 0.4]])
    forearm = Body.from_parameters("forearm", whole.bodies[N - 1].parameters + load.parameters)
    return replace(whole, bodies=(*whole.bodies[: N - 1], forearm), joints=whole.joints[:N])


@functools.cache
def torque_model():
    return TorqueModel(robot(), (RigidBodies(), Viscous(), Coulomb(WIDTH), Offset()))


@functools.cache
def torque_at():
    """The motion of the robot, and its torque at any time, exact."""
    rng = np.random.default_rng(3)
    laws = [FourierSeries(0.1, *0.4 * rng.normal(size=(2, 5)), 0.3 * j) for j in range(N)]
    x = torque_model().prior()
    x[-3 * N :] = np.repeat([300.0, 200.0, 0.0], N)

    def motion(t):
        return [np.stack(part, axis=1) for part in zip(*(law(t) for law in laws), strict=True)]

    def torque(t):
        q, v, a = motion(t)
        return torque_model().torque(Samples(q, v, a, np.zeros_like(q)), x)

    return motion, torque


def recording(late=0.0):
    """One piece; the torques of all joints, or of each, are recorded late [s]."""
    from scipy.signal import butter, sosfiltfilt

    motion, torque = torque_at()
    t = np.arange(0, SECONDS, PERIOD)
    late = np.broadcast_to(late, N)
    tau = np.column_stack([torque(t - seconds)[:, j] for j, seconds in enumerate(late)])
    tau = tau + NOISE * np.sqrt(np.mean(tau**2, axis=0)) * np.random.default_rng(0).normal(size=tau.shape)
    sections = butter(4, CUTOFF, fs=1 / PERIOD, output="sos")
    return Piece(Samples(*(sosfiltfilt(sections, values, axis=0) for values in (*motion(t), tau))), PERIOD)


def changed(**matrices):
    return changed_in(RecordedColumns.of_joints(N), **matrices)


def changed_in(columns, **matrices):
    return Piece(Change("zero", (), **matrices).applied(recording().samples, columns), PERIOD)


@functools.cache
def clean():
    return assess_recording(torque_model(), [recording()])


def signs(*joints):
    return np.diag([-1.0 if j in joints else 1.0 for j in range(N)])


def exchange(i, j):
    order = np.arange(N)
    order[[i, j]] = j, i
    return np.eye(N)[order]


class TestClean:
    def test_no_fault(self):
        assert clean().faults == ()

    def test_gains(self):
        """CAD is the truth, but rotors and friction are fitted along."""
        g = clean().gains
        heavy = g.share > 0.3
        assert heavy.sum() >= 3
        np.testing.assert_allclose(g.gain[heavy], 1.0, atol=0.05)
        assert np.all(np.abs(g.gain - 1)[heavy] < 6 * g.deviation[heavy])

    def test_gains_by_leaving_out_twentieths(self):
        """Torque of the bodies, drives and acceleration, fitted to all rows and to all but each block of them."""
        samples = recording().samples[::10]
        fit = BoundedFit.of(torque_model(), samples, np.abs(samples.v) > 0.05)
        found, x = gains(torque_model(), samples, fit), torque_model().prior()
        for j in range(N):
            kept = fit.kept[:, j]
            drives = fit.matrix[kept, j][:, 10 * N + j :: N]
            own = np.column_stack([drives, samples.a[kept, j]])
            predicted, tau = fit.matrix[kept, j] @ x, samples.tau[kept, j]
            columns = np.column_stack([predicted, own])
            blocks = np.array_split(np.arange(len(tau)), np.linspace(0, len(tau), 21).astype(int)[1:-1])
            every = [np.delete(np.arange(len(tau)), block) for block in blocks]
            without = [np.linalg.lstsq(columns[rows], tau[rows], rcond=None)[0][0] for rows in every]
            gain = np.linalg.lstsq(columns, tau, rcond=None)[0][0]
            assert found.gain[j] == pytest.approx(gain, rel=1e-6)
            assert found.deviation[j] == pytest.approx(np.sqrt(19 * np.var(without)), rel=1e-4)
            assert found.share[j] == pytest.approx(gain * np.linalg.norm(predicted) / np.linalg.norm(tau), rel=1e-6)
            left = tau - predicted - own @ np.linalg.lstsq(own, tau - predicted, rcond=None)[0]
            assert found.without_gain[j] == pytest.approx(np.linalg.norm(left) / np.linalg.norm(tau), rel=1e-6)

    def test_costs_of_reversed_torques(self):
        """Of the logarithm of the likelihood per sample, with each torque of the wrong sign."""
        samples = ThinnedRecording([recording()]).samples
        fit = BoundedFit.of(torque_model(), samples, np.ones(samples.tau.shape, dtype=bool))
        costs = [np.log(fit.errors(samples.tau @ signs(j))).sum() for j in range(N)]
        np.testing.assert_allclose(clean().sign_costs, costs - np.log(clean().errors).sum(), rtol=1e-6)
        assert np.all(clean().sign_costs > 0.5)

    def test_errors_are_the_noise(self):
        """The low-pass takes most of it, and rounds the friction where a joint turns back."""
        assert np.all(clean().errors < 1.5 * NOISE)
        assert np.all(clean().halves < 1.5 * NOISE)
        np.testing.assert_allclose(clean().free_errors, clean().errors, rtol=0.05)

    def test_a_turned_base_is_unseen(self):
        zeros = {change.joints for change in clean().unseen if change.kind == "zero"}
        assert zeros == {(0,), (N - 1,)}  # the first axis is upright; other parameters make up for the last zero


class TestFaults:
    @pytest.mark.parametrize(
        ("kind", "joints", "matrices"),
        [
            pytest.param("reversed torque", (3,), {"torque": signs(3)}, marks=LONG),
            pytest.param("reversed position", (1,), {"position": signs(1), "velocity": signs(1)}, marks=LONG),
            ("exchanged torques", (1, 2), {"torque": exchange(1, 2)}),
            pytest.param(
                "exchanged positions", (1, 2), {"position": exchange(1, 2), "velocity": exchange(1, 2)}, marks=LONG
            ),
            pytest.param(
                "exchanged joints",
                (1, 3),
                dict.fromkeys(("position", "velocity", "torque"), exchange(1, 3)),
                marks=LONG,
            ),
            pytest.param("all torques reversed", tuple(range(N)), {"torque": -np.eye(N)}, marks=LONG),
            pytest.param("zero", (2,), {"zero": np.deg2rad([0, 0, 90, 0])}, marks=LONG),
            pytest.param("scaled torque", (2,), {"torque": np.diag([1, 1, 1000, 1])}, marks=LONG),
        ],
    )
    def test_one_is_found(self, kind, joints, matrices):
        found = assess_recording(torque_model(), [changed(**matrices)])
        (fault,) = found.faults
        assert (fault.change.kind, fault.change.joints) == (kind, joints)
        np.testing.assert_allclose(fault.after, clean().errors, rtol=0.1)

    @LONG
    def test_degrees(self):
        scale = np.eye(N) * 180 / np.pi
        found = assess_recording(torque_model(), [changed(position=scale, velocity=scale)])
        assert [fault.change.kind for fault in found.faults] == ["degrees"]

    @pytest.mark.long
    def test_two_are_found_one_after_the_other(self):
        matrices = {"torque": signs(3), "position": exchange(1, 2), "velocity": exchange(1, 2)}
        found = assess_recording(torque_model(), [changed(**matrices)])
        kinds = {(fault.change.kind, fault.change.joints) for fault in found.faults}
        assert kinds == {("reversed torque", (3,)), ("exchanged positions", (1, 2))}
        np.testing.assert_allclose(found.faults[-1].after, clean().errors, rtol=0.1)

    def test_position_that_contradicts_its_velocity(self):
        found = assess_recording(torque_model(), [changed(position=signs(1))])
        (fault,) = found.faults
        assert (fault.change.kind, fault.change.alone) == ("reversed position", "position")
        assert found.channels.velocity_gain[1] == pytest.approx(-1, abs=1e-3)

    def test_the_noise_of_a_joint_at_rest_is_no_rate(self):
        still = np.diag([1, 1e-6, 1, 1])
        gain = rate_gain([changed(position=still, velocity=still @ signs(1))])
        assert np.isnan(gain[1])
        np.testing.assert_allclose(np.delete(gain, 1), 1, rtol=1e-2)

    def test_columns_in_front_of_a_coupled_transmission(self):
        """The motor of the last axis turns along with the one before: its reversed column spoils two joints."""
        matrix = np.eye(N)
        matrix[3, 2] = 1.0
        columns = RecordedColumns(np.linalg.inv(matrix), matrix.T, np.array([0, -1.5, 1.5, 0]))
        piece = changed_in(columns, torque=signs(3))
        (fault,) = assess_recording(torque_model(), [piece], columns=columns).faults
        assert (fault.change.kind, fault.change.joints) == ("reversed torque", (3,))

    @LONG
    def test_a_reversed_column_with_an_offset(self):
        columns = RecordedColumns(np.eye(N), np.eye(N), np.array([0, -1.5, 1.5, 0]))
        piece = changed_in(columns, position=signs(2), velocity=signs(2))
        (fault,) = assess_recording(torque_model(), [piece], columns=columns).faults
        assert (fault.change.kind, fault.change.joints, fault.change.zero) == ("reversed position", (2,), None)

    def test_a_change_is_one_of_the_columns(self):
        """q = P c + zero, τ = T c of columns c, and the same of columns that are multiplied by a matrix."""
        rng = np.random.default_rng(0)
        p, t, of_q, of_v, of_tau = rng.normal(size=(5, N, N))
        zero, moved, c = rng.normal(size=N), rng.normal(size=N), rng.normal(size=(4, 6, N))

        def joints(of_q, of_v, of_tau, moved):
            q, v, a, tau = c
            return [q @ of_q.T @ p.T + zero + moved, v @ of_v.T @ p.T, a @ of_v.T @ p.T, tau @ of_tau.T @ t.T]

        recorded = Samples(*joints(np.eye(N), np.eye(N), np.eye(N), 0.0))
        change = Change("exchanged joints", (0, 1), of_q, of_v, of_tau, zero=moved)
        found = change.applied(recorded, RecordedColumns(p, t, zero))
        for name, expected in zip(("q", "v", "a", "tau"), joints(of_q, of_v, of_tau, moved), strict=True):
            assert getattr(found, name) == pytest.approx(expected), name

    def test_columns_exchanged_without_their_factors(self):
        """Signs and gains belong to the joints: recorded numbers change places, F P F⁻¹ in SI units."""
        factor = np.array([1.0, -2.0, 4.0, 1.0])
        columns = RecordedColumns(np.eye(N), np.eye(N), np.zeros(N), np.ones(N), factor)
        tried = [change for change in changes([False] * N, (), columns) if change.kind == "exchanged torques"]
        numbers = np.random.default_rng(0).normal(size=N)
        wanted = factor * numbers[[0, 2, 1, 3]]
        found = [change.torque @ (factor * numbers) for change in tried if change.joints == (1, 2)]
        assert min(np.abs(values - wanted).max() for values in found) < 1e-14
        assert len([change for change in tried if change.joints == (0, 3)]) == 1

    @pytest.mark.parametrize("kind", ["reversed position", "reversed joint"])
    def test_an_angle_that_counts_back_from_half_a_turn(self, kind):
        """π - q instead of q: one of the changes that are tried gives the angle back."""
        q = np.random.default_rng(0).normal(size=(5, N))
        recorded = Samples(np.where(np.arange(N) == 1, np.pi - q, q), q, q, q)
        tried = [change for change in changes([False] * N) if (change.kind, change.joints) == (kind, (1,))]
        angles = [change.applied(recorded, RecordedColumns.of_joints(N)).q for change in tried]
        assert min(np.abs(found - q).max() for found in angles) < 1e-14


class TestThinned:
    """Quintics, of which a spline of order five is exact, in a long and in a short piece of another rate."""

    QUINTIC = np.polynomial.Polynomial([3.0, -2.0, 1.0, 0.5, -0.2, 0.04])

    def piece(self, first, last, period):
        """Two joints; their positions are the time."""
        t = np.arange(first, last, period)
        q = np.column_stack([t, t])
        tau = np.column_stack([self.QUINTIC(t), -3 * self.QUINTIC(t)])
        return Piece(Samples(q, q, q, tau), period)

    def test_shifted_torques(self):
        found = ThinnedRecording([self.piece(0.0, 3.0, 0.004), self.piece(10.0, 11.0, 0.01)], rows=60)
        t = found.samples.q[:, 0]
        assert found.span == pytest.approx(0.2)
        assert 60 <= len(t) < 120
        for first, last, period in ((0.0, 3.0, 0.004), (10.0, 11.0, 0.01)):
            here = t[(t >= first) & (t < last)]
            assert here[0] == pytest.approx(first + found.span)
            step = here[1] - here[0]
            assert last - found.span - period - step < here[-1] < last - found.span
        for later in (-found.span, 0.0, 0.0371, found.span):
            expected = np.column_stack([self.QUINTIC(t + later), -3 * self.QUINTIC(t - later)])
            assert found.torque(later)[:, 0] == pytest.approx(expected[:, 0])
            assert found.torque(np.array([later, -later])) == pytest.approx(expected)
            assert found.torque_of(1, -later) == pytest.approx(expected[:, 1])
        rate = found.torque_rate(np.array([0.0, 0.02]))
        assert rate == pytest.approx(np.column_stack([self.QUINTIC.deriv()(t), -3 * self.QUINTIC.deriv()(t + 0.02)]))

    def test_too_short(self):
        with pytest.raises(TooShort, match="no piece of the recording is long enough to look for delays"):
            ThinnedRecording([self.piece(0.0, 0.07, 0.01)])


class TestDelays:
    @pytest.mark.parametrize("seconds", few([-0.02, 0.0073, 0.02, 0.1], 0.0073))
    def test_of_all_joints(self, seconds):
        found = assess_recording(torque_model(), [recording(seconds)])
        assert found.lag.common == pytest.approx(seconds, abs=WITHIN)
        assert abs(found.lag.common - seconds) < 6 * found.lag.deviation
        assert [fault.change.kind for fault in found.faults][:1] == ["late torque"]

    @LONG
    def test_of_one_joint(self):
        found = assess_recording(torque_model(), [recording([0, 0, 0.03, 0])])
        assert [(fault.change.kind, fault.change.joints) for fault in found.faults] == [("late torque", (2,))]
        assert found.faults[0].change.factor == pytest.approx(0.03, abs=WITHIN)

    def test_none(self):
        assert abs(clean().lag.common) < WITHIN
        assert clean().lag.deviation < WITHIN

    def test_friction_that_the_model_lacks(self):
        """It grows with the root of the speed, which the model takes for straight; σ contains what it feigns."""
        motion, _ = torque_at()
        late = 0.02
        clean, v = recording(late), motion(np.arange(0, SECONDS, PERIOD) - late)[1]
        size = np.sqrt(np.mean(clean.samples.tau**2, axis=0))
        tau = clean.samples.tau + 0.2 * size * np.sign(v) * np.sqrt(np.abs(v))
        found = Examined.of(torque_model(), [replace(clean, samples=replace(clean.samples, tau=tau))], 0.0).delays
        assert abs(found.common - late) < 2 * found.deviation < 0.002
        assert np.all(np.abs(found.joints - late) < 4 * found.deviations)

    def test_joints_that_disagree(self):
        """The mean of two delays is uncertain by their difference; one joint against the others is told as such."""
        found = Examined.of(torque_model(), [recording([0, 0, 0.03, 0])], 0.0).delays
        assert found.deviation > 0.005
        assert np.flatnonzero(found.joints_gained).tolist() == [2]
        assert found.joints_held_out[2].improves
        assert found.deviations[2] < 0.002

    def test_low_and_all_frequencies(self):
        """The variance of a difference that chance explains is left out."""
        of = functools.partial(_Mean, between=0.0)
        delay, deviation = _of_both(of(0.005, 0.001), of(0.0, 0.0005))
        chance = MIN_CHANCE_SHARE * 0.001**2
        assert delay == 0.005
        assert deviation == pytest.approx(np.sqrt((STUDENT * 0.001) ** 2 + 0.005**2 - MIN_DISAGREEMENT**2 * chance))
        assert _of_both(of(0.005, 0.001), of(0.0, 0.003))[1] == pytest.approx(STUDENT * 0.001)

    def test_mean_of_delays(self):
        """By information; its variance is that of chance, and of a scatter that chance does not explain."""
        seconds, weights = np.array([0.0, 0.01, np.nan]), np.array([3.0, 1.0, 5.0])
        found = FittedDelays(seconds, 1e-8 * np.eye(3), np.diag(weights))
        mean, deviation, between = _common(found, np.ones(3, dtype=bool))
        assert mean == pytest.approx(0.0025)
        scatter = 0.75 * 0.0025**2 + 0.25 * 0.0075**2
        assert between == pytest.approx(np.sqrt((scatter - 0.375 * 1e-8) / 0.375))
        assert deviation == pytest.approx(np.sqrt((1e-8 + between**2) * (0.75**2 + 0.25**2)))

    def test_held_out(self):
        """Blocks predicted by a fit on the others: of a delay that is there, and of one that is not."""
        there = ThinnedRecording([recording(0.02)])
        fit = BoundedFit.of(torque_model(), there.samples, np.ones(there.samples.q.shape, dtype=bool))
        before, after = held_out_squares(fit, there.torque()), held_out_squares(fit, there.torque(0.02))
        undone = held_out_gain(before, after)
        assert undone.improves
        redone = held_out_gain(after, before)
        assert not redone.improves
        assert redone.gained == pytest.approx(-undone.gained, rel=1e-3)
        blocks, tau, later = np.array_split(np.arange(len(there.samples)), 10), there.torque(), there.torque(0.02)
        squares = np.zeros((2, N))
        for block in blocks:
            rest = np.setdiff1d(np.arange(len(tau)), block)
            for k, measured in enumerate((tau, later)):
                own = BoundedFit.of(torque_model(), there.samples[rest], fit.kept[rest])
                e = fit.matrix[block] @ own.parameters(measured[rest]) - measured[block]
                squares[k] += np.sum(e**2, axis=0) / np.sum(measured**2, axis=0)
        assert undone.gained == pytest.approx(np.sum(np.log(squares[0] / squares[1])) / 2, rel=1e-6)


class TestHalves:
    def half_reversed(self, piece):
        tau = piece.samples.tau.copy()
        tau[len(tau) // 2 :, 1] *= -1
        return replace(piece, samples=replace(piece.samples, tau=tau))

    @LONG
    def test_a_fault_of_one_half(self):
        found = assess_recording(torque_model(), [self.half_reversed(recording())])
        assert found.faults == ()
        assert found.half_faults[0] == ()
        assert [(fault.change.kind, fault.change.joints) for fault in found.half_faults[1]] == [
            ("reversed torque", (1,))
        ]
        assert found.contradictions[:, 1].any()
        common, own = found.halves[:, 0, 1], found.halves[:, 1, 1]
        assert np.all(common > 3 * own)

    @pytest.mark.long
    def test_beside_a_fault_of_the_whole(self):
        found = assess_recording(torque_model(), [self.half_reversed(changed(torque=exchange(2, 3)))])
        assert [(fault.change.kind, fault.change.joints) for fault in found.faults] == [("exchanged torques", (2, 3))]
        assert [(fault.change.kind, fault.change.joints) for fault in found.half_faults[1]] == [
            ("reversed torque", (1,))
        ]

    def test_which_half_shows_what(self):
        def fault(kind, *joints):
            return DataFault(Change(kind, joints), 1.0, np.ones(N), np.ones(N))

        a, b, c, d, e = (fault("reversed torque", j) for j in (0, 1, 2, 3, 4))
        of_halves = iter([(a, b, d), (a, c)])
        found = faults_by_halves([recording()], (a, e), [1, 2], lambda half: next(of_halves))
        assert found.of_both == (a,)
        assert found.of_one == ((b,), (c,))
        assert found.doubtful == (e, d)

    def test_halves_of_pieces(self):
        long, short = recording(), recording()
        long, short = (Piece(piece.samples[:rows], PERIOD) for piece, rows in ((long, 700), (short, 100)))
        first, second = halved([long, short])
        assert [len(piece.samples) for piece in first] == [400]
        assert [len(piece.samples) for piece in second] == [300, 100]

    def test_too_short_for_halves(self):
        def refuse(half):
            raise TooShort("too short")

        whole = (DataFault(Change("reversed torque", (0,)), 1.0, np.ones(N), np.ones(N)),)
        assert faults_by_halves([recording()], whole, [0], refuse).doubtful == whole


class TestChannels:
    def test_duplicated_and_constant(self):
        samples = recording().samples
        tau = samples.tau.copy()
        tau[:, 2], tau[:, 3] = -2 * tau[:, 1], 7.0
        found = assess_recording(torque_model(), [Piece(Samples(samples.q, samples.v, samples.a, tau), PERIOD)])
        assert (found.channels.duplicated_torques, found.channels.constant_torques) == (((1, 2),), (3,))
        assert found.faults == ()

    def test_gain_of_a_velocity(self):
        samples = recording().samples
        v = np.gradient(samples.q, PERIOD, axis=0) * [1.0, 1.1, -2.0, 0.5]
        assert rate_gain([Piece(replace(samples, v=v), PERIOD)]) == pytest.approx([1.0, 1.1, -2.0, 0.5])

    def test_five_rows_at_an_end_are_clipped(self):
        tau = np.array([*range(10), *[20] * 4, 3, *[20] * 5, 2, *[-7] * 6])[:, None] * np.ones(N)
        piece = recording().samples[: len(tau)]
        assert channels([Piece(piece, PERIOD)], [tau]).clipped == pytest.approx(np.full(N, 11 / len(tau)))

    def test_clipped_and_still(self):
        samples = recording().samples
        v, bound = samples.v.copy(), np.quantile(samples.tau[:, 2], 0.9)
        v[:, 0] = 0.0
        tau = np.minimum(samples.tau, np.where(np.arange(N) == 2, bound, np.inf))
        found = channels([Piece(Samples(samples.q, v, samples.a, tau), PERIOD)], [tau])
        held = np.diff(np.flatnonzero(np.diff(np.concatenate([[False], tau[:, 2] == bound, [False]]))))[::2]
        assert found.clipped[2] == held[held >= 5].sum() / len(tau)
        assert found.clipped[2] == pytest.approx(0.1, abs=0.06)
        assert np.all(found.clipped[[0, 1, 3]] == 0)
        assert found.standstill[0] == 1.0


class TestBounds:
    def test_without_bounds_the_fit_is_least_squares(self):
        """On the rows that count: first all joints alike, relative to their torque, then weighted by what is left."""
        samples = recording().samples[::5]
        kept = np.abs(samples.v) > 0.05
        fit = BoundedFit.of(torque_model(), samples, kept)
        w, size = fit.matrix * kept[..., None], np.linalg.norm(samples.tau * kept, axis=0)

        def errors(weights):
            scale = size * weights
            rows = (w / scale[:, None]).reshape(-1, w.shape[-1])
            length = np.linalg.norm(rows, axis=0)
            length[length < 1e-9 * length.max()] = np.inf  # rounding, which scaling would make a parameter
            x = np.linalg.lstsq(rows / length, (samples.tau * kept / scale).ravel(), rcond=1e-9)[0] / length
            return np.linalg.norm(w @ x - samples.tau * kept, axis=0) / size

        np.testing.assert_allclose(fit.errors(samples.tau, bounded=False), errors(errors(np.ones(N))), rtol=1e-4)

    def test_bounds_hold(self):
        tau = -recording().samples.tau[::10]
        samples = recording().samples[::10]
        fit = BoundedFit.of(torque_model(), samples, np.ones(tau.shape, dtype=bool))
        x = fit.parameters(tau)
        moments = np.array([x[10 * i + np.array([4, 6, 9])] for i in range(N)])
        assert np.all(x[: 10 * N : 10] >= -1e-9)
        assert np.all(moments.sum(axis=1, keepdims=True) - 2 * moments >= -1e-6 * np.abs(moments).max())
        assert np.all(x[10 * N : 12 * N] >= 0)
        assert np.all(fit.errors(tau) > 5 * fit.errors(tau, bounded=False))


def test_a_known_torque_that_refuses_other_motions():
    """Changes of the motion are then not tried; those of the torque are."""
    first = recording().samples.q[:, 0]

    class Picky:
        def torque(self, model, samples):
            if not np.isin(samples.q[:, 0], first).all():
                raise ValueError("never seen")
            return np.zeros(samples.q.shape)

    model = TorqueModel(robot(), torque_model().terms, (Picky(),))
    found = assess_recording(model, [changed(torque=signs(3))])
    assert [fault.change.kind for fault in found.faults] == ["reversed torque"]
    assert not [change for change in found.unseen if change.joints == (0,) and change.moves]


def test_too_short():
    with pytest.raises(InvalidInput, match="no piece of the recording is long enough"):
        assess_recording(torque_model(), [Piece(recording().samples[:6], PERIOD)])


def test_groups_are_those_of_the_symbols():
    """The weakest direction of a group: the smallest singular value of what others do not explain, from W alone."""
    problem = Problem(torque_model(), recording().samples[::10])
    symbols = np.array([column.symbol.split("_")[0] for column in torque_model().columns])
    named = {
        "masses and centers of mass": {"M", "MX", "MY", "MZ"},
        "inertia tensors": {"XX", "XY", "YY", "XZ", "YZ", "ZZ"},
        "viscous": {"FV"},
        "coulomb": {"FC"},
        "offset": {"OFF"},
    }
    assert {name: set(symbols[columns]) for name, columns in groups(torque_model())} == named
    rows = list(problem.rows())
    w = np.concatenate([problem.reduced(part) for part in rows])
    w = w / np.sqrt(np.mean(np.concatenate([part.right for part in rows]) ** 2, axis=0))[:, None]
    w = w.reshape(-1, w.shape[-1])
    w = w / np.linalg.norm(w, axis=0)
    for group in excitation(problem):
        own = np.isin(symbols[problem.base.independent], list(named[group.name]))
        left = w[:, own] - w[:, ~own] @ np.linalg.lstsq(w[:, ~own], w[:, own], rcond=None)[0]
        assert group.determined == own.sum()
        assert group.weakest == pytest.approx(np.linalg.svd(left, compute_uv=False)[-1], rel=1e-6)


def test_excitation_of_a_joint_that_never_moves():
    piece = recording().samples
    still = Samples(piece.q, piece.v * [1, 1, 1, 0], piece.a, piece.tau)
    moving = {group.name: group for group in excitation(Problem(torque_model(), piece))}
    resting = {group.name: group for group in excitation(Problem(torque_model(), still))}
    assert [*moving] == ["masses and centers of mass", "inertia tensors", "viscous", "coulomb", "offset"]
    assert (moving["viscous"].determined, moving["viscous"].structural) == (N, N)
    assert (resting["viscous"].determined, resting["coulomb"].determined) == (N - 1, N - 1)
    assert all(0 < group.weakest <= 1 for group in moving.values())


def test_units_of_torques_that_are_tried():
    """Gains of 1000 in one joint, of -100 in all but one: against the others, and against the model."""
    sure = np.ones(4)

    def tried(gain, share=sure):
        found = list(scales(np.array(gain), share))
        for change in found:
            size = np.ones(4)
            size[list(change.joints)] = 1 / change.factor
            np.testing.assert_allclose(change.torque, np.diag(size), rtol=1e-15)
        return [(change.joints, change.factor) for change in found]

    assert tried([1.0, 1.5, -1000.0, 0.7]) == [((2,), 1000 / 1.25), ((2,), 1000.0)]
    everywhere = [((0, 1, 2, 3), 100.0), ((0,), 100.0), ((1,), 100.0), ((2,), 0.01), ((3,), 100.0)]
    assert tried([-100.0, 100.0, 1.0, 100.0]) == everywhere
    assert tried([1.0, 1.0, 1000.0, 1.0], np.array([1.0, 1.0, 0.0, 1.0])) == []  # which explains nothing
