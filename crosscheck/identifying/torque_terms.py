"""Torque terms of the drives (friction, rotor inertia, …), by the names of the program."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from numpy.typing import ArrayLike

from graphdyn import InvalidInput
from graphdyn.identification.terms import (
    AsymmetricCoulomb,
    AsymmetricViscous,
    Coulomb,
    CoupledWrist,
    Offset,
    RotorInertia,
    Stribeck,
    Term,
    Viscous,
)

STRIBECK_VELOCITY = 0.1
"""Default Stribeck velocity of a gear [rad/s or m/s]."""

STANDARD_TERMS = ("viscous", "coulomb", "offset")

WITH_WIDTH, WITH_VELOCITY = ("coulomb", "asymmetric-coulomb", "stribeck", "coupled-wrist"), ("stribeck",)
"""Terms with a sign of v, and with a Stribeck velocity."""

TERMS: dict[str, Callable[[float | None, ArrayLike], Term]] = {
    "viscous": lambda width, velocity: Viscous(),
    "asymmetric-viscous": lambda width, velocity: AsymmetricViscous(),
    "coulomb": lambda width, velocity: Coulomb(width),
    "asymmetric-coulomb": lambda width, velocity: AsymmetricCoulomb(width),
    "stribeck": lambda width, velocity: Stribeck(velocity, width=width),
    "offset": lambda width, velocity: Offset(),
    "rotor": lambda width, velocity: RotorInertia(),
    "coupled-wrist": lambda width, velocity: CoupledWrist(width=width),
}
"""By name: a function of the width of the smooth sign and the Stribeck velocity that returns the term."""


def friction_terms(
    names: Sequence[str], *, width: float | None = None, stribeck_velocity: ArrayLike | None = None
) -> tuple[Term, ...]:
    """The terms with these names (TERMS), in their order.

    width: sign(v) becomes tanh(v / width) [rad/s or m/s]
    stribeck_velocity: speed at which Stribeck friction fades, STRIBECK_VELOCITY unless given [rad/s or m/s]

    Raises InvalidInput for an unknown or a repeated name, and for a width or a velocity that none of the terms has.
    """
    for k, name in enumerate(names):
        if name not in TERMS:
            raise InvalidInput(f"there is no term '{name}'; known: {', '.join(TERMS)}")
        if name in names[:k]:
            raise InvalidInput(f"the term '{name}' is given twice; give each once")
    for what, value, users in (
        ("width", width, WITH_WIDTH),
        ("Stribeck velocity", stribeck_velocity, WITH_VELOCITY),
    ):
        if value is not None and not set(names) & set(users):
            raise InvalidInput(
                f"a {what} is given, but none of the terms ({', '.join(names) or 'none'}) has one; "
                f"leave it out, or take one of: {', '.join(users)}"
            )
    velocity = STRIBECK_VELOCITY if stribeck_velocity is None else stribeck_velocity
    return tuple(TERMS[name](width, velocity) for name in names)
