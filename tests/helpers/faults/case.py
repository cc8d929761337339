"""A fault on a robot, and what a diagnosis has to say about it."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from shared_data import ARMS

import urdf

ROBOTS = {
    **{name: name for name in ("ur5", "kr500", "kinova", "z1")},
    "vx300s": str(ARMS / "vx300s.urdf"),
    "kr210": str(ARMS / "kr210_r2700_2.urdf"),
}


@dataclass(frozen=True)
class Case:
    """A fault on a robot.

    plant: (arm, model) → a function, or (folder, path) → robot and arm, where the fault is in reading the file
    named: expressions that the messages of the diagnoses that hold must match, one each, and no other may hold
    located: expression that a part, a candidate or an unknown has to match to count as located
    function: which function is judged
    """

    name: str
    robot: str
    plant: Callable
    named: tuple[str, ...]
    located: str = ""
    function: str = "inverse_dynamics"
    from_file: bool = False

    def __str__(self):
        return f"{self.name}-{self.robot}"


def path_of(robot: str) -> Path:
    known = {entry.name: entry.path for entry in urdf.robots()}
    return Path(known.get(ROBOTS[robot], ROBOTS[robot]))
