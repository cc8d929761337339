"""Recordings: shapes, printed digits, noise, rows."""

import dataclasses

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from graphdyn import InvalidInput, VirtualRecording
from graphdyn.experiments.virtual_recording import BODY_CHANNELS, CHANNELS, JOINT_CHANNELS
from graphdyn.model.spatial import cardano_matrix

N_TIMES = 5


def recording(n_times=N_TIMES, **changed):
    rng = np.random.default_rng(3)
    channels = {name: rng.normal(size=(n_times, 2)) for name in JOINT_CHANNELS}
    channels |= {name: rng.normal(size=(n_times, 2, 3)) for name in BODY_CHANNELS}
    names = {"robot": "pair", "joint_names": ["O1", "O2"], "body_names": ["B1", "B2"], "prismatic": [False, True]}
    return VirtualRecording(**(names | {"time": np.arange(n_times) * 0.1} | channels | changed))


def with_value(name, value):
    array = np.array(getattr(recording(), name))
    array[3, 1] = value
    return {name: array}


def test_names_and_numbers_cannot_change():
    x = recording()
    assert x.joint_names == ("O1", "O2")
    with pytest.raises(ValueError, match="read-only"):
        x.q[0, 0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        x.time = np.zeros(N_TIMES)


def test_rotation_is_that_of_the_cardano_angles():
    x = recording()
    assert x.rotation.shape == (N_TIMES, 2, 3, 3)
    assert np.array_equal(x.rotation, cardano_matrix(x.cardano))


@given(st.floats(-1e300, 1e300), st.integers(1, 17))
@example(-0.0, 7)
def test_rounded_prints_like_c(number, digits):
    rounded = recording(**with_value("tau", number)).rounded(digits).tau[3, 1]
    assert np.array([rounded]).tobytes() == np.array([float(f"{number:.{digits - 1}e}")]).tobytes()


@given(st.integers(1, 10**6), st.integers(1, 7))
def test_what_looks_like_a_tie_is_rounded_as_the_number_behind_it(count, digits):
    """0.15 is less than it looks, and 0.1 with one digit; 0.35 is less too, 0.45 more."""
    number = float(f"{count}5e-{digits}")
    wanted = len(str(count))
    rounded = recording(**with_value("tau", number)).rounded(wanted).tau[3, 1]
    assert rounded == float(f"{number:.{wanted - 1}e}")


@given(st.floats(-1e12, 1e12), st.integers(1, 15))
def test_truncated_cuts_digits_and_cuts_them_once(number, digits):
    once = recording(**with_value("tau", number)).rounded(digits, "truncated")
    cut = once.tau[3, 1]
    assert abs(cut) <= abs(number)
    assert abs(number - cut) <= abs(number) * 10.0 ** (1 - digits) * (1 + 1e-12)
    assert np.array_equal(once.rounded(digits, "truncated").tau, once.tau)


def test_the_two_conventions():
    x = recording(**with_value("joint_forces", [24853.756, 0.3, -2008.9349999]))
    assert x.rounded().joint_forces[3, 1].tolist() == [24853.76, 0.3, -2008.935]
    assert x.rounded(7, "truncated").joint_forces[3, 1].tolist() == [24853.75, 0.3, -2008.934]
    assert np.array_equal(x.rounded(2).time, x.time)


def test_ties_go_to_the_even_digit():
    assert recording(**with_value("q", 2.5)).rounded(1).q[3, 1] == 2.0
    assert recording(**with_value("q", 3.5)).rounded(1).q[3, 1] == 4.0


@pytest.mark.parametrize("rate", [10.0, 100.0, 1000.0])
def test_the_last_row_is_sampled_where_the_rate_meets_it(rate):
    """However the duration times the rate is rounded."""
    for count in range(1, 60):
        x = recording(count + 1, time=np.arange(count + 1) / rate)
        assert np.array_equal(x.sampled(rate=rate).time, x.time)
        assert len(x.sampled(rate=rate / 2).time) == count // 2 + 1


def test_relative_noise_has_the_asked_size():
    x = recording(20_000, tau=np.zeros((20_000, 2)))
    x = dataclasses.replace(x, position=x.position + 3.0)  # of which the mean counts too
    y = x.noisy(1, relative=0.01)
    assert not y.tau.any()
    assert np.array_equal(y.time, x.time)
    for name in CHANNELS[4:]:
        exact = getattr(x, name)
        size = np.std(getattr(y, name) - exact, axis=0) / np.sqrt(np.mean(exact**2, axis=0))
        assert np.abs(size / 0.01 - 1).max() < 0.03  # six standard deviations of this estimate


def test_absolute_noise_is_per_channel():
    x = recording(20_000)
    y = x.noisy(np.random.default_rng(1), absolute={"q": 0.1, "tau": [0.0, 2.0]})
    assert np.abs(np.std(y.q - x.q, axis=0) / 0.1 - 1).max() < 0.03
    assert np.array_equal(y.tau[:, 0], x.tau[:, 0])
    assert np.std(y.tau[:, 1] - x.tau[:, 1]) == pytest.approx(2.0, rel=0.03)
    assert np.array_equal(y.position, x.position)


def test_the_same_seed_gives_the_same_noise():
    x = recording()
    assert np.array_equal(x.noisy(5, relative=0.1).q, x.noisy(5, relative=0.1).q)
    assert not np.array_equal(x.noisy(5, relative=0.1).q, x.noisy(6, relative=0.1).q)


def test_rows_by_time():
    x = recording()
    y = x.at([0.1, 0.1 * 3])  # 0.30000000000000004, recorded as such; 0.3 below is one rounding away
    assert np.array_equal(y.joint_moments, x.joint_moments[[1, 3]])
    assert np.array_equal(x.at(0.3).q, x.q[[3]])
    assert np.array_equal(recording(1).at(0.0).q, recording(1).q)


def test_sampled_by_rows_and_by_rate():
    x = recording()
    assert np.array_equal(x.sampled(every=2).time, x.time[::2])
    assert np.array_equal(x.sampled(rate=5.0).time, x.time[::2])
    assert np.array_equal(x.sampled(rate=10.0).tau, x.tau)
    assert len(x.sampled(every=9).time) == 1


@pytest.mark.parametrize(("first", "scale"), [(0.0, 1.0), (-3.0, 1e-3), (1.7e9, 100.0), (-500.0, 1e3)])
def test_rows_are_those_of_the_nearest_times_and_of_no_others(first, scale):
    """Whatever the times begin with: all times are looked at, and the largest of them says what is the same."""
    rng = np.random.default_rng(int(abs(first)))
    x = recording(9, time=first + scale * np.cumsum(rng.uniform(1, 9, 9)))
    same = 1e-9 * max(abs(x.time))
    for part in (-0.9, -0.1, 0.0, 0.1, 0.9):
        asked = np.sort(rng.choice(x.time, 6, replace=False)) + part * same
        wanted = [min(range(9), key=lambda k, t=t: abs(x.time[k] - t)) for t in asked]
        found = x.at(asked)
        for name in ("time", *CHANNELS):
            assert np.array_equal(getattr(found, name), getattr(x, name)[wanted]), name
    for row in range(9):
        for part in (-1.5, 1.5):
            with pytest.raises(InvalidInput, match=r"was not recorded \(nearest: .*, 9 times from "):
                x.at(x.time[row] + part * same)


def test_every_so_many_rows_from_the_first_on():
    x = recording(7)
    for every in range(1, 9):
        assert np.array_equal(x.sampled(every=every).a, [row for k, row in enumerate(x.a) if k % every == 0])
    late = recording(7, time=100 + np.arange(7) / 4)
    assert np.array_equal(late.sampled(rate=2.0).time, [100, 100.5, 101, 101.5])
    assert np.array_equal(late.sampled(rate=4 / 3).v, late.v[::3])


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: recording(q=np.zeros((5, 3))), r"q has shape \(5, 3\), expected \(5, 2\)"),
        (lambda: recording(position=np.zeros((5, 2))), r"position has shape \(5, 2\), expected \(5, 2, 3\)"),
        (lambda: recording(time=[]), r"time has shape \(0,\), expected \(N,\) with at least one time"),
        (lambda: recording(time=[0, 1, 1, 2, 3]), r"time 1 s in row 2 does not increase; sort the rows by time"),
        (lambda: recording(time=[0, 1, np.nan, 2, 3]), r"time is nan in row 2; leave out the rows without numbers"),
        (lambda: recording(**with_value("v", np.inf)), r"v of 'O2' is inf in row 3; leave out"),
        (lambda: recording(**with_value("joint_forces", np.nan)), r"joint_forces of 'B2' is nan in row 3; leave out"),
        (lambda: recording(prismatic=[True]), r"prismatic has 1 entries for 2 joints; each joint carries one body"),
        (lambda: recording(body_names=["B", "B"]), r"the name 'B' occurs twice; name each joint and each body"),
        (lambda: recording().rounded(0), r"digits is 0; a whole number from 1 on is needed"),
        (lambda: recording().rounded(7.5), r"digits is 7.5; a whole number"),
        (lambda: recording().rounded(7, "up"), r"convention is 'up'; use 'half even' or 'truncated'"),
        (lambda: recording().noisy(0), r"relative or by absolute standard deviations; pass exactly one"),
        (lambda: recording().noisy(0, relative=0.1, absolute={}), r"pass exactly one"),
        (lambda: recording().noisy(0, relative=-0.1), r"the standard deviation of q is negative or not finite"),
        (lambda: recording().noisy(0, absolute={"force": 1}), r"no channel 'force'; known: q, v, a, tau, cardano, pos"),
        (lambda: recording().noisy(0, absolute={"q": [1, 2, 3]}), r"of q has shape \(3,\), expected \(\) or \(2,\)"),
        (lambda: recording().at([0.1, 0.25]), r"time 0.25 s was not recorded \(nearest: 0.\d s, 5 times from 0 to 0.4"),
        (lambda: recording().at(7.0), r"time 7 s was not recorded \(nearest: 0.4 s"),
        (lambda: recording().at(np.nan), r"time nan s was not recorded"),
        (lambda: recording().sampled(), r"give every \(a number of rows\) or rate \[Hz\], exactly one"),
        (lambda: recording().sampled(every=0), r"every is 0; a whole number from 1 on is needed"),
        (lambda: recording().sampled(rate=0.0), r"rate is 0.0 Hz; give one above zero"),
        (lambda: recording().sampled(rate=20.0), r"time 0.05 s was not recorded"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(InvalidInput, match=message):
        make()
