"""Steps of fixed width in Python, one run: what the compiled steps (graphdyn.kernels.stepping_code) must agree with."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from graphdyn.kernels.stepping import Stretch
from graphdyn.layout import Array
from graphdyn.simulation.equations import Contact, Equations
from graphdyn.simulation.methods import Tableau

Torque = Callable[[float, Array, Array], Array]


def python_steps(
    equations: Equations,
    tableau: Tableau,
    stretch: Stretch,
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
