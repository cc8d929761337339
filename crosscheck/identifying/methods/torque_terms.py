"""Torque terms of the drives (friction, rotor inertia, …), by the names of the program."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Literal

from numpy.typing import ArrayLike

from graphdyn import InvalidInput
from graphdyn.identification import Tunable
from graphdyn.identification.terms import (
    DEFLECTION,
    AsymmetricCoulomb,
    AsymmetricViscous,
    Coulomb,
    CoupledWrist,
    Drift,
    LoadFriction,
    MaxwellSlip,
    Offset,
    RotorInertia,
    SmoothCoulomb,
    Spring,
    Stribeck,
    Term,
    Viscous,
)

STRIBECK_VELOCITY = 0.1
"""Default Stribeck velocity of a gear [rad/s or m/s]."""

STANDARD_TERM_NAMES = ("viscous", "coulomb", "offset")


def _slip(deflection: ArrayLike | None = None, deflections: Sequence[ArrayLike] | None = None) -> Term:
    if deflection is not None and deflections is not None:
        raise InvalidInput("the term 'slip' has a deflection, and deflections; give one of the two")
    return MaxwellSlip(((DEFLECTION if deflection is None else deflection),) if deflections is None else deflections)


TERMS: dict[str, Callable[..., Term]] = {
    "viscous": Viscous,
    "asymmetric-viscous": AsymmetricViscous,
    "coulomb": Coulomb,
    "asymmetric-coulomb": AsymmetricCoulomb,
    "stribeck": lambda velocity=STRIBECK_VELOCITY, exponent=2.0, width=None: Stribeck(velocity, exponent, width),
    "load": LoadFriction,
    "smooth-coulomb": SmoothCoulomb,
    "slip": _slip,
    "offset": Offset,
    "rotor": RotorInertia,
    "spring": Spring,
    "coupled-wrist": CoupledWrist,
}
"""Functions that return a term, by its name; their keywords are the settings of the term."""

FIT_SETTING = "fit"
"""Value of a setting that is to be found, one number for each joint."""

SEARCH_STARTS = {"width": 0.05, "velocity": STRIBECK_VELOCITY, "exponent": 2.0, "deflection": DEFLECTION}
"""Settings that can be found, with the initial values of the search."""

DRIFT_VARIABLES = ("time", "temperature")
"""Variables of a term's drift, as in viscous*temperature."""


Setting = ArrayLike | Literal["fit"] | None


def settings_of(name: str) -> tuple[str, ...]:
    """The settings of the term with this name. Raises InvalidInput for an unknown name."""
    own, star, over = name.partition("*")
    if own not in TERMS or (star and over not in DRIFT_VARIABLES):
        drifts = " and ".join(f"NAME*{over}" for over in DRIFT_VARIABLES)
        raise InvalidInput(f"there is no term '{name}'; known: {', '.join(TERMS)}, and {drifts} of these")
    return (*inspect.signature(TERMS[own]).parameters, *(("reference",) if star else ()))


def with_setting(setting: str) -> tuple[str, ...]:
    """The terms that have this setting."""
    return tuple(name for name in TERMS if setting in settings_of(name))


def term_with(term: str, **settings: Any) -> Term:
    """The term of this name (TERMS) with settings; if one of them is "fit", the term is a Tunable.

    Raises InvalidInput for a name or a setting that does not exist, or that cannot be found.
    """
    known = settings_of(term)
    for setting in settings:
        if setting not in known:
            raise InvalidInput(f"the term '{term}' has no setting '{setting}'; it has: {', '.join(known) or 'none'}")
    searched = [setting for setting, value in settings.items() if isinstance(value, str) and value == FIT_SETTING]
    if searched:
        return _tunable(term, searched, {name: value for name, value in settings.items() if name not in searched})
    own, star, over = term.partition("*")
    if not star:
        return TERMS[own](**settings)
    reference = settings.pop("reference", 0.0)
    return Drift(TERMS[own](**settings), "time" if over == "time" else "temperature", reference)


def _tunable(term: str, searched: Sequence[str], given: Mapping[str, Any]) -> Tunable:
    for setting in searched:
        if setting not in SEARCH_STARTS:
            raise InvalidInput(
                f"the setting '{setting}' cannot be found by a fit; these can: {', '.join(SEARCH_STARTS)}"
            )
    start = {setting: SEARCH_STARTS[setting] for setting in searched}
    term_with(term, **given, **start)  # refuses settings that do not go together
    return Tunable(term, lambda **found: term_with(term, **given, **found), start)


def friction_terms(
    names: Sequence[str],
    *,
    width: Setting = None,
    stribeck_velocity: Setting = None,
    stribeck_exponent: Setting = None,
) -> tuple[Term, ...]:
    """The terms with these names (TERMS), in their order.

    Each of the settings may be "fit", to be found together with the parameters (graphdyn.identification.tuned).

    width: sign(v) becomes tanh(v / width), one for all joints or one each [rad/s or m/s]
    stribeck_velocity: speed at which Stribeck friction fades, STRIBECK_VELOCITY unless given [rad/s or m/s]
    stribeck_exponent: exponent of the fading, 2 unless given

    Raises InvalidInput for an unknown or a repeated name, and for a setting that none of the terms has.
    """
    for k, name in enumerate(names):
        settings_of(name)
        if name in names[:k]:
            raise InvalidInput(f"the term '{name}' is given twice; give each once")
    given = {"width": width, "velocity": stribeck_velocity, "exponent": stribeck_exponent}
    settings = {setting: value for setting, value in given.items() if value is not None}
    for setting in settings:
        if not any(setting in settings_of(name) for name in names):
            what = setting if setting == "width" else f"Stribeck {setting}"
            raise InvalidInput(
                f"a {what} is given, but none of the terms ({', '.join(names) or 'none'}) has one; "
                f"leave it out, or take one of: {', '.join(with_setting(setting))}"
            )
    return tuple(
        term_with(name, **{setting: value for setting, value in settings.items() if setting in settings_of(name)})
        for name in names
    )
