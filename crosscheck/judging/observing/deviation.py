"""A function that deviates: what was seen of it, and the evidence in words."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from crosscheck.judging.observing.observation import Observation
from crosscheck.judging.observing.precision import precision_said
from crosscheck.judging.states.experiments import EXPERIMENT_PARTS, Parts, TrialStates
from graphdyn import RobotModel
from urdf.reading import Misreadings

MAX_NOISE_FACTOR = 10.0
"""A fault explains a deviation if it leaves at most this many times the noise of the function, at every state."""


@dataclass(frozen=True, eq=False)
class Deviation:
    """A function that deviates, and what was seen of it.

    observed: the experiments
    judged: the answers at all judged states, None where no torques follow from them
    readings: gives the misreadings of the robot's file, None where it has none
    noise: relative, of the function; tolerance: relative error that counts as agreement
    """

    function: str
    model: RobotModel
    trial: TrialStates
    observed: Parts
    judged: Observation | None
    readings: Callable[[], Misreadings | None]
    noise: float
    tolerance: float

    @property
    def bound(self) -> float:
        return max(self.tolerance, MAX_NOISE_FACTOR * self.noise)


def evidence_of(deviation: Deviation, before: Mapping[str, float], observed: Parts, own: Parts) -> str:
    said = [
        f"{EXPERIMENT_PARTS[part]}: {'agrees' if error <= deviation.bound else f'relative error {error:.1e}'}"
        for part, error in before.items()
    ]
    if "velocity" in before and before["velocity"] > deviation.bound:
        assert observed.doubled is not None
        assert own.doubled is not None
        assert observed.velocity is not None
        assert own.velocity is not None
        once = np.abs(observed.velocity - own.velocity).max()
        twice = np.abs(observed.doubled - own.doubled).max()
        said.append(f"at twice the velocity the error is {twice / once:.3g} times as large")
    if deviation.noise > deviation.tolerance / MAX_NOISE_FACTOR:
        said.append(precision_said(deviation.noise))
    return "; ".join(said)
