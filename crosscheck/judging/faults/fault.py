"""A fault of a dynamics code, and a family of faults whose numbers are fitted."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from crosscheck.judging.faults.recursion import DynamicsCode
from crosscheck.judging.judgment import FittedNumber
from graphdyn.layout import Array

Change = Callable[[DynamicsCode], DynamicsCode]

FAULT_KINDS = (
    *("gravity", "coriolis", "sign", "joint_order", "argument", "frame", "geometry", "zero", "gear", "coupling"),
    *("inertia_point", "inertial_parameters", "unit", "continuous_joint", "inertial_frame", "fixed_link"),
    *("massless_link", "rounding", "friction", "spring", "offset", "rotor_inertia", "clipped"),
)
"""Kinds of the faults, in the order in which those that fit alike and change as many numbers are told."""


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
    """One fault, and how a code is changed that gets it."""

    said: FaultDescription
    change: Change

    @classmethod
    def of(cls, kind: str, message: str, remedy: str, change: Change, size: int = 1) -> CodeFault:
        return cls(FaultDescription(kind, message, remedy, size), change)


@dataclass(frozen=True, eq=False)
class Family:
    """Faults that differ by p numbers, which are fitted.

    right: numbers without a fault (p,); starts: where fits begin (S, p), the best of them is taken
    change: (code, numbers) → code, differentiable, of complex numbers too
    say: numbers → what is wrong, one entry for each fault that they are
    """

    right: Array
    change: Callable[[DynamicsCode, Array], DynamicsCode]
    say: Callable[[Array], list[FaultDescription]]
    starts: Array | None = None
