"""New inertials, armature, damping and friction in an existing MJCF file, which changes in no other byte."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

import numpy as np
from lxml import etree

from graphdyn import Body, Joint, RobotModel
from graphdyn.display import short_repr
from graphdyn.layout import Array
from graphdyn.model import check_model
from urdf.document.document import check_size, root_of
from urdf.document.files import write_whole
from urdf.document.mjcf import Compiled, compiled_mjcf, expand_mjcf, is_mjcf
from urdf.errors import CannotUpdate, listed, one_line, shortened
from urdf.reading.loading import armed
from urdf.reading.parsing import build, parsed_source
from urdf.reading.reading import AS_IT_STANDS
from urdf.writing.in_place import check_editable
from urdf.writing.mjcf.grouping import refuse_impossible
from urdf.writing.mjcf.positions import Edit, positions, with_edits
from urdf.writing.mjcf.saving import mjcf_inertial

PLACEMENT_TOLERANCE = 1e-6
"""Largest difference [m, 1] of placements and axes of joints between the model and the file: digits of a file."""

KEPT_TOLERANCE = 1e-14
"""Numbers that differ by less than this share of the largest of their kind in the body stay as they are written."""

READ_BACK_TOLERANCE = 1e-12
"""Largest relative difference between the parameters that are wanted and those that MuJoCo makes of the new file."""

DRIVE = {"damping": "damping", "frictionloss": "friction", "armature": "armature"}
"""Attributes of <joint>, with their names in graphdyn.Joint."""


@dataclass(frozen=True)
@short_repr
class Patch:
    """What urdf.patch_mjcf did.

    bodies, joints: with new numbers; notes: bodies whose mass is shared with bodies fixed to them
    """

    path: Path
    bodies: tuple[str, ...]
    joints: tuple[str, ...]
    notes: tuple[str, ...]


def patch_mjcf(model: RobotModel, source: str | PathLike[str], destination: str | PathLike[str]) -> Patch:
    """Write a copy of an MJCF file with the inertials, armature, damping and friction of the model.

    model: has the joints of the file, by name, at the same places; its bodies may carry others that are fixed to them
    source: the MJCF file; destination: may be the same path

    Bodies fixed to others keep their own <inertial>; the body that carries them gets the rest. Numbers that are the
    same already are not written again. What MuJoCo makes of the new file is compared with the model before it is
    written.

    Raises CannotUpdate for another robot, and for bodies and joints that the file itself does not write (by <include>,
    <replicate> or without a name); CannotSave for inertials that MuJoCo refuses; urdf.load's errors for the source;
    OSError.
    """
    check_model(model)
    path = Path(source)
    data = path.read_bytes()
    check_size(data, path)
    root = root_of(path, data)
    if not is_mjcf(root):
        raise CannotUpdate("the file is not MJCF", "give a file whose root element is <mujoco>", path=path)
    check_editable(path, data)
    document, _, parsed = parsed_source(path, AS_IT_STANDS)
    old = armed(build(parsed, document.gravity), document)
    native = compiled_mjcf(path, data, root)
    wanted = _wanted(model, old, path)
    found = positions(data)
    edits: list[Edit] = []
    joints: list[str] = []
    notes: list[str] = []
    changed: list[tuple[str, Body, Array]] = []
    for number, (before, joint) in enumerate(zip(old.bodies, old.joints, strict=True), start=1):
        body, new = wanted[joint.name]
        values = {name: getattr(new, field) for name, field in DRIVE.items() if _differ(new, joint, field)}
        if values:
            edits += found.attributes(_known(joint.name, found.joints, "joint", path), values)
            joints.append(joint.name)
        if not _same(body.parameters, before.parameters):
            shares = {
                name: share
                for name, (carrier, share) in parsed.assembly.fused.items()
                if carrier == number and name != native.body_of[joint.name] and share.any()
            }
            changed.append(_rest(native, joint.name, body, shares, path))
            notes += _shared(changed[-1], shares)
    if changed and native.changed_inertials:
        names = ", ".join(native.changed_inertials)
        problem = f"settings of <compiler> change the inertials that are written: {names}"
        raise CannotUpdate(problem, "remove them, with the inertials that MuJoCo makes of them", path=path)
    refuse_impossible([body for _, body, _ in changed])
    for name, body, center in changed:
        element = etree.tostring(mjcf_inertial(body, center))
        edits.append(found.inertial(_known(name, found.inertials, "body", path), element))
    content = with_edits(data, edits)
    _read_back(wanted, path, content)
    write_whole(Path(destination), content)
    return Patch(Path(destination), tuple(name for name, _, _ in changed), tuple(joints), tuple(notes))


def _wanted(model: RobotModel, old: RobotModel, path: Path) -> dict[str, tuple[Body, Joint]]:
    """Body and joint of the model by the name of the joint. Raises CannotUpdate for another robot."""
    only_model, only_file = set(model.joint_names) - set(old.joint_names), set(old.joint_names) - set(model.joint_names)
    if only_model or only_file:
        said = [
            f"{where} has {listed(sorted(names))}"
            for where, names in (("only the robot", only_model), ("only the file", only_file))
            if names
        ]
        problem = f"its joints are not those of robot '{shortened(model.name)}': {'; '.join(said)}"
        raise CannotUpdate(problem, "give the file of the same robot, with the same names of joints", path=path)
    number = {name: k for k, name in enumerate(model.joint_names)}
    for joint in old.joints:
        other = model.joints[number[joint.name]]
        inside = [m.joint_names[j.inside - 1] if j.inside else "" for m, j in ((old, joint), (model, other))]
        here = old.base @ joint.placement if joint.inside == 0 else joint.placement
        there = model.base @ other.placement if other.inside == 0 else other.placement
        apart = max(
            np.abs(here.translation - there.translation).max(),
            np.abs(here.rotation - there.rotation).max(),
            np.abs(joint.axis - other.axis).max(),
        )
        if inside[0] != inside[1] or apart > PLACEMENT_TOLERANCE:
            problem = f"is placed otherwise than in robot '{shortened(model.name)}' (by {apart:.3g})"
            remedy = (
                "inertials belong to link frames: give a robot with the frames of this file, such as the file itself"
            )
            raise CannotUpdate(problem, remedy, path=path, element=f"joint '{shortened(joint.name)}'")
    return {name: (model.bodies[k], model.joints[k]) for name, k in number.items()}


def _differ(new: Joint, old: Joint, field: str) -> bool:
    wanted, known = getattr(new, field), getattr(old, field)
    return bool(abs(wanted - known) > KEPT_TOLERANCE * abs(known))


def _same(new: Array, old: Array) -> bool:
    scales = np.repeat([abs(old[0]), np.abs(old[1:4]).max(), np.abs(old[4:]).max()], [1, 3, 6])
    return bool(np.all(np.abs(new - old) <= KEPT_TOLERANCE * scales))


def _rest(native: Compiled, joint: str, body: Body, shares: Mapping[str, Array], path: Path) -> tuple[str, Body, Array]:
    """Name of the file's body, its inertials in link axes, and its center of mass from the file's own origin."""
    name = native.body_of[joint]
    if joint not in native.last:
        problem = "has mass, but stands between two joints of one body of the file"
        raise CannotUpdate(problem, "give it none", path=path, element=f"body '{shortened(body.name)}'")
    rest = body.parameters - sum(shares.values(), np.zeros(len(body.parameters)))
    if rest[0] <= 0:
        remedy = "bodies fixed to it weigh as much or more by themselves: correct them first"
        element = f"body '{shortened(name)}'"
        raise CannotUpdate(f"would get a mass of {rest[0]:.6g} kg", remedy, path=path, element=element)
    alone = Body.from_parameters(name, rest) if shares else Body(name, body.mass, body.center_of_mass, body.inertia)
    return name, alone, alone.center_of_mass + native.anchor[joint]


def _shared(rest: tuple[str, Body, Array], shares: Mapping[str, Array]) -> list[str]:
    if not shares:
        return []
    names = ", ".join(f"'{shortened(name)}' ({share[0]:.6g} kg)" for name, share in shares.items())
    said = f"body '{shortened(rest[0])}' gets {rest[1].mass:.6g} kg: {names}, fixed to it, keep their own <inertial>"
    return [one_line(said)]


def _known(name: str, found: Mapping[str, object], kind: str, path: Path) -> str:
    if name not in found:
        problem = "is not written in the file itself, but included, copied or without a name"
        remedy = "name it, or write the file as a whole: urdf.save_mjcf (graphdyn export --to mjcf)"
        raise CannotUpdate(problem, remedy, path=path, element=f"{kind} '{shortened(name)}'")
    return name


def _read_back(wanted: Mapping[str, tuple[Body, Joint]], path: Path, content: bytes) -> None:
    """Raises CannotUpdate if MuJoCo makes other numbers of the new file."""
    expansion = expand_mjcf(path, content, root_of(path, content), use_geoms=False)
    _, _, parsed = parsed_source(expansion.text, AS_IT_STANDS)
    for body, joint in zip(parsed.assembly.bodies, parsed.assembly.joints, strict=True):
        asked, drive = wanted[joint.name]
        scale = np.abs(asked.parameters).max()
        wrong = np.abs(body.parameters - asked.parameters).max() > READ_BACK_TOLERANCE * scale
        numbers = (joint.damping, joint.friction, expansion.beyond.armature.get(joint.name, 0.0))
        if wrong or not np.allclose(numbers, (drive.damping, drive.friction, drive.armature), rtol=1e-12, atol=0):
            problem = "MuJoCo reads other numbers from the new file than were written"
            raise CannotUpdate(
                problem, "report it, with the file", path=path, element=f"body '{shortened(asked.name)}'"
            )
