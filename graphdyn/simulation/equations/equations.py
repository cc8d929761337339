"""The equations of motion of one run, with friction that sticks: M a + h = τ + (torque of friction and stops).

Written with the verbs of the dynamics, one state at a time: the specification of the compiled steps.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from graphdyn.arguments.arrays import as_floats
from graphdyn.errors import InvalidInput
from graphdyn.experiments.experiment import carriage
from graphdyn.layout import BODY_FREEDOMS, Array
from graphdyn.simulation.plant import PlantConstants
from graphdyn.verbs.compiled import compile as compiled
from graphdyn.verbs.dynamics import joint_torques


class Contact(NamedTuple):
    """How the dry friction of every joint acts: sign of its sliding (n,), and which joints are free to move (n,)."""

    sign: Array
    free: NDArray[np.bool_]


class Rates(NamedTuple):
    """a (n,), and the torque of friction and stops on the joints (n,); held: what holds a joint at rest (n,)."""

    a: Array
    passive: Array
    held: Array


class Equations:
    """Accelerations and torques of a plant."""

    def __init__(self, plant: PlantConstants) -> None:
        self.plant, self._constants = plant, plant.constants
        self._verbs = compiled(plant.model, "mass_matrix", "bias_torque")
        self._rotor = np.diag(plant.rotor)

    def clamped(self, tau: Array) -> Array:
        """The torque that the actuators can give."""
        if not self.plant.is_clamped:
            return tau
        clipped: Array = np.clip(tau, self._constants["least_torque"], self._constants["largest_torque"])
        return clipped

    def rates(self, t: float, q: Array, v: Array, tau: Array, contact: Contact) -> Rates:
        """At the torque of the actuators. Joints that are not free keep their velocity of zero."""
        passive = self._passive(q, v, contact.sign)
        mass = self._verbs.mass_matrix(q) + self._rotor
        bias = self._bias(t, q, v)
        applied, free = tau + passive, contact.free
        a, held = np.zeros(len(q)), np.zeros(len(q))
        if free.all():
            a[:] = np.linalg.solve(mass, applied - bias)
            return Rates(a, passive, held)
        a[free] = np.linalg.solve(mass[np.ix_(free, free)], (applied - bias)[free])
        held[~free] = (mass @ a + bias - applied)[~free]
        return Rates(a, passive + held, held)

    def contact(self, t: float, q: Array, v: Array, tau: Array, passes: int = 1, loose: int | None = None) -> Contact:
        """Which joints slide. A joint at rest is held, and begins to slide where that takes more than F_c.

        passes: how often what slides is decided again, given what the other joints do
        loose: a joint that has just reached F_c, and slides whatever the rounding of its torque
        """
        sign = np.sign(v)
        if not self.plant.sticks:
            return Contact(sign, np.ones(len(q), dtype=bool))
        dry = self._constants["coulomb"]
        resting = (v == 0) & (dry > 0)
        free = ~resting
        decided = np.arange(len(q)) == loose
        for _ in range(passes if resting.any() else 0):
            rates = self.rates(t, q, v, tau, Contact(sign, free))
            slips = resting & ~free & ((np.abs(rates.held) > dry) | decided)
            driven_back = resting & free & (rates.a * sign < 0) & ~decided
            if not slips.any() and not driven_back.any():
                break
            sign = np.where(slips, -np.sign(rates.held), np.where(driven_back, 0.0, sign))
            free = (free | slips) & ~driven_back
        return Contact(sign, free)

    def _passive(self, q: Array, v: Array, sign: Array) -> Array:
        """Torque of friction and stops on the joints, but for what holds them at rest."""
        passive, x = np.zeros(len(q)), self._constants
        if self.plant.has_friction:
            passive -= x["viscous"] * v + x["coulomb"] * sign + x["offset"]
        if self.plant.has_stops:
            for limit, side in ((x["lower"], -1.0), (x["upper"], 1.0)):
                beyond = side * (q - limit) > 0
                push = np.zeros(len(q))
                push[beyond] = -(x["stiffness"] * (q - limit) + x["damping"] * v)[beyond]
                passive += np.where(side * push < 0, push, 0.0)
        return passive

    def _bias(self, t: float, q: Array, v: Array) -> Array:
        """The torque at a = 0: velocity, gravity, motion of the base, external wrenches."""
        plant = self.plant
        if not plant.base and not plant.is_loaded:
            return self._verbs.bias_torque(q, v).copy()
        wrenches = self.wrenches(t, q, v) if plant.is_loaded else None
        base = carriage(plant.base, np.array([t])).at((1,), (np.array(0),)) if plant.base else None
        return joint_torques(plant.model, q, v, np.zeros(len(q)), wrenches, base=base, method="recursive")

    def wrenches(self, t: float, q: Array, v: Array) -> Array:
        """The external wrenches (n, 6). Raises InvalidInput where a function answers anything else."""
        shape = (self.plant.model.n_bodies, BODY_FREEDOMS)
        if self.plant.wrenches is None:
            return self._constants["external_wrenches"].reshape(shape)
        return answer("external_wrenches", self.plant.wrenches(t, q.copy(), v.copy()), shape, t)


def answer(name: str, value: object, shape: tuple[int, ...], t: float) -> Array:
    """What a function of the caller answers at a time. Raises InvalidInput for another shape, NaN and infinity."""
    array = as_floats(f"what the function {name} answers", value)  # type: ignore[arg-type]
    if array.shape != shape or not np.all(np.isfinite(array)):
        what = f"shape {array.shape}" if array.shape != shape else "NaN or infinity"
        raise InvalidInput(f"the function {name} answers {what} at {t:g} s; finite numbers of shape {shape} are needed")
    return array
