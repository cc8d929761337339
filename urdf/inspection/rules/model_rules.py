"""Findings about the whole robot: plausible units, a mass matrix that determines accelerations, loops that close."""

from __future__ import annotations

from collections.abc import Generator, Iterator
from dataclasses import replace

import numpy as np

from graphdyn import InconsistentState, RobotModel, mass_matrix
from graphdyn.errors import counted
from graphdyn.layout import Array
from graphdyn.model import CLOSED_TOLERANCE, LOOP_RANK_TOLERANCE, assembled, loop_spaces, refuse_infinitesimal
from urdf.document.elements import name_of
from urdf.errors import listed, shortened
from urdf.inspection.findings import Finding, about, of_file
from urdf.inspection.structure import Structure
from urdf.loops.mimics import INDEPENDENT_VALUES, unbound_dependents

N_STATES, SEED = 5, 0
"""Number of random states at which the mass matrix and the loops are examined, and their seed."""

STATE_DISTANCE = 0.1
"""How far from the first closed state others are looked for [rad or m]."""

MAX_CHORD_ROWS = 100
"""Largest number of chord rows that are examined: closing more takes longer than a second."""


MAX_EXAMINED_BODIES = 200
"""Largest number of bodies whose mass matrix is examined: for more it takes longer than a second."""

MIN_ILL_CONDITION = 1e8
"""Condition number from which an acceleration has lost half of its digits."""

PSEUDO_INERTIA_TOLERANCE = 1e-9
"""Part of the largest eigenvalue of a pseudo-inertia matrix below which a negative one is rounding."""

MIN_REACH, MAX_REACH = 0.02, 50.0
"""Plausible reach of a robot [m]: sum of the distances between joints, along the longest branch."""

MIN_LINK_DENSITY, MAX_LINK_DENSITY = 0.05, 5000.0
"""Plausible total mass over the cube of the reach [kg/m³]; arms have 10 to 1000."""


def closed_states(model: RobotModel) -> Array:
    """Joint positions that close the loops (N_STATES, nv); the first near q = 0.

    Raises InconsistentState where none is found.
    """
    start = model.closed_pose
    strayed = start + STATE_DISTANCE * np.random.default_rng(SEED).standard_normal((N_STATES, start.size))
    strayed[0] = start
    q, gaps = assembled(model.loops, strayed)
    closed: Array = q[model.loops.widest(gaps) <= CLOSED_TOLERANCE]
    return closed


def free_motions(model: RobotModel, q: Array) -> list[Array]:
    """Per state: a basis of the joint velocities that keep the loops closed (nv, f), in the units of the loops."""
    spaces = model.loops.spaces(model.loops.jacobian(model.loops.links(q)))
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
    try:
        refuse_infinitesimal(f"robot '{model.name}'", model.loops, q[0])
    except InconsistentState as error:
        yield of_file("infinitesimal-mobility", str(error))
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
    if model.loops.widest(gaps) > CLOSED_TOLERANCE:
        said.append(f"at q = 0 the loops are open by {gaps.max():.2g} m or rad")
    if motions[0].shape[-1] > degrees_of_freedom:
        said.append("the closed pose next to q = 0 is singular")
    return of_file("loop-rows", "; ".join(said))


def _idle(model: RobotModel, motion: Array) -> Iterator[Finding]:
    """Degrees of freedom that the motors do not hold."""
    if model.actuated is None:
        return
    joints = model.independent_joints
    in_units = motion / model.loops.column_units[:, None]
    of_motors = loop_spaces(in_units[[joints.index(name) for name in model.actuated]])
    idle = in_units @ of_motors.right[:, of_motors.free]
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
        name_of(joint): INDEPENDENT_VALUES[joint.get("independent", "true").lower()] for joint in structure.movable
    }
    if not any("independent" in joint.attrib for joint in structure.movable):
        return
    joints = model.independent_joints
    stated = [k for k, name in enumerate(joints) if marks.get(name, True)]
    in_units = motion / model.loops.column_units[:, None]
    rank = np.count_nonzero(np.linalg.svd(in_units[stated], compute_uv=False) > LOOP_RANK_TOLERANCE) if stated else 0
    if not rank == len(stated) == motion.shape[-1]:
        named = listed(shortened(joints[k]) for k in stated)
        yield of_file(
            "independent-contradiction",
            f"the loops leave {counted(motion.shape[-1], 'degree', 'degrees')} of freedom, but the motions of the "
            f"{counted(len(stated), 'joint that is', 'joints that are')} not marked "
            f'independent="false" determine {rank} of them: {named}',
        )


def model_findings(model: RobotModel, structure: Structure) -> Iterator[Finding]:
    """Findings about a robot that loads."""
    yield from _bodies(model, structure)
    yield from _units(model)
    if unbound := unbound_dependents(structure.source, model):
        yield of_file("unbound-joints", f'joints marked independent="false" that move by themselves: {listed(unbound)}')
    closed = (yield from loop_findings(model, structure)) if model.chords else None
    yield from _mass_matrix(model, closed)


def _bodies(model: RobotModel, structure: Structure) -> Iterator[Finding]:
    links = {name_of(link): link for link in structure.source.links}
    for body, verdict in zip(model.bodies, model.physical_consistency(), strict=True):
        eigenvalue = verdict.pseudo_inertia_eigenvalue
        if eigenvalue < -PSEUDO_INERTIA_TOLERANCE * max(np.abs(body.parameters).max(), 1e-300):
            yield about(
                "inconsistent-body",
                links[body.name],
                "together with all links fixed to it, no physically possible body: the pseudo-inertia matrix has "
                f"eigenvalue {eigenvalue:.3g}",
            )


def _units(model: RobotModel) -> Iterator[Finding]:
    along = np.zeros(model.n_bodies + 1)
    for j, joint in enumerate(model.joints, start=1):
        along[j] = along[joint.inside] + np.linalg.norm(joint.placement.translation)
    ends = [along[frame.body] + np.linalg.norm(frame.placement.translation) for frame in model.frames]
    reach, mass = float(max(along.max(), *ends, 0.0)), sum(body.mass for body in model.bodies)
    if not MIN_REACH <= reach <= MAX_REACH:
        yield of_file("suspicious-lengths", f"the joints span {reach:.3g} m along the longest branch")
    elif mass > 0 and not MIN_LINK_DENSITY <= mass / reach**3 <= MAX_LINK_DENSITY:
        yield of_file("suspicious-masses", f"{mass:.3g} kg on a reach of {reach:.3g} m")


def _mass_matrix(model: RobotModel, closed: list[Array] | None) -> Iterator[Finding]:
    """closed: mass matrices of the motions that keep loops closed, None where there are no loops."""
    n = model.n_bodies
    if n > MAX_EXAMINED_BODIES:
        problem = f"{n} moving bodies: the mass matrix of more than {MAX_EXAMINED_BODIES} is not examined"
        yield of_file("mass-matrix-not-examined", problem)
        return
    if closed is None:
        q, _ = model.random_state(np.random.default_rng(SEED), N_STATES)
        yield from _judged(model, mass_matrix(model, q), f"over {N_STATES} random states (seed {SEED})")
    elif closed:
        yield from _judged(model, np.array(closed), f"over motions that keep the loops closed, at {len(closed)} poses")


def _judged(model: RobotModel, matrices: Array, where: str) -> Iterator[Finding]:
    n = matrices.shape[-1]
    if not np.isfinite(matrices).all():
        yield of_file("mass-matrix-not-examined", f"the mass matrix is larger than any number {where}")
        return
    ranks, negative = _ranks(matrices)
    if negative.any():
        problem = f"the mass matrix has negative eigenvalues {where}: some motion has a negative kinetic energy"
        yield of_file("mass-matrix-indefinite", problem)
    if ranks.min() < n:
        massless = [body.name for body in model.bodies if body.mass == 0 or not body.inertia.any()]
        cause = f"bodies without mass or inertia: {listed(massless)}" if massless else "every body has mass"
        yield of_file(
            "mass-matrix-singular",
            f"the mass matrix has rank {_span(ranks)} of {n} {where}: torques do not determine accelerations ({cause})",
        )
        return
    conditions = np.linalg.cond(matrices)
    yield of_file("mass-matrix", f"the mass matrix has rank {n} and condition number {_span(conditions)} {where}")
    if conditions.max() > MIN_ILL_CONDITION:
        problem = f"the condition number of the mass matrix reaches {conditions.max():.3g}: accelerations lose digits"
        yield of_file("mass-matrix-ill-conditioned", problem)


def _ranks(matrices: Array) -> tuple[Array, Array]:
    """Per matrix (k, n, n): its rank, and whether an eigenvalue is negative.

    The rank is the smaller of two: with scaling to unit diagonal, by which forward dynamics judge a mass matrix, and
    without, where a joint whose inertia is mere rounding does not count.
    """
    diagonal = np.abs(np.diagonal(matrices, axis1=-2, axis2=-1))
    scale = np.where(diagonal > 0, diagonal, 1.0) ** -0.5
    scaled = matrices * scale[..., :, None] * scale[..., None, :]
    values = np.linalg.eigvalsh(np.stack([matrices, scaled]))
    limit = matrices.shape[-1] * np.finfo(float).eps * np.abs(values).max(axis=-1, keepdims=True)
    ranks = (np.abs(values) > limit).sum(axis=-1).min(axis=0)
    return ranks, (values < -limit).any(axis=(0, -1))


def _span(numbers: Array) -> str:
    low, high = f"{numbers.min():.3g}", f"{numbers.max():.3g}"
    return low if low == high else f"{low} to {high}"
