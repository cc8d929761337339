"""--models FILE.toml: torque models to compare, each a table with terms, known torques and methods.

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

import tomllib
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from crosscheck.commands.identify.models import OF_A_METHOD, known_torques, links, made, scaled_torques
from graphdyn import InvalidInput

if TYPE_CHECKING:
    from crosscheck.identifying import CandidateModel
    from graphdyn.identification import Estimator
    from graphdyn.identification.terms import KnownTerm, Term

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
        drives = [_term(where, file, entry) for entry in _entries(where, table, "terms")]
        chosen = [_method(where, file, entry) for entry in _entries(where, table, "methods")] or methods
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


def _term(where: str, file: Path, entry: str | dict[str, Any]) -> Any:
    from crosscheck.identifying import term_with

    if isinstance(entry, str) and ":" in entry:
        return made("--models", _beside(file, entry), "columns", "rows")
    return _called(term_with, where, "term", entry)


def _method(where: str, file: Path, entry: str | dict[str, Any]) -> Any:
    from crosscheck.identifying import method_with

    if isinstance(entry, str) and ":" in entry:
        return made("--models", _beside(file, entry), *OF_A_METHOD)
    return _called(method_with, where, "method", entry)


def _called(make: Callable[..., Any], where: str, kind: str, entry: str | dict[str, Any]) -> Any:
    given = {kind: entry} if isinstance(entry, str) else entry
    if kind not in given:
        raise typer.BadParameter(f"{where}: {entry} names no {kind}; write {{{kind} = NAME, …}}")
    try:
        return make(**given)
    except (InvalidInput, TypeError, ValueError) as error:
        raise typer.BadParameter(f"{where} {kind} {given[kind]}: {error}") from error


def _beside(file: Path, text: str) -> str:
    """FILE.py:NAME with the file beside the TOML file; MODULE:NAME as it is."""
    place, colon, name = text.rpartition(":")
    return f"{file.parent / place}{colon}{name}" if place.endswith(".py") else text
