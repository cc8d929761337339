"""The catalog: faults of dynamics codes, and families whose numbers are fitted."""

from __future__ import annotations

from collections.abc import Iterator

from crosscheck.judging.faults.arguments import angles, arguments, orders, units
from crosscheck.judging.faults.fault import CodeFault, Family
from crosscheck.judging.faults.file_reading import file_reading
from crosscheck.judging.faults.geometry import frames, geometry
from crosscheck.judging.faults.inertials import inertials, parameters
from crosscheck.judging.faults.signs import signs
from crosscheck.judging.faults.terms import gravity, joint_terms, terms
from graphdyn import RobotModel
from urdf.reading import Misreadings


def faults(model: RobotModel, readings: Misreadings | None) -> Iterator[CodeFault]:
    """All faults without free numbers; readings: of the file, where there is one."""
    yield from signs(model)
    yield from units(model)
    yield from angles(model)
    yield from arguments(model)
    yield from frames(model)
    yield from inertials(model)
    yield from orders(model)
    if readings is not None:
        yield from file_reading(readings)


def families(model: RobotModel) -> Iterator[Family]:
    """All families of faults."""
    yield from gravity(model)
    yield from terms(model)
    yield from geometry(model)
    yield from parameters(model)
    yield from joint_terms(model)
