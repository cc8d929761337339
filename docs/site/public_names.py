"""The public names of the three packages, as their `__all__` say."""

from __future__ import annotations

import importlib
import inspect
import warnings
from functools import cache
from typing import get_origin

import rooms

FOR_USERS = {
    "graphdyn": "Models, dynamics, recordings",
    "graphdyn.motion_laws": "Prescribed motions",
    "graphdyn.layout": "Rows and columns of stacked vectors",
    "graphdyn.excitation": "Exciting motions",
    "graphdyn.identification": "Identification",
    "graphdyn.identification.terms": "Terms of the torque",
    "graphdyn.identification.data_quality": "Data quality of recordings",
    "graphdyn.identification.currents": "Loads and gains from currents",
    "graphdyn.aligning": "Two descriptions of one robot",
    "graphdyn.export": "Code to take along",
    "graphdyn.export.casadi": "Functions for CasADi",
    "graphdyn.export.jax": "Functions for JAX",
    "urdf": "URDF files",
    "crosscheck": "Cross-check, judge, recordings, identification from files",
    "crosscheck.identifying": "Options of an identification from files",
}
"""The modules with public names, and a title for the page of each."""

TO_EXTEND = {
    "graphdyn.model": "Parts of a model, rotations, inertias",
    "graphdyn.arguments": "Arguments of the verbs",
    "graphdyn.equations": "The equations",
    "graphdyn.verbs": "How verbs are declared",
    "graphdyn.recursions": "How recursions are declared",
    "graphdyn.scalars": "Recorded scalars",
    "graphdyn.compiler": "From programs to machine code",
    "graphdyn.experiments": "Virtual experiments",
    "graphdyn.identification.closed_loop": "Simulated control loops",
    "urdf.document": "URDF documents",
    "urdf.reading": "Stages of reading",
    "urdf.writing": "Stages of writing",
}
"""The rooms whose names other packages use, for people who extend the program."""

MODULES = FOR_USERS | TO_EXTEND


@cache
def public_names(module: str) -> list[str]:
    """`__all__` without modules, or without one what the module itself defines and does not mark as private."""
    loaded = importlib.import_module(module)
    if hasattr(loaded, "__all__"):
        return sorted(name for name in loaded.__all__ if not inspect.ismodule(getattr(loaded, name)))
    return sorted(
        name
        for name, value in vars(loaded).items()
        if not name.startswith("_") and getattr(value, "__module__", None) == module and callable(value)
    )


@cache
def value_of(module: str, name: str) -> object:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return getattr(importlib.import_module(module), name)


def everything() -> dict[str, object]:
    """What every public name stands for, by full name."""
    return {f"{module}.{name}": value_of(module, name) for module in MODULES for name in public_names(module)}


def home(module: str, name: str) -> str:
    """Full name under which it is documented: of the first module that has the same object under the same name."""
    value = value_of(module, name)
    homes = (other for other in MODULES if name in public_names(other) and value_of(other, name) is value)
    return f"{next(homes)}.{name}"


def room_of(module: str, name: str) -> str:
    """The room of a public module that defines a name; empty where it is defined elsewhere, or in the module itself."""
    value = value_of(module, name)
    defined = getattr(value, "__module__", None) or ""
    if defined.startswith(f"{module}."):
        return defined.removeprefix(f"{module}.").partition(".")[0]
    found = (room for room in rooms.rooms(module) if _offers(f"{module}.{room}", name, value))
    return next(found, "") if kind_of(value) == "data" else ""


def _offers(module: str, name: str, value: object) -> bool:
    return getattr(importlib.import_module(module), name, None) is value


def kind_of(value: object) -> str:
    """function, class, exception or data, as which the types Literal[…] and Callable[…] count."""
    if get_origin(value) is not None:
        return "data"
    if inspect.isclass(value):
        return "exception" if issubclass(value, BaseException) else "class"
    return "function" if callable(value) else "data"


def links() -> dict[str, str]:
    """Full name of every public error and warning, by its short name; that of the lowest package where two share it."""
    found: dict[str, str] = {}
    for full, value in everything().items():
        if kind_of(value) == "exception":
            found.setdefault(full.rpartition(".")[2], full)
    return found
