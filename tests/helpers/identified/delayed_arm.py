"""Simulated arms whose torques are recorded late, with friction and noise that the assumed torque model lacks."""

import functools
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

import graphdyn
from crosscheck.recordings import Provenance, Recording
from graphdyn.motion_laws import FourierSeries

MAX_DELAY = 0.04
"""[s] Delays are drawn between it and its negative."""

ENCODER_NOISE = 2e-5
"""[rad or m]"""

FRICTIONS = ("assumed", "stribeck", "load", "asymmetric", "curved", "ripple", "slip")
"""Kinds of friction: "assumed" is Coulomb and viscous, all others deviate from it."""


@dataclass(frozen=True)
class DelayedLog:
    """recording: as measured; delay: of its torques [s]; friction: its kind; motion: "waves" or "steps" """

    recording: Recording
    delay: float
    friction: str
    motion: str


def delayed_log(model, seed, friction=None):
    """A log of a random motion, friction, noise and delay."""
    rng = np.random.default_rng([seed, 1])
    friction = friction or FRICTIONS[int(rng.integers(len(FRICTIONS)))]
    motion = ("waves", "steps")[int(rng.integers(2))]
    seconds, rate = rng.uniform(10.0, 25.0), float(rng.choice([100.0, 125.0, 250.0, 500.0]))
    delay = rng.uniform(-MAX_DELAY, MAX_DELAY)
    laws = _laws(model, rng, motion, seconds)
    t = np.arange(0.0, seconds, 1 / rate)
    moved = graphdyn.simulate_recording(model, t, laws)
    acting = graphdyn.simulate_recording(model, t - delay, laws)
    size = np.sqrt(np.mean(acting.tau**2, axis=0)) + 1e-6
    tau = acting.tau + size * np.column_stack(
        [_friction(rng, friction, *row) for row in zip(acting.q.T, acting.v.T, (acting.tau / size).T, strict=True)]
    )
    noise = rng.uniform(0.01, 0.05) * np.sqrt(np.mean(tau**2, axis=0))
    decay = np.exp(-1 / (rate * 10 ** rng.uniform(-2.5, -0.8)))
    white = rng.normal(size=tau.shape)
    white[1:] *= np.sqrt(1 - decay**2)
    tau = tau + noise * lfilter([1.0], [1.0, -decay], white, axis=0)
    q = moved.q + ENCODER_NOISE * rng.normal(size=tau.shape)
    recording = Recording(model.joint_names, t, q, tau=tau, provenance=Provenance((f"log {seed}",)))
    return DelayedLog(recording, delay, friction, motion)


def _laws(model, rng, motion, seconds):
    lower, upper, speed, _ = _ranges(model)
    laws = []
    for low, high, fast in zip(lower, upper, speed, strict=True):
        if motion == "waves":
            a, b = rng.normal(size=(2, 5))
            dense = np.linspace(0.0, 10.0, 1000)
            q, v, _ = FourierSeries(0.1, a, b)(dense)
            scale = 0.9 * min((high - low) / np.ptp(q), fast / np.abs(v).max())
            laws.append(FourierSeries(0.1, scale * a, scale * b, (high + low) / 2 - scale * (q.max() + q.min()) / 2))
        else:
            laws.append(_Steps(rng, low, high, fast, seconds))
    return laws


class _Steps:
    """From one position to the next along quintics of Bezier's kind, with a rest now and then."""

    def __init__(self, rng, low, high, fast, seconds):
        knots, positions, t = [-1.0], [rng.uniform(low, high)], -1.0
        while t < seconds + 1.0:
            target = rng.uniform(low, high) if rng.uniform() < 0.85 else positions[-1]
            t += max(0.5, 1.875 * abs(target - positions[-1]) / (fast * rng.uniform(0.4, 1.0)))
            knots.append(t)
            positions.append(target)
        self.knots, self.positions = np.array(knots), np.array(positions)

    def __call__(self, times):
        k = np.clip(np.searchsorted(self.knots, times, side="right") - 1, 0, len(self.knots) - 2)
        span, step = np.diff(self.knots)[k], np.diff(self.positions)[k]
        x = (times - self.knots[k]) / span
        q = self.positions[k] + step * x**3 * (10 - 15 * x + 6 * x**2)
        v = step / span * 30 * x**2 * (1 - x) ** 2
        return q, v, step / span**2 * 60 * x * (1 - x) * (1 - 2 * x)


@functools.cache
def _ranges(model):
    """Lowest and highest positions, and speeds, of every joint; those of an arm where the file has none."""
    q, v, *_ = model.random_state(np.random.default_rng(0), 1000)
    lower, upper = np.maximum(q.min(axis=0), -2.5), np.minimum(q.max(axis=0), 2.5)
    return lower, upper, np.minimum(np.abs(v).max(axis=0), 2.0), None


def _friction(rng, kind, q, v, load):
    """Friction of one joint along its motion, relative to the size of its torque (N,). load: torque of the bodies"""
    coulomb, viscous = rng.uniform(0.05, 0.3, size=2)
    fast = np.abs(v).max() or 1.0
    sign, u = np.tanh(v / (fast * 10 ** rng.uniform(-3, -1.5))), v / fast
    match kind:
        case "assumed":
            return coulomb * sign + viscous * u
        case "stribeck":
            falling = np.exp(-((u / rng.uniform(0.02, 0.2)) ** 2))
            return coulomb * sign * (1 + rng.uniform(0.2, 0.6) * falling) + viscous * u
        case "load":
            return coulomb * sign * (1 + rng.uniform(0.2, 1.0) * np.abs(load)) + viscous * u
        case "asymmetric":
            return coulomb * sign + viscous * np.where(u > 0, u, rng.uniform(0.5, 0.9) * u) + 0.2 * coulomb * (u > 0)
        case "curved":
            return coulomb * sign + viscous * np.sign(u) * np.abs(u) ** rng.uniform(0.4, 0.7)
        case "ripple":
            waves = np.sin(rng.integers(2, 40) * q + rng.uniform(0, 6.3))
            return coulomb * sign * (1 + 0.3 * waves) + viscous * u
        case "slip":
            return coulomb * _slipping(q, 10 ** rng.uniform(-3.5, -2)) + viscous * u
    raise ValueError(kind)


def _slipping(q, deflection):
    """One Maxwell element (N,): a spring before a slider."""
    z, now = np.empty(len(q)), 0.0
    for k, step in enumerate(np.diff(q, prepend=q[:1]) / deflection):
        now = min(1.0, max(-1.0, now + step))
        z[k] = now
    return z
