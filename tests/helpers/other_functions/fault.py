"""A mistake in one function of a robot: how it is planted, and what a true message says of it."""

import re
from collections.abc import Callable
from dataclasses import dataclass
from zlib import crc32

import numpy as np
from shared_data import ARMS
from textbook_codes.arm import PlainArm
from textbook_codes.code import FRAMES, right_code, text_with

import urdf

TEN_ARMS = ("ur5", "kr500", "kinova", "z1", "panda", "xarm7", "ur3", "so100", "vx300s", "kr210_r2700_2")
SHOWS = 1e-6
"""Relative difference of the answers from which on a fault shows on an arm."""


SHOWS_SPECIAL = 1e-8
"""The same at special states, where angles are small: ten times the judge's tolerance."""


@dataclass(frozen=True)
class Fault:
    """A mistake in a function of the table in docs/judge.md.

    plant: (arm, right function, code(name, arm)) → the wrong function
    named: expression that a true message matches; <body 3>, <joint n> stand for names (n: the last one)
    equal: expression of other words that were found to give the same numbers
    robots: arms on which it is planted; one of them is chosen by the name, where it shows
    options: further options of the judgment
    """

    function: str
    name: str
    plant: Callable
    named: str
    equal: str = ""
    robots: tuple[str, ...] = TEN_ARMS
    frame: str | None = None
    options: tuple[tuple[str, object], ...] = ()

    def __str__(self):
        return f"{self.function}: {self.name}"

    @property
    def number(self):
        """A random number that only depends on the name."""
        return crc32(str(self).encode())

    @property
    def is_aside(self):
        """Kept aside, to be counted but not read while the judge is written: a third."""
        return self.number % 3 == 0

    def planted(self):
        """Robot, model, frame and the wrong function, on the first arm in turn on which the fault shows."""
        start = self.number % len(self.robots)
        for robot in (*self.robots[start:], *self.robots[:start]):
            if found := self.planted_on(robot):
                return found
        raise AssertionError(f"{self} shows on no arm")

    def planted_on(self, robot):
        """Robot, model, frame and the wrong function on an arm, or None where the fault does not show."""
        model = model_of(robot)
        frame = self.frame or FRAMES[robot]
        arm = PlainArm.of(model, frame)
        right = right_code(self.function, arm)
        if self.shows(right, self.plant(arm, right, right_code), model):
            return robot, model, frame, self.plant(arm, right, right_code)
        return None

    def shows(self, right, wrong, model):
        if self.function == "base_regressor":
            return True
        rng = np.random.default_rng(0)
        states = [arguments_of(self.function, rng, model.n_bodies) for _ in range(2)]
        return any(differs(right(*x), wrong(*x)) for x in states)

    def words(self, model, expression):
        """An expression with the names of this robot."""
        names = {"body": [x.name for x in model.bodies], "joint": list(model.joint_names)}
        framed = [x.body for x in model.frames if x.name in FRAMES.values()]
        expression = expression.replace("<body of the frame>", f"<body {framed[0] if framed else 'n'}>")

        def name(found):
            kind, k = found.groups()
            return re.escape(names[kind][-1 if k == "n" else int(k) - 1])

        return re.sub(r"<(body|joint) (\d+|n)>", name, expression)


class SpecialFault(Fault):
    """A mistake that shows at special states alone, or in the order of the calls."""

    def shows(self, right, wrong, model):
        rng = np.random.default_rng(0)
        for q in special_positions(model):
            given = [q, *arguments_of(self.function, rng, model.n_bodies)[1:]]
            rest = [q, *(0 * x for x in given[1:])]
            for x in (given, [2 * q - q, *(2 * y for y in given[1:])], rest, [*given[:2], *rest[2:]]):
                try:
                    if differs(right(*x), wrong(*x), SHOWS_SPECIAL):
                        return True
                except ValueError:  # the code refuses this state
                    return True
        return False


def special_positions(model):
    """Positions within the limits at which codes take another branch; limits that leave out zero move them."""
    limits = [(x.limits.lower, x.limits.upper) if x.kind != "continuous" else (None, None) for x in model.joints]
    lower, upper = np.array([(-np.inf if a is None else a, np.inf if b is None else b) for a, b in limits]).T
    for angle in (0.0, 1e-8, 9e-7, 9e-5, 2e-2, 2 * np.pi, -4.0):
        yield np.clip(np.full(model.n_bodies, angle), lower, upper)


def path_of(robot):
    known = {entry.name: str(entry.path) for entry in urdf.robots()}
    return known.get(robot, str(ARMS / f"{robot}.urdf"))


def model_of(robot):
    return urdf.load(path_of(robot)).uncoupled


def differs(right, wrong, bound=SHOWS):
    right, wrong = np.asarray(right), np.asarray(wrong)
    return right.shape != wrong.shape or not np.abs(right - wrong).max() <= bound * np.abs(right).max()


ARGUMENTS = {
    **dict.fromkeys(("forward_dynamics", "da_dq", "da_dv", "forward_dynamics_parameter_derivatives"), 3),
    **dict.fromkeys(("inverse_dynamics", "power", "joint_wrenches", "multipliers", "frame_acceleration"), 3),
    **{f"d{of}_d{x}": 3 for of in ("tau", "wrenches", "multipliers") for x in "qva"},
    **dict.fromkeys(("joint_torque_regressor", "base_regressor", "body_regressor"), 3),
    **dict.fromkeys(("bias_torque", "coriolis_matrix", "frame_jacobian_derivative", "frame_velocity"), 2),
    **dict.fromkeys(("center_of_mass_velocity", "momentum", "kinetic_energy", "momentum_regressor"), 2),
    "kinetic_energy_regressor": 2,
}
"""Number of vectors (n,) that a function takes, where there are more than one."""


def arguments_of(function, rng, n):
    """Some state."""
    given = [rng.normal(size=n) for _ in range(ARGUMENTS.get(function, 1))]
    if function == "forward_dynamics":
        given[2] = 100 * given[2]
    return [*given, rng.normal(size=(n, 6))] if function == "static_torque" else given


def text(function, name, where, place, instead, named, **more):
    """One place of the code written otherwise."""
    changed = text_with(where, place, instead)
    return Fault(function, name, lambda arm, right, code: code(function, arm, changed), named, **more)


def numbers(function, name, change, named, **more):
    """The code is right, numbers of the robot are not: change(arm)."""
    return Fault(function, name, lambda arm, right, code: code(function, change(arm)), named, **more)


def answers(function, name, change, named, **more):
    """The answer is changed: change(answer, *arguments)."""

    def plant(arm, right, code):
        return lambda *x: change(np.asarray(right(*x)), *x)

    return Fault(function, name, plant, named, **more)


def arguments(function, name, change, named, **more):
    """The arguments are changed: change(*arguments) → arguments."""
    return Fault(function, name, lambda arm, right, code: lambda *x: right(*change(*x)), named, **more)


def plant(function, name, planted, named, **more):
    """Anything else: planted(arm, right, code) → function."""
    return Fault(function, name, planted, named, **more)
