"""Low-pass, derivatives, resampling and decimation against motions that are known exactly, and against SciPy."""

import dataclasses

import numpy as np
import pytest

import graphdyn
from crosscheck.identifying import Preparation
from crosscheck.recordings import (
    Recording,
    chosen_cutoff,
    concatenated,
    decimated_columns,
    derivative,
    differentiated,
    lowpass,
    recording_of,
    resampled,
    residual_analysis,
    samples_of,
    sampling_rate,
)
from crosscheck.recordings.mapping.mapping import Channel, ColumnMapping
from crosscheck.recordings.preparation import derivatives
from crosscheck.recordings.preparation.derivatives import white_noise
from crosscheck.recordings.preparation.filtering import BORDER_DECAY, PADDING_ROWS, TorqueFilter, border, rows_needed
from crosscheck.recordings.preparation.resampling import with_delays_undone
from graphdyn import InvalidInput

RATE = 500.0
SLOW = 2 * np.pi * np.array([0.7, 1.1])
"""[rad/s] Two joints that move far below every cutoff used here."""


def motion(t):
    """q, v, a (N, 2)."""
    phase = np.outer(t, SLOW)
    return np.sin(phase), SLOW * np.cos(phase), -(SLOW**2) * np.sin(phase)


def record(t, noise=0.0, **channels):
    q, _, _ = motion(t)
    q = q + noise * np.random.default_rng(0).normal(size=q.shape)
    return Recording(("a", "b"), t, q, tau=np.cos(np.outer(t, SLOW)), **channels)


T = np.arange(3000) / RATE

INNER = 1e-8
"""Differences of fourth order err by (ω h)^4 / 30 = 1e-9 each, the filter at 1.1 of 40 Hz by (1.1 / 40)^8 = 3e-13."""

BORDERS = 5e-3
"""They end at 1e-3 of the start of a transient, which two derivatives weigh more than the motion; measured 1.3e-3."""


@pytest.mark.parametrize(("cutoff", "order"), [(8.0, 4), (50.0, 2), (100.0, 4)])
def test_the_low_pass_has_no_phase_and_the_squared_gain_of_one_pass(cutoff, order):
    from scipy.signal import butter, sosfreqz

    frequencies = np.array([0.3, 0.8, 1.0]) * cutoff
    sections = butter(order, cutoff, fs=RATE, output="sos")
    gains = np.abs(sosfreqz(sections, frequencies, fs=RATE)[1]) ** 2
    assert gains[-1] == pytest.approx(0.5)
    waves = np.sin(2 * np.pi * np.outer(T, frequencies))
    cut = border(RATE, cutoff, order)
    inner = slice(cut, len(T) - cut)
    filtered = lowpass(waves, RATE, cutoff, order)
    assert np.abs(filtered - gains * waves)[inner].max() < 3 * BORDER_DECAY


def test_beyond_the_border_the_continuation_is_forgotten():
    values = np.random.default_rng(1).normal(size=3000)
    cut = border(RATE, 8.0)
    whole, part = lowpass(values, RATE, 8.0), lowpass(values[1000:2000], RATE, 8.0)
    error = np.abs(whole[1000:2000] - part)
    assert error[cut:-cut].max() < BORDER_DECAY * error.max()


@pytest.mark.parametrize(
    ("rows", "cutoff", "order", "message"),
    [
        (100, 250.0, 4, r"cutoff is 250 Hz at 500 samples per second; choose one between zero and 250 Hz"),
        (100, 0.0, 4, r"cutoff is 0 Hz"),
        (100, 8.0, 0, r"the order of the filter is 0; choose 1 or more, usually 4"),
        (15, 8.0, 4, r"15 rows are too few for a filter of order 4; give more than 15"),
    ],
)
def test_filters_that_there_are_not(rows, cutoff, order, message):
    with pytest.raises(InvalidInput, match=message):
        lowpass(np.zeros(rows), RATE, cutoff, order)


def test_the_derivative_is_exact_for_polynomials_of_fourth_degree_and_of_fourth_order():
    t = np.arange(20) / 10
    np.testing.assert_allclose(derivative(t**4 - t, 10), 4 * t**3 - 1, rtol=0, atol=1e-11)
    errors = []
    for rate in (50, 100):
        t = np.arange(0, 1, 1 / rate)
        errors.append(np.abs(derivative(np.sin(9 * t), rate) - 9 * np.cos(9 * t))[5:-5].max())
    assert errors[0] / errors[1] == pytest.approx(2**4, rel=0.1)


@pytest.mark.parametrize("cutoff", [40.0, {"q": 40.0}, None])
def test_velocities_and_accelerations_of_a_known_motion(cutoff):
    result = differentiated(record(T), cutoff)
    q, v, a = motion(result.t)
    inner = slice(200, -200)
    for name, exact in (("q", q), ("v", v), ("a", a)):
        error = np.abs(getattr(result, name) - exact) / np.abs(exact).max()
        assert error[inner].max() < INNER
        assert error.max() < (BORDERS if cutoff else INNER)
    assert np.array_equal(result.rows, np.arange(result.rows[0], result.rows[-1] + 1))
    assert result.rows[0] == len(T) - 1 - result.rows[-1]
    assert np.array_equal(result.t, T[result.rows])
    assert np.array_equal(result.tau, record(T).tau[result.rows])
    assert np.all(result.torque_cutoff == (cutoff if isinstance(cutoff, float) else np.inf))


def test_what_was_done_is_in_the_provenance():
    (step,) = differentiated(record(T), 8.0).provenance.steps
    assert step == (
        "zero-phase Butterworth low-pass of order 4: q 8 Hz, tau and every column of the regressor 8 Hz; v, a by "
        "central differences; 184 rows cut at both ends of each block"
    )
    (step,) = differentiated(record(T), None).provenance.steps
    assert step == "no filter; v, a by central differences; 4 rows cut at both ends of each block"
    step = differentiated(record(T, noise=1e-4), "residual").provenance.steps[0]
    assert step.endswith("cutoff by residual analysis (Winter)")


def test_recorded_velocities_are_kept_unless_told_otherwise():
    with_v = dataclasses.replace(record(T), v=np.ones((len(T), 2)))
    kept = differentiated(with_v, {"q": 8.0})
    assert np.array_equal(kept.v, np.ones_like(kept.q))
    assert np.abs(kept.a).max() < 1e-12 * RATE
    assert "a by central differences" in kept.provenance.steps[0]
    derived = differentiated(with_v, 40.0, velocity="derived")
    assert np.abs(derived.v - motion(derived.t)[1]).max() < BORDERS * SLOW.max()


def test_nothing_is_filtered_across_a_gap():
    """A step of 1000 rad between blocks would ring through every filter that saw it."""
    block = np.repeat([0, 1, 2], [1400, 200, 1400])
    t = T + 10 * block
    base = record(t, block=block)
    jumping = dataclasses.replace(base, q=base.q + 1000.0 * block[:, None])
    result = differentiated(jumping, 8.0)
    assert np.unique(result.block).tolist() == [0, 2]
    assert np.abs(result.v - motion(result.t)[1]).max() < 2e-2 * SLOW.max()
    assert result.provenance.steps[0].endswith("without the blocks 1 of fewer than 369 rows")
    with pytest.raises(
        InvalidInput, match=r"the longest block has 1400 rows, \d+ are needed with borders of \d+ rows; ch"
    ):
        differentiated(jumping, 1.0)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"cutoff": {"v": 8.0}}, r"cutoff of 'v', which is not recorded; there are q, tau"),
        ({"cutoff": "winter"}, r"cutoff is 'winter'; give it in Hz, per channel, or 'residual'"),
        ({"cutoff": 8.0, "velocity": "none"}, r"velocity is 'none'; use 'recorded' or 'derived'"),
    ],
)
def test_settings_that_there_are_not(options, message):
    with pytest.raises(InvalidInput, match=message):
        differentiated(record(T), **options)


@pytest.mark.parametrize("noise", [1e-5, 1e-3])
def test_residual_analysis_finds_the_noise_and_a_cutoff_beyond_the_motion(noise):
    rng = np.random.default_rng(3)
    t = np.arange(20_000) / RATE
    q = np.sin(2 * np.pi * 0.8 * t)
    found = residual_analysis(q + noise * rng.normal(size=len(t)), RATE)
    assert found.noise == pytest.approx(noise, rel=0.05)
    assert 0.8 < found.cutoff < 30
    noisy = q + noise * rng.normal(size=len(t))

    def error(cutoff):
        return np.std((lowpass(noisy, RATE, cutoff) - q)[2000:-2000])

    best = min(map(error, found.frequencies))
    assert (
        error(found.cutoff) <= np.sqrt(2) * best
    )  # where loss and noise are equal, no cutoff has less than one of them


def test_less_noise_allows_a_higher_cutoff():
    loud, quiet = (chosen_cutoff(record(np.arange(20_000) / RATE, noise=noise)) for noise in (1e-2, 1e-6))
    assert quiet > loud


def test_cutoffs_that_cannot_be_chosen():
    with pytest.raises(InvalidInput, match=r"20 rows are too few to choose a cutoff from; give the cutoff"):
        residual_analysis(np.arange(20.0), RATE)
    still = Recording(("a",), T, np.ones((len(T), 1)))
    with pytest.raises(InvalidInput, match=r"no joint moves, so no cutoff can be chosen; give the cutoff"):
        chosen_cutoff(still)


def test_a_cutoff_is_chosen_once_per_recording(monkeypatch):
    asked = []
    real = derivatives.residual_analysis
    monkeypatch.setattr(derivatives, "residual_analysis", lambda *given: asked.append(given) or real(*given))
    one, other = (record(np.arange(2_000) / RATE) for _ in range(2))
    assert chosen_cutoff(one) == chosen_cutoff(one) == chosen_cutoff(other)
    assert len(asked) == 2 * one.n_joints


def test_white_noise_of_positions():
    """4000 rows know it to 2 %; of the motion, 1 rad at 1 Hz, nothing is left."""
    t = np.arange(4000) / RATE
    noise = np.random.default_rng(0).normal(size=(4000, 2)) * [1e-4, 3e-3]
    found = white_noise(np.sin(2 * np.pi * t)[:, None] + noise)
    assert found == pytest.approx([1e-4, 3e-3], rel=0.06)
    assert np.all(white_noise(noise[:6]) == 0)


@pytest.mark.parametrize("cutoff", [None, 40.0])
def test_samples_are_the_rows_of_their_block(cutoff):
    """In every channel, and in time: of blocks of different lengths."""
    block = np.repeat([0, 1, 2], [900, 1200, 900])
    log = record(T, temperature=np.column_stack([T, -T]), block=block)
    prepared = differentiated(log, cutoff)
    for k, samples in enumerate(samples_of(prepared)):
        rows = prepared.block == k
        assert np.array_equal(samples.time, prepared.t[rows])
        assert np.array_equal(samples.temperature, prepared.temperature[rows])
        for name in ("q", "v", "a", "tau"):
            assert np.array_equal(getattr(samples, name), prepared.channel(name)[rows])
        assert samples.v == pytest.approx(motion(samples.time)[1], abs=0.05)
    assert k == 2


@pytest.mark.parametrize(
    ("decimate", "speed"), [((), None), ((4,), None), ((), [0.2, 0.05])], ids=["each", "fourth", "measured velocities"]
)
def test_errors_of_the_motion(decimate, speed):
    """Of q, v and a in a row of the equations, against noise that goes through the same filters."""
    rows, sigma, rng = 60_000, np.array([1e-3, 2e-3]), np.random.default_rng(1)
    q = rng.normal(size=(rows, 2)) * sigma
    v = None if speed is None else rng.normal(size=(rows, 2)) * speed
    cutoff = {"q": RATE / 5, "tau": RATE / 8} | ({} if speed is None else {"v": RATE / 6})
    preparation = Preparation(cutoff=cutoff, decimate=decimate)
    log = Recording(("A", "B"), np.arange(rows) / RATE, q, v, tau=0 * q)
    (samples,) = preparation.samples(preparation.differentiated(log))
    for joint, expected in enumerate(samples.motion_covariance):
        motion = np.stack([samples.row_filter(getattr(samples, name)[:, [joint]])[:, 0] for name in ("q", "v", "a")])
        size = np.sqrt(np.diag(expected))
        assert np.cov(motion) / np.outer(size, size) == pytest.approx(expected / np.outer(size, size), abs=0.05)


def test_uneven_steps_are_made_even():
    rng = np.random.default_rng(5)
    t = np.delete(T + rng.uniform(-0.3, 0.3, len(T)) / RATE, [700, 701, 1500])
    even = resampled(record(t))
    assert sampling_rate(even) == pytest.approx(RATE, rel=0.02)
    assert np.ptp(np.diff(even.t)) < 1e-12
    assert np.abs(even.q - motion(even.t)[0]).max() < 1e-7
    assert np.abs(even.t - t[even.rows]).max() <= 2 / RATE
    assert even.provenance.steps[0].startswith("resampled to ")
    result = differentiated(record(t), 40.0)
    assert np.abs(result.a - motion(result.t)[2]).max() < 1e-2 * np.max(SLOW**2)
    assert result.provenance.steps[0] == even.provenance.steps[0]


def test_resampling_block_by_block():
    t = np.concatenate([T[:100], T[200:203], T[300:400]])
    block = np.repeat([0, 1, 2], [100, 3, 100])
    even = resampled(record(t, block=block), 2 * RATE)
    assert even.provenance.steps == (
        "resampled to 1000 Hz by cubic splines, without the blocks 1 of fewer than 4 rows",
    )
    assert [rows.stop - rows.start for rows in even.block_slices] == [199, 199]
    with pytest.raises(InvalidInput, match=r"rate is 100 Hz, the recording has 500 Hz; a lower one would alias"):
        resampled(record(t, block=block), 100)
    with pytest.raises(InvalidInput, match=r"no block of the recording has 4 rows; nothing can be resampled"):
        resampled(record(T[:3]))
    with pytest.raises(InvalidInput, match=r"every block of the recording is one row; a sampling rate needs two"):
        sampling_rate(record(T[:1]))


def test_the_steps_between_blocks_are_no_steps_of_the_rate():
    t = np.array([0.0, 0.01, 5.0, 5.01, 9.0, 9.01, 20.0])
    assert sampling_rate(record(t, block=np.array([0, 0, 1, 1, 2, 2, 3]))) == pytest.approx(100.0)


def test_decimation_of_any_columns_is_that_of_scipy():
    from scipy.signal import decimate

    columns = np.random.default_rng(7).normal(size=(4000, 2, 3))
    by_hand = decimate(decimate(columns, 10, axis=0), 10, axis=0)
    assert np.array_equal(decimated_columns(columns, (10, 10)), by_hand)


def test_decimation_leaves_short_blocks_out():
    assert rows_needed((10,)) == PADDING_ROWS + 1
    assert rows_needed((10, 10)) == 10 * PADDING_ROWS + 1
    block = np.repeat([0, 1, 2], [1000, 270, 1730])
    with_short = record(T, block=block, v=record(T).q, a=record(T).q)
    long = samples_of(with_short, (10, 10))
    assert [len(samples) for samples in long] == [1000, 1730]
    assert [len(samples.row_filter(samples.q)) for samples in long] == [10, 18]
    assert len(decimated_columns(np.zeros(271), (10, 10))) == 3
    with pytest.raises(InvalidInput, match=r"270 rows are too few to be decimated by \(10, 10\); give 271 or more"):
        decimated_columns(np.zeros(270), (10, 10))
    with pytest.raises(InvalidInput, match=r"no block has the 2701 rows that decimation by \(10, 10, 10\) needs; use"):
        samples_of(with_short, (10, 10, 10))
    for factors in ((), (1,), (14,), (2.5,)):
        with pytest.raises(InvalidInput, match=r"give factors from 2 to 13, larger ones in stages: \(10, 10\)"):
            decimated_columns(np.zeros(3000), factors)


def test_the_filter_of_the_torque_goes_with_the_samples():
    """Low-pass, then decimation, of each block at its own cutoff and rate; no row beyond the memory counts."""
    recording = concatenated([differentiated(record(T), 8.0), differentiated(record(T / 2), {"q": 20.0, "tau": 12.0})])
    columns = np.random.default_rng(3).normal(size=(len(recording.t), 2))
    here, there = samples_of(recording)
    np.testing.assert_allclose(here.row_filter(columns), lowpass(columns, RATE, 8.0), atol=1e-9)
    np.testing.assert_allclose(there.row_filter(columns), lowpass(columns, 2 * RATE, 12.0), atol=1e-9)
    both = samples_of(recording, (5, 4))[0].row_filter
    np.testing.assert_allclose(both(columns), decimated_columns(lowpass(columns, RATE, 8.0), (5, 4)), atol=1e-9)
    assert samples_of(differentiated(record(T), None))[0].row_filter is None
    for row_filter in (here.row_filter, both):
        beyond = columns[: 2 * row_filter.memory + 1].copy()
        before = row_filter(beyond)[row_filter.memory // row_filter.factor]
        beyond[[0, -1]] += 1.0
        assert np.abs(row_filter(beyond)[row_filter.memory // row_filter.factor] - before).max() < 1e-5
    with pytest.raises(InvalidInput, match=r"no block has the 16 rows that the filter needs; record longer"):
        samples_of(recording.take(slice(10)))
    with pytest.raises(InvalidInput, match=r"torque_cutoff has shape \(3,\), expected"):
        dataclasses.replace(recording, torque_cutoff=np.ones(3))


def test_a_record_refuses_what_is_none():
    good = record(T)
    for changed, message in [
        ({"q": good.q[:, :1]}, r"q has shape \(3000, 1\), expected \(3000, 2\)"),
        ({"tau": np.full_like(good.q, np.nan)}, r"tau is nan in row 0; leave out the rows without numbers"),
        ({"prismatic": (True,)}, r"prismatic has 1 entry for 2 joints"),
        ({"t": T[::-1]}, r"time 5.996 s in row 1 does not increase inside its block"),
        (
            {"block": np.arange(3000)[::-1]},
            r"the blocks of a recording are not in order; number them in the order of the",
        ),
    ]:
        with pytest.raises(InvalidInput, match=message):
            dataclasses.replace(good, **changed)
    with pytest.raises(InvalidInput, match=r"the recording has no rows; give at least one"):
        good.take([])
    with pytest.raises(InvalidInput, match=r"the recording has no a; derive it with crosscheck.differentiated"):
        good.channel("a")
    with pytest.raises(InvalidInput, match=r"has no joint_wrenches; record it, or map its columns"):
        good.channel("joint_wrenches")
    with pytest.raises(ValueError, match="read-only"):
        good.q[0] = 1


def test_records_one_after_another():
    experiment = recording_of(graphdyn.kr500_experiment())
    both = concatenated([experiment, experiment.take(slice(None, None, 2))])
    assert both.block_slices[1].start == len(experiment.t)
    assert np.unique(both.file).tolist() == [0, 1]
    assert both.joint_wrenches.shape[0] == len(both.t)
    assert concatenated([record(T), dataclasses.replace(record(T), tau=None)]).tau is None
    with pytest.raises(InvalidInput, match=r"no recordings to concatenate; give at least one"):
        concatenated([])
    with pytest.raises(InvalidInput, match=r" has the joints a, b, .* O1, O2, .*; give recordings of the same joints"):
        concatenated([experiment, record(T)])


def test_delays_of_either_sign_are_undone_where_torques_are_recorded():
    """Splines of cosines err by (ω h)^4 · 5/384: 5e-12; at the ends, by more."""
    t, delays = T[:500], np.array([0.053, -0.021])
    none = np.zeros(2)
    channel = Channel(("1", "2"), np.ones(2), none, (None, None), np.ones(2), delays)
    found = with_delays_undone(record(t), ColumnMapping("m.toml", ("a", "b"), {"tau": channel}, rate=RATE))
    kept = t[(t - 0.021 >= t[0]) & (t + 0.053 <= t[-1])]
    np.testing.assert_array_equal(found.t, kept)
    np.testing.assert_array_equal(found.q, motion(kept)[0])
    shifted = np.cos((kept[:, None] + delays) * SLOW)
    assert np.abs(found.tau - shifted).max() < 1e-6
    assert np.abs(found.tau - shifted)[50:-50].max() < 1e-10


@pytest.mark.parametrize("factors", [(10,), (4, 10), (10, 3)])
def test_stages_of_a_decimation_forget_a_row_within_their_memory(factors):
    """Hardly anything of the response to one row is left at the end of the memory, and something halfway."""
    values = np.zeros(20_000)
    values[10_000] = 1.0
    response = np.abs(decimated_columns(values, factors))
    away = np.abs(np.arange(len(response)) * int(np.prod(factors)) - 10_000)
    memory = TorqueFilter(factors=factors).memory
    assert response[away > memory].max() < 1e-5 * response.max()
    assert response[away > memory / 2].max() > 1e-5 * response.max()
