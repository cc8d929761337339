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
        ("are taken in axes of the inside links", _in_inside_axes),
        ("are taken in world axes", lambda s: _in_link_axes(s, s.all_loads)),
        ("are taken as acting at the centers of mass", lambda s: _at_origins(s, s.all_loads)),
        *(_of_bodies(states.model)),
    ):
        yield AnswerFault(
            "external_wrenches", f"the external wrenches {message}",
            "they are force, then moment, on each body, at its link origin, in link axes",
            lambda s, c, change=change: known.of_graphdyn(s.but(loads=change(s)), c),  # type: ignore[misc]
        )  # fmt: skip


def _of_bodies(model: RobotModel) -> Iterator[tuple[str, Callable[[JudgedStates], Array]]]:
    """One body's wrench left out, or all others."""
    if model.n_bodies > 1:
        for name, kept in zip(model.body_names, np.eye(model.n_bodies)[..., None], strict=True):
            yield f"of all bodies but '{name}' are left out", lambda s, kept=kept: s.all_loads * kept  # type: ignore[misc]
            yield f"on body '{name}' are left out", lambda s, kept=kept: s.all_loads * (1 - kept)  # type: ignore[misc]


def _in_inside_axes(states: JudgedStates) -> Array:
    """The wrenches in link axes, if their numbers are those in axes of the inside links."""
    world = states.model.base.rotation + 0 * states.rotations[:, :1]
    before = np.concatenate([world, states.rotations], axis=1)[:, [joint.inside for joint in states.model.joints]]
    halves = states.all_loads.reshape(*states.all_loads.shape[:-1], 2, 3)
    turned = np.einsum("...iba,...ibc,...ihc->...iha", states.rotations, before, halves)
    return np.asarray(turned.reshape(states.all_loads.shape))


def _in_link_axes(states: JudgedStates, loads: Array) -> Array:
    halves = loads.reshape(*loads.shape[:-1], 2, 3)
    turned: Array = np.einsum("...iba,...ihb->...iha", states.rotations, halves).reshape(loads.shape)
    return turned


def _at_origins(states: JudgedStates, loads: Array) -> Array:
    centers = np.array([body.center_of_mass for body in states.model.bodies])
    force, moment = loads[..., LINEAR], loads[..., ANGULAR]
    return np.concatenate([force, moment + np.cross(centers, force)], axis=-1)
