"""How a robot is read: the options of urdf.load as one object, which all that read a robot hand on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, fields, replace
from os import PathLike
from typing import Any, TypedDict

from numpy.typing import ArrayLike

from graphdyn.arguments import refuse_unknown
from graphdyn.display import short_repr
from urdf.document.opening import Xacro
from urdf.loops.closing import Loops
from urdf.loops.mimics import Mimic
from urdf.reading.cutting import Chain, Lock
from urdf.reading.mesh_inertials import InertialsFromMeshes
from urdf.reading.repairing import Repair


@dataclass(frozen=True, kw_only=True, eq=False)
@short_repr
class Reading:
    """How a robot is read from its file. Functions that read one take these fields as keywords, or as `reading=`.

    chain: (base_link, tip_link) cuts out the arm between two links; base_link becomes the root, at the origin.
        Links fixed to the path stay. Other movable joints are locked where the path carries them (at 0 unless lock
        says otherwise), because the arm carries their mass; on base_link itself they are left out
    lock: joints to hold still: {name: value [rad or m]}, or names (value 0)
    mimic: what becomes of mimic joints: "coupled" ties them to the joint that they mimic, and q, v, a and tau have no
        entries for them (RobotModel.couplings); "independent" makes each a joint of its own, as Pinocchio does by
        default; "locked" holds them at 0, or where lock says
    loops: loops that the file itself does not state: a sequence of urdf.Loop, or the path of a YAML file as the package
        example-parallel-robots has them. Default: the YAML file of that form that stands beside the URDF and has its
        name (arm.urdf, arm.yaml), if there is one; loops=() leaves it unread
    repair: what to repair, each change reported by RepairWarning: "axis" gives unit length to axes,
        "angles" all digits to multiples of π/2, "limits" exchanges lower and upper limits that are reversed,
        "inertials" corrects those that one slip explains,
        InertialsFromMeshes(density=…) computes missing inertials from the shapes of their links
    gravity: (3,) in world axes [m/s²]; default: the catalog's for a name, (0, 0, -9.81) for a file
    xacro: arguments and packages for a .xacro file
    """

    chain: Chain = None
    lock: Lock = None
    mimic: Mimic = "coupled"
    loops: Loops = None
    repair: Iterable[Repair] = ()
    gravity: ArrayLike | None = None
    xacro: Xacro | None = None

    def __post_init__(self) -> None:
        """Keeps the entries of iterators, which can be read only once."""
        lock, loops, repair = self.lock, self.loops, self.repair
        if not isinstance(lock, Mapping | str | None):
            object.__setattr__(self, "lock", tuple(lock))
        if not isinstance(loops, str | PathLike | None):
            object.__setattr__(self, "loops", tuple(loops))
        if not isinstance(repair, Repair):  # one repair alone is refused when it is used, with its file
            object.__setattr__(self, "repair", tuple(repair))

    @classmethod
    def of(cls, caller: Callable[..., object], options: ReadingKeywords) -> Reading:
        """The keywords of a function as one object. Raises TypeError for one that neither it nor Reading has."""
        refuse_unknown(caller, options, ReadingKeywords.__annotations__)
        given: dict[str, Any] = {name: value for name, value in options.items() if name != "reading"}
        return replace(options.get("reading") or AS_IT_STANDS, **given)

    @property
    def stated(self) -> tuple[str, ...]:
        """Names of the fields that say something else than their defaults."""
        given = {field: value for field in fields(self) if (value := getattr(self, field.name)) is not None}
        return tuple(field.name for field, value in given.items() if field.default is None or value != field.default)

    @property
    def without_computed_inertials(self) -> Reading:
        """The same, with inertials as the file states them."""
        repair = () if isinstance(self.repair, Repair) else self.repair
        return replace(self, repair=[one for one in repair if not isinstance(one, InertialsFromMeshes)])

    @property
    def locked(self) -> dict[str, float]:
        """Value per joint of `lock` [rad or m]."""
        return dict(self.lock) if isinstance(self.lock, Mapping) else dict.fromkeys(self.lock or (), 0.0)


class ReadingKeywords(TypedDict, total=False):
    """The fields of Reading as keywords of a function. reading: all at once, those beside it put in its place."""

    reading: Reading | None
    chain: Chain
    lock: Lock
    mimic: Mimic
    loops: Loops
    repair: Iterable[Repair]
    gravity: ArrayLike | None
    xacro: Xacro | None


AS_IT_STANDS = Reading()
"""The robot of the file as it stands, with everything that it states."""
