"""Mimic joints: joints whose position is multiplier × that of another joint + offset."""

from __future__ import annotations

from collections.abc import Container, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

from graphdyn import Coupling
from urdf._elements import name_of
from urdf._errors import InvalidLock, InvalidMimic, URDFError
from urdf._source import Source
from urdf._wording import shortened

if TYPE_CHECKING:
    import yourdfpy

Mimic = Literal["coupled", "independent", "locked"]


@dataclass(frozen=True)
class Mimics:
    """couplings of the joints that mimic free ones; locked: value per joint held still, mimic joints included."""

    couplings: tuple[Coupling, ...]
    locked: Mapping[str, float]


def resolve(
    source: Source,
    robot: yourdfpy.urdf.Robot,
    mimic: Mimic,
    locked: Mapping[str, float],
    stated: Container[str],
) -> Mimics:
    """What becomes of the mimic joints of a file.

    locked: joints held still by the caller or by a chain; stated: those of them that the caller named. With "coupled" a
    mimic joint beside a chain is held still only if the joint that it mimics is.

    Raises InvalidMimic for another choice, joints that mimic one that the robot lacks, or each other in a circle;
    InvalidLock for a locked mimic joint that does not stand where the joint that it mimics wants it.
    """
    if mimic not in get_args(Mimic):
        choices = ", ".join(map(repr, get_args(Mimic)))
        raise InvalidMimic(f"mimic is {mimic!r}", f"give one of {choices}", path=source.path)
    by_name = {joint.name: joint for joint in robot.joints}
    followers = [joint.name for joint in robot.joints if joint.mimic is not None and joint.type != "fixed"]
    if mimic == "independent":
        return Mimics((), locked)
    if mimic == "locked":
        return Mimics((), {**dict.fromkeys(followers, 0.0), **locked})
    elements = {name_of(joint): joint for joint in source.joints}
    multipliers = {name: _or(by_name[name].mimic.multiplier, 1.0) for name in followers}
    offsets = {name: _or(by_name[name].mimic.offset, 0.0) for name in followers}

    def error(name: str, problem: str, remedy: str) -> URDFError:
        return source.error(InvalidMimic, "invalid-mimic", elements[name], problem, remedy)

    def value(name: str, on_the_way: tuple[str, ...]) -> float | None:
        """Where a joint stands; None if it is free or mimics a free one."""
        if name in on_the_way:
            circle = " → ".join(shortened(x) for x in (*on_the_way[on_the_way.index(name) :], name))
            raise error(name, f"joints mimic each other in a circle: {circle}", "remove a <mimic>")
        if name not in multipliers:
            return 0.0 if by_name[name].type == "fixed" else locked.get(name)
        other = by_name[name].mimic.joint
        if other not in by_name and name in stated:
            return locked[name]
        if other not in by_name:
            raise error(
                name,
                f"it mimics joint '{shortened(other)}', which the robot lacks or chain= leaves out",
                "correct the name, take a longer chain, lock it, or load with mimic='independent'",
            )
        at = value(other, (*on_the_way, name))
        if multipliers[name] == 0:
            return offsets[name]
        return None if at is None else multipliers[name] * at + offsets[name]

    couplings, held = [], dict(locked)
    for name in followers:
        at, other = value(name, ()), by_name[name].mimic.joint
        if at is None:
            if name in stated:
                raise InvalidLock(
                    f"cannot lock '{name}': it mimics joint '{other}', which is free",
                    f"lock '{other}', which holds both, or load with mimic='independent'",
                    path=source.path,
                )
            held.pop(name, None)
            couplings.append(Coupling(name, {other: multipliers[name]}, offsets[name]))
        else:
            if name in stated and locked[name] != at:
                raise InvalidLock(
                    f"cannot lock '{name}' at {locked[name]:.9g}: it mimics joint '{other}', and stands at {at:.9g}",
                    "leave it out of lock=, or load with mimic='independent'",
                    path=source.path,
                )
            held[name] = at
    return Mimics(tuple(couplings), held)


def _or(number: float | None, default: float) -> float:
    return default if number is None else float(number)
