"""Torque terms of the drives (friction, rotor inertia, …), by the names of the program."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Sequence
from typing import Any

from numpy.typing import ArrayLike

from graphdyn import InvalidInput
from graphdyn.identification.terms import (
    AsymmetricCoulomb,
    AsymmetricViscous,
    Coulomb,
    CoupledWrist,
    LoadFriction,
    Offset,
    RotorInertia,
    SmoothCoulomb,
    Stribeck,
    Term,
    Viscous,
)

STRIBECK_VELOCITY = 0.1
"""Default Stribeck velocity of a gear [rad/s or m/s]."""

STANDARD_TERMS = ("viscous", "coulomb", "offset")

TERMS: dict[str, Callable[..., Term]] = {
    "viscous": Viscous,
    "asymmetric-viscous": AsymmetricViscous,
    "coulomb": Coulomb,
    "asymmetric-coulomb": AsymmetricCoulomb,
    "stribeck": lambda velocity=STRIBECK_VELOCITY, exponent=2.0, width=None: Stribeck(velocity, exponent, width),
    "load": LoadFriction,
    "smooth-coulomb": SmoothCoulomb,
    "offset": Offset,
    "rotor": RotorInertia,
    "coupled-wrist": CoupledWrist,
}
"""By name: a function that returns the term; its keywords are the settings of the term."""


def settings_of(name: str) -> tuple[str, ...]:
    """The settings of the term with this name. Raises InvalidInput for an unknown name."""
    if name not in TERMS:
        raise InvalidInput(f"there is no term '{name}'; known: {', '.join(TERMS)}")
    return tuple(inspect.signature(TERMS[name]).parameters)


WITH_WIDTH, WITH_VELOCITY = (
    tuple(name for name in TERMS if setting in settings_of(name)) for setting in ("width", "velocity")
)
"""Terms with a sign of v, and with a Stribeck velocity."""


def term_with(term: str, **settings: Any) -> Term:
    """The term of this name (TERMS) with settings. Raises InvalidInput for a name or a setting that does not exist."""
    known = settings_of(term)
    for setting in settings:
        if setting not in known:
            raise InvalidInput(f"the term '{term}' has no setting '{setting}'; it has: {', '.join(known) or 'none'}")
    return TERMS[term](**settings)


def friction_terms(
    names: Sequence[str], *, width: ArrayLike | None = None, stribeck_velocity: ArrayLike | None = None
) -> tuple[Term, ...]:
    """The terms with these names (TERMS), in their order.

    width: sign(v) becomes tanh(v / width), one for all joints or one each [rad/s or m/s]
    stribeck_velocity: speed at which Stribeck friction fades, STRIBECK_VELOCITY unless given [rad/s or m/s]

    Raises InvalidInput for an unknown or a repeated name, and for a width or a velocity that none of the terms has.
    """
    for k, name in enumerate(names):
        settings_of(name)
        if name in names[:k]:
            raise InvalidInput(f"the term '{name}' is given twice; give each once")
    given = {"width": (width, WITH_WIDTH, "width"), "velocity": (stribeck_velocity, WITH_VELOCITY, "Stribeck velocity")}
    for value, users, what in given.values():
        if value is not None and not set(names) & set(users):
            raise InvalidInput(
                f"a {what} is given, but none of the terms ({', '.join(names) or 'none'}) has one; "
                f"leave it out, or take one of: {', '.join(users)}"
            )
    settings = {key: (value, users) for key, (value, users, _) in given.items() if value is not None}
    return tuple(
        term_with(name, **{key: value for key, (value, users) in settings.items() if name in users}) for name in names
    )
