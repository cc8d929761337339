"""The commands that mend what an inspection has found: each is tried, and can be typed as it stands."""

from __future__ import annotations

import shlex
from collections import Counter
from contextlib import suppress

import urdf
from crosscheck.commands.program.reading_options import FROM_MESHES, repair_of

USUAL_DENSITY = 1000
"""Median of mass over volume of the links of published robots [kg/m³], for links without <inertial>."""

TAKEN = {**{code: code for code in urdf.REPAIRED_CODES}, "missing-inertial": f"{FROM_MESHES}={USUAL_DENSITY}"}
"""What `graphdyn repair` takes, by the code of the findings that it mends."""


def repair_command(robot: str, taken: list[str]) -> str:
    """The command with these repairs."""
    words = [word for one in taken for word in ("--take", one)]
    return shlex.join(["graphdyn", "repair", robot, *words, "--out", "repaired.urdf"])


LISTED = ("inertials", "limits", "axis", "angles")
"""The repairs in the order in which they are listed: what changes the dynamics most is first."""


def repairs_of(robot: str) -> tuple[dict[str, urdf.RepairedFile], str]:
    """What each repair would do to a file, and the command of those that do something, "" where none does.

    Raises as urdf.repair.
    """
    found = {name: urdf.repair(robot, None, [name]) for name in LISTED}
    taken = [name for name, each in found.items() if each.changes]
    return found, repair_command(robot, taken) if taken else ""


def proposed(file: urdf.Inspection) -> list[str]:
    """A command for each kind of finding that it makes fewer, and one for all of them."""
    wanted = {code: take for code, take in TAKEN.items() if code in file.codes}
    named = {code: urdf.REPAIRED_CODES.get(code, take) for code, take in wanted.items()}  # of several codes one repair
    mending: dict[str, str] = {}
    with suppress(urdf.URDFError, OSError):  # .xacro files, and those that another program has taken away
        for name in dict.fromkeys(named.values()):
            if urdf.repair(file.robot, None, [repair_of("--take", name)]).changes:
                mending |= {code: take for code, take in wanted.items() if named[code] == name}
        if not mending:
            return []
        repairs = dict.fromkeys(named[code] for code in mending)
        after = urdf.inspect(file.robot, repair=[repair_of("--take", name) for name in repairs])
        before, left = (Counter(finding.code for finding in each.findings) for each in (file, after))
        mending = {code: take for code, take in mending.items() if left[code] < before[code]}
    commands = [repair_command(file.robot, [take]) for take in mending.values()]
    return [*commands, repair_command(file.robot, list(mending.values()))] if len(mending) > 1 else commands
