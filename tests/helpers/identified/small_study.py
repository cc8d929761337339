"""A study of an arm with two joints, and workers that do as they are told."""

from pathlib import Path

from own_processes import travelled
from urdf_text import joint, link, robot_text

from crosscheck.distributing import Lost
from crosscheck.study.settings.configuration import configuration_of

ARM = robot_text(
    "small",
    link("base", None),
    link("upper", 2.5, xyz="0.1 0.2 0.3", tensor="0.11 0.01 0.02 0.13 0.03 0.17"),
    link("fore", 1.5, xyz="0 0.1 0.4", tensor="0.05 0 0 0.06 0 0.02"),
    joint("shoulder", "base", "upper", "continuous", '<origin rpy="0.4 0.3 -1.1"/><axis xyz="0 0.6 0.8"/>'),
    joint("elbow", "upper", "fore", "continuous", '<origin xyz="0.3 0 0.1" rpy="1.2 0 0"/><axis xyz="0 1 0"/>'),
)

ROBOT = """
[robot]
name = "small.urdf"
viscous = 0.5
coulomb = 0.3
rotor_inertia = 0.2
"""

STUDY = """
[study]
runs = 2
methods = ["wls", "ols", "iv"]
"""

SCENARIO = """
[scenario]
duration = 10
sampling_rate = 200
control_rate = 200
cutoff = 20
torque_noise = 0.01
"""

GRID = """
[[grid]]
position_noise = [1e-6, 1e-5]
"""

FURTHER = """
[[grid]]
motion = "steps"
"""


def study_of(folder, *parts):
    """The study of these tables; its robot is small.urdf in the folder, and code in it may run."""
    return configuration_of("".join(parts).encode(), "study.toml", Path(folder), allow_code=True)


def small_study(folder, *further, study=STUDY):
    return study_of(folder, study, ROBOT, SCENARIO, GRID, *further)


class InThisProcess:
    """Tasks in an order. lost: says of a task whether its process dies; ends: interrupted after so many."""

    def __init__(self, order=lambda tasks: range(len(tasks)), lost=lambda task: False, ends=None):
        self.order, self.lost, self.ends = order, lost, ends
        self.done = 0

    def each(self, function, tasks):
        for k in self.order(tasks):
            if self.done == self.ends:
                raise KeyboardInterrupt
            self.done += 1
            if self.lost(tasks[k]):
                yield k, Lost("its process died with code -9, tries: 2")
            else:
                yield k, travelled(function(travelled(tasks[k])))


def backwards(tasks):
    return reversed(range(len(tasks)))
