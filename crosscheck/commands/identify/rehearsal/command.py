"""`graphdyn identify --rehearse`."""

from __future__ import annotations

from typing import TYPE_CHECKING, NoReturn

import typer

from crosscheck.commands.identify.models import methods_of
from crosscheck.commands.program.console import progress, warnings_shown
from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED, DISAGREED

if TYPE_CHECKING:
    from crosscheck.commands.identify.options import IdentifyOptions


def rehearsed(options: IdentifyOptions, robot: str) -> NoReturn:
    """Rehearse, deliver the report, and end the command: 0 if the motion determines all that any motion could."""
    import urdf
    from crosscheck.commands.identify.rehearsal.report import rehearsal_report
    from crosscheck.exciting.motion_formats.krl import AxisSettings
    from crosscheck.exciting.motion_formats.motion_file import read_motion
    from crosscheck.identifying import REHEARSED_METHODS, rehearse
    from graphdyn.identification.terms import RigidBodies

    assert options.rehearse is not None
    conditions = options.conditions(options.rate, options.seed)
    named = methods_of(options.methods or ",".join(REHEARSED_METHODS), of_sums=False, wrenches=False)
    (model,) = options.candidates(named)
    with warnings_shown():
        motion = read_motion(options.rehearse, urdf.load(robot, reading=options.reading), AxisSettings())
        with progress("rehearse", conditions.runs) as advance:
            found = rehearse(
                robot,
                motion,
                name=str(options.rehearse),
                terms=[term for term in model.terms if not isinstance(term, RigidBodies)],
                methods=named,
                preparation=options.preparation,
                conditions=conditions,
                progress=advance,
                reading=options.reading,
            )
    deliver(rehearsal_report(found), options)
    raise typer.Exit(AGREED if found.complete else DISAGREED)
