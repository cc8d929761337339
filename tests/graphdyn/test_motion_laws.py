"""Motion laws: derivatives against finite differences, closed forms, refusals."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from graphdyn import InvalidInput
from graphdyn.motion_laws import (
    ConstantAcceleration,
    FourierSeries,
    Locked,
    Polynomial,
    Rail,
    TabulatedMotion,
    Turntable,
)

STEP = 1e-4
DIFFERENCE = 1e-6
"""Central differences with STEP: truncation h² x'''/6 and rounding eps x / h, both below 1e-7 of the largest value."""

SPLINE = {"position": 1e-9, "velocity": 1e-7, "acceleration": 1e-5}
"""A quintic spline through a sine at steps of 0.05 rad: errors O(h⁶), O(h⁵), O(h⁴), measured 1e-10, 2e-8, 2e-6."""

numbers = st.floats(-5, 5)
KNOTS = np.linspace(-1.5, 1.5, 31)


@st.composite
def laws(draw, kind):
    values = draw(st.lists(numbers, min_size=1, max_size=5))
    if kind == "locked":
        return Locked(values[0])
    if kind == "constant":
        return ConstantAcceleration(*values[:3])
    if kind == "polynomial":
        return Polynomial(values)
    if kind == "fourier":
        return FourierSeries(draw(st.floats(0.05, 0.5)), values, values[::-1], draw(numbers))
    return TabulatedMotion(KNOTS, np.polynomial.Polynomial(values)(np.sin(KNOTS)))


@pytest.mark.parametrize("kind", ["locked", "constant", "polynomial", "fourier", "table"])
@given(st.data())
def test_velocity_and_acceleration_are_the_derivatives(kind, data):
    law, times = data.draw(laws(kind)), np.array(data.draw(st.lists(st.floats(-1, 1), min_size=1, max_size=8)))
    position, velocity, acceleration = law(times)
    before, after = law(times - STEP), law(times + STEP)
    largest = max(1.0, *(np.abs(part).max() for part in (*law(KNOTS), position)))
    for k, derivative in ((0, velocity), (1, acceleration)):
        assert position.shape == derivative.shape == times.shape
        assert np.abs((after[k] - before[k]) / (2 * STEP) - derivative).max() < 10 * DIFFERENCE * largest


def test_constant_acceleration():
    position, velocity, acceleration = ConstantAcceleration(2.0, velocity=3.0, position=5.0)(np.array([0.0, 2.0]))
    assert position.tolist() == [5.0, 15.0]
    assert velocity.tolist() == [3.0, 7.0]
    assert acceleration.tolist() == [2.0, 2.0]


def test_fourier_series_is_that_of_swevers():
    """a_l and b_l are the amplitudes of the velocity; the series is periodic and its mean is the offset."""
    law = FourierSeries(0.1, a=(0.3, -0.2), b=(0.5, 0.4), offset=0.7)
    times = np.linspace(0.0, 10.0, 201)[:-1]
    position, velocity, acceleration = law(times)
    assert position.mean() == pytest.approx(0.7, abs=1e-13)
    spectrum = np.fft.rfft(velocity) / 100
    assert spectrum[1:3].real == pytest.approx([0.3, -0.2], abs=1e-13)
    assert -spectrum[1:3].imag == pytest.approx([0.5, 0.4], abs=1e-13)
    rate = np.fft.rfft(acceleration) / 100  # iω times the spectrum of the velocity
    assert rate[1:3] == pytest.approx(2j * np.pi * 0.1 * np.array([1, 2]) * spectrum[1:3], abs=1e-13)
    assert law(times + 10.0)[0] == pytest.approx(position, abs=1e-13)


def test_table_meets_its_points_and_the_curve_between_them():
    times = np.linspace(0.0, 4.0, 81)
    law = TabulatedMotion(times, np.sin(times))
    assert law(times)[0] == pytest.approx(np.sin(times), abs=1e-14)
    between = np.linspace(0.0, 4.0, 333)
    position, velocity, acceleration = law(between)
    assert np.abs(position - np.sin(between)).max() < SPLINE["position"]
    assert np.abs(velocity - np.cos(between)).max() < SPLINE["velocity"]
    assert np.abs(acceleration + np.sin(between)).max() < SPLINE["acceleration"]


def test_table_keeps_its_own_numbers():
    times = np.arange(6.0)
    law = TabulatedMotion(times, times)
    times[:] = 0.0
    assert law.times.tolist() == [0, 1, 2, 3, 4, 5]


def test_a_time_at_the_end_of_the_table_may_be_rounded():
    law = TabulatedMotion(np.arange(7) * 0.1, np.zeros(7))
    assert law(np.array([0.1 * 6, 0.6, -1e-17]))[0].tolist() == [0, 0, 0]


@pytest.mark.parametrize("first", [-1.0, 0.0, 1e3])
def test_times_beside_a_table_are_refused_by_its_span(first):
    """A table of one second, whenever it was: a ten-billionth of a second beyond is no rounding."""
    law = TabulatedMotion(first + np.linspace(0.0, 1.0, 9), np.zeros(9))
    law(first + np.array([0.0, 1.0]))
    for outside in (first - 1e-10, first + 1 + 1e-10):
        with pytest.raises(InvalidInput, match="is outside the table"):
            law(np.array([outside]))


def test_equal_laws_are_equal_and_their_directions_have_length_one():
    assert Polynomial([1, 2]) == Polynomial(np.array([1.0, 2.0]))
    assert Rail((0, 3, 4), Locked()) == Rail((0.0, 0.6, 0.8), Locked(0))
    assert Turntable((0, 0, -1e-200), Locked()).axis == (0.0, 0.0, -1.0)


SIX = np.arange(6.0)


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Locked(np.nan), r"Locked: position contains NaN or infinity: nan"),
        (lambda: Locked("low"), r"Locked: position is not an array of real numbers"),
        (
            lambda: ConstantAcceleration([1.0, 2.0]),
            r"ConstantAcceleration: acceleration has shape \(2,\), expected \(\)",
        ),
        (lambda: Polynomial([]), r"Polynomial: coefficients has shape \(0,\), expected \(k,\)"),
        (lambda: Polynomial([1.0, np.inf]), r"Polynomial: coefficients contains NaN or infinity"),
        (lambda: FourierSeries(0.0, [1], [1]), r"FourierSeries: frequency is 0.0 Hz; give one above zero"),
        (lambda: FourierSeries(1.0, [1], [1, 2]), r"a has 1 harmonics and b 2; give as many, zeros included"),
        (lambda: TabulatedMotion(SIX, SIX[:5]), r"TabulatedMotion: 6 times and 5 positions; give one for each"),
        (lambda: TabulatedMotion(SIX[:5], SIX[:5]), r"TabulatedMotion: 5 rows; a quintic spline needs at least 6"),
        (
            lambda: TabulatedMotion([0, 1, 2, 2, 3, 4], SIX),
            r"TabulatedMotion: time 2 s in row 3 does not increase; sort the rows",
        ),
        (lambda: TabulatedMotion(SIX, [SIX]), r"TabulatedMotion: positions has shape \(1, 6\), expected \(K,\)"),
        (
            lambda: TabulatedMotion(SIX, SIX)(np.array([1.0, 5.5])),
            r"time 5.5 s is outside the table \(0 … 5 s\); nothing is extrap",
        ),
        (lambda: Rail((0, 0, 0), Locked()), r"Rail: direction is zero; give a direction in world axes"),
        (lambda: Turntable((1, 0), Locked()), r"Turntable: axis has shape \(2,\), expected \(3,\)"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(InvalidInput, match=message):
        make()
