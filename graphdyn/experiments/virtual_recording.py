"""Recordings: what a measurement, or a virtual experiment, knows about a robot at given times.

These are the six kinds of numbers that section 3.1 of the paper takes per body from its simulation, and those of the
joints. All vectors are in world axes, the paper's e^(0).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from decimal import ROUND_DOWN, ROUND_HALF_EVEN, Context, Decimal
from numbers import Integral
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arguments.arrays import as_floats
from graphdyn.display import Displayed
from graphdyn.errors import InvalidInput
from graphdyn.layout import Array
from graphdyn.model.spatial import cardano_matrix
from graphdyn.tables import data_frame, joint_columns

if TYPE_CHECKING:
    import pandas

JOINT_CHANNELS = ("q", "v", "a", "tau")
BODY_CHANNELS = (
    "cardano",
    "position",
    "acceleration",
    "angular_velocity",
    "angular_acceleration",
    "joint_forces",
    "joint_moments",
)
CHANNELS = (*JOINT_CHANNELS, *BODY_CHANNELS)

TIME_TOLERANCE = 1e-9
"""Two times are the same if they differ by less than this, relative to the largest: sums of steps round."""

Convention = Literal["half even", "truncated"]


@dataclass(frozen=True, eq=False, repr=False)
class VirtualRecording(Displayed):
    """Numbers at N times of a robot of n bodies on n joints; joint j is the inside joint of body j.

    robot, joint_names, body_names: names                   (n,)
    prismatic: which joints slide                           (n,)
    time: increasing                                        (N,)       [s]
    q, v, a, tau: joints; tau of the actuators              (N, n)     [rad or m, …/s, …/s², N m or N]
    cardano: θ = (α, β, γ) of each body                     (N, n, 3)  [rad]
    position, acceleration: r, r̈ of the centers of mass     (N, n, 3)  [m, m/s²]
    angular_velocity, angular_acceleration: ω, ω̇            (N, n, 3)  [rad/s, rad/s²]
    joint_forces: of the inside body on body j              (N, n, 3)  [N]
    joint_moments: the same about O_j, actuator included    (N, n, 3)  [N m]

    Cardano angles jump at ±π, and in gimbal lock α is arbitrary; `rotation` does neither.
    Raises InvalidInput, naming the channel, for wrong shapes, NaN, infinity, times that do not increase, equal names.
    """

    robot: str
    joint_names: tuple[str, ...]
    body_names: tuple[str, ...]
    prismatic: tuple[bool, ...]
    time: Array
    q: Array
    v: Array
    a: Array
    tau: Array
    cardano: Array
    position: Array
    acceleration: Array
    angular_velocity: Array
    angular_acceleration: Array
    joint_forces: Array
    joint_moments: Array

    def __post_init__(self) -> None:
        for name in ("joint_names", "body_names", "prismatic"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
        n = len(self.joint_names)
        for name in ("body_names", "prismatic"):
            if len(getattr(self, name)) != n:
                raise InvalidInput(
                    f"{name} has {len(getattr(self, name))} entries for {n} joints; each joint carries one body"
                )
        for names in (self.joint_names, self.body_names):
            repeated = [name for name in names if names.count(name) > 1]
            if repeated:
                raise InvalidInput(f"the name '{repeated[0]}' occurs twice; name each joint and each body differently")
        object.__setattr__(self, "time", self._checked("time", as_floats("time", self.time), None))
        for name in JOINT_CHANNELS:
            object.__setattr__(self, name, self._checked(name, getattr(self, name), (n,)))
        for name in BODY_CHANNELS:
            object.__setattr__(self, name, self._checked(name, getattr(self, name), (n, 3)))

    def summary(self) -> str:
        """Whose numbers, and over which time."""
        span = f"{self.time[0]:g} to {self.time[-1]:g} s" if len(self.time) else "no rows"
        return f"virtual recording of {self.robot}: {len(self.joint_names)} joints, {len(self.time)} rows, {span}"

    def to_pandas(self) -> pandas.DataFrame:
        """A row for every time, with q, v, a and tau of every joint, in columns such as "q shoulder".

        Raises ImportError where pandas is missing.
        """
        channels = {"q": self.q, "v": self.v, "a": self.a, "tau": self.tau}
        return data_frame(joint_columns(channels, self.joint_names), self.time, "time")

    def _checked(self, name: str, value: ArrayLike, trailing: tuple[int, ...] | None) -> Array:
        """A read-only copy of the channel; the time, with no trailing shape, sets the number of rows."""
        array = np.array(as_floats(name, value))
        if trailing is None:
            if array.ndim != 1 or array.size == 0:
                raise InvalidInput(f"time has shape {array.shape}, expected (N,) with at least one time")
        elif array.shape != (len(self.time), *trailing):
            raise InvalidInput(f"{name} has shape {array.shape}, expected {(len(self.time), *trailing)}")
        bad = np.argwhere(~np.isfinite(array))
        if bad.size:
            row, *element = (int(k) for k in bad[0])
            names = self.joint_names if name in JOINT_CHANNELS else self.body_names
            of = f" of '{names[element[0]]}'" if element else ""
            raise InvalidInput(f"{name}{of} is {array[tuple(bad[0])]} in row {row}; leave out the rows without numbers")
        if trailing is None and np.any(np.diff(array) <= 0):
            row = int(np.argmax(np.diff(array) <= 0)) + 1
            raise InvalidInput(f"time {array[row]:g} s in row {row} does not increase; sort the rows by time")
        array.setflags(write=False)
        return array

    @property
    def rotation(self) -> Array:
        """R (N, n, 3, 3), body axes to world axes, from the Cardano angles."""
        return cardano_matrix(self.cardano)

    def rounded(self, digits: int = 7, convention: Convention = "half even") -> VirtualRecording:
        """All channels rounded to significant digits, as a program prints them (ADAMS: 7); the times stay.

        "half even" rounds the exact decimal expansion of a double, as C's %e does. "truncated" cuts the shortest
        decimal that stands for it, so that 0.3 stays 0.3.
        """
        if not isinstance(digits, Integral) or digits < 1:
            raise InvalidInput(f"digits is {digits!r}; a whole number from 1 on is needed")
        if convention not in ("half even", "truncated"):
            raise InvalidInput(f"convention is '{convention}'; use 'half even' or 'truncated'")
        truncated = convention == "truncated"
        context = Context(prec=digits, rounding=ROUND_DOWN if truncated else ROUND_HALF_EVEN)

        def printed(array: Array) -> Array:
            decimals = (Decimal(repr(x) if truncated else x) for x in array.ravel().tolist())
            numbers = [float(context.plus(x) if x else x) for x in decimals]  # plus would drop the sign of -0
            return np.array(numbers).reshape(array.shape)

        changed: dict[str, Any] = {name: printed(getattr(self, name)) for name in CHANNELS}
        return replace(self, **changed)

    def noisy(
        self,
        rng: np.random.Generator | int,
        *,
        relative: float | None = None,
        absolute: Mapping[str, ArrayLike] | None = None,
    ) -> VirtualRecording:
        """The recording with independent normal noise on the channels; the times stay. The same seed gives the same
        noise.

        rng: generator or seed
        relative: standard deviation of each column (one joint, or one component of one body) as a part of its root mean
            square over time; a column of zeros stays zero
        absolute: standard deviation per channel name, in units of the channel: one number, or (n,) or (n, 3)

        Exactly one of relative and absolute is needed; channels that absolute does not name stay as they are.
        """
        if (relative is None) == (absolute is None):
            raise InvalidInput("noise is given by relative or by absolute standard deviations; pass exactly one")
        unknown = [name for name in absolute or () if name not in CHANNELS]
        if unknown:
            raise InvalidInput(f"there is no channel '{unknown[0]}'; known: {', '.join(CHANNELS)}")
        rng = np.random.default_rng(rng)
        changed: dict[str, Any] = {}
        for name in CHANNELS if absolute is None else absolute:
            exact = getattr(self, name)
            if absolute is None:
                deviation = as_floats("relative", relative) * np.sqrt(np.mean(exact**2, axis=0))
            else:
                deviation = as_floats(name, absolute[name])
            if not np.all(np.isfinite(deviation)) or np.any(deviation < 0):
                raise InvalidInput(f"the standard deviation of {name} is negative or not finite; give zero or more")
            try:
                deviation = np.broadcast_to(deviation, exact.shape[1:])
            except ValueError as error:
                raise InvalidInput(
                    f"the standard deviation of {name} has shape {deviation.shape}, expected () or {exact.shape[1:]}"
                ) from error
            changed[name] = exact + deviation * rng.standard_normal(exact.shape)
        return replace(self, **changed)

    def at(self, times: ArrayLike) -> VirtualRecording:
        """The rows of these times (K,) [s]. Raises InvalidInput for a time that was not recorded."""
        times = np.atleast_1d(as_floats("times", times))
        right = np.minimum(np.searchsorted(self.time, times), len(self.time) - 1)
        left = np.maximum(right - 1, 0)
        rows = np.where(np.abs(self.time[left] - times) <= np.abs(self.time[right] - times), left, right)
        apart = ~(np.abs(self.time[rows] - times) <= TIME_TOLERANCE * np.abs(self.time).max())
        if apart.any():
            raise InvalidInput(
                f"time {times[apart][0]:g} s was not recorded (nearest: {self.time[rows[apart][0]]:g} s, "
                f"{len(self.time)} times from {self.time[0]:g} to {self.time[-1]:g} s); take these"
            )
        return self._rows(rows)

    def sampled(self, *, every: int | None = None, rate: float | None = None) -> VirtualRecording:
        """Every k-th row, or the rows at a rate [Hz], from the first on. Raises InvalidInput where rows are missing."""
        if (every is None) == (rate is None):
            raise InvalidInput("give every (a number of rows) or rate [Hz], exactly one")
        if every is not None:
            if not isinstance(every, Integral) or every < 1:
                raise InvalidInput(f"every is {every!r}; a whole number from 1 on is needed")
            return self._rows(np.arange(0, len(self.time), every))
        assert rate is not None
        if not (rate > 0 and np.isfinite(rate)):
            raise InvalidInput(f"rate is {rate!r} Hz; give one above zero")
        duration = self.time[-1] - self.time[0]
        return self.at(self.time[0] + np.arange(int(duration * rate * (1 + TIME_TOLERANCE)) + 1) / rate)

    def _rows(self, rows: NDArray[np.intp]) -> VirtualRecording:
        return replace(self, **{name: getattr(self, name)[rows] for name in ("time", *CHANNELS)})
