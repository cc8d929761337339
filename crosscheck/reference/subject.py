"""Arguments that compare, judge and identify share: the robot, by name, path or RobotModel, counts, and frames."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from numbers import Integral
from os import PathLike
from typing import get_args

import urdf
from graphdyn import InvalidInput, RobotModel
from graphdyn.arguments import Reference
from urdf import Reading, Xacro
from urdf.document import UNNAMED_SOURCES, content_of, locate, path_of
from urdf.reading import Chain

Robot = str | PathLike[str] | RobotModel


class OfReading:
    """A result of a robot that was read from a file, which says how; locked, chain: of its reading."""

    reading: Reading

    @property
    def locked(self) -> dict[str, float]:
        """Value per joint that was held still [rad or m]."""
        return self.reading.locked

    @property
    def chain(self) -> Chain:
        """Base link and tip link of the arm that was cut out; None for the whole robot."""
        return self.reading.chain


@dataclass(frozen=True, eq=False)
class Subject(OfReading):
    """The robot to be compared.

    name: as given
    file: whole path of its URDF; None where a RobotModel was given
    file_sha256: SHA-256 of the content of that file, in hexadecimal; None where a RobotModel was given
    reading: how the file is read
    """

    name: str
    model: RobotModel
    file: str | None
    file_sha256: str | None
    reading: Reading


def subject(robot: Robot, reading: Reading) -> Subject:
    """Load a name or path; take a RobotModel as it is.

    Raises InvalidInput where it is to be read in some way but is a RobotModel, and for XML or another type.
    """
    if isinstance(robot, RobotModel):
        if reading.stated:
            given = " and ".join(reading.stated)
            raise InvalidInput(f"{given}: only for names and files; a RobotModel already has its joints and gravity")
        return Subject(robot.name, robot, None, None, reading)
    if not isinstance(robot, str | PathLike):
        raise InvalidInput(f"the robot is of type {type(robot).__name__}; give a name, a path or a RobotModel")
    if path_of(robot) in UNNAMED_SOURCES:
        raise InvalidInput("XML is given in place of a name or path; give the file, or urdf.load(…) of the XML")
    model = urdf.load(robot, reading=reading)
    return Subject(str(robot), model, str(locate(robot)[0].resolve()), content_sha256(robot, reading.xacro), reading)


JUDGE_THE_TREE = "are not judged; from Python, judge its tree: urdf.load(…).opened"

IDENTIFY_CLOSED = (
    "recorded positions leave open by their noise; from Python, identify it with samples that graphdyn.assemble has "
    "closed"
)


def refuse_chords(model: RobotModel, why: str = JUDGE_THE_TREE) -> None:
    """Raise InvalidInput for a robot with loops. why: what they are not, and the remedy."""
    if model.chords:
        names = ", ".join(f"'{chord.name}'" for chord in model.chords[:5])
        more = f" and {len(model.chords) - 5} more" if len(model.chords) > 5 else ""
        raise InvalidInput(f"robot '{model.name}' has loops, closed by {names}{more}, which {why}")


def tip(model: RobotModel) -> str:
    """The frame that is meant where none is named: the last one fixed to the last body, or this body itself."""
    fixed = [frame.name for frame in model.frames if frame.body == model.n_bodies]
    return fixed[-1] if fixed else model.body_names[-1]


def content_sha256(robot: str | PathLike[str], xacro: Xacro | None = None) -> str:
    """Hash of the file of a name or path, a .xacro file expanded. Raises RobotNotFound, InvalidXacro, OSError."""
    return hashlib.sha256(content_of(locate(robot)[0], xacro)).hexdigest()


def check_counts(samples: int, seed: int) -> None:
    """Raise InvalidInput for an invalid number of samples or seed."""
    if not isinstance(samples, Integral) or samples < 1:
        raise InvalidInput(f"samples is {samples!r}; give a whole number of random states, at least 1")
    if not isinstance(seed, Integral) or seed < 0:
        raise InvalidInput(f"seed is {seed!r}; give a whole number from 0 on")


FRAME_REFERENCES: tuple[Reference, ...] = get_args(Reference)
"""Points and axes in which a frame is described, in the words of graphdyn.frame_velocity."""


def compared_frames(model: RobotModel) -> tuple[str, ...]:
    """Frames that are compared: of every leaf of the tree the last frame fixed in it, or the body itself; and the last
    one fixed in any body."""
    fixed = {frame.body: frame.name for frame in model.frames if frame.body > 0}
    leaves = [i for i in range(1, model.n_bodies + 1) if not model.graph.outside(i)]
    names = [fixed.get(i, model.bodies[i - 1].name) for i in leaves]
    return tuple(dict.fromkeys([*names, *list(fixed.values())[-1:]]))


def placed_frames(model: RobotModel) -> tuple[str, ...]:
    """Frames whose placement is compared: all that are fixed in bodies, or the bodies of the leaves."""
    return tuple(frame.name for frame in model.frames) or compared_frames(model)
