"""Wrong uses of the arguments: angles cut off, arguments ignored or exchanged, joints in another order, wrong units."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from functools import partial

import numpy as np
from numpy.typing import NDArray

from crosscheck.judging.faults.fault import CodeFault, joints_said, of_joints, rotation_from
from crosscheck.judging.faults.recursion import DynamicsCode, Numbers, State
from graphdyn import RobotModel
from graphdyn.layout import Array
from urdf.document import rpy_from_rotation

Taken = Callable[[Array, Array, Array], State]
"""What a code takes as its arguments, of q, v, a."""


def angles(model: RobotModel) -> Iterator[CodeFault]:
    turning = [k for k, joint in enumerate(model.joints) if not joint.is_prismatic]
    lower = np.array([-np.inf if joint.limits.lower is None else joint.limits.lower for joint in model.joints])
    upper = np.array([np.inf if joint.limits.upper is None else joint.limits.upper for joint in model.joints])
    maps: dict[str, Callable[[Array], Array]] = {
        "is clipped at ±π": lambda q: np.clip(q, -np.pi, np.pi),
        "is clipped at its limits": lambda q: np.clip(q, lower, upper),
        "is replaced by its cosine": np.cos,
        "is replaced by its sine": np.sin,
        "is the other angle of (cos, sin), π/2 - q": lambda q: np.pi / 2 - q,
        "is halved, as in a quaternion": lambda q: q / 2,
        "is doubled": lambda q: 2 * q,
        "is held at zero": np.zeros_like,
    }
    remedy = (
        "a revolute or continuous joint takes its plain angle, any number of turns; Pinocchio's continuous joints take "
        "(cos q, sin q)"
    )
    for said, change in maps.items():
        for joints in [*([k] for k in turning), *([turning] if len(turning) > 1 else [])]:
            at = np.isin(np.arange(model.n_bodies), joints)
            message = f"the angle of {joints_said(model, joints)} {said}"
            yield CodeFault.of("continuous_joint", message, remedy, partial(_other_angle, at, change), len(joints))


def _other_angle(at: NDArray[np.bool_], change: Callable[[Array], Array], code: DynamicsCode) -> DynamicsCode:
    return code.taking(lambda q, v, a: (np.where(at, change(q), q), v, a))


def arguments(model: RobotModel) -> Iterator[CodeFault]:
    """Arguments that are ignored, or taken for one another."""
    remedy = "compare the order of the arguments: q, v, a"
    of_all: dict[str, Taken] = {
        "the accelerations are ignored": lambda q, v, a: (q, v, 0 * a),
        "the positions are ignored": lambda q, v, a: (0 * q, v, a),
        "velocities and accelerations are exchanged": lambda q, v, a: (q, a, v),
        "positions and velocities are exchanged": lambda q, v, a: (v, q, a),
        "positions and accelerations are exchanged": lambda q, v, a: (a, v, q),
    }
    for message, taken in of_all.items():
        yield CodeFault.of("argument", message, remedy, partial(DynamicsCode.taking, arguments=taken))
    for k, name in enumerate(model.joint_names):
        kept = np.where(np.arange(model.n_bodies) == k, 0.0, 1.0)
        for which, what in (("v", "velocity"), ("a", "acceleration")):
            ignoring = partial(DynamicsCode.taking, arguments=scaled_arguments(kept, which))
            yield CodeFault.of("argument", f"the {what} of joint '{name}' is ignored", "pass all entries on", ignoring)


def scaled_arguments(scale: Array, which: str) -> Taken:
    """The arguments among q, v, a that `which` names, multiplied by factors (n,)."""

    def taken(*state: Array) -> State:
        q, v, a = (scale * x if name in which else x for name, x in zip("qva", state, strict=True))
        return q, v, a

    return taken


MAX_PERMUTED_JOINTS = 6
"""Largest number of joints for which all n! orders are tried; beyond, exchanges of two joints, cyclic shifts, and the
reverse and alphabetical orders."""


def orders(model: RobotModel) -> Iterator[CodeFault]:
    names, rules = model.joint_names, set(_rules(model))
    remedy = f"the order here is {', '.join(names)}; pass joint_names=, or sort by name"
    for order in map(np.array, _orders(model)):
        listed = ", ".join(names[k] for k in order)
        for message, motions, torques in (
            (f"joint quantities are in the order {listed}", True, True),
            (f"joint motions, but not torques, are in the order {listed}", True, False),
            (f"torques, but not joint motions, are in the order {listed}", False, True),
        ):
            change = partial(_permuted, order, motions, torques)
            yield CodeFault.of(
                "joint_order", message, remedy, change, 1 if tuple(order) in rules else _exchanges(order)
            )


def _permuted(order: NDArray[np.intp], motions: bool, torques: bool, code: DynamicsCode) -> DynamicsCode:
    """A code whose joint k is our joint order[k]."""
    if motions:
        back = np.argsort(order)
        code = code.taking(lambda q, v, a: (q[..., back], v[..., back], a[..., back]))
    return code.giving(lambda tau, _: tau[..., order]) if torques else code


def _exchanges(order: NDArray[np.intp]) -> int:
    """How many exchanges of two joints make this order: its length less the number of its cycles."""
    left, cycles = set(range(len(order))), 0
    while left:
        k = left.pop()
        cycles += 1
        while (k := int(order[k])) in left:
            left.remove(k)
    return len(order) - cycles


def _rules(model: RobotModel) -> list[tuple[int, ...]]:
    """Orders that follow from a rule: alphabetical, reversed, one after the other shifted."""
    ours = tuple(range(model.n_bodies))
    alphabetical = tuple(sorted(ours, key=lambda k: model.joint_names[k]))
    return [alphabetical, ours[::-1], *(ours[k:] + ours[:k] for k in ours[1:])]


def _orders(model: RobotModel) -> Iterator[tuple[int, ...]]:
    """Every order but ours."""
    n = model.n_bodies
    ours = tuple(range(n))
    likely = _rules(model)
    for i, k in itertools.combinations(ours, 2):
        exchanged = list(ours)
        exchanged[i], exchanged[k] = k, i
        likely.append(tuple(exchanged))
    every = itertools.permutations(ours) if n <= MAX_PERMUTED_JOINTS else ()
    yield from (order for order in dict.fromkeys([*likely, *every]) if order != ours)


LENGTH_UNITS = {"millimeters": 1e3, "centimeters": 1e2, "inches": 1 / 0.0254}
"""Units that a length may be in, per meter."""

MOTIONS = "positions, velocities and accelerations"


def units(model: RobotModel) -> Iterator[CodeFault]:
    slides = np.array([joint.is_prismatic for joint in model.joints])
    degree = np.pi / 180
    sets = [[k] for k in range(model.n_bodies)] + ([list(range(model.n_bodies))] if model.n_bodies > 1 else [])
    for joints in sets:
        who = "joint" if len(joints) > 1 else joints_said(model, joints)
        turning, sliding = [k for k in joints if not slides[k]], [k for k in joints if slides[k]]
        of = f"{who} {{what}}" if len(joints) > 1 else f"{{what}} of {who}"
        if turning:
            for factor, unit in ((degree, "degrees"), (1 / degree, "radians where the code means degrees")):
                yield _scaled(model, turning, of, MOTIONS, unit, factor, "qva")
                yield _scaled(model, turning, of, "positions", unit, factor, "q")
            yield _scaled(model, turning, of, "velocities", "degrees per second", degree, "v")
            yield _scaled(model, turning, of, "velocities", "rev/min", 2 * np.pi / 60, "v")
        if sliding and (len(joints) == 1 or len(sliding) > 1):
            of_slides = of if len(joints) == 1 else "sliding {what}"
            for unit, per_meter in LENGTH_UNITS.items():
                yield _scaled(model, sliding, of_slides, MOTIONS, unit, 1 / per_meter, "qva")
                yield _scaled(model, sliding, of_slides, "positions", unit, 1 / per_meter, "q")
    yield from of_joints(
        model,
        "unit",
        "convert lengths to meters",
        {
            f"the placement of {{who}} is in {unit}, the rest in meters": partial(_other_length, per_meter)
            for unit, per_meter in LENGTH_UNITS.items()
        },
    )
    yield from of_joints(
        model,
        "unit",
        "URDF gives rpy in radians",
        {
            f"the rpy angles of {{who}} are taken as {said}": partial(_other_rpy, factor)
            for factor, said in ((degree, "degrees"), (1 / degree, "radians, but the code means degrees"))
        },
    )


def _other_length(factor: float, x: Numbers, k: int) -> dict[str, Array]:
    return {"translations": factor * x.translations[k]}


def _other_rpy(factor: float, x: Numbers, k: int) -> dict[str, Array]:
    return {"rotations": rotation_from(factor * rpy_from_rotation(x.rotations[k]))}


def _scaled(
    model: RobotModel, joints: Sequence[int], of: str, what: str, unit: str, factor: float, which: str
) -> CodeFault:
    """Some of q, v, a multiplied by a factor at some joints."""
    scale = np.where(np.isin(np.arange(model.n_bodies), joints), factor, 1.0)
    message = f"{of.format(what=what)} are taken as {unit}"
    change = partial(DynamicsCode.taking, arguments=scaled_arguments(scale, which))
    return CodeFault.of("unit", message, "convert to rad, m, rad/s, m/s when they are read", change)
