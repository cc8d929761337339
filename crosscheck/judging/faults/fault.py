"""A fault of a dynamics code, or a family of faults whose numbers are fitted.

Faults are made of changed numbers of joints and bodies. A fitted number that is round is a step of a code, not a value.
"""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from crosscheck.judging.faults.recursion import DynamicsCode, Numbers
from crosscheck.judging.judgment import FittedNumber
from graphdyn import RobotModel
from graphdyn.layout import Array
from graphdyn.model import rotation_about

COMPLEX_STEP = 1e-30
"""Size of the complex steps that give exact derivatives."""

NO_NUMBERS = np.zeros(0)

Change = Callable[[DynamicsCode], DynamicsCode]

FAULT_KINDS = (
    *("gravity", "coriolis", "sign", "joint_order", "argument", "frame", "geometry", "zero", "gear", "coupling"),
    *("inertia_point", "inertial_parameters", "unit", "continuous_joint", "inertial_frame", "fixed_link"),
    *("massless_link", "rounding", "friction", "spring", "offset", "rotor_inertia", "clipped", "slip"),
)
"""Kinds of the faults, in the order in which those that fit alike and change as many numbers are listed."""


@dataclass(frozen=True, eq=False)
class FaultDescription:
    """What is wrong, in words.

    kind: one of FAULT_KINDS
    size: how many numbers or steps of a code it changes; of explanations that fit alike the smallest is preferred
    numbers: those that were fitted
    """

    kind: str
    message: str
    remedy: str
    size: int = 1
    numbers: tuple[FittedNumber, ...] = ()


@dataclass(frozen=True, eq=False)
class CodeFault:
    """A fault of a dynamics code, or a family of faults that differ by p numbers, which are fitted.

    right: numbers without a fault (p,), none for a single fault
    starts: where fits begin (S, p), the best of them is taken
    change: (code, numbers) → code, differentiable, of complex numbers too
    say: numbers → what is wrong, one entry for each fault that they are
    """

    right: Array
    change: Callable[[DynamicsCode, Array], DynamicsCode]
    say: Callable[[Array], Iterable[FaultDescription]]
    starts: Array | None = None

    @classmethod
    def of(
        cls,
        kind: str,
        message: str,
        remedy: str,
        change: Change,
        size: int = 1,
        numbers: tuple[FittedNumber, ...] = (),
    ) -> CodeFault:
        """A single fault."""
        said = FaultDescription(kind, message, remedy, size, numbers)
        return cls(NO_NUMBERS, lambda code, _: change(code), lambda _: [said])


ROUND_NUMBER_TOLERANCE = 1e-6
"""Relative distance from a round number within which a fitted factor is that number."""


def rounded(x: float) -> float:
    """The integer or power of ten next to x, or x."""
    x = float(x)
    if abs(x - round(x)) < ROUND_NUMBER_TOLERANCE * max(1.0, abs(x)):
        return float(round(x))
    power = np.log10(abs(x))
    return float(np.sign(x) * 10.0 ** round(power)) if abs(power - round(power)) < ROUND_NUMBER_TOLERANCE else x


def told_apart(theirs: float, ours: float, unit: str) -> str:
    """Such as "2.01 kg, not 2 kg", with as many digits as tell the two apart."""
    digits = next((k for k in range(6, 17) if f"{theirs:.{k}g}" != f"{ours:.{k}g}"), 17)
    return f"{theirs:.{digits}g} {unit}, not {ours:.{digits}g} {unit}"


FITTED_ZERO_SHARE = 1e-9
"""Part of the right number below which a fitted number is zero."""


def round_factor(x: float) -> float:
    """The integer next to a factor that was found by least squares, or the factor."""
    return float(round(x)) if abs(x - round(x)) < ROUND_NUMBER_TOLERANCE else x


def is_round(x: float) -> bool:
    """0, ±1, ±2, powers of ten."""
    return x in (0.0, 2.0, -2.0) or float(np.log10(abs(x))).is_integer()


E1, E2, E3 = np.eye(3)
AXES = {"x": E1, "y": E2, "z": E3}
QUARTER_TURNS = [
    (name, degrees, rotation_about(axis, np.deg2rad(degrees)))
    for name, axis in AXES.items()
    for degrees in (90, 180, 270)
]
"""Turns by one to three right angles: name of the axis, degrees, matrix."""

Changed = Callable[[Numbers, int], Mapping[str, Array]]
"""(numbers of a code, index of a joint or body) → its new entries by the name of the array."""


def changed(code: DynamicsCode, change: Changed, members: Sequence[int]) -> DynamicsCode:
    """The code with the entries of some joints or bodies changed."""
    arrays: dict[str, Array] = {}
    for k in members:
        for name, entry in change(code.numbers, k).items():
            arrays.setdefault(name, np.array(getattr(code.numbers, name)))[k] = entry
    return code.but(**arrays)


def of_joints(
    model: RobotModel,
    kind: str,
    remedy: str,
    changes: Mapping[str, Changed],
    size: int = 1,
    joints: Sequence[int] | None = None,
) -> Iterator[CodeFault]:
    """Faults by their messages, {who} in it: each at one joint, for each joint or some, and at every joint at once."""
    which = range(model.n_bodies) if joints is None else joints
    yield from _of_members("joint", model.joint_names, which, kind, remedy, changes, size)


def of_bodies(
    model: RobotModel, kind: str, remedy: str, changes: Mapping[str, Changed], size: int = 1
) -> Iterator[CodeFault]:
    """Faults by their messages, {who} in it: each at one body, for each body, and at every body at once."""
    yield from _of_members("body", model.body_names, range(model.n_bodies), kind, remedy, changes, size)


def _of_members(
    what: str,
    names: Sequence[str],
    which: Sequence[int],
    kind: str,
    remedy: str,
    changes: Mapping[str, Changed],
    size: int,
) -> Iterator[CodeFault]:
    sets = {f"{what} '{names[k]}'": [k] for k in which}
    if len(names) > 1:
        sets[f"every {what}"] = list(range(len(names)))
    for (message, change), (who, members) in itertools.product(changes.items(), sets.items()):
        faulty = partial(changed, change=change, members=members)
        yield CodeFault.of(kind, message.format(who=who), remedy, faulty, size + len(members) - 1)


def rotation_from(rpy: Array) -> Array:
    """R_z(yaw) R_y(pitch) R_x(roll)."""
    roll, pitch, yaw = rpy
    return rotation_about(E3, yaw) @ rotation_about(E2, pitch) @ rotation_about(E1, roll)


def opposite_rotation_from(rpy: Array) -> Array:
    """R_x(roll) R_y(pitch) R_z(yaw)."""
    roll, pitch, yaw = rpy
    return rotation_about(E1, roll) @ rotation_about(E2, pitch) @ rotation_about(E3, yaw)


def joints_said(model: RobotModel, joints: Sequence[int]) -> str:
    """every joint; joints 'a', 'b'"""
    every = len(joints) == model.n_bodies > 1
    return "every joint" if every else named("joint", [model.joint_names[k] for k in joints])


def named(what: str, names: Sequence[str]) -> str:
    """joint 'a'; joints 'a', 'b'"""
    return f"{what}{'s' if len(names) > 1 else ''} {', '.join(repr(name) for name in names)}"


_NOUN_ENDS = re.compile(r" (?=(?:at|in|of|on) |v\b|v_|ω|\d)")
"""Marks that end the noun of a term's name and begin its formula or place."""


def factor_said(name: str, factor: float) -> str:
    """What a factor on a term says, rounded to what it is within the accuracy of a fit."""
    noun = _NOUN_ENDS.split(name)[0]
    have, are = ("have", "are") if noun.endswith("s") and not noun.endswith(("axis", "mass")) else ("has", "is")
    if factor == 0:
        return f"{name} {are} left out"
    if factor == -1:
        return f"{name} {have} the opposite sign"
    return f"{name} {are} multiplied by {factor:.6g}"
