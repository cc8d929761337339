"""What `graphdyn repair` has changed, or could change, as a report."""

from __future__ import annotations

import shlex

import urdf
from crosscheck.commands.repair.record import record
from crosscheck.report.report import Note, Notes, Report, Section, Verdict
from graphdyn.errors import counted


def repairs_of(robot: str) -> tuple[urdf.RepairedFile, str]:
    """What could be repaired in a file, and the command that does it, "" where nothing can. Raises as urdf.repair."""
    found = {name: urdf.repair(robot, None, [name]) for name in sorted(set(urdf.REPAIRED_CODES.values()))}
    changes = tuple(change for each in found.values() for change in each.changes)
    candidates = tuple(one for each in found.values() for one in each.candidates)
    taken = [word for name, each in found.items() if each.changes for word in ("--take", name)]
    command = shlex.join(["graphdyn", "repair", robot, *taken, "--out", "repaired.urdf"]) if taken else ""
    return urdf.RepairedFile(None, changes, candidates), command


def repair_report(robot: str, found: urdf.RepairedFile, command: str) -> Report:
    """command: what makes these changes, where they are only listed"""
    number = counted(len(found.changes), "change")
    if not found.changes:
        verdict = Verdict("undecided", "nothing to repair", "Nothing of what was asked for is there")
    elif found.path is None:
        verdict = Verdict("plain", f"{number} possible", f"Written by: {command}")
    else:
        verdict = Verdict("agrees", f"{number}, written to {found.path}", "Every other byte is as it was")
    notes = Notes(tuple(Note(change) for change in found.changes))
    several = Notes(tuple(Note(one) for one in found.candidates), title="Not repaired, because it is not clear how")
    blocks = (notes, several) if found.candidates else (notes,)
    return Report(
        f"Repairs of {robot}", verdict, (Section("changes", "", blocks),), record=lambda _: record(robot, found)
    )
