"""Models of the drives that the ladder tries: friction curves, load, memory, rotors and offsets, combined."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, NamedTuple

from crosscheck.identifying.methods.torque_terms import term_with
from graphdyn import RobotModel
from graphdyn.identification.terms import Term

Entry = Mapping[str, Any]
"""A term with its settings, as in a table of torque models: {"term": "coulomb", "width": 0.05}."""

VISCOUS: Entry = {"term": "viscous"}

CURVES: dict[str, tuple[Entry, ...]] = {
    "Coulomb": ({"term": "coulomb"},),
    "Coulomb, width 0.05": ({"term": "coulomb", "width": 0.05},),
    "Stribeck, velocity 0.05": ({"term": "coulomb"}, {"term": "stribeck", "velocity": 0.05}),
    "Stribeck, velocity 0.15": ({"term": "coulomb"}, {"term": "stribeck", "velocity": 0.15}),
    "Stribeck, velocity 0.5": ({"term": "coulomb"}, {"term": "stribeck", "velocity": 0.5}),
    "smooth": ({"term": "smooth-coulomb", "widths": [0.02, 0.1, 1.0]},),
}
"""Friction over velocity [rad/s or m/s], from the simplest on. The smooth curve is any that saturates: stiction, a
falling part, and viscous friction that grows more slowly than the velocity."""

LOADS: dict[str, tuple[Entry, ...]] = {"": (), "load": ({"term": "load", "width": 0.1},)}

MEMORIES: dict[str, tuple[Entry, ...]] = {
    "": (),
    **{f"slip, {d:g}": ({"term": "slip", "deflection": d},) for d in (0.003, 0.01, 0.03)},
}
"""Deflections of the springs before they slip [rad or m]: a sixth of a degree to two degrees."""

ROTORS: dict[str, tuple[Entry, ...]] = {"": (), "rotors": ({"term": "rotor"},)}

COUPLINGS: dict[str, tuple[Entry, ...]] = {"": (), "coupled wrist": ({"term": "coupled-wrist", "width": 0.05},)}
"""The motor of the last axis moves the one before it, too."""

OFFSETS: dict[str, tuple[Entry, ...]] = {"": (), "offsets": ({"term": "offset"},)}

CHOICES = {
    "curve": CURVES,
    "load": LOADS,
    "memory": MEMORIES,
    "rotors": ROTORS,
    "coupling": COUPLINGS,
    "offsets": OFFSETS,
}
"""The alternatives for each part of a model of the drives."""


@dataclass(frozen=True)
class DriveModel:
    """Terms of the drives: one alternative of each part, in addition to viscous friction.

    curve, load, memory, rotors, coupling, offsets: keys of the CHOICES; "" without
    """

    curve: str = "Coulomb"
    load: str = ""
    memory: str = ""
    rotors: str = ""
    coupling: str = ""
    offsets: str = ""

    @property
    def entries(self) -> tuple[Entry, ...]:
        """The terms, as in a table of torque models."""
        chosen = (CHOICES[field.name][getattr(self, field.name)] for field in fields(self))
        return (VISCOUS, *(entry for part in chosen for entry in part))

    @property
    def words(self) -> str:
        """The parts as text."""
        return "; ".join(["viscous", *(part for field in fields(self) if (part := getattr(self, field.name)))])

    @property
    def keys(self) -> tuple[str, ...]:
        """Names of the terms beside viscous friction (every_term)."""
        return tuple(entry_text(entry) for entry in self.entries if entry is not VISCOUS)

    @property
    def terms(self) -> tuple[Term, ...]:
        """The terms."""
        return tuple(term_with(**entry) for entry in self.entries)

    def neighbors(self, without: Collection[str]) -> Iterator[ModelChange]:
        """Models that differ in one part. without: parts that are not tried"""
        for part, alternatives in CHOICES.items():
            here = getattr(self, part)
            for there in alternatives:
                if there != here and part not in without:
                    model = replace(self, **{part: there})
                    change = there or f"without {here}"
                    yield ModelChange(change, model, leaves_out=not there, couples=part == "coupling")


class ModelChange(NamedTuple):
    """A change as text, the model that it leads to, whether it leaves a part out, and whether it couples the wrist."""

    words: str
    model: DriveModel
    leaves_out: bool = False
    couples: bool = False


FULL = DriveModel("smooth", "load", rotors="rotors", offsets="offsets")
"""All parts but memory and coupling: what only several of them together explain is found from here."""


def entry_text(entry: Entry) -> str:
    """A term as in a file of torque models."""
    settings = [f"{name} = {value}" for name, value in entry.items() if name != "term"]
    name = f'"{entry["term"]}"'
    return f"{{term = {', '.join([name, *settings])}}}" if settings else name


def parts_without_use(robot: RobotModel, fixed: Sequence[Term], *, memory: bool) -> set[str]:
    """Parts that are not tried for a robot: those without effect, and those that fixed terms already are.

    memory: whether terms may have memory
    """
    last = [robot.joints[k] for k in robot.degrees_of_freedom.independent[-2:]]
    turning = len(last) == 2 and not any(joint.is_prismatic for joint in last)
    found = ({"memory"} if not memory else set()) | ({"coupling"} if not turning else set())
    given = {column.name for term in fixed for column in term.columns(robot)}
    for part in set(CHOICES) - found:
        terms = (term_with(**entry) for entries in CHOICES[part].values() for entry in entries)
        if given.intersection(column.name for term in terms for column in term.columns(robot)):
            found.add(part)
    return found


def every_term(without: Collection[str] = ()) -> dict[str, Term]:
    """All terms of all models beside viscous friction, by the names of DriveModel.keys."""
    parts = [every.values() for part, every in CHOICES.items() if part not in without]
    entries = (entry for part in parts for alternative in part for entry in alternative)
    return {entry_text(entry): term_with(**entry) for entry in entries}
