"""Random motions and heights that they graze, pass twice or just miss, with all crossings by a second computation.

The height lies a hair below or above an extremum of a joint's course, or anywhere. The second computation is a spline
through fine steps of order eight without any event; Euler's course is the polygon through its own rows. How far the
method itself is off is measured first, and the hair is wider. Of loops it is measured with the rows that are asked
for, since their steps end there: with a row at every fine step they are off by 4e-11, without by 2e-8 at rtol = 2e-6.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from random_trees import random_tree
from robots.mechanisms import four_bar
from robots.moving_robots import pendulum, slider
from scipy.interpolate import CubicHermiteSpline, PPoly
from scipy.optimize import brentq

import graphdyn
from graphdyn import Coupling, Event, Friction, JointLimits, PDControl, RobotModel, Simulation, simulate

METHODS = ("dop853", "rk8", "rk4", "euler")
KINDS = ("throw", "swing", "spring", "function", "sampled", "friction", "arm", "coupled", "loop")

FINE_STEPS, FINE_PYTHON_STEPS = 800, 200
BEYOND = 1e-9
"""What a row may be beyond a limit [m or rad]."""

ACCURACY_SHARE, LEAST_HAIR = 20.0, 1e-9
"""A hair is so many times as wide as the method is off, and so wide at least [m or rad]."""


@dataclass(frozen=True, eq=False)
class Start:
    """A motion without limits and events: what simulate takes."""

    model: RobotModel
    q: np.ndarray
    v: np.ndarray
    duration: float
    given: dict[str, Any]

    def moved(self, model: RobotModel | None = None, **settings: Any) -> Simulation:
        return simulate(model or self.model, self.q, self.v, self.duration, **self.given, **settings)


def started(kind: str, rng: np.random.Generator) -> Start:
    q, v = rng.uniform(-0.3, 0.3, 1), rng.choice([-1.0, 1.0]) * rng.uniform(0.5, 2.0, 1)
    duration, stiffness = rng.uniform(0.8, 3.0), rng.uniform(4.0, 30.0)
    if kind == "throw":
        return Start(slider(mass=1.0), q, v, duration, {"torque": -np.sign(v) * rng.uniform(0.5, 3.0)})
    if kind == "swing":
        return Start(pendulum(), q, v, duration, {})
    if kind == "spring":
        control = PDControl(stiffness, rng.uniform(0.0, 1.0), rng.uniform(-0.2, 0.2, 1), period=duration / 10)
        return Start(slider(mass=1.0), q, v, duration, {"torque": control})
    if kind == "function":
        return Start(pendulum(), q, v, duration, {"torque": lambda t, q, v: [np.sin(0.3 * stiffness * t) - q[0]]})
    if kind == "sampled":
        return Start(slider(mass=1.0), q, v, duration, {"torque": rng.uniform(-5.0, 5.0, (5, 1))})
    if kind == "friction":
        given = {"friction": Friction(coulomb=rng.uniform(0.1, 1.0)), "torque": rng.uniform(-0.5, 0.5, 1)}
        return Start(pendulum(), q, v, duration, given)
    if kind == "arm":
        model = random_tree(int(rng.integers(12)), (0, 1, 2), ("revolute", "prismatic", "revolute"))
        return Start(model, rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3), duration / 4, {})
    if kind == "coupled":
        arm = random_tree(int(rng.integers(12)), (0, 1), ("revolute", "revolute"))
        driving, driven = arm.joint_names
        coupling = Coupling(driven, {driving: rng.choice([-1.5, 0.7])}, 0.2)
        return Start(replace(arm, couplings=(coupling,)), q, v, duration / 2, {})
    crank = four_bar()
    q, v = graphdyn.assemble(crank, [rng.uniform(0.5, 1.0), 0.0, 1.0], [v[0], 0, 0], hold=["a"])
    return Start(crank, q, v, 0.15, {"torque": np.array([rng.uniform(-60.0, 60.0), 0.0, 0.0])})


@dataclass(frozen=True, eq=False)
class Course:
    """Where a joint is: a piecewise polynomial of the time, its extrema, and how far a method is from it."""

    joint: int
    position: PPoly
    accuracy: float

    @cached_property
    def critical(self) -> np.ndarray:
        """The times of both ends and of all extrema between."""
        x = self.position.x
        if self.position.c.shape[0] == 2:  # a polygon
            return np.asarray(x)
        roots = self.position.derivative().roots(discontinuity=True, extrapolate=False)
        return np.unique(np.concatenate([[x[0]], roots[np.isfinite(roots)], [x[-1]]]))

    def crossings(self, height: float) -> list[tuple[float, float]]:
        """Time and direction of each."""
        times = self.critical
        signs = np.sign(self.position(times) - height)
        found = np.flatnonzero(signs[1:] != signs[:-1])
        return [
            (float(brentq(lambda t: self.position(t) - height, times[k], times[k + 1], xtol=1e-14)), signs[k + 1])
            for k in found
        ]

    def distance(self, height: float) -> float:
        """Between the height and the nearest end or extremum."""
        return float(np.abs(self.position(self.critical) - height).min())


def positions(motion: Simulation, joint: int) -> np.ndarray:
    freedom = motion.model.degrees_of_freedom
    return np.asarray(motion.q @ freedom.matrix[joint] + freedom.offset[joint])


def course(start: Start, joint: int, settings: dict[str, Any], fine: Simulation) -> Course:
    if settings.get("method") == "euler":
        own = start.moved(**settings)
        x, t = positions(own, joint), own.time
        # loops are closed within steps too, which bends the polygon
        bent = float(np.abs(np.diff(x, 2)).max()) if start.model.chords else 0.0
        return Course(joint, PPoly(np.array([np.diff(x) / np.diff(t), x[:-1]]), t), bent)
    velocity, rows = fine.v @ fine.model.degrees_of_freedom.matrix[joint], positions(fine, joint)
    position = CubicHermiteSpline(fine.time, rows, velocity)
    asked = start.moved(**settings)
    own = [asked] if "method" in settings else [asked, start.moved(**{**settings, "at": fine.time})]
    # a spline of every other row is off by sixteen times as much
    coarse = CubicHermiteSpline(fine.time[::2], rows[::2], velocity[::2])
    off = np.abs(coarse(fine.time) - rows).max() / 16
    apart = max(float(np.abs(positions(each, joint) - position(each.time)).max()) for each in own)
    return Course(joint, position, float(apart + off))


def limited(model: RobotModel, joint: int, height: float, side: float) -> RobotModel:
    own = model.joints[joint]
    bounds = (-1e3, height) if side > 0 else (height, 1e3)
    kind = "revolute" if own.kind == "continuous" else own.kind
    joints = list(model.joints)
    joints[joint] = replace(own, kind=kind, limits=JointLimits(*bounds))
    return replace(model, joints=tuple(joints))


def shapes(value: float, which: int) -> float:
    """Functions with the sign of a value."""
    return float((value, np.arctan(3 * value), np.expm1(value), value * (1 + value**2))[which])


def problems(kind: str, method: str, seed: int, heights: int = 8) -> tuple[int, list[str]]:
    """How many simulations were asked for events or limits, and what is wrong with them."""
    rng = np.random.default_rng(seed)
    start = started(kind, rng)
    settings: dict[str, Any] = {"rtol": 10 ** rng.uniform(-10, -5), "atol": 1e-9}
    if method != "dop853":
        settings = {"method": method, "step": start.duration / (10 * int(rng.integers(1, 7)))}
    steps = FINE_PYTHON_STEPS if kind in ("loop", "function") else FINE_STEPS
    fine = start.moved(method="rk8", step=start.duration / steps)
    at = None if method != "dop853" or rng.random() < 0.5 else np.linspace(0, start.duration, 7)
    joint = int(rng.integers(len(start.model.joints)))
    settings["at"] = at
    known = course(start, joint, settings, fine)
    # where fixed steps stop a joint for good they are off by more, and not at rows alone
    least = (2.0 if kind == "friction" else ACCURACY_SHARE) * known.accuracy + LEAST_HAIR
    values = known.position(known.critical)
    span = np.ptp(values)
    asked, found = 0, list[str]()
    for _ in range(heights if span > 4 * least else 0):
        extremum, hair = rng.choice(values), 10 ** rng.uniform(np.log10(least), np.log10(span / 2))
        height = float(extremum + rng.choice([-1.0, 1.0]) * hair)
        if known.distance(height) < least or abs(height - values[0]) < least:
            continue
        expected, where = known.crossings(height), f"{kind} {method} {seed}: height {height!r}, hair {hair:.2g}: "
        found += [where + text for text in _limit(start, known, height, settings, expected, least)]
        found += [where + text for text in _event(start, known, height, settings, expected, least, rng)]
        asked += 2
    return asked, found


def _limit(
    start: Start, known: Course, height: float, settings: dict[str, Any], expected: list[Any], least: float
) -> list[str]:
    side = np.sign(height - known.position(0.0))
    motion = start.moved(limited(start.model, known.joint, height, side), limits="stop", **settings)
    beyond = float((side * (positions(motion, known.joint) - height)).max())
    found = [f"a row is {beyond:.2g} beyond"] if beyond > BEYOND else []
    if bool(motion.ended) != bool(expected):
        found.append(f"limit {'missed' if expected else 'that is not reached'}, ended at {motion.time[-1]:g}")
    elif expected and abs(known.position(motion.time[-1]) - height) > least:
        found.append(f"limit at {motion.time[-1]:g} in place of {expected[0][0]:g}")
    return found


def _event(
    start: Start,
    known: Course,
    height: float,
    settings: dict[str, Any],
    expected: list[Any],
    least: float,
    rng: np.random.Generator,
) -> list[str]:
    freedom = start.model.degrees_of_freedom
    ratios, offset, which = freedom.matrix[known.joint], freedom.offset[known.joint], int(rng.integers(4))

    def value(t: float, q: np.ndarray, v: np.ndarray) -> float:
        return shapes(float(q @ ratios + offset - height), which)

    direction = int(rng.integers(-1, 2))
    event = Event(value, "height", stop=False, direction=direction)  # type: ignore[arg-type]
    motion = start.moved(events=event, **settings)
    wanted = [time for time, sign in expected if direction in (0, sign)]
    times = [occurrence.time for occurrence in motion.occurrences]
    if len(times) != len(wanted):
        return [f"{len(times)} events in place of {len(wanted)}: {times} in place of {wanted}"]
    far = [time for time in times if abs(known.position(time) - height) > least]
    return [f"events at {times} in place of {wanted}"] if far else []
