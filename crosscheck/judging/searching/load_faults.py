"""External wrenches that a function takes wrongly: left out, in other axes, about another point."""

from __future__ import annotations

from collections.abc import Callable, Iterator

import numpy as np

from crosscheck.judging.searching.found_fault import AnswerFault
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import Quantity
from graphdyn import RobotModel
from graphdyn.layout import ANGULAR, LINEAR, Array

FORCES = np.repeat([1.0, 0.0], 3)
"""Factors on a wrench that leave its force."""


def other_loads(known: Quantity, states: JudgedStates) -> Iterator[AnswerFault]:
    for message, change in (
        ("are left out", lambda s: 0 * s.all_loads),
        ("have the opposite sign", lambda s: -s.all_loads),
        ("are taken as moment, then force", lambda s: np.roll(s.all_loads, 3, axis=-1)),
        ("are taken without their moments: they are left out", lambda s: s.all_loads * FORCES),
        ("are taken without their forces: they are left out", lambda s: s.all_loads * (1 - FORCES)),
        ("have moments of the opposite sign", lambda s: s.all_loads * (2 * FORCES - 1)),
        *(
            (f"{what} taken {how}", lambda s, halves=halves, turn=turn: _turned(s, halves, turn))
            for what, halves in TURNED_HALVES.items()
            for how, turn in TURNS.items()
        ),
        ("are taken as acting at the centers of mass", lambda s: _moved(s, _centers(s))),
        ("are taken as acting at the origins of the inside links", lambda s: _moved(s, _inside_origins(s))),
        ("are taken as those of the body before", lambda s: _shifted(s.all_loads, 1)),
        ("are taken as those of the body after", lambda s: _shifted(s.all_loads, -1)),
        *(_of_bodies(states.model)),
    ):
        yield AnswerFault(
            "external_wrenches", f"the external wrenches {message}",
            "they are force, then moment, on each body, at its link origin, in link axes",
            lambda s, c, change=change: known.of_graphdyn(s.but(loads=change(s)), c),  # type: ignore[misc]
        )  # fmt: skip


def _shifted(loads: Array, by: int) -> Array:
    """The wrenches of other bodies; zero where there is none."""
    found = np.zeros_like(loads)
    here, there = (slice(by, None), slice(None, -by)) if by > 0 else (slice(None, by), slice(-by, None))
    found[:, here] = loads[:, there]
    return found


def _of_bodies(model: RobotModel) -> Iterator[tuple[str, Callable[[JudgedStates], Array]]]:
    """One body's wrench left out, or all others."""
    if model.n_bodies > 1:
        for name, kept in zip(model.body_names, np.eye(model.n_bodies)[..., None], strict=True):
            yield f"of all bodies but '{name}' are left out", lambda s, kept=kept: s.all_loads * kept  # type: ignore[misc]
            yield f"on body '{name}' are left out", lambda s, kept=kept: s.all_loads * (1 - kept)  # type: ignore[misc]


TURNED_HALVES = {"are": (True, True), "have forces that are": (True, False), "have moments that are": (False, True)}
"""Which halves are turned wrongly, in words: force, moment."""

Turn = Callable[[JudgedStates], Array]

TURNS: dict[str, Turn] = {
    "in world axes": lambda s: s.rotations.swapaxes(-1, -2),
    "in world axes, turned the wrong way": lambda s: s.rotations.swapaxes(-1, -2) @ s.rotations.swapaxes(-1, -2),
    "in axes of the inside links": lambda s: s.rotations.swapaxes(-1, -2) @ _inside_rotations(s),
}
"""The matrix by which the numbers are turned into link axes (N, n, 3, 3)."""


def _turned(states: JudgedStates, halves: tuple[bool, bool], turn: Turn) -> Array:
    """The wrenches in link axes, if the numbers of some halves are those in other axes."""
    loads = states.all_loads.reshape(*states.all_loads.shape[:-1], 2, 3)
    turned = np.einsum("...iab,...ihb->...iha", turn(states), loads)
    found: Array = np.where(np.array(halves)[:, None], turned, loads).reshape(states.all_loads.shape)
    return found


def _inside_rotations(states: JudgedStates) -> Array:
    world = states.model.base.rotation + 0 * states.rotations[:, :1]
    found: Array = np.concatenate([world, states.rotations], axis=1)[:, [x.inside for x in states.model.joints]]
    return found


def _moved(states: JudgedStates, points: Array) -> Array:
    """The wrenches about the link origins, if they act at other points, in link axes."""
    force, moment = states.all_loads[..., LINEAR], states.all_loads[..., ANGULAR]
    return np.concatenate([force, moment + np.cross(points, force)], axis=-1)


def _centers(states: JudgedStates) -> Array:
    return np.array([body.center_of_mass for body in states.model.bodies])


def _inside_origins(states: JudgedStates) -> Array:
    """Origins of the inside links, from the link origins in link axes (N, n, 3)."""
    ground = states.model.base.translation + 0 * states.origins[:, :1]
    inside = np.concatenate([ground, states.origins], axis=1)[:, [x.inside for x in states.model.joints]]
    return np.asarray(np.einsum("...ba,...b->...a", states.rotations, inside - states.origins))
