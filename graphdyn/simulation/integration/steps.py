"""Explicit Runge-Kutta methods of fixed step: their coefficients.

"euler": explicit Euler. "rk4": Kutta's classical method of order 4. "rk8": the method of order 8, twelve stages, of
Dormand and Prince that DOP853 is made of (Hairer, Nørsett, Wanner, Solving Ordinary Differential Equations I, section
II.5); its coefficients are those of scipy.integrate.DOP853.

Steps of fixed width in Python, one run: what the compiled steps (graphdyn.compiler.stepping.code) must agree with.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np

from graphdyn.compiler.stepping.stepping import StepRange
from graphdyn.layout import Array
from graphdyn.simulation.equations import Contact, Equations

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


def python_steps(
    equations: Equations,
    tableau: Tableau,
    stretch: StepRange,
    state: dict[str, Array],
    torque: Torque,
    held: Callable[[int, Array, Array], Array] | None = None,
) -> dict[str, list[Array]]:
    """Advance the state (q, v, work, loss) in place; answers the recorded rows by name.

    torque: of t, q and v, asked at every stage
    held: instead, of the number of the tick, q and v: asked at every tick and held in between
    """
    rows: dict[str, list[Array]] = {name: [] for name in ("q", "v", "work", "loss", "tau", "a", "passive")}
    h, tau_held = stretch.h, np.zeros(len(state["q"]))
    for step in range(stretch.start, stretch.start + stretch.count):
        t, q, v = step * h, state["q"], state["v"]
        if held is not None and (step % stretch.hold == 0 or step == stretch.start):
            tau_held = equations.clamped(held(step // stretch.hold, q, v))

        def tau_at(time: float, position: Array, velocity: Array, tau: Array = tau_held) -> Array:
            return equations.clamped(torque(time, position, velocity)) if held is None else tau

        tau = tau_at(t, q, v)
        contact = equations.contact(t, q, v, tau)
        rates: list[Array] = []
        for c, weights in zip(tableau.c, tableau.a, strict=True):
            moved = [_weighted(weights, rates, k) for k in (0, 1)] if rates else [0.0, 0.0]
            at_q, at_v = q + h * moved[0], v + h * moved[1]
            there = tau if not rates else tau_at(t + c * h, at_q, at_v)
            found = equations.rates(t + c * h, at_q, at_v, there, contact)
            if not rates and step % stretch.every == 0:
                for name, value in {**state, "tau": there, "a": found.a, "passive": found.passive}.items():
                    rows[name].append(np.array(value))
            rates.append(np.array([at_v, found.a, there * at_v, found.passive * at_v]))
        change = h * _weighted(tableau.b, rates)
        state["q"], state["v"] = q + change[0], _at_rest(equations, v + change[1], contact)
        state["work"], state["loss"] = state["work"] + change[2].sum(), state["loss"] + change[3].sum()
    return rows


def _weighted(weights: Array, rates: list[Array], row: int | slice = slice(None)) -> Array:
    total = sum(weight * rate[row] for weight, rate in zip(weights, rates, strict=False))
    return np.asarray(total)


def _at_rest(equations: Equations, v: Array, contact: Contact) -> Array:
    """Zero for the velocity of a joint that has turned against its dry friction."""
    if not equations.plant.has_friction:
        return v
    turned = (v * contact.sign < 0) & (equations.plant.constants["coulomb"] > 0)
    return np.where(turned, 0.0, v)
