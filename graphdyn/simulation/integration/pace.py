"""How adaptive steps advance: a torque that jumps with the state, again and again, holds them up without end."""

from __future__ import annotations

from collections import deque

import numpy as np

from graphdyn.errors import IntegrationFailed
from graphdyn.layout import Array

WINDOW = 200
"""Steps that are looked back at."""

MAX_JUMPS = 50
"""More of them that end at another acceleration: steps that never recover from one jump before the next."""

JUMP_SHARE = 0.01
"""An acceleration jumps by this part of it at least."""

JUMP_TOLERANCES = 100.0
"""A step over a jump is accepted where the jump changes the velocity by few tolerances: smooth steps change it more."""

MAX_STEPS_AHEAD = 2000
"""So many more steps of their median width for what remains are too many."""


class Pace:
    """Looks at the steps of one integration."""

    def __init__(self, duration: float, rtol: float, atol: float) -> None:
        self._duration, self._rtol, self._atol = duration, rtol, atol
        self._widths, self._jumps = deque[float](maxlen=WINDOW), deque[bool](maxlen=WINDOW)
        self._t, self._v, self._a = 0.0, np.zeros(0), np.zeros(0)

    def restart(self, v: Array) -> None:
        """The acceleration may be another from here on, for a reason."""
        self._v, self._a = v, np.full(len(v), np.nan)

    def step(self, t: float, v: Array) -> None:
        """A step has come so far. Raises IntegrationFailed where steps jump without end."""
        width = t - self._t
        if width <= 0:
            return
        a = (v - self._v) / width
        jump = np.abs(a - self._a)
        sudden = jump * width <= JUMP_TOLERANCES * (self._atol + self._rtol * np.abs(v))
        large = jump > JUMP_SHARE * np.maximum(np.abs(a), np.abs(self._a))
        self._widths.append(width)
        self._jumps.append(bool(np.any(sudden & large)))
        self._t, self._v, self._a = t, v, a
        if len(self._widths) < WINDOW or sum(self._jumps) <= MAX_JUMPS:
            return
        usual = float(np.median(self._widths))
        if self._duration - t > MAX_STEPS_AHEAD * usual:
            raise IntegrationFailed(
                f"at {t:g} s the acceleration jumps again and again, and steps have shrunk to {usual:.2g} s: a torque "
                "or force jumps with the state, as sign(v) does; make it continuous, give a controller with a period, "
                "or fixed steps"
            )
