"""What the options of `graphdyn identify` say of the torque and of the methods: the torque models to compare."""

from __future__ import annotations

import inspect
from collections.abc import Iterable, Sequence
from itertools import chain
from typing import TYPE_CHECKING, Any, Literal

import typer

from crosscheck.commands.program.functions import user_function
from crosscheck.commands.program.recording_options import numbers

if TYPE_CHECKING:
    from graphdyn.identification import Estimator
    from graphdyn.identification.terms import KnownTerm, Term

FUNCTION_FORM = "FILE.py:NAME"

DEFAULT_TERMS = "viscous,coulomb,offset"

OF_A_METHOD = ("name", "reference", "assumptions", "needs", "estimate")


def drives_of(
    terms: Sequence[str], width: str | None, stribeck: tuple[str | None, str | None], further: Sequence[str] | None
) -> list[tuple[Term, ...]]:
    """What the drives add, for every --terms. Width, Stribeck velocity and exponent go to the terms that have them.

    Raises InvalidInput for unknown names, and where no model has a use for a number; typer.BadParameter for a wrong
    FILE.py:NAME.
    """
    from crosscheck.identifying import friction_terms
    from crosscheck.identifying.methods.torque_terms import settings_of

    named = [[] if text == "none" else [name.strip() for name in text.split(",")] for text in terms]
    own = tuple(made("--term", text, "columns", "rows") for text in further or ())
    velocity, exponent = stribeck
    numbers = {
        "width": ("width", _one_or_several("--width", width)),
        "stribeck_velocity": ("velocity", _one_or_several("--stribeck-velocity", velocity)),
        "stribeck_exponent": ("exponent", _one_or_several("--stribeck-exponent", exponent)),
    }

    def used(setting: str, names: Iterable[str]) -> bool:
        return any(setting in settings_of(name) for name in names)

    found = []
    for names in named:
        wanted = {
            option: value
            for option, (setting, value) in numbers.items()
            if used(setting, names) or not used(setting, chain(*named))
        }
        found.append(friction_terms(names, **wanted) + own)
    return found


def _one_or_several(option: str, text: str | None) -> float | list[float] | Literal["fit"] | None:
    if text is None or text == "fit":
        return text  # type: ignore[return-value]
    values = numbers(option, text)
    return values if len(values) > 1 else values[0]


def payload_of(text: str | None, link: str | None) -> tuple[list[Term], list[KnownTerm]]:
    """--payload as an unknown or as a known term. Raises typer.BadParameter."""
    import numpy as np

    from graphdyn.identification.terms import KnownPayload, Payload, PayloadMass
    from graphdyn.model import parameters_from_inertia

    if text is None:
        if link is not None:
            raise typer.BadParameter(f"--payload-on {link}: say with --payload what it carries")
        return [], []
    if text == "unknown":
        return [Payload(link)], []
    mass, at, place = text.partition("@")
    center = numbers("--payload", place) if at else []
    if len(center) != 3:
        raise typer.BadParameter(f"--payload {text}: give unknown, unknown@X,Y,Z or M@X,Y,Z [kg, m]")
    if mass == "unknown":
        return [PayloadMass(center, body=link)], []
    try:
        kilograms = float(mass)
    except ValueError:
        raise typer.BadParameter(f"--payload {text}: '{mass}' is neither unknown nor a mass in kg") from None
    return [], [KnownPayload(parameters_from_inertia(kilograms, np.array(center), np.zeros((3, 3))), link)]


def links(known: bool) -> tuple[list[Term], list[KnownTerm]]:
    """The rigid bodies as an unknown or as a known term."""
    from graphdyn.identification.terms import KnownBodies, RigidBodies

    return ([], [KnownBodies()]) if known else ([RigidBodies()], [])


def known_torques(texts: list[str] | None) -> list[KnownTerm]:
    """--known-torque. Raises typer.BadParameter for a wrong FILE.py:NAME."""
    from graphdyn.identification.terms import KnownTorque

    return [KnownTorque(user_function("--known-torque", text)) for text in texts or ()]  # type: ignore[arg-type]


def scaled_torques(texts: Sequence[str] | None) -> list[Term]:
    """--scaled-torque. Raises typer.BadParameter for a wrong FILE.py:NAME."""
    from graphdyn.identification.terms import ScaledTorque

    return [
        ScaledTorque(user_function("--scaled-torque", text), text.rpartition(":")[2])  # type: ignore[arg-type]
        for text in texts or ()
    ]


def method_shown(text: str) -> str:
    """--choose: the name in the table of a method that may be named as in --methods."""
    from crosscheck.identifying import ESTIMATORS, method_named

    return method_named(text).name if text in ESTIMATORS else text


def methods_of(text: str | None) -> list[str | Estimator]:
    """--methods. Raises InvalidInput for unknown names, typer.BadParameter for a wrong FILE.py:NAME."""
    from crosscheck.identifying import ESTIMATORS, STANDARD_METHODS, method_named

    if text is None:
        return list(STANDARD_METHODS)
    if text == "all":
        return list(ESTIMATORS)
    names = [name.strip() for name in text.split(",")]
    return [made("--methods", name, *OF_A_METHOD) if ":" in name else method_named(name) for name in names]


def made(option: str, text: str, *needed: str) -> Any:
    """What a user's function or class makes, without arguments.

    Raises typer.BadParameter where it takes some, or something that is needed is missing from what it makes.
    """
    function = user_function(option, text)
    try:
        inspect.signature(function).bind()
    except TypeError as error:
        raise typer.BadParameter(
            f"{option} {text}: {error}; give a function or class that is called without arguments and makes one"
        ) from None
    except ValueError:  # what is written in C may have no signature
        pass
    made: Any = function()
    missing = [name for name in needed if not hasattr(made, name)]
    if missing:
        raise typer.BadParameter(f"{option} {text}: what it makes has no {', '.join(missing)}")
    return made
