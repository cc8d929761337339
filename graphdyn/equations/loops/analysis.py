"""What the loops of a robot hold at a pose, and which reactions they leave undetermined."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from graphdyn.arguments.arrays import one_state
from graphdyn.display import short_repr
from graphdyn.equations.loops.dynamics import closed
from graphdyn.equations.loops.reactions import in_self_stress, in_sizes_of_loops, self_stress, transmission
from graphdyn.equations.specification import Arguments
from graphdyn.equations.system.chord_rows import chord_rows
from graphdyn.errors import InvalidInput
from graphdyn.layout import JOINT_CONSTRAINTS, Array
from graphdyn.model.assembly import infinitesimal_motions
from graphdyn.model.loops import LOOP_RANK_TOLERANCE, NEAR_SINGULAR_SHARE, SELF_STRESS_SHARE, Loops, pivoted_columns
from graphdyn.model.robot_model import RobotModel

DIRECTION_SHARE = 1e-2
"""Part of a motion along others below which it is one of them: the gaps that count as closed turn motions by 1e-4."""


@dataclass(frozen=True, eq=False)
@short_repr
class LoopAnalysis:
    """Answer of analyze_loops.

    n_rows, rank: constraint rows of joints, couplings and chords, and how many of them are independent
    mobility: motions that keep all loops closed
    infinitesimal_mobility: motions that keep them closed to first order alone, as in a linkage that closes only when
        stretched; the dynamics are refused there
    grubler_mobility: 6 bodies less the rows, after Grübler and Kutzbach: what it would be, were all rows independent
    usual_rank: rank in a regular pose; the pose is singular where the rank is lower
    motions: joint motions that keep the loops closed, orthonormal columns in the sizes of the loops   (nv, mobility)
    determined_multipliers, determined_wrenches, determined_chord_multipliers: which reactions the equations determine,
        in the shapes (n, 5), (n, 6) and (n_chord_rows,) of forward_dynamics, where the others are NaN
    self_stresses: combinations of reactions that hold each other without any load; each by the names of the joint or
        chord and the direction along its t1, t2, p, relative to its largest    ("elbow force p": 1.0, …)
    """

    n_rows: int
    rank: int
    mobility: int
    infinitesimal_mobility: int
    grubler_mobility: int
    usual_rank: int
    motions: Array
    determined_multipliers: NDArray[np.bool_]
    determined_wrenches: NDArray[np.bool_]
    determined_chord_multipliers: NDArray[np.bool_]
    self_stresses: tuple[dict[str, float], ...]

    @property
    def is_singular(self) -> bool:
        """More motions are free here than in a regular pose."""
        return self.rank < self.usual_rank


def analyze_loops(model: RobotModel, q: ArrayLike) -> LoopAnalysis:
    """Rank and redundancy of the loop constraints at ONE pose q (nv,) [rad or m].

    Raises InvalidInput for a robot without chords and for more than one pose; InconsistentState, naming the loop, where
    one is open.

    >>> import graphdyn, numpy as np
    >>> from graphdyn import Body, Chord, Joint, Placement, RobotModel
    >>> def at(x):
    ...     return Placement(translation=np.array([x, 0.0, 0.0]))
    ...
    >>> bodies = [Body(name, 1.0, (0.5, 0, 0), 0.1 * np.eye(3)) for name in ("upper", "lower")]
    >>> joints = [Joint(f"joint {k}", "continuous", k, at(float(k)), (0, 0, 1)) for k in (0, 1)]
    >>> rod = Chord("rod", "distance", 0, at(2.0), 2, at(1.0), length=1.5)  # from the ground to the lower end
    >>> model = RobotModel("linkage", bodies, joints, chords=[rod])
    >>> found = graphdyn.analyze_loops(model, graphdyn.assemble(model, [0.5, 1.0]))
    >>> found.rank, found.mobility
    (11, 1)
    """
    x = one_state(model, None, q=q)["q"]
    if not model.chords:
        raise InvalidInput(f"robot '{model.name}' has no loops: all its reactions are determined")
    held = closed(model, x, moving=False)
    loops, state = model.loops.in_sizes, Arguments(model, {"q": x}).rooted_state()
    shaky = infinitesimal_motions(loops, x)
    spaces = loops.spaces(held.jacobian, _share(shaky))
    of_tree = JOINT_CONSTRAINTS * model.n_bodies + len(model.couplings)
    rank, usual = int(spaces.rank), _usual_rank(loops, model.regular_pose)
    stress = self_stress(state, chord_rows(state)[0], spaces)
    undetermined = in_self_stress(model, stress)
    motions = _without(spaces.right[:, spaces.free], shaky, loops.column_units[:, None])
    return LoopAnalysis(
        n_rows=of_tree + model.n_chord_rows,
        rank=of_tree + rank,
        mobility=motions.shape[1],
        infinitesimal_mobility=shaky.shape[1],
        grubler_mobility=model.nv - model.n_chord_rows,
        usual_rank=of_tree + usual,
        motions=motions,
        determined_multipliers=~undetermined["multipliers"],
        determined_wrenches=~undetermined["joint_wrenches"],
        determined_chord_multipliers=~undetermined["chord_multipliers"],
        self_stresses=_named(model, *_sparse(loops, stress.joints, spaces.left, spaces.redundant)),
    )


def _share(shaky: Array) -> float:
    """Below which part of the largest a singular value is zero: where motions are infinitesimal, gaps leave some of
    their root."""
    return NEAR_SINGULAR_SHARE if shaky.shape[1] else LOOP_RANK_TOLERANCE


def _usual_rank(loops: Loops, q: Array) -> int:
    share = _share(infinitesimal_motions(loops, q))
    return int(loops.spaces(loops.jacobian(loops.links(q)), share).rank)


def _without(motions: Array, others: Array, units: Array) -> Array:
    """Motions (nv, f), less their part along others (nv, k); columns of both are orthonormal in units (nv, 1)."""
    if not others.shape[1]:
        return motions
    of_others = others / units
    left, values, _ = np.linalg.svd(
        motions / units - of_others @ (of_others.T @ (motions / units)), full_matrices=False
    )
    rest: Array = left[:, values > DIRECTION_SHARE] * units
    return rest


def _sparse(loops: Loops, joints: Array, left: Array, redundant: NDArray[np.bool_]) -> tuple[Array, Array]:
    """Self-stresses of joints (n, 6, d) and chords (m, d), each without the chord rows that lead the others.

    The columns are combined so that d rows, chosen by pivoting, form a unit matrix: small combinations by name.
    """
    chords = left[:, redundant]
    leading = pivoted_columns((chords * loops.row_units[:, None]).T, chords.shape[1])
    change = np.linalg.inv(chords[leading])
    return joints[..., redundant] @ change, chords @ change


def _named(model: RobotModel, joints: Array, chords: Array) -> tuple[dict[str, float], ...]:
    found = []
    for d in range(chords.shape[1]):
        parts = _by_name(model, joints[..., d], chords[:, d])
        in_sizes = _by_name(model, *in_sizes_of_loops(model, joints[..., d], chords[:, d]))
        largest, limit = max(parts.values(), key=abs), SELF_STRESS_SHARE * max(map(abs, in_sizes.values()))
        found.append({name: part / largest for name, part in parts.items() if abs(in_sizes[name]) > limit})
    return tuple(found)


def _by_name(model: RobotModel, joints: Array, chords: Array) -> dict[str, float]:
    """What joints (n, 6), chords (m,) and couplings transmit in a self-stress."""
    directions = [f"{what} {axis}" for what in ("force", "moment") for axis in ("t1", "t2", "p")]
    slides = np.array([2 if joint.is_prismatic else 5 for joint in model.joints])
    column = transmission(model, joints, chords)
    parts = {
        f"{joint.name} {direction}": float(column["joint_wrenches"][k, c])
        for k, joint in enumerate(model.joints)
        for c, direction in enumerate(directions)
        if c != slides[k]
    }
    parts |= dict(zip(model.loops.row_names(), column["chord_multipliers"].tolist(), strict=True))
    return parts | {
        f"coupling {coupling.joint}": float(x)
        for coupling, x in zip(model.couplings, column["coupling_multipliers"], strict=True)
    }
