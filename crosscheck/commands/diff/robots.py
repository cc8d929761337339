"""The two robots of a comparison: what a description of a robot may be, and how it is cut to an arm."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import typer

import urdf
from crosscheck.commands.diff.exported import exported_robot
from graphdyn import RobotModel
from graphdyn.aligning import ModelDifferences, same_names
from urdf import Reading

UNCUT = "-"
"""The tip of a robot that is not cut."""


@dataclass(frozen=True, eq=False)
class Described:
    """A robot of the command line.

    source: as given; reading: how it was read
    held: joints that stand still at 0, because the other robot has none of their names
    """

    source: str
    model: RobotModel
    reading: Reading
    held: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class ComparedRobots:
    """Two robots and what differs between them.

    seed: of the random states
    written: what was written with the inertials of one robot; None where nothing was
    """

    robots: tuple[Described, Described]
    found: ModelDifferences
    seed: int
    written: urdf.Update | None = None


def robots_of(sources: tuple[str, str], tips: Sequence[str]) -> tuple[Described, Described]:
    """Robots A and B, up to their tips, without joints that only one of them has by name.

    Raises the errors of urdf.load, InvalidInput, and typer.BadParameter for more than two tips.
    """
    if len(tips) > 2:
        raise typer.BadParameter(f"--tip is given {len(tips)} times; give it once, or for A and for B")
    ends = [*tips, *tips] if len(tips) == 1 else list(tips) or [UNCUT, UNCUT]
    first, second = (_described(source, tip) for source, tip in zip(sources, ends, strict=True))
    return _without_further_joints(first, second), _without_further_joints(second, first)


def _without_further_joints(robot: Described, other: Described) -> Described:
    """The robot with all joints held at 0 that the other one has not, if it has all of the other one's by name."""
    joints = robot.model.independent_joints
    wanted = same_names(other.model.joint_names, joints)
    held = tuple(name for name in joints if name not in wanted.values())
    if not held or len(wanted) < other.model.n_bodies or _is_exported(robot.source):
        return robot
    reading = replace(robot.reading, lock=held)
    return Described(robot.source, urdf.load(robot.source, reading=reading), reading, held)


def _is_exported(source: str) -> bool:
    return Path(source).suffix.lower() == ".json"


def _described(source: str, tip: str) -> Described:
    if _is_exported(source):
        if tip != UNCUT:
            raise typer.BadParameter(f"--tip {tip}: {source} is a model that is cut already; give - for it")
        return Described(source, exported_robot(source), Reading())
    if tip == UNCUT:
        return Described(source, urdf.load(source), Reading())
    reading = Reading(chain=(urdf.load(source).base_name, tip))
    return Described(source, urdf.load(source, reading=reading), reading)
