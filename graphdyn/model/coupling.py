"""Joints that others drive: gears, belts and parallelograms as q_j = Σ ratio q_k + offset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from graphlib import CycleError, TopologicalSorter
from numbers import Real

import numpy as np

from graphdyn.display import short_repr
from graphdyn.errors import InvalidModel
from graphdyn.layout import Array


@dataclass(frozen=True)
@short_repr
class Coupling:
    """The position of a joint as a sum of those of others: q_joint = Σ ratio q + offset.

    joint: name of the joint that is driven, and has no freedom of its own
    ratios: by the name of a driving joint; one that is driven itself is allowed [1, rad/m or m/rad]
    offset: [rad or m]

    Raises InvalidModel, naming the joint, without driving joints, and for numbers that are not finite or ratios of 0.
    """

    joint: str
    ratios: Mapping[str, float]
    offset: float = 0.0

    def __post_init__(self) -> None:
        who = f"coupling of joint '{self.joint}'"
        if not self.ratios:
            raise InvalidModel(f"{who}: no joint drives it; lock it at its offset instead")
        for what, number in (("offset", self.offset), *((f"ratio to '{name}'", x) for name, x in self.ratios.items())):
            if not isinstance(number, Real) or not np.isfinite(number):
                raise InvalidModel(f"{who}: {what} is {number!r}; give a finite number")
            if number == 0 and what != "offset":
                raise InvalidModel(f"{who}: {what} is 0; leave that joint out")
        object.__setattr__(self, "ratios", {name: float(x) for name, x in self.ratios.items()})


@dataclass(frozen=True, eq=False)
@short_repr
class DegreesOfFreedom:
    """What couplings leave free, and what they transmit.

    independent: numbers of the joints whose positions are q   (nv,)
    matrix, offset: K and o of (all joint positions) = K q + o   (n, nv), (n,)
    rows: B with B (all joint positions) = offsets: per coupling 1 at its joint and -ratio at those that drive it
    reactions: (n_couplings, n), from the torques that all joints need to what the couplings supply
    """

    independent: tuple[int, ...]
    matrix: Array
    offset: Array
    rows: Array
    reactions: Array


def degrees_of_freedom(who: str, joints: Sequence[str], couplings: Sequence[Coupling]) -> DegreesOfFreedom:
    """Degrees of freedom of joints with these names. Raises InvalidModel for unknown joints, one driven twice, and
    circles."""
    index, driven = {name: k for k, name in enumerate(joints)}, [coupling.joint for coupling in couplings]
    for coupling in couplings:
        for name in (coupling.joint, *coupling.ratios):
            if name not in index:
                raise InvalidModel(
                    f"{who}: the coupling of joint '{coupling.joint}' names joint '{name}', which it lacks"
                )
        if driven.count(coupling.joint) > 1:
            raise InvalidModel(
                f"{who}: joint '{coupling.joint}' is driven by more than one coupling; give their sum as one"
            )
    by_joint = {coupling.joint: coupling for coupling in couplings}
    try:
        order = list(
            TopologicalSorter({name: list(coupling.ratios) for name, coupling in by_joint.items()}).static_order()
        )
    except CycleError as error:
        raise InvalidModel(f"{who}: joints drive each other in a circle: {' → '.join(error.args[1])}") from error
    independent = tuple(k for k, name in enumerate(joints) if name not in by_joint)
    if not independent:
        raise InvalidModel(f"{who}: all joints are driven; one must be free")
    matrix, offset = np.zeros((len(joints), len(independent))), np.zeros(len(joints))
    matrix[list(independent), range(len(independent))] = 1.0
    for name in order:
        if name in by_joint:
            ratios = by_joint[name].ratios.items()
            matrix[index[name]] = sum(ratio * matrix[index[other]] for other, ratio in ratios)
            offset[index[name]] = by_joint[name].offset + sum(ratio * offset[index[other]] for other, ratio in ratios)
    rows, of_driven = np.zeros((len(couplings), len(joints))), [index[name] for name in driven]
    for row, coupling in zip(rows, couplings, strict=True):
        row[index[coupling.joint]] = 1.0
        for other, ratio in coupling.ratios.items():
            row[index[other]] = -ratio
    reactions = np.zeros_like(rows)
    reactions[:, of_driven] = np.linalg.inv(rows[:, of_driven]).T
    for array in (matrix, offset, rows, reactions):
        array.setflags(write=False)
    return DegreesOfFreedom(independent, matrix, offset, rows, reactions)
