"""Runge-Kutta steps of robots with loops: projected onto closed states after each step, and past singular poses.

A singular pose is passed in an instant, but accelerations are 0/0 there, and near it they have rounding errors of the
order ε/σ³ with the smallest singular value σ of J. Far from one, stages are evaluated as they are. Near one, stages
are closed first, since what they are open is divided by σ², and steps are divided so that none of their stages comes
closer to the singular pose than it must: the motion goes on as the smooth one that it was.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from graphdyn.errors import IntegrationFailed
from graphdyn.layout import Array
from graphdyn.simulation.equations import Contact, LoopEquations
from graphdyn.simulation.integration.steps import Tableau, Torque
from graphdyn.simulation.torques import SMALLER_STEPS_REMEDY

NEAR_POSE_SHARE = 0.1
"""Below this part of the distance of a regular pose, stages are closed, and choose where they are."""

GOOD_DISTANCE_SHARE = 0.01
"""A step whose stages keep this part of that distance is good enough to be taken."""

STEP_DIVISIONS = ((1.0,), (0.5, 0.5), (0.35, 0.65), (0.65, 0.35), (0.43, 0.57), (0.57, 0.43), (0.2, 0.8), (0.8, 0.2))
"""Divisions of a step near a singular pose; the one whose stages stay farthest from it is taken."""


@dataclass(frozen=True, eq=False)
class Stepped:
    """A step.

    y: the state q, v, work, loss at its end                (2n + 2,)
    distance: how near its stages came to a singular pose
    errors: what the method adds up of its rates with other weights, if there are   (k, 2n + 2)
    """

    y: Array
    distance: float
    errors: Array


class LoopSteps:
    """Steps of one method.

    closed_stages: whether every stage is closed, as functions that call verbs need it
    errors: further weights of the stages                   (k, s)
    """

    def __init__(
        self, equations: LoopEquations, tableau: Tableau, closed_stages: bool = False, errors: Array | None = None
    ) -> None:
        self.equations, self._tableau, self._closed_stages = equations, tableau, closed_stages
        self._errors = np.zeros((0, len(tableau.b))) if errors is None else errors

    def advanced(self, t: float, y: Array, h: float, torque: Torque) -> Stepped:
        """The closed state a time h later. Raises IntegrationFailed where the numbers do not stay finite."""
        try:
            step = self._stepped(t, y, h, torque, careful=False)
            return step if step.distance > self.wary else self._best_divided(t, y, h, torque)
        except np.linalg.LinAlgError as error:
            raise IntegrationFailed(f"at {t:g} s the numbers are no longer finite; {SMALLER_STEPS_REMEDY}") from error

    @property
    def wary(self) -> float:
        """The distance from a singular pose below which a step is taken with care."""
        return NEAR_POSE_SHARE * self.equations.usual_distance

    def _best_divided(self, t: float, y: Array, h: float, torque: Torque) -> Stepped:
        best: Stepped | None = None
        for parts in STEP_DIVISIONS:
            tried = self._divided(t, y, [h * part for part in parts], torque)
            if best is None or tried.distance > best.distance:
                best = tried
            if best.distance > GOOD_DISTANCE_SHARE * self.equations.usual_distance:
                break
        assert best is not None
        return best

    def row(self, t: float, y: Array, torque: Torque) -> dict[str, Array]:
        """What is recorded of a state."""
        n = (len(y) - 2) // 2
        q, v = y[:n], y[n : 2 * n]
        tau = torque(t, q, v)
        found = self.equations.rates(t, q, v, tau, self._contact(v))
        values = (q, v, y[2 * n : 2 * n + 1], y[2 * n + 1 :], tau, found.a, found.passive)
        return dict(zip(("q", "v", "work", "loss", "tau", "a", "passive"), values, strict=True))

    def _divided(self, t: float, y: Array, parts: list[float], torque: Torque) -> Stepped:
        nearest, errors = np.inf, np.zeros((len(self._errors), len(y)))
        for h in parts:
            step = self._stepped(t, y, h, torque, careful=True)
            t, y, nearest, errors = t + h, step.y, min(nearest, step.distance), errors + np.abs(step.errors)
        return Stepped(y, nearest, errors)

    def _stepped(self, t: float, y: Array, h: float, torque: Torque, careful: bool) -> Stepped:
        n, rates, nearest = (len(y) - 2) // 2, list[Array](), np.inf
        for c, weights in zip(self._tableau.c, self._tableau.a, strict=True):
            there = y + h * _weighted(weights, rates) if rates else y
            q, v = there[:n], there[n : 2 * n]
            if (careful or self._closed_stages) and rates:
                q, v = self.equations.closed(q, v)
            tau = torque(t + c * h, q, v)
            found = self.equations.rates(t + c * h, q, v, tau, self._contact(v))
            if rates or not careful:  # where a step begins is decided already
                nearest = min(nearest, self.equations.distance)
            rates.append(np.concatenate([v, found.a, [tau @ v, found.passive @ v]]))
        after = y + h * _weighted(self._tableau.b, rates)
        q, v = self.equations.closed(after[:n], after[n : 2 * n])
        errors = h * self._errors @ np.array(rates)
        return Stepped(np.concatenate([q, v, after[2 * n :]]), min(nearest, self.equations.distance), errors)

    def _contact(self, v: Array) -> Contact:
        return Contact(np.sign(v), np.ones(len(v), dtype=bool))


def _weighted(weights: Array, rates: list[Array]) -> Array:
    return np.asarray(weights[: len(rates)] @ np.array(rates))
