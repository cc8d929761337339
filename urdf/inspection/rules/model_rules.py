"""Findings about the whole robot: whether its mass matrix determines accelerations, and its units are plausible."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from graphdyn import RobotModel, mass_matrix
from graphdyn.layout import Array
from urdf.document.elements import name_of
from urdf.errors import listed
from urdf.inspection.findings import Finding, about, of_file
from urdf.inspection.rules.loop_rules import loop_findings
from urdf.inspection.structure import Structure

N_STATES, SEED = 5, 0
"""Number of random states at which the mass matrix is examined, and their seed."""

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


def model_findings(model: RobotModel, structure: Structure) -> Iterator[Finding]:
    """Findings about a robot that loads."""
    yield from _bodies(model, structure)
    yield from _units(model)
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
