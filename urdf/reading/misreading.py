"""A file as readers get it that misunderstand it."""

from __future__ import annotations

import copy
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from graphdyn import Body, Joint
from urdf.document.opening import Given
from urdf.document.tree import joints_in_order
from urdf.reading.fusing import assemble
from urdf.reading.parsing import parsed_source
from urdf.reading.reading import AS_IT_STANDS, Reading

if TYPE_CHECKING:
    from yourdfpy.urdf import Robot


class Misreadings:
    """What bodies and joints become when elements of a file are changed.

    robot: yourdfpy's, to look at; its joints in the order of `order`, names, parents first
    carriers: by name of each link with an <inertial> that is fixed to a body, the name of the body
    """

    def __init__(self, source: Given, reading: Reading = AS_IT_STANDS) -> None:
        _, document, self._parsed = parsed_source(source, reading)
        self.robot: Robot = self._parsed.robot
        self.order = joints_in_order(document)[1]
        assembly = self._parsed.assembly
        self.carriers = {
            name: assembly.bodies[number - 1].name for name, (number, share) in assembly.fused.items() if share.any()
        }

    def of(
        self, changes: Mapping[str, Callable[[Robot], object]]
    ) -> Iterator[tuple[str, tuple[Body, ...], tuple[Joint, ...]]]:
        """Numbers by name of the change: the bodies and joints after it; change(robot) alters a copy of the robot in
        place."""
        for name, change in changes.items():
            robot = _copied(self.robot)
            change(robot)
            assembly = assemble(robot, self._parsed.root, self.order, self._parsed.locked)
            yield name, tuple(assembly.bodies), tuple(assembly.joints)


def _copied(robot: Robot) -> Robot:
    """A copy whose links, inertials and joints can be given other attributes."""
    links = [copy.copy(link) for link in robot.links]
    for link in links:
        link.inertial = copy.copy(link.inertial)
    return replace(robot, links=links, joints=[copy.copy(joint) for joint in robot.joints])
