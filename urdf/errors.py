"""Names and values of a file quoted in messages: shortened, whatever the file contains.

Errors and warnings of loading, saving and updating URDF files.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import ClassVar

from graphdyn import GraphDynError

MAX_QUOTED_CHARACTERS = 80
"""Largest number of characters of a quoted name or value."""

MAX_QUOTED_NAMES = 20
"""Largest number of names in a quoted list."""


def shortened(text: str) -> str:
    """The text on one line; beyond MAX_QUOTED_CHARACTERS characters, without its middle."""
    half = MAX_QUOTED_CHARACTERS // 2
    if len(text) > MAX_QUOTED_CHARACTERS:  # which may be megabytes
        text = text[:half] + text[-half - 1 :]
    text = one_line(text)
    return text if len(text) <= MAX_QUOTED_CHARACTERS else f"{text[:half]} … {text[-half:]}"


def one_line(text: str) -> str:
    """The text on one line: characters that do not print, such as line breaks, as in a Python string: \\n, \\x1b."""
    return text if text.isprintable() else "".join(c if c.isprintable() else ascii(c)[1:-1] for c in text)


def listed(names: Iterable[str]) -> str:
    """The names in quotes, the first MAX_QUOTED_NAMES of them."""
    names = list(names)
    said = ", ".join(f"'{shortened(name)}'" for name in names[:MAX_QUOTED_NAMES])
    return said if len(names) <= MAX_QUOTED_NAMES else f"{said} and {len(names) - MAX_QUOTED_NAMES} more"


class URDFError(GraphDynError, ValueError):
    """Base of every error of this package: where, what is wrong, and what to do about it.

    code: a stable name of the fault ("negative-mass"), for programs
    path: the file, line: its line, element: the element there; None where the error has none
    """

    default_code: ClassVar[str] = "invalid-robot"

    def __init__(
        self,
        problem: str,
        remedy: str,
        *,
        code: str | None = None,
        path: Path | None = None,
        line: int | None = None,
        element: str | None = None,
    ):
        self.problem, self.remedy = one_line(problem), one_line(remedy)
        self.code = code or self.default_code
        self.path, self.line = path, line
        self.element = None if element is None else one_line(element)
        file = "" if path is None else one_line(str(path))
        place = file if line is None else f"{file}:{line}"
        super().__init__(": ".join(part for part in (place, self.element, f"{self.problem}; {self.remedy}") if part))


class RobotNotFound(URDFError):
    """Neither a file nor a name of the catalog."""

    default_code = "no-such-file"


class TooLarge(URDFError):
    """A file that is too large: in bytes, tags, links or joints."""

    default_code = "too-large"


class MalformedXML(URDFError):
    """Not a well-formed XML document, or not one whose root element is <robot>."""

    default_code = "malformed-xml"


class MissingEntry(URDFError):
    """An element or attribute without which a value would have to be guessed."""


class DuplicateEntry(URDFError):
    """A name, or an element of which there can be one, that occurs twice."""


class InvalidNumber(URDFError):
    """An attribute whose text is not the finite number, or the three finite numbers, that it should hold."""


class UnsupportedJoint(URDFError):
    """A joint type other than revolute, continuous, prismatic and fixed."""


class UnsupportedConstraint(URDFError):
    """An element that closes a loop, couples joints or joins links in a way that is not modeled."""

    default_code = "unsupported-constraint"


class InvalidLoop(URDFError):
    """A loop, a coupling or a motor that is malformed, or that names what the robot lacks."""

    default_code = "invalid-loop"


class NotATree(URDFError):
    """Links and joints that do not form one tree."""


class InvalidLock(URDFError):
    """A joint to be locked that is unknown or fixed, or a lock value that is not a finite number."""


class InvalidMimic(URDFError):
    """A mimic= that urdf.load does not know, or mimic joints that cannot be coupled."""

    default_code = "invalid-mimic"


class InvalidChain(URDFError):
    """A chain= that does not name the base link and the tip link of an arm."""


class InvalidXacro(URDFError):
    """A .xacro file that cannot be expanded, or that reaches for files outside its folder and the given packages."""

    default_code = "invalid-xacro"


class XacroNotInstalled(InvalidXacro):
    """A .xacro file, where the package that expands it is not installed."""

    default_code = "xacro-not-installed"


class InvalidMJCF(URDFError):
    """An MJCF file that MuJoCo refuses, or that includes what it must not."""

    default_code = "invalid-mjcf"


class MujocoNotInstalled(InvalidMJCF):
    """An MJCF file, where MuJoCo, which reads it, is not installed."""

    default_code = "mujoco-not-installed"


class InvalidDH(URDFError):
    """A table of Denavit-Hartenberg parameters that is no robot, or names no units."""

    default_code = "invalid-dh"


class InvalidRepair(URDFError):
    """A repair= that urdf.load does not know."""


class InvalidRobot(URDFError):
    """A readable file that describes a robot that graphdyn refuses."""


class CannotSave(URDFError):
    """A model that a URDF file cannot express: names that XML cannot hold, some couplings of several joints."""


class CannotUpdate(URDFError):
    """Inertial parameters that cannot be written into a file."""


class URDFWarning(UserWarning):
    """Base of every warning of this package."""


class MissingInertialWarning(URDFWarning):
    """Moving bodies without any <inertial>: mass zero, forward dynamics not determined."""


class ZeroMassWarning(URDFWarning):
    """Moving bodies whose <inertial>s state a mass of zero."""


class AxisNotNormalizedWarning(URDFWarning):
    """Joint axes that are not of unit length; they are normalized."""


class ChainWarning(URDFWarning):
    """Decisions of urdf.load about an arm that is cut out of a larger robot (chain=)."""


class XacroWarning(URDFWarning):
    """Warnings of the program that expands .xacro files."""


class RepairWarning(URDFWarning):
    """Repairs that the caller asked for (repair=)."""


class MimicJointWarning(URDFWarning):
    """Mimic joints, loaded as independent joints (mimic="independent")."""


class UnboundJointWarning(URDFWarning):
    """Joints marked independent="false" that no loop and no coupling binds to others."""


class UnreadWarning(URDFWarning):
    """Elements or attributes that are not read and that change the dynamics elsewhere, or that URDF does not know."""


class GravityNotSavedWarning(URDFWarning):
    """A URDF file has no place for gravity; this model's differs from the default that a reload assumes."""
