"""Wrong centers of mass and tensors: axes, missing entries, exchanged bodies."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable, Iterator

import numpy as np

from crosscheck.judging.faults.changes import of_bodies, with_parameters
from crosscheck.judging.faults.fault import Fault
from graphdyn import Body, RobotModel
from graphdyn.layout import Array


def inertials(model: RobotModel) -> Iterator[Fault]:
    axes = "the inertial frame's rotation turns the tensor into link axes: R J Rᵀ"
    changes: tuple[tuple[str, Callable[[Body, Array], Body]], ...] = (
        ("the center of mass of {who} is expressed in the axes of the inside body", lambda b, r: _placed(b, r.T, None)),
        ("the center of mass of {who} is turned the wrong way", lambda b, r: _placed(b, r, None)),
        ("the tensor of {who} is expressed in the axes of the inside body", lambda b, r: _placed(b, None, r.T)),
        ("the tensor of {who} is turned the wrong way", lambda b, r: _placed(b, None, r)),
        (
            "center of mass and tensor of {who} are expressed in the axes of the inside body",
            lambda b, r: _placed(b, r.T, r.T),
        ),
        ("center of mass and tensor of {who} are turned the wrong way", lambda b, r: _placed(b, r, r)),
    )
    for message, change in changes:
        yield from of_bodies(model, "frame", message, axes, change)
    yield from of_bodies(
        model,
        "frame",
        "the tensor of {who} is taken in its principal axes as if they were the link axes",
        axes,
        lambda body, _: dataclasses.replace(body, inertia=np.diag(np.linalg.eigvalsh(body.inertia))),
    )
    yield from of_bodies(
        model,
        "inertial_parameters",
        "the products of inertia of {who} are left out",
        "use the full tensor",
        lambda body, _: dataclasses.replace(body, inertia=np.diag(np.diag(body.inertia))),
    )
    yield from of_bodies(
        model,
        "inertial_parameters",
        "the center of mass of {who} is taken at the link origin",
        "use the center of mass in the link frame",
        lambda body, _: dataclasses.replace(body, center_of_mass=np.zeros(3)),
    )
    pi = model.inertial_parameters.reshape(model.n_bodies, -1)
    for i, k in itertools.combinations(range(model.n_bodies), 2):
        order = list(range(model.n_bodies))
        order[i], order[k] = k, i
        yield Fault(
            "inertial_parameters",
            f"the inertial parameters of bodies '{model.body_names[i]}' and '{model.body_names[k]}' are exchanged",
            "assign them by name",
            with_parameters(model, pi[order].ravel()),
        )


def _placed(body: Body, center: Array | None, tensor: Array | None) -> Body:
    """Rotations applied to the center of mass and to the tensor."""
    return dataclasses.replace(
        body,
        center_of_mass=body.center_of_mass if center is None else center @ body.center_of_mass,
        inertia=body.inertia if tensor is None else tensor @ body.inertia @ tensor.T,
    )
