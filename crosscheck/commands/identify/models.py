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

Files of Python code are looked up beside the TOML file, and run with --allow-code alone, after all else in it is valid.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import typer

from crosscheck.commands.program.functions import user_function
from crosscheck.commands.program.recording_options import numbers
from crosscheck.user_code import refuse_code
from graphdyn import InvalidInput
from urdf.document import toml_document

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
    from urdf.document import finite_number

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
    kilograms = finite_number(mass)
    if kilograms is None:
        raise typer.BadParameter(f"--payload {text}: '{mass}' is neither unknown nor a mass in kg")
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


def methods_of(text: str | None, *, of_sums: bool, wrenches: bool) -> list[str | Estimator]:
    """--methods. Raises InvalidInput for unknown names, typer.BadParameter for a wrong FILE.py:NAME.

    of_sums: without names, those that need no more than sums
    wrenches: whether there are some; without names, methods that need them are left out where there are none
    """
    from crosscheck.identifying import (
        ESTIMATORS,
        METHODS_OF_SUMS,
        STANDARD_METHODS,
        STANDARD_METHODS_OF_SUMS,
        method_named,
        without_wrenches,
    )

    if text is None or text == "all":
        of_all = METHODS_OF_SUMS if of_sums else ESTIMATORS
        names = list(of_all if text else STANDARD_METHODS_OF_SUMS if of_sums else STANDARD_METHODS)
        return list(names if wrenches else without_wrenches(names))
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
    file: Path,
    methods: Sequence[str | Estimator],
    load: Sequence[Term],
    known: Sequence[KnownTerm],
    *,
    known_bodies: bool,
    allow_code: bool,
) -> list[CandidateModel]:
    """The torque models of a file, in its order.

    methods, known_bodies: for models that do not say; load, known: payload and known torques of all models
    allow_code: run the Python code that the file names, once all else in it is valid

    Raises typer.BadParameter, naming file, table and entry.
    """
    from crosscheck.identifying import CandidateModel

    try:
        tables = toml_document(file.read_bytes())
    except (OSError, ValueError) as error:
        raise typer.BadParameter(f"--models {file}: {error}") from error
    if not tables:
        raise typer.BadParameter(f"--models {file}: the file has no table; give one per torque model, such as [gears]")
    named = list[str]()

    def read(run: Callable[[Callable[[], Any]], list[Any]]) -> list[CandidateModel]:
        found = []
        for name, table in tables.items():
            own = _ModelTable(f"--models {file}: [{name}]", file.parent, table, run, named)
            bodies, known_links = links(own.flag("known_bodies", known_bodies))
            subtracted = (*known_links, *known, *own.torques("known_torques", known_torques))
            terms = (*bodies, *load, *own.made("term"), *own.torques("scaled_torques", scaled_torques))
            chosen = own.made("method") or methods
            expected = _expected(f"{own.where} expected", table.get("expected", {}))
            found.append(CandidateModel(name, terms, subtracted, chosen, expected=expected, noise=table.get("noise")))
        return found

    found = read(lambda code: [])
    if not named:
        return found
    try:
        refuse_code(f"--models {file}", named, allow_code)
    except InvalidInput as error:
        raise typer.BadParameter(str(error)) from None
    return read(lambda code: [code()])


@dataclass(frozen=True)
class _ModelTable:
    """One table of the file.

    where: for messages; folder: of the file
    run: what stands in place of code: nothing, or what the code makes
    named: collects every place of Python code
    """

    where: str
    folder: Path
    table: Mapping[str, Any]
    run: Callable[[Callable[[], Any]], list[Any]]
    named: list[str]

    def __post_init__(self) -> None:
        _check(self.where, self.table)

    def flag(self, key: str, default: bool) -> bool:
        value = self.table.get(key, default)
        if not isinstance(value, bool):
            raise typer.BadParameter(f"{self.where} {key} is {value!r}; give true or false")
        return value

    def entries(self, key: str) -> list[str | dict[str, Any]]:
        entries = self.table.get(key, [])
        if not isinstance(entries, list) or not all(isinstance(entry, str | dict) for entry in entries):
            raise typer.BadParameter(f"{self.where} {key} is {entries!r}; give a list of names")
        return entries

    def code(self, text: str, run: Callable[[str], Any]) -> list[Any]:
        """What `run` makes of a place of Python code, FILE.py:NAME beside the file."""
        self.named.append(text)
        place, colon, name = text.rpartition(":")
        return self.run(lambda: run(f"{self.folder / place}{colon}{name}"))

    def torques(self, key: str, read: Callable[[list[str]], list[Any]]) -> list[Any]:
        entries = self.entries(key)
        if not all(isinstance(entry, str) for entry in entries):
            raise typer.BadParameter(f"{self.where} {key} is {entries!r}; give a list of FILE.py:NAME")
        return [one for entry in entries for found in self.code(str(entry), lambda text: read([text])) for one in found]

    def made(self, kind: Literal["term", "method"]) -> list[Any]:
        """Terms or methods."""
        return [one for entry in self.entries(f"{kind}s") for one in self._one(kind, entry)]

    def _one(self, kind: Literal["term", "method"], entry: str | dict[str, Any]) -> list[Any]:
        from crosscheck.identifying import method_with, term_with

        if isinstance(entry, str) and ":" in entry:
            needed = ("columns", "rows") if kind == "term" else OF_A_METHOD
            return self.code(entry, lambda text: made("--models", text, *needed))
        given: dict[str, Any] = {kind: entry} if isinstance(entry, str) else entry
        if kind not in given:
            raise typer.BadParameter(f"{self.where}: {entry} names no {kind}; write {{{kind} = NAME, …}}")
        try:
            return [(term_with if kind == "term" else method_with)(**given)]
        except (InvalidInput, TypeError, ValueError) as error:
            raise typer.BadParameter(f"{self.where} {kind} {given[kind]}: {error}") from error


def _check(where: str, table: object) -> None:
    if not isinstance(table, dict):
        raise typer.BadParameter(f"{where} is no table; give one per torque model, such as [gears]")
    unknown = [key for key in table if key not in MODEL_FILE_KEYS]
    if unknown:
        raise typer.BadParameter(f"{where} {unknown[0]}: unknown; a torque model has {', '.join(MODEL_FILE_KEYS)}")
    if "terms" not in table:
        raise typer.BadParameter(f"{where}: terms are missing; give a list, which may be empty")


def _expected(where: str, table: object) -> dict[str, tuple[float, float]]:
    """Value and standard deviation by symbol."""
    if not isinstance(table, dict):
        raise typer.BadParameter(f"{where} is {table!r}; give SYMBOL = [value, standard deviation]")
    for symbol, pair in table.items():
        numbers = isinstance(pair, list) and len(pair) == 2 and all(type(x) in (int, float) for x in pair)
        if not numbers:
            raise typer.BadParameter(f"{where} {symbol} is {pair!r}; give [value, standard deviation]")
    return {symbol: (float(value), float(deviation)) for symbol, (value, deviation) in table.items()}
