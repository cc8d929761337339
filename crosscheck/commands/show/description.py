"""What `graphdyn show` says of a robot that was loaded, and of the matrix of its equations."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from crosscheck import exact
from crosscheck.commands.show.loops import LoopsDescription, describe_loops
from crosscheck.commands.show.state import StateDescription
from crosscheck.exact import Proof
from crosscheck.reference.subject import OfReading
from crosscheck.report.records.record import Count, Keywords
from graphdyn import RobotModel, kkt_system
from graphdyn.layout import BODY_DOF, JOINT_CONSTRAINTS, Array
from urdf import DHTable, Reading
from urdf.reading import AS_IT_STANDS

SEED = 0
"""Seed of the random state at which the matrix of Eq. (111) is shown."""

ZERO_ENTRY_SHARE = 1e-14
"""Part of the largest entry of its block (body, joint, coupling or chord by another) below which an entry is zero."""


@dataclass(frozen=True, eq=False)
class SystemDescription:
    """The matrix [A φ_qᵀ; φ_q 0] of Eq. (111) at one random state.

    seed: seed of the state
    q: the state (n,) [rad or m]
    pattern: whether an entry differs from zero by more than rounding
    rank: numerical rank; full: size. With loops it is less where rows depend on each other
    condition_number: 2-norm condition number in SI units; ∞ where the matrix is singular
    size: rows and columns: 11n, one for each coupling, one for each row of a chord
    """

    seed: Count
    q: Array
    pattern: NDArray[np.bool_]
    rank: Count
    condition_number: float
    size: Annotated[int, Keywords(minimum=11)]


@dataclass(frozen=True, eq=False)
class RobotDescription(OfReading):
    """A robot of n bodies: its parts, its graph, and the pattern of its equations.

    robot: name or path as given
    reading: how it was loaded
    loops: None where the robot is a tree
    system: the matrix of Eq. (111)
    state: what was asked for with --state; None where nothing was
    proofs: what is proven of the decimals of the file, at that state or that of the equations; None without --proofs
    dh: Denavit-Hartenberg parameters; None without --dh
    """

    model: RobotModel
    robot: str
    reading: Reading
    loops: LoopsDescription | None
    system: SystemDescription
    state: StateDescription | None
    proofs: tuple[Proof, ...] | None
    dh: DHTable | None

    @property
    def total_mass(self) -> float:
        """Mass of the moving bodies [kg]."""
        return sum(body.mass for body in self.model.bodies)


def describe(
    model: RobotModel,
    robot: str,
    reading: Reading = AS_IT_STANDS,
    state: StateDescription | None = None,
    prove: bool = False,
    dh: DHTable | None = None,
) -> RobotDescription:
    """Everything about a robot that was loaded under this name.

    Raises InconsistentState, naming the loop, where none of many poses closes it; what crosscheck.prove raises.
    """
    loops = describe_loops(model, None if state is None else state.q) if model.chords else None
    system = _system(model, loops)
    proofs = exact.prove(robot, system.q if state is None else state.q, reading=reading) if prove else None
    return RobotDescription(model, robot, reading, loops, system, state, proofs, dh)


def _system(model: RobotModel, loops: LoopsDescription | None) -> SystemDescription:
    if loops is not None and loops.analysis.infinitesimal_mobility:  # no velocities keep the loops closed
        q, v = loops.q, np.zeros_like(loops.q)
    else:
        q, v = model.random_state(np.random.default_rng(SEED))
    system = kkt_system(model, q, v, np.zeros_like(q))
    rank, size = int(system.rank()), len(system.rhs)
    return SystemDescription(
        seed=SEED,
        q=q,
        pattern=_pattern(system.matrix, model),
        rank=rank,
        condition_number=float(system.condition_number()) if rank == size else np.inf,
        size=size,
    )


def _pattern(matrix: Array, model: RobotModel) -> NDArray[np.bool_]:
    """Entries that are more than the rounding of their block (the shape of the matrix)."""
    n, of_chords = model.n_bodies, [len(chord.rows) for chord in model.chords]
    sizes = n * [BODY_DOF] + n * [JOINT_CONSTRAINTS] + len(model.couplings) * [1] + of_chords
    block = np.repeat(np.arange(len(sizes)), sizes)
    largest = np.zeros((len(sizes), len(sizes)))
    np.maximum.at(largest, (block[:, None], block), np.abs(matrix))
    pattern: NDArray[np.bool_] = np.abs(matrix) > ZERO_ENTRY_SHARE * largest[block[:, None], block]
    return pattern
