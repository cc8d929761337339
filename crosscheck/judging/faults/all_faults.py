"""Common faults of dynamics codes, put into graphdyn one at a time: the torques of a code that has this fault."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from crosscheck.judging.faults.angles import angles
from crosscheck.judging.faults.fault import Fault
from crosscheck.judging.faults.fixed_links import fixed_links
from crosscheck.judging.faults.frames import frames
from crosscheck.judging.faults.inertials import inertials
from crosscheck.judging.faults.signs import several_reversed_axes, signs
from crosscheck.judging.faults.units import units
from graphdyn import RobotModel
from graphdyn.layout import Array


def faults(model: RobotModel, links: Mapping[str, tuple[int, Array]]) -> Iterator[Fault]:
    """All faults, the likelier of two indistinguishable ones first.

    links: fixed links by name: number of the body that they are fused into, and what they contribute to its
        inertial parameters (10,)
    """
    yield from signs(model)
    yield from fixed_links(model, links)
    yield from units(model)
    yield from angles(model)
    yield from frames(model)
    yield from inertials(model)
    yield from several_reversed_axes(model)
