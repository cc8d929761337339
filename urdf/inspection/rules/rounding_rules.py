"""What only the rounding of angles shows: parameters that the robot does not have beside others."""

from __future__ import annotations

from collections.abc import Iterator

from graphdyn import InvalidInput, RobotModel
from urdf.document.numbers import values
from urdf.errors import listed, shortened
from urdf.inspection.findings import Finding, of_file
from urdf.inspection.structure import Structure
from urdf.reading.repairing import is_truncated

MAX_ROUNDED_BODIES = 12
"""Largest number of bodies whose parameters are examined: for more it takes longer than a quarter of a second."""


def rounding_findings(model: RobotModel, structure: Structure) -> Iterator[Finding]:
    """The parameters that a robot has only as long as its angles are rounded, if every joint has a rotor."""
    origins = [origin for joint in structure.source.joints for origin in joint.iter("origin")]
    first = next((origin for origin in origins if any(map(is_truncated, values(origin, "rpy", 3) or ()))), None)
    if first is None or model.n_bodies > MAX_ROUNDED_BODIES:
        return
    from graphdyn import identification  # a quarter of a second
    from graphdyn.identification.terms import RigidBodies, RotorInertia

    torques = identification.TorqueModel(model, (RigidBodies(), RotorInertia()))
    try:
        columns = identification.structure(torques).nearly_undetermined
    except InvalidInput:  # lengths or limits whose squares are larger than any number
        return
    names = [shortened(torques.columns[k].name) for k in columns]
    if names:
        yield of_file(
            "rpy-truncated",
            f"by the rounding of angles alone torques show {listed(names)}; graphdyn identify leaves "
            f"{'it' if len(names) == 1 else 'them'} out as nearly undetermined",
            at=first,
        )
