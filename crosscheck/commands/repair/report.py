"""What `graphdyn repair` has changed, or could change, as a report."""

from __future__ import annotations

import urdf
from crosscheck.commands.repair.record import record
from crosscheck.report.report import Code, Note, Notes, Report, Section, Verdict
from graphdyn.errors import counted


def repair_report(robot: str, found: urdf.RepairedFile, command: str) -> Report:
    """command: what makes these changes, where they are only listed"""
    number = counted(len(found.changes), "change")
    if not found.changes:
        verdict = Verdict("undecided", "nothing to repair", "Nothing of what was asked for is there")
    elif found.path is None:
        verdict = Verdict("plain", f"{number} possible", "Nothing is written")
    else:
        verdict = Verdict("agrees", f"{number}, written to {found.path}", "Every other byte is as it was")
    notes = Notes(tuple(Note(change) for change in found.changes))
    several = Notes(tuple(Note(one) for one in found.candidates), title="Not repaired, because it is not clear how")
    command_block = [Code(command, title="Written by")] if command else []
    blocks = (*command_block, notes, *([several] if found.candidates else []))
    return Report(
        f"Repairs of {robot}", verdict, (Section("changes", "", blocks),), record=lambda _: record(robot, found)
    )
