"""Which joints of a robot with loops have motors: <transmission> elements, and name_mot of the YAML file."""

from __future__ import annotations

from collections.abc import Container, Iterator, Sequence

from urdf.document.connections.loops import CompanionFiles, Motor
from urdf.document.elements import name_of
from urdf.document.extensions import Unread
from urdf.document.source import Source
from urdf.errors import InvalidLoop, shortened


def check_motors(source: Source, beside: CompanionFiles) -> None:
    """Raises InvalidLoop for a motor stated beside the file, at a joint that the file lacks; source: all of it."""
    joints = {name_of(joint) for joint in source.joints}
    for motor in beside.motors:
        if motor.joint not in joints:
            problem = f"there is no joint '{shortened(motor.joint)}'"
            raise motor.place.error(InvalidLoop, problem, "correct the name")


def actuated(motors: Sequence[Motor], independent: Sequence[str]) -> tuple[str, ...] | None:
    """The joints that have motors; None where none of those that are independent is said to."""
    return tuple(dict.fromkeys(motor.joint for motor in motors if motor.joint in independent)) or None


def unread_motors(motors: Sequence[Motor], driven: Container[str]) -> Iterator[Unread]:
    """Motors at joints that others drive."""
    for motor in motors:
        if motor.joint in driven:
            problem = f"a motor at joint '{shortened(motor.joint)}', which other joints drive"
            yield Unread("unread-dynamics", motor.place.element or "", motor.place.line, problem, 1)


def unread_beside(beside: CompanionFiles) -> Iterator[Unread]:
    """What the YAML file has that is not known."""
    for said in beside.unread:
        yield Unread("unread-dynamics", "", None, said, 1)
