"""What `graphdyn repair` has changed, or could change, as a report."""

from __future__ import annotations

import shlex

import urdf
from crosscheck.commands.repair.record import record
from crosscheck.report.report import Note, Notes, Report, Section, Verdict
from graphdyn.errors import counted


def repairs_of(robot: str) -> tuple[urdf.RepairedFile, str]:
    """What could be repaired in a file, and the command that does it, "" where nothing can. Raises as urdf.repair."""
    found = {code: urdf.repair(robot, None, [code]).changes for code in urdf.REPAIRED_CODES}
    changes = tuple(change for code in found for change in found[code])
    taken = [word for code in found if found[code] for word in ("--take", code)]
    command = shlex.join(["graphdyn", "repair", robot, *taken, "--out", "repaired.urdf"]) if taken else ""
    return urdf.RepairedFile(None, changes), command


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
    return Report(
        f"Repairs of {robot}", verdict, (Section("changes", "", (notes,)),), record=lambda _: record(robot, found)
    )
