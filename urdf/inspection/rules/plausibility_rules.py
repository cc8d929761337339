"""Findings about numbers that are possible and hardly true: motors too weak for the links, links out of line."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from lxml import etree

from graphdyn import RobotModel, gravity_torque, mass_matrix
from urdf.document.elements import name_of
from urdf.errors import listed, shortened
from urdf.inspection.findings import Finding, about
from urdf.inspection.rules.twin_rules import twin_findings
from urdf.inspection.structure import LinkInertial, Structure
from urdf.reading.corrections import mirrored_names

N_POSES, SEED = 50, 0
"""Number of random poses at which motors are compared with links, and their seed."""

MAX_COMPARED_BODIES = 60
"""Largest number of bodies whose motors are compared with them: for more it takes longer than half a second."""

DOUBTFUL_LOAD = 2.0
"""Gravity torque over effort from which a joint is doubtful: makers' arms with a payload or poses that they never take
reach 1.4."""

MIN_ACCELERATION = 1.0
"""Acceleration at full effort [rad/s² or m/s²] below which a joint hardly moves; the slowest sound robot has 6."""

HEAVY, DOUBTFULLY_HEAVY = 3.0, 10.0
"""Mass over those of both neighbors in a chain: of a few sound robots (an elbow between two light motors), of none."""

MIN_ALONE = 4
"""Number of moving links with mass from which one that outweighs all others is worth a note."""


def plausibility_findings(model: RobotModel, structure: Structure) -> Iterator[Finding]:
    """Findings about a robot that loads, joint by joint and link by link."""
    links = {name_of(link): link for link in structure.source.links}
    if model.n_bodies <= MAX_COMPARED_BODIES:
        yield from _motors(model.opened.uncoupled, structure)
    yield from _heavy(model, links)
    moving = [each for each in structure.inertials if structure.moving(each.link) and each.mass > 0]
    yield from _equal(structure, moving)
    yield from twin_findings(moving)


def _motors(model: RobotModel, structure: Structure) -> Iterator[Finding]:
    """Joints whose effort does not hold or hardly accelerates what they carry."""
    q, _ = model.random_state(np.random.default_rng(SEED), N_POSES)
    held = np.abs(gravity_torque(model, q)).max(axis=0)
    inertia = np.einsum("kjj->kj", mass_matrix(model, q)).max(axis=0)
    limits = {name_of(joint): joint.find("limit") for joint in structure.movable}
    for joint, load, moved in zip(model.joints, held, inertia, strict=True):
        effort, limit = joint.limits.effort, limits.get(joint.name)
        if limit is None or effort is None or not effort > 0:
            continue
        unit, rate = ("N", "m/s²") if joint.is_prismatic else ("N m", "rad/s²")
        if load > effort:
            yield about(
                "effort-below-gravity",
                limit,
                f"gravity takes up to {load:.3g} {unit} within the limits of position, the effort is {effort:.3g} "
                f"{unit}",
                "warning" if load > DOUBTFUL_LOAD * effort else "note",
            )
        if moved * MIN_ACCELERATION > effort:
            yield about(
                "effort-below-inertia",
                limit,
                f"an effort of {effort:.3g} {unit} accelerates the joint by {effort / moved:.2g} {rate} in some poses",
            )


def _heavy(model: RobotModel, links: dict[str, etree._Element]) -> Iterator[Finding]:
    """Links that outweigh both neighbors in a chain, or all other links."""
    masses = [body.mass for body in model.bodies]
    outside: dict[int, list[int]] = {}
    for k, joint in enumerate(model.joints):
        outside.setdefault(joint.inside, []).append(k)
    for k, (body, joint) in enumerate(zip(model.bodies, model.joints, strict=True)):
        ahead = outside.get(k + 1, [])
        if joint.inside == 0 or len(ahead) != 1:  # a torso carries several limbs
            continue
        neighbors = masses[joint.inside - 1], masses[ahead[0]]
        if min(neighbors) > 0 and body.mass > HEAVY * max(neighbors):
            factor = body.mass / max(neighbors)
            yield about(
                "heavy-link",
                links[body.name],
                f"{body.mass:.3g} kg, {factor:.3g} times the heavier of its neighbors ({neighbors[0]:.3g} and "
                f"{neighbors[1]:.3g} kg)",
                "warning" if factor > DOUBTFULLY_HEAVY else "note",
            )
    heaviest = int(np.argmax(masses))
    if np.count_nonzero(masses) >= MIN_ALONE and masses[heaviest] > sum(masses) - masses[heaviest]:
        rest = sum(masses) - masses[heaviest]
        problem = f"{masses[heaviest]:.3g} kg, more than all other moving links together ({rest:.3g} kg)"
        yield about("heaviest-link", links[model.bodies[heaviest].name], problem)


def _equal(structure: Structure, moving: list[LinkInertial]) -> Iterator[Finding]:
    """Links with one inertial and different meshes."""
    alike: dict[tuple[float, bytes, bytes], list[LinkInertial]] = {}
    for each in moving:
        if each.size > 0:
            alike.setdefault((each.mass, each.center.tobytes(), each.tensor.tobytes()), []).append(each)
    drawings = structure.source.drawings.drawings
    meshes = {each.link: each.mesh_file for each in drawings if each.geometry == "visual" and each.mesh_file}
    for group in alike.values():
        files = {meshes[each.link] for each in group if each.link in meshes}
        first, *others = (each.link for each in group)
        is_pair = len(others) == 1 and (others[0] in mirrored_names(first) or first in mirrored_names(others[0]))
        if len(files) > 1 and not is_pair:
            yield about(
                "equal-inertials",
                group[0].element,
                f"the inertial of {listed(shortened(name) for name in others)}, too, with other meshes",
            )
