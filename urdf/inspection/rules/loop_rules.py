"""Findings about the loops of a robot: whether they close, what their rows hold, what moves with all motors held."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import replace

import numpy as np

from graphdyn import InconsistentState, RobotModel, mass_matrix
from graphdyn.errors import counted
from graphdyn.layout import Array
from graphdyn.model import CLOSED_TOLERANCE, LOOP_RANK_TOLERANCE, assembled, loop_spaces
from urdf.document.elements import name_of
from urdf.errors import listed, shortened
from urdf.inspection.findings import Finding, of_file
from urdf.inspection.structure import Structure
from urdf.loops.couplings import INDEPENDENT_VALUES

N_LOOP_STATES, SEED, STATE_DISTANCE = 5, 0, 0.1
"""Closed states that are examined, their seed, and how far from the first of them they are looked for [rad or m]."""

MAX_CHORD_ROWS = 100
"""Largest number of chord rows that are examined: closing more takes longer than a second."""


def closed_states(model: RobotModel) -> Array:
    """Joint positions that close the loops (N_LOOP_STATES, nv); the first near q = 0.

    Raises InconsistentState where none is found.
    """
    start = model.closed_pose
    strayed = start + STATE_DISTANCE * np.random.default_rng(SEED).standard_normal((N_LOOP_STATES, start.size))
    strayed[0] = start
    q, gaps = assembled(model.loops, strayed)
    closed: Array = q[np.abs(gaps).max(axis=-1) <= CLOSED_TOLERANCE]
    return closed


def free_motions(model: RobotModel, q: Array) -> list[Array]:
    """Per state: a basis of the joint velocities that keep the loops closed (nv, f)."""
    spaces = loop_spaces(model.loops.jacobian(model.loops.links(q)))
    return [right[:, free] for right, free in zip(spaces.right, spaces.free, strict=True)]


def loop_findings(model: RobotModel, structure: Structure) -> Generator[Finding, None, list[Array]]:
    """Findings about a robot with chords; returns the mass matrices of the motions that keep the loops closed."""
    yield from _massless(model)
    if model.n_chord_rows > MAX_CHORD_ROWS:
        problem = f"the loops have {model.n_chord_rows} rows: more than {MAX_CHORD_ROWS} are not examined"
        yield of_file("loops-not-examined", problem)
        return []
    try:
        q = closed_states(model)
    except InconsistentState as error:
        yield of_file("loop-cannot-close", str(error))
        return []
    motions = free_motions(model, q)
    yield _rows(model, motions)
    generic = min(motions, key=lambda motion: motion.shape[-1])  # singular poses have more
    yield from _idle(model, generic)
    yield from _independent(model, structure, generic)
    matrices = mass_matrix(replace(model, chords=(), actuated=None), q)
    projected = [motion.T @ matrix @ motion for motion, matrix in zip(motions, matrices, strict=True)]
    return [matrix for matrix in projected if 0 < len(matrix) == generic.shape[-1]]


def _massless(model: RobotModel) -> Iterator[Finding]:
    ends = {body for chord in model.chords for body in (chord.body_i, chord.body_j) if body}
    massless = [model.body_names[body - 1] for body in sorted(ends) if model.bodies[body - 1].mass == 0]
    if massless:
        yield of_file(
            "massless-closing-link",
            f"loops close at bodies without mass: {listed(massless)}. Pinocchio's constrained dynamics are NaN there",
        )


def _rows(model: RobotModel, motions: list[Array]) -> Finding:
    n, rows = model.nv, model.n_chord_rows
    degrees_of_freedom = min(motion.shape[-1] for motion in motions)
    held, gaps = n - degrees_of_freedom, np.abs(model.loops.gaps(np.zeros(n)))
    said = [f"{rows} rows close loops: they hold {held} of {n} degrees of freedom and leave {degrees_of_freedom}"]
    if held < rows:
        said.append(f"redundant rows: {rows - held}, so that not all reactions are determined")
    if gaps.max() > CLOSED_TOLERANCE:
        said.append(f"at q = 0 the loops are open by {gaps.max():.2g} m or rad")
    if motions[0].shape[-1] > degrees_of_freedom:
        said.append("the closed pose next to q = 0 is singular")
    return of_file("loop-rows", "; ".join(said))


def _idle(model: RobotModel, motion: Array) -> Iterator[Finding]:
    """Degrees of freedom that the motors do not hold."""
    if model.actuated is None:
        return
    joints = model.independent_joints
    of_motors = loop_spaces(motion[[joints.index(name) for name in model.actuated]])
    idle = motion @ of_motors.right[:, of_motors.free]
    if idle.shape[-1]:
        names = [name for name, row in zip(joints, idle, strict=True) if np.abs(row).max() > LOOP_RANK_TOLERANCE]
        yield of_file(
            "idle-degrees-of-freedom",
            f"degrees of freedom that no motor drives: {idle.shape[-1]}; "
            f"with all motors held, joints {listed(names)} can move",
        )


def _independent(model: RobotModel, structure: Structure, motion: Array) -> Iterator[Finding]:
    """Joints that are not marked independent="false", where any joint is marked."""
    marks = {
        name_of(joint): INDEPENDENT_VALUES.get((joint.get("independent") or "true").lower(), True)
        for joint in structure.movable
    }
    if not any("independent" in joint.attrib for joint in structure.movable):
        return
    joints = model.independent_joints
    stated = [k for k, name in enumerate(joints) if marks.get(name, True)]
    rank = np.count_nonzero(np.linalg.svd(motion[stated], compute_uv=False) > LOOP_RANK_TOLERANCE) if stated else 0
    if not rank == len(stated) == motion.shape[-1]:
        named = listed(shortened(joints[k]) for k in stated)
        yield of_file(
            "independent-contradiction",
            f"the loops leave {counted(motion.shape[-1], 'degree', 'degrees')} of freedom, but the motions of the "
            f"{counted(len(stated), 'joint that is', 'joints that are')} not marked "
            f'independent="false" determine {rank} of them: {named}',
        )
