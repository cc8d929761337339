"""What the head of every exported model says: units, frames, numbering."""

from __future__ import annotations

from crosscheck.commands.export.record import ExportedModel
from crosscheck.report.plain_text import printable
from crosscheck.report.records.record import versions


def head(model: ExportedModel, numbering: str) -> list[str]:
    """Lines of a comment. numbering: of bodies and joints in this language, one sentence"""
    locked = ", ".join(f"{printable(name)} at {value:g}" for name, value in model.locked.items())
    return [
        f"Rigid-body model of {printable(model.robot)}, written by graphdyn {versions()['graphdyn']}.",
        *([f"Locked joints: {locked}."] if locked else []),
        "",
        "Units: m, rad, kg, kg m^2, m/s^2.",
        numbering,
        "",
        "rotation R, translation t: placement of the joint frame in the link frame of the parent; a point with",
        "    coordinates x in the joint frame has R x + t in the link frame of the parent",
        "axis: unit axis in the joint frame. The link frame of the body coincides with the joint frame at q = 0;",
        "    a revolute joint turns it about the axis by q, a prismatic joint shifts it along the axis by q",
        "center_of_mass: in the link frame",
        "inertia: tensor about the center of mass, in link axes",
        "gravity: in world axes. base_rotation, base_translation: placement of the ground frame in the world",
        "frame_...: further named frames fixed in bodies, placed in their link frames",
    ]
