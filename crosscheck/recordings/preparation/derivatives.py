"""Velocities and accelerations from noisy positions, block by block, and the resulting noise.

The cutoff comes from the data by residual analysis: section 3.4.4.3 of Winter, Biomechanics and Motor Control (2009).
R(f) is the root mean square of the part that a filter with the cutoff f removes. At high f it is noise only. Winter
extends that part of the curve as a straight line to f = 0, where it gives the size of all the noise, and takes the
cutoff at which R(f) has this size: the signal removed there is as large as the noise let through. For white noise the
response of the filter determines the square of R(f), so this curve is fitted instead of a line.

The cutoff balances the errors of the filtered quantity itself, so for identification it is an upper bound:
derivatives amplify noise by the frequency. Above the commanded motion lie vibrations of the arm, which the encoder
measures but which are not rigid-body motion. Blocked cross-validation shows whether a lower cutoff predicts better.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import comb
from typing import Literal
from weakref import WeakKeyDictionary

import numpy as np

from crosscheck.recordings.preparation.filtering import (
    FILTER_ORDER,
    REMEMBERED_FILTERS,
    TorqueFilter,
    border,
    butterworth,
    check_cutoff,
    lowpass,
    padding,
)
from crosscheck.recordings.preparation.resampling import is_even, resampled, sampling_rate
from crosscheck.recordings.recording import RECORDED_JOINT_CHANNELS, Recording
from graphdyn import InvalidInput
from graphdyn.errors import counted
from graphdyn.identification import RowFilter
from graphdyn.layout import Array

N_TRIAL_CUTOFFS = 60
"""Number of trial cutoffs, evenly spaced in the logarithm."""

RESPONSE_FREQUENCIES = 1024
"""Number of frequencies over which the response of a filter is averaged."""

MIN_CUTOFF, NOISE_FROM, MAX_CUTOFF = 0.002, 0.5, 0.9
"""Fractions of the Nyquist frequency: trial cutoffs range from MIN_CUTOFF to MAX_CUTOFF, above which hardly any noise
is removed; from NOISE_FROM on, only noise is expected."""

NOISE_DIFFERENCE_ORDER = 6
"""Order of the differences that show white noise alone: a motion a tenth as fast as the sampling leaves 6 % in them."""


@dataclass(frozen=True, eq=False)
class ResidualAnalysis:
    """Residual analysis of one column.

    cutoff: the chosen one [Hz]; noise: standard deviation of the noise, the value at f = 0 of the fitted curve
    frequencies, residuals: the curve R(f)   (K,) [Hz], units of the column
    """

    cutoff: float
    noise: float
    frequencies: Array
    residuals: Array


def residual_analysis(values: Array, rate: float, order: int = 4) -> ResidualAnalysis:
    """Choose the cutoff [Hz] for a column (N,) sampled evenly at the rate [Hz].

    A constant column gets the lowest trial; one whose noise floor is hidden by signal at all trials gets the highest.
    Raises InvalidInput if the column is too short for a trial.
    """
    values = np.asarray(values, dtype=float)
    nyquist = rate / 2
    shortest = max(MIN_CUTOFF * nyquist, rate * 4 / max(len(values), 1))  # a border of the recording must fit into it
    if shortest > NOISE_FROM * nyquist / 2:
        raise InvalidInput(
            f"{counted(len(values), 'row is', 'rows are')} too few to choose a cutoff from; give the cutoff"
        )
    frequencies = np.geomspace(shortest, MAX_CUTOFF * nyquist, N_TRIAL_CUTOFFS)
    cut = min(border(rate, float(frequencies[0]), order), len(values) // 4)
    squares = np.array(
        [np.mean((values - lowpass(values, rate, float(f), order))[cut : len(values) - cut] ** 2) for f in frequencies]
    )
    tail = frequencies >= NOISE_FROM * nyquist
    part = np.array([_removed(float(f), rate, order) for f in frequencies[tail]])
    noise = float(part @ squares[tail] / (part @ part))
    below = np.flatnonzero(squares <= noise)
    cutoff = float(frequencies[below[0]] if below.size else frequencies[-1])
    return ResidualAnalysis(cutoff, float(np.sqrt(noise)), frequencies, np.sqrt(squares))


@lru_cache(maxsize=REMEMBERED_FILTERS)
def _removed(cutoff: float, rate: float, order: int) -> float:
    """The part of the power of white noise that the filter, run forward and backward, removes."""
    from scipy.signal import sosfreqz

    _, response = sosfreqz(butterworth(order, cutoff, rate), RESPONSE_FREQUENCIES, fs=rate)
    return float(np.mean((1 - np.abs(response) ** 2) ** 2))


def white_noise(values: Array) -> Array:
    """Standard deviation of the white noise of columns (N, n) sampled evenly (n,): that of their sixth differences.

    A difference of order k of white noise has the variance binom(2 k, k) times that of the noise.
    """
    if len(values) <= NOISE_DIFFERENCE_ORDER:
        return np.zeros(values.shape[1:])
    squares = np.mean(np.diff(values, NOISE_DIFFERENCE_ORDER, axis=0) ** 2, axis=0)
    return np.asarray(np.sqrt(squares / comb(2 * NOISE_DIFFERENCE_ORDER, NOISE_DIFFERENCE_ORDER)))


STENCIL_ROWS = 5
"""Number of rows in the central difference of fourth order, (1, -8, 0, 8, -1) / 12 h."""

Cutoff = float | Mapping[str, float] | Literal["residual"] | None


def derivative(values: Array, rate: float) -> Array:
    """Time derivative of rows (N, …) at the rate [Hz], N ≥ 5, without phase shift: central difference of fourth order.

    That is the slope of the quartic through five rows; at the first and last two rows the formula is one-sided.
    """
    from scipy.signal import savgol_filter

    return np.asarray(savgol_filter(values, STENCIL_ROWS, STENCIL_ROWS - 1, deriv=1, delta=1 / rate, axis=0))


_chosen: WeakKeyDictionary[Recording, float] = WeakKeyDictionary()
"""Cutoffs that were chosen, as long as their recordings exist: data quality and fit ask for the same one."""


def chosen_cutoff(recording: Recording) -> float:
    """The largest cutoff [Hz] that residual analysis chooses for a joint's position, in the longest block."""
    if recording not in _chosen:
        _chosen[recording] = _analyzed(recording)
    return _chosen[recording]


def _analyzed(recording: Recording) -> float:
    rows = max(recording.block_slices, key=lambda rows: rows.stop - rows.start)
    rate = sampling_rate(recording)
    moving = [q for q in recording.q[rows].T if np.ptp(q) > 0]
    if not moving:
        raise InvalidInput("no joint moves, so no cutoff can be chosen; give the cutoff")
    return max(residual_analysis(q, rate).cutoff for q in moving)


@dataclass(frozen=True)
class Differentiation:
    """The operation of `differentiated` on q and v of a block, for use on other motions.

    cutoffs: of the low-passes of q and v, if there are any [Hz]; velocity: whether v is measured, not derived
    """

    cutoffs: Mapping[str, float]
    velocity: bool

    @classmethod
    def of(cls, recording: Recording, cutoff: Cutoff, velocity: Literal["recorded", "derived"]) -> Differentiation:
        measured = recording.v is not None and velocity == "recorded"
        names = ["q", "v"] if measured else ["q"]
        given = {name: x for name, x in cutoff.items() if name in names} if isinstance(cutoff, Mapping) else cutoff
        return cls(_cutoffs(recording, given, names), measured)

    def __call__(self, q: Array, v: Array, rate: float) -> tuple[Array, Array, Array]:
        """q, v (N, n) of a motion → q, v, a as of a recording."""
        motion = {"q": q, "v": v} if self.velocity else {"q": q}
        motion |= {name: lowpass(motion[name], rate, cutoff) for name, cutoff in self.cutoffs.items()}
        derived = motion["v"] if self.velocity else derivative(motion["q"], rate)
        return motion["q"], derived, derivative(derived, rate)


def differentiated(
    recording: Recording, cutoff: Cutoff, *, velocity: Literal["recorded", "derived"] = "recorded"
) -> Recording:
    """The recording with v and a: filtered without phase shift, differentiated, the borders of its blocks cut off.

    cutoff: [Hz] of all channels, or per channel ({"q": 100.0}; the others stay as they are), or "residual": chosen from
        the positions by residual analysis, or None: no filter
    velocity: "recorded" takes v if the recording has it; "derived" differentiates q in any case

    v is the derivative of the filtered q unless recorded, a that of v unless recorded. tau stays as it is, because a
    torque that is filtered alone no longer fits its regressor. `torque_cutoff` keeps its cutoff, and the identification
    filters tau and every column of the regressor alike (crosscheck.samples_of). A recording with uneven steps is
    resampled first. Blocks shorter than their borders are left out. The provenance lists these steps.

    Raises InvalidInput for other channels, cutoffs from half the sampling rate on, and if no block is left.
    """
    if velocity not in ("recorded", "derived"):
        raise InvalidInput(f"velocity is '{velocity}'; use 'recorded' or 'derived'")
    if not is_even(recording):
        recording = resampled(recording)
    rate = sampling_rate(recording)
    recorded = recording.recorded(RECORDED_JOINT_CHANNELS)
    if velocity == "derived":
        recorded = [name for name in recorded if name not in ("v", "a")]
    cutoffs = _cutoffs(recording, cutoff, recorded)
    for frequency in cutoffs.values():
        check_cutoff(rate, frequency)
    now = {name: frequency for name, frequency in cutoffs.items() if name != "tau"}
    cut = max([border(rate, frequency) for frequency in now.values()], default=0) + STENCIL_ROWS - 1
    needed = max(2 * cut + 1, padding() + 1)
    noisy = [] if "a" in recorded else [name for name in ("q", "v") if name in recorded]
    parts: dict[str, list[np.ndarray]] = {name: [] for name in ("rows", *RECORDED_JOINT_CHANNELS, "q_noise", "v_noise")}
    short = []
    for rows in recording.block_slices:
        if rows.stop - rows.start < needed:
            short.append(int(recording.block[rows.start]))
            continue
        block = {name: recording.channel(name)[rows] for name in recorded}
        noise = {f"{name}_noise": white_noise(block[name]) for name in noisy}
        block |= {name: lowpass(block[name], rate, frequency) for name, frequency in now.items()}
        block.setdefault("v", derivative(block["q"], rate))
        block.setdefault("a", derivative(block["v"], rate))
        for name, values in block.items():
            parts[name].append(values[cut:-cut])
        for name, deviations in noise.items():
            parts[name].append(np.broadcast_to(deviations, block["q"][cut:-cut].shape))
        parts["rows"].append(np.arange(rows.start + cut, rows.stop - cut))
    if not parts["rows"]:
        longest = max(rows.stop - rows.start for rows in recording.block_slices)
        raise InvalidInput(
            f"the longest block has {counted(longest, 'row')}, {needed} are needed with borders of {cut} rows; "
            "choose a higher cutoff, or record longer"
        )
    words = {"tau": "tau and every column of the regressor"}
    filtered = ", ".join(f"{words.get(name, name)} {frequency:.4g} Hz" for name, frequency in cutoffs.items())
    steps = [f"zero-phase Butterworth low-pass of order {FILTER_ORDER}: {filtered}"] if cutoffs else ["no filter"]
    steps.append(", ".join(name for name in ("v", "a") if name not in recorded) + " by central differences")
    steps.append(f"{cut} rows cut at both ends of each block")
    if cutoff == "residual":
        steps.append("cutoff by residual analysis (Winter)")
    if short:
        steps.append(f"without the blocks {', '.join(map(str, short))} of fewer than {needed} rows")
    changed = {name: np.concatenate(part) for name, part in parts.items() if part and name != "rows"}
    if "tau" in cutoffs:
        changed["torque_cutoff"] = np.full(len(changed["q"]), cutoffs["tau"])
    return recording.take(np.concatenate(parts["rows"]), "; ".join(steps), **changed)


def _cutoffs(recording: Recording, cutoff: Cutoff, recorded: list[str]) -> dict[str, float]:
    """Cutoff [Hz] of every channel that is to be filtered."""
    if cutoff is None:
        return {}
    if isinstance(cutoff, Mapping):
        unknown = [name for name in cutoff if name not in recorded]
        if unknown:
            raise InvalidInput(f"cutoff of {unknown[0]!r}, which is not recorded; there are {', '.join(recorded)}")
        return dict(cutoff)
    if isinstance(cutoff, str):
        if cutoff != "residual":
            raise InvalidInput(f"cutoff is '{cutoff}'; give it in Hz, per channel, or 'residual'")
        cutoff = chosen_cutoff(recording)
    return dict.fromkeys(recorded, cutoff)


def motion_covariance(
    differentiation: Differentiation, row_filter: RowFilter | None, rate: float, q_noise: Array, v_noise: Array | None
) -> Array:
    """Covariance of the errors of q, v and a of each joint in a row of the equations (n, 3, 3).

    rate: of the samples [Hz]; q_noise: standard deviations of the measured positions (n,), v_noise: of measured
    velocities, if v is measured

    White noise through a filter has the covariance Σ_t h_t h_tᵀ, h the impulse responses of q, v and a. If the
    rows are decimated, every factor-th term of the sum is known; they represent all, because h is slower than the rows.
    """
    factor, memory = (1, 0) if row_filter is None else (row_filter.factor, row_filter.memory)
    lows = (TorqueFilter(cutoff, rate).memory for cutoff in differentiation.cutoffs.values())
    middle = memory + max(lows, default=0) + 2 * STENCIL_ROWS + padding()
    impulse, nothing = np.zeros((2, 2 * middle + 1, 1))
    impulse[middle] = 1.0

    def spread(q: Array, v: Array) -> Array:
        seen = differentiation(q, v, rate)
        answers = np.hstack(seen if row_filter is None else [row_filter(column) for column in seen])
        return np.asarray(factor * answers.T @ answers)

    covariance = q_noise[:, None, None] ** 2 * spread(impulse, nothing)
    if v_noise is not None:
        covariance = covariance + v_noise[:, None, None] ** 2 * spread(nothing, impulse)
    return np.asarray(covariance)
