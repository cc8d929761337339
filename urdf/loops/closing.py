"""The loops of a file, of the YAML file beside it and of loops=, and the chords of the model that they become."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from os import PathLike
from pathlib import Path

from lxml import etree

from graphdyn import Chord, Placement
from urdf.document.connections.loop_yaml import beside, read_yaml
from urdf.document.connections.loops import Closure, CompanionFiles, Loop, SourceLocation
from urdf.document.elements import name_of
from urdf.document.source import Source
from urdf.document.tree import end, joint_into, path_up
from urdf.errors import InvalidLoop, UnsupportedConstraint, URDFError, shortened

Loops = Sequence[Loop] | str | PathLike[str] | None

Locations = Mapping[str, tuple[int, Placement]]
"""Per link: its body, and its placement in the link frame of that body."""


def stated_beside(loops: Loops, path: Path) -> CompanionFiles:
    """What is stated beside a file: by loops=, or where that is None by the YAML file beside it.

    Raises InvalidLoop; OSError.
    """
    if loops is None:
        return beside(path)
    if isinstance(loops, str | PathLike):
        return read_yaml(Path(loops))
    wrong = [loop for loop in loops if not isinstance(loop, Loop)]
    if wrong:
        kind = type(wrong[0]).__name__
        raise InvalidLoop(f"loops has an entry of type {kind}", "give urdf.Loop(…), or the YAML file", path=path)
    return CompanionFiles(
        tuple((loop, SourceLocation(path, None, f"loop '{shortened(str(loop.name))}'")) for loop in loops)
    )


def all_closures(source: Source, added: CompanionFiles) -> list[Closure]:
    """The closures of the file and those stated beside it; source: with all its links."""
    links = {name_of(link) for link in source.links}
    carried = {name_of(joint): end(joint, "child") for joint in source.joints}
    return [*source.extensions.closures, *(_closure(loop, place, links, carried) for loop, place in added.loops)]


def _closure(loop: Loop, place: SourceLocation, links: set[str], carried: Mapping[str, str | None]) -> Closure:
    """The loop with links in place of joints."""
    ends, fault = [], None
    for name in (loop.link_i, loop.link_j):
        carrying = carried.get(name)
        if name in links and carrying not in (None, name):
            fault = place.error(
                InvalidLoop,
                f"'{shortened(name)}' is a link, and a joint that carries link '{shortened(str(carrying))}'",
                "rename one of the two",
            )
        link = name if name in links else carrying
        if link is None:
            problem = f"there is no link or joint '{shortened(str(name))}'"
            fault = fault or place.error(InvalidLoop, problem, "correct the name")
        ends.append(link or "")
    if fault is None and ends[0] == ends[1]:
        problem = f"both ends are on link '{shortened(ends[0])}'"
        fault = place.error(InvalidLoop, problem, "name two links")
    named = replace(loop, link_i=ends[0], link_j=ends[1])
    problem = f"'{shortened(str(loop.name))}' closes a kinematic loop"
    return Closure(place, problem, frozenset(ends), fault or named)


def closure_faults(
    closures: Sequence[Closure],
    carriers: Mapping[str, str | None],
    source: Source,
    held: Sequence[str] | None = None,
) -> Iterator[URDFError]:
    """An error for each element that constrains the model in a way that is not modeled, or that is malformed.

    carriers: per link of the model, the body that carries it
    held: joints that chain= holds still, None where there is no chain=
    """
    names: set[str] = set()
    for closure in constraining(closures, carriers):
        place, says = closure.place, closure.says
        left_out = sorted(link for link in closure.links if link not in carriers)
        if isinstance(says, URDFError):
            yield says
        elif says is None:
            yield place.error(
                UnsupportedConstraint,
                f"{closure.problem}, which is not modeled",
                "remove it to load the robot without it, or let one body carry the links that it joins (chain=, lock=; "
                "--chain, --lock)",
            )
        elif left_out and held is not None:
            problem = f"{closure.problem}, and the chain leaves out link '{shortened(left_out[0])}'"
            remedy = "take a chain that has both links, or remove it to load the arm without it"
            yield place.error(UnsupportedConstraint, problem, remedy)
        elif isinstance(says, Loop):
            still = [name_of(joint) for joint in _between(source, says) if name_of(joint) in held] if held else []
            if still:
                problem = f"{closure.problem}, and the chain holds its joint '{shortened(still[0])}' still"
                remedy = "lock it yourself if that is meant (lock=, --lock), or load the whole robot"
                yield place.error(UnsupportedConstraint, problem, remedy)
            if says.name in names:
                problem = f"the name '{shortened(str(says.name))}' is already used by another loop"
                yield place.error(InvalidLoop, problem, "rename one of the two")
            names.add(says.name)


def constraining(closures: Sequence[Closure], carriers: Mapping[str, str | None]) -> Iterator[Closure]:
    """The closures that constrain the model: not those between links of one body, or between links that are left
    out."""
    for closure in closures:
        if len(closure.links) < 2 or len({carriers.get(link, "") for link in closure.links}) > 1:
            yield closure


def chords(closures: Sequence[Closure], carriers: Mapping[str, str | None], locations: Locations) -> list[Chord]:
    """The loops that constrain the model, as its chords."""
    loops = [closure.says for closure in constraining(closures, carriers)]
    return [loop.chord(locations[loop.link_i], locations[loop.link_j]) for loop in loops if isinstance(loop, Loop)]


def _between(source: Source, loop: Loop) -> list[etree._Element]:
    """The joints on the way from one link to the other."""
    into = joint_into(source)
    up_i, up_j = path_up(into, loop.link_i), path_up(into, loop.link_j)
    return [*(joint for joint in up_i if joint not in up_j), *(joint for joint in up_j if joint not in up_i)]
