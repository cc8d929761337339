"""Wrong signs: of torques, motions, axes, products of inertia and centers of mass."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Iterable, Iterator, Sequence

import numpy as np

from crosscheck.judging.experiments import torques
from crosscheck.judging.faults.changes import joints_said, of_bodies
from crosscheck.judging.faults.fault import Fault
from graphdyn import RobotModel

MOST_SUBSETS = 7
"""Largest number of joints for which every set of reversed axes is tried (2^n); beyond, single axes and all."""


def signs(model: RobotModel) -> Iterator[Fault]:
    own, names = torques(model), model.joint_names
    yield Fault("sign", "all torques have the opposite sign", "negate the result", lambda q, v, a: -own(q, v, a))
    yield from _reversed_axes(model, [[k] for k in range(model.n_bodies)])
    for k, name in enumerate(names):
        s = np.where(np.arange(model.n_bodies) == k, -1.0, 1.0)
        yield Fault(
            "sign",
            f"the torque of joint '{name}' has the opposite sign",
            "negate it",
            lambda q, v, a, s=s: s * own(q, v, a),  # type: ignore[misc]
        )
        yield Fault(
            "sign",
            f"the motion of joint '{name}' is taken with the opposite sign, its torque is not",
            "use one sense for motion and torque",
            lambda q, v, a, s=s: own(s * q, s * v, s * a),  # type: ignore[misc]
        )
    yield from of_bodies(
        model,
        "sign",
        "the products of inertia of {who} have the opposite sign",
        "a tensor holds I_xy = -∫xy dm; some programs print +∫xy dm",
        lambda body, _: dataclasses.replace(body, inertia=2 * np.diag(np.diag(body.inertia)) - body.inertia),
    )
    yield from of_bodies(
        model,
        "sign",
        "the center of mass of {who} lies on the other side of the link origin",
        "negate it",
        lambda body, _: dataclasses.replace(body, center_of_mass=-body.center_of_mass),
    )


def several_reversed_axes(model: RobotModel) -> Iterator[Fault]:
    """The axes of two and more joints at once; one alone is among the signs."""
    yield from _reversed_axes(model, _larger_sets(model.n_bodies))


def _reversed_axes(model: RobotModel, sets: Iterable[Sequence[int]]) -> Iterator[Fault]:
    own = torques(model)
    for joints in sets:
        s = np.where(np.isin(np.arange(model.n_bodies), joints), -1.0, 1.0)
        yield Fault(
            "sign",
            f"the axis of {joints_said(model, joints)} points the other way",
            "reverse the axis, or negate position, velocity, acceleration and torque of the joint",
            lambda q, v, a, s=s: s * own(s * q, s * v, s * a),  # type: ignore[misc]
        )


def _larger_sets(n: int) -> Iterator[tuple[int, ...]]:
    """Sets of two and more joints, small ones first."""
    for size in range(2, n + 1) if n <= MOST_SUBSETS else [n]:
        yield from itertools.combinations(range(n), size)
