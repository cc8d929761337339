"""The URDF file of one robot with the inertials of the other."""

from __future__ import annotations

from pathlib import Path
from typing import Literal

import typer

import urdf
from crosscheck.commands.diff.robots import Described
from graphdyn.aligning import ModelDifferences, align


def with_inertials_of(
    giver: Literal["A", "B"], robots: tuple[Described, Described], found: ModelDifferences, out: Path
) -> urdf.Update:
    """Write the other robot's file with the inertials of the giver, in its own link frames; nothing else changes.

    Raises typer.BadParameter where the other robot is no URDF file, the errors of urdf.update, and OSError.
    """
    taker = robots[0] if giver == "B" else robots[1]
    if Path(taker.source).suffix.lower() in (".json", ".xml"):
        raise typer.BadParameter(
            f"--use-inertials-of {giver}: {taker.source} is no URDF file; write MJCF with `graphdyn export --patch`"
        )
    if giver == "B":
        model = found.alignment.model
    else:
        model = align(robots[1].model, robots[0].model, tolerance=found.tolerance).model
    return urdf.update(taker.source, out, model.inertial_parameters, inconsistent=True, reading=taker.reading)
