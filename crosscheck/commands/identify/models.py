"""What the options of `graphdyn identify` say of the torque and of the methods: the torque models to compare.

The file of --models has a table for each, with terms, known torques and methods:

    [gears]
    terms = ["viscous", {term = "coulomb", width = 0.05}, "offset", "drives.py:Spring"]
    methods = ["wls", "consistent", {method = "pullback", strength = 1e6}]
    known_torques = ["drives.py:counterbalance"]
    scaled_torques = ["drives.py:spring"]
    known_bodies = false
    expected = {IA_3 = [764, 80]}
    noise = [40, 60, 60, 10, 10, 8]

Files are looked up beside the TOML file.
"""

from __future__ import annotations

import inspect
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import typer

from crosscheck.commands.program.functions import user_function
from crosscheck.commands.program.recording_options import numbers
from graphdyn import InvalidInput

if TYPE_CHECKING:
    from crosscheck.identifying import CandidateModel
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


def methods_of(text: str | None, *, of_sums: bool) -> list[str | Estimator]:
    """--methods. Raises InvalidInput for unknown names, typer.BadParameter for a wrong FILE.py:NAME.

    of_sums: without names, those that need no more than sums
    """
    from crosscheck.identifying import (
        ESTIMATORS,
        METHODS_OF_SUMS,
        STANDARD_METHODS,
        STANDARD_METHODS_OF_SUMS,
        method_named,
    )

    if text is None:
        return list(STANDARD_METHODS_OF_SUMS if of_sums else STANDARD_METHODS)
    if text == "all":
        return list(METHODS_OF_SUMS if of_sums else ESTIMATORS)
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


MODEL_FILE_KEYS = ("terms", "methods", "known_torques", "scaled_torques", "known_bodies", "expected", "noise")


def models_of(
    file: Path, methods: Sequence[str | Estimator], load: Sequence[Term], known: Sequence[KnownTerm], known_bodies: bool
) -> list[CandidateModel]:
    """The torque models of a file, in its order.

    methods, known_bodies: for models that do not say; load, known: payload and known torques of all models

    Raises typer.BadParameter, naming file, table and entry.
    """
    from crosscheck.identifying import CandidateModel

    try:
        tables = tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise typer.BadParameter(f"--models {file}: {error}") from error
    if not tables:
        raise typer.BadParameter(f"--models {file}: the file has no table; give one per torque model, such as [gears]")
    found = []
    for name, table in tables.items():
        where = f"--models {file}: [{name}]"
        _check(where, table)
        bodies, known_links = links(_flag(f"{where} known_bodies", table.get("known_bodies", known_bodies)))
        own, scaled = (
            [_beside(file, text) for text in _names(where, table, key)] for key in ("known_torques", "scaled_torques")
        )
        drives = [_made("term", where, file, entry) for entry in _entries(where, table, "terms")]
        chosen = [_made("method", where, file, entry) for entry in _entries(where, table, "methods")] or methods
        subtracted = (*known_links, *known, *known_torques(own))
        terms = (*bodies, *load, *drives, *scaled_torques(scaled))
        expected = _expected(f"{where} expected", table.get("expected", {}))
        found.append(CandidateModel(name, terms, subtracted, chosen, expected=expected, noise=table.get("noise")))
    return found


def _check(where: str, table: object) -> None:
    if not isinstance(table, dict):
        raise typer.BadParameter(f"{where} is no table; give one per torque model, such as [gears]")
    unknown = [key for key in table if key not in MODEL_FILE_KEYS]
    if unknown:
        raise typer.BadParameter(f"{where} {unknown[0]}: unknown; a torque model has {', '.join(MODEL_FILE_KEYS)}")
    if "terms" not in table:
        raise typer.BadParameter(f"{where}: terms are missing; give a list, which may be empty")


def _flag(where: str, value: object) -> bool:
    if not isinstance(value, bool):
        raise typer.BadParameter(f"{where} is {value!r}; give true or false")
    return value


def _expected(where: str, table: object) -> dict[str, tuple[float, float]]:
    """Value and standard deviation by symbol."""
    if not isinstance(table, dict):
        raise typer.BadParameter(f"{where} is {table!r}; give SYMBOL = [value, standard deviation]")
    for symbol, pair in table.items():
        numbers = isinstance(pair, list) and len(pair) == 2 and all(type(x) in (int, float) for x in pair)
        if not numbers:
            raise typer.BadParameter(f"{where} {symbol} is {pair!r}; give [value, standard deviation]")
    return {symbol: (float(value), float(deviation)) for symbol, (value, deviation) in table.items()}


def _entries(where: str, table: Mapping[str, Any], key: str) -> list[str | dict[str, Any]]:
    entries = table.get(key, [])
    if not isinstance(entries, list) or not all(isinstance(entry, str | dict) for entry in entries):
        raise typer.BadParameter(f"{where} {key} is {entries!r}; give a list of names")
    return entries


def _names(where: str, table: Mapping[str, Any], key: str) -> list[str]:
    entries = _entries(where, table, key)
    if not all(isinstance(entry, str) for entry in entries):
        raise typer.BadParameter(f"{where} {key} is {entries!r}; give a list of FILE.py:NAME")
    return [str(entry) for entry in entries]


def _made(kind: str, where: str, file: Path, entry: str | dict[str, Any]) -> Any:
    """kind: term or method"""
    from crosscheck.identifying import method_with, term_with

    if isinstance(entry, str) and ":" in entry:
        return made("--models", _beside(file, entry), *(("columns", "rows") if kind == "term" else OF_A_METHOD))
    given = {kind: entry} if isinstance(entry, str) else entry
    if kind not in given:
        raise typer.BadParameter(f"{where}: {entry} names no {kind}; write {{{kind} = NAME, …}}")
    try:
        return (term_with if kind == "term" else method_with)(**given)
    except (InvalidInput, TypeError, ValueError) as error:
        raise typer.BadParameter(f"{where} {kind} {given[kind]}: {error}") from error


def _beside(file: Path, text: str) -> str:
    """FILE.py:NAME with the file beside the TOML file; MODULE:NAME as it is."""
    place, colon, name = text.rpartition(":")
    return f"{file.parent / place}{colon}{name}" if place.endswith(".py") else text
