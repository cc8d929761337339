"""Explicit Runge-Kutta methods of fixed step: their coefficients, and their steps in Python, one run.

"euler": explicit Euler. "rk4": Kutta's classical method of order 4. "rk8": the method of order 8, twelve stages, of
Dormand and Prince that DOP853 is made of (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, section
II.5); its coefficients are those of scipy.integrate.DOP853. The compiled steps (graphdyn.compiler.stepping.code) must
agree with these.

Steps of robots with loops are projected onto closed states after each step, and go past singular poses. A singular
pose is passed in an instant, but accelerations are 0/0 there, and near it they have rounding errors of the order ε/σ³
with the smallest singular value σ of J. Far from one, stages are evaluated as they are. Near one, stages are closed
first, since what they are open is divided by σ², and steps are divided so that none of their stages comes closer to the
singular pose than it must: the motion goes on as the smooth one that it was.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache, partial

import numpy as np

from graphdyn.compiler.stepping.stepping import StepRange
from graphdyn.errors import IntegrationFailed
from graphdyn.layout import Array
from graphdyn.simulation.equations import Contact, Equations, LoopEquations, Rates
from graphdyn.simulation.integration.events import COURSE_COLUMNS
from graphdyn.simulation.torques import SMALLER_STEPS_REMEDY

FIXED_STEPS = ("rk8", "rk4", "euler")


@dataclass(frozen=True, eq=False)
class Tableau:
    """a (s, s), b (s,) and c (s,) of Butcher's table."""

    a: Array
    b: Array
    c: Array


@cache
def tableau(name: str) -> Tableau:
    """One of FIXED_STEPS."""
    if name == "euler":
        return Tableau(np.zeros((1, 1)), np.ones(1), np.zeros(1))
    if name == "rk4":
        a = np.zeros((4, 4))
        a[1, 0], a[2, 1], a[3, 2] = 0.5, 0.5, 1.0
        return Tableau(a, np.array([1.0, 2.0, 2.0, 1.0]) / 6, np.array([0.0, 0.5, 0.5, 1.0]))
    from scipy.integrate import DOP853

    s = DOP853.n_stages
    return Tableau(DOP853.A[:s, :s], DOP853.B, DOP853.C[:s])


Torque = Callable[[float, Array, Array], Array]


def joints_of(y: Array) -> tuple[Array, Array]:
    """q and v of a state q, v, work, loss (2n + 2,)."""
    n = (len(y) - 2) // 2
    return y[:n], y[n : 2 * n]


def derivative(v: Array, tau: Array, rates: Rates) -> Array:
    """The derivative of q, v, work and loss (2n + 2,)."""
    return np.concatenate([v, rates.a, [tau @ v, rates.passive @ v]])


def recorded(y: Array, tau: Array, rates: Rates) -> dict[str, Array]:
    """A row of COURSE_COLUMNS."""
    work, loss = y[-2:-1], y[-1:]
    return dict(zip(COURSE_COLUMNS, (*joints_of(y), work, loss, tau, rates.a, rates.passive), strict=True))


Take = Callable[[float, Array, float, Torque], tuple[Array, dict[str, Array]]]
"""A function of t, y, h and the torque at every stage: the state a time h later, and the row of that before."""


def python_steps(
    take: Take,
    clamped: Callable[[Array], Array],
    stretch: StepRange,
    y: Array,
    torque: Torque,
    held: Callable[[int, Array, Array], Array] | None = None,
) -> tuple[Array, dict[str, Array]]:
    """The state after a stretch of steps, from q, v, work, loss (2n + 2,) before it, and the recorded columns by name.

    clamped: a torque within its limits
    torque: of t, q and v, asked at every stage
    held: instead, of the number of the tick, q and v: asked at every tick and held in between
    """
    rows, tau = list[dict[str, Array]](), np.zeros(len(y) // 2 - 1)

    def applied(t: float, q: Array, v: Array) -> Array:
        return tau if held else clamped(torque(t, q, v))

    for step in range(stretch.start, stretch.start + stretch.count):
        if held and (step % stretch.hold == 0 or step == stretch.start):
            tau = clamped(held(step // stretch.hold, *joints_of(y)))
        y, row = take(step * stretch.h, y, stretch.h, applied)
        if step % stretch.every == 0:
            rows.append(row)
    columns = {name: np.array([row[name] for row in rows]).reshape(stretch.records, -1) for name in COURSE_COLUMNS}
    return y, columns


def tree_step(
    equations: Equations, tableau: Tableau, t: float, y: Array, h: float, torque: Torque
) -> tuple[Array, dict[str, Array]]:
    """The state a time h later, and the row of that before; which joints slide is decided at the beginning.

    torque: within its limits, asked at every stage
    """
    q, v = joints_of(y)
    tau = torque(t, q, v)
    contact = equations.contact(t, q, v, tau)
    found = equations.rates(t, q, v, tau, contact)
    row, rates = recorded(y, tau, found), [derivative(v, tau, found)]
    for c, weights in zip(tableau.c[1:], tableau.a[1:], strict=True):
        q, v = joints_of(y + h * _weighted(weights, rates))
        tau = torque(t + c * h, q, v)
        rates.append(derivative(v, tau, equations.rates(t + c * h, q, v, tau, contact)))
    y = y + h * _weighted(tableau.b, rates)
    y[len(v) : -2] = _at_rest(equations, y[len(v) : -2], contact)
    return y, row


def _weighted(weights: Array, rates: list[Array]) -> Array:
    """The sum of the rates so far, times their weights; zero at the first stage."""
    return np.asarray(weights[: len(rates)] @ np.array(rates))


def _at_rest(equations: Equations, v: Array, contact: Contact) -> Array:
    """Zero for the velocity of a joint that has turned against its dry friction."""
    if not equations.plant.has_friction:
        return v
    turned = (v * contact.sign < 0) & (equations.plant.constants["coulomb"] > 0)
    return np.where(turned, 0.0, v)


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


def near_pose(equations: LoopEquations) -> float:
    """The distance from a singular pose below which a step is taken with care."""
    return NEAR_POSE_SHARE * equations.usual_distance


@dataclass(frozen=True, eq=False)
class Held:
    """A torque that stays the same for a while, as a Torque."""

    tau: Array

    def __call__(self, t: float, q: Array, v: Array) -> Array:
        return self.tau


Compiled = Callable[[float, Array, float, Array], tuple[Stepped, dict[str, Array]] | None]
"""A function of t, y, h and a held torque: the step and the row before, or None where only Python takes the step."""


class LoopSteps:
    """Steps of one method.

    closed_stages: whether every stage is closed, as functions that call verbs need it
    errors: further weights of the stages                   (k, s)
    compiled: takes steps of torques that are held, where it can
    """

    compiled: Compiled | None = None

    def __init__(
        self, equations: LoopEquations, tableau: Tableau, closed_stages: bool = False, errors: Array | None = None
    ) -> None:
        self.equations, self._tableau, self._closed_stages = equations, tableau, closed_stages
        self._errors = np.zeros((0, len(tableau.b))) if errors is None else errors

    def advanced(self, t: float, y: Array, h: float, torque: Torque) -> Stepped:
        """The closed state a time h later. Raises IntegrationFailed where the numbers do not stay finite."""
        found = self.compiled(t, y, h, torque.tau) if self.compiled and isinstance(torque, Held) else None
        if found is not None:
            return found[0]
        try:
            step = self._stepped(t, y, h, torque, careful=False)
            if step.distance > self.wary:
                return step
            with self.equations.plain():
                return self._best_divided(t, y, h, torque)
        except np.linalg.LinAlgError as error:
            raise IntegrationFailed(f"at {t:g} s the numbers are no longer finite; {SMALLER_STEPS_REMEDY}") from error

    @property
    def wary(self) -> float:
        """The distance from a singular pose below which a step is taken with care."""
        return near_pose(self.equations)

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

    def taken(self, t: float, y: Array, h: float, torque: Torque) -> tuple[Array, dict[str, Array]]:
        """The closed state a time h later, and the row of that before. Raises as advanced does."""
        row = self.row(t, y, torque)
        return self.advanced(t, y, h, torque).y, row

    def taken_or_nan(self, t: float, y: Array, h: float, torque: Torque) -> tuple[Array, dict[str, Array]]:
        """The same, with NaN for what does not stay finite, and for the state after a step that does not close."""
        nothing = np.full(len(y), np.nan)
        if np.isnan(y).any():
            _, v = joints_of(nothing)
            return nothing, recorded(nothing, v, Rates(v, v, v))
        row = self.row(t, y, torque)
        try:
            return self.advanced(t, y, h, torque).y, row
        except IntegrationFailed:
            return nothing, row

    def row(self, t: float, y: Array, torque: Torque) -> dict[str, Array]:
        """What is recorded of a state."""
        found = self.compiled(t, y, 0.0, torque.tau) if self.compiled and isinstance(torque, Held) else None
        if found is not None:
            return found[1]
        q, v = joints_of(y)
        tau = torque(t, q, v)
        rates = self.equations.rates(t, q, v, tau, self._contact(v))
        if self.equations.distance <= self.wary:
            with self.equations.plain():
                rates = self.equations.rates(t, q, v, tau, self._contact(v))
        return recorded(y, tau, rates)

    def _divided(self, t: float, y: Array, parts: list[float], torque: Torque) -> Stepped:
        nearest, errors = np.inf, np.zeros((len(self._errors), len(y)))
        for h in parts:
            step = self._stepped(t, y, h, torque, careful=True)
            t, y, nearest, errors = t + h, step.y, min(nearest, step.distance), errors + np.abs(step.errors)
        return Stepped(y, nearest, errors)

    def _stepped(self, t: float, y: Array, h: float, torque: Torque, careful: bool) -> Stepped:
        rates, nearest = list[Array](), np.inf
        for c, weights in zip(self._tableau.c, self._tableau.a, strict=True):
            q, v = joints_of(y + h * _weighted(weights, rates))
            if (careful or self._closed_stages) and rates:
                q, v = self.equations.closed(q, v)
            tau = torque(t + c * h, q, v)
            found = self.equations.rates(t + c * h, q, v, tau, self._contact(v))
            if rates or not careful:  # where a step begins is decided already
                nearest = min(nearest, self.equations.distance)
            rates.append(derivative(v, tau, found))
        after = y + h * _weighted(self._tableau.b, rates)
        q, v = self.equations.closed(*joints_of(after))
        errors = h * self._errors @ np.array(rates)
        return Stepped(np.concatenate([q, v, after[-2:]]), min(nearest, self.equations.distance), errors)

    def _contact(self, v: Array) -> Contact:
        return Contact(np.sign(v), np.ones(len(v), dtype=bool))


def steps_of(equations: Equations, tableau: Tableau, closed_stages: bool = False) -> Take:
    """The steps of a tree, or of a robot with loops (LoopSteps)."""
    if isinstance(equations, LoopEquations):
        return LoopSteps(equations, tableau, closed_stages).taken
    return partial(tree_step, equations, tableau)
