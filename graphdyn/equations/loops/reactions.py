"""What joints and chords of robots with loops transmit, and which of it the equations do not determine.

Redundant rows leave combinations of multipliers that nothing determines (self-stresses of the linkage); what takes part
in one is NaN. Forces are along t_1, t_2, p of each joint and chord.
"""

from __future__ import annotations

from dataclasses import dataclass
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from graphdyn.equations import projected
from graphdyn.equations.kinematics import MaximalState, joint_axes
from graphdyn.equations.specification import Arguments
from graphdyn.equations.system.chord_rows import chord_rows
from graphdyn.equations.system.reactions import transmitted_wrenches
from graphdyn.equations.system.unconstrained import passive_terms
from graphdyn.layout import ANGULAR, LINEAR, Array, per_body
from graphdyn.model.loops import SELF_STRESS_SHARE, LoopSpaces
from graphdyn.model.robot_model import RobotModel
from graphdyn.model.spatial import apply


def reactions(
    state: MaximalState, spaces: LoopSpaces, accelerations: Array, external_wrenches: Array, chord_multipliers: Array
) -> dict[str, Array]:
    """What joints and chords transmit, from any chord multipliers that move the robot so; NaN where undetermined."""
    rows, _ = chord_rows(state)
    required = projected.inertial_terms(state, accelerations) - passive_terms(state, external_wrenches)
    required = required + per_body(apply(np.swapaxes(rows, -1, -2), chord_multipliers))
    found = transmission(state.model, along_pins(state, transmitted_wrenches(state, required)), chord_multipliers)
    undetermined = in_self_stress(state.model, self_stress(state, rows, spaces))
    return {
        "body_accelerations": accelerations,
        **{name: np.where(undetermined[name], np.nan, array) for name, array in found.items()},
    }


def along_pins(state: MaximalState, wrenches: Array) -> Array:
    """World wrenches (…, n, 6) at O_j as force, moment along t_1, t_2, p of each joint."""
    vertices, axes = state.vertices, joint_axes(state)
    triads = np.empty((*axes.shape, 3))
    for k, joint in enumerate(state.model.joints):
        in_world = vertices.rotation[..., joint.inside, :, :] @ joint.placement.rotation
        triads[..., k, :, :] = np.stack([*(in_world @ t for t in joint.axis_normals), axes[..., k, :]], axis=-2)
    return np.concatenate([apply(triads, wrenches[..., part]) for part in (LINEAR, ANGULAR)], axis=-1)


def transmission(model: RobotModel, wrenches: Array, chord_multipliers: Array) -> dict[str, Array]:
    """The answers that state joint wrenches along the pins (…, n, 6) and chord multipliers (…, m)."""
    slides = [joint.is_prismatic for joint in model.joints]
    held = np.array([[0, 1, 3, 4, 5] if slide else [0, 1, 2, 3, 4] for slide in slides])
    along = np.array([[2] if slide else [5] for slide in slides])
    transmitted = _components(wrenches, along)[..., 0]
    return {
        "multipliers": _components(wrenches, held),
        "joint_wrenches": wrenches,
        "coupling_multipliers": transmitted @ model.degrees_of_freedom.reactions.T,
        "chord_multipliers": chord_multipliers,
    }


def _components(wrenches: Array, chosen: NDArray[np.intp]) -> Array:
    picked: Array = np.take_along_axis(
        wrenches, np.broadcast_to(chosen, (*wrenches.shape[:-1], chosen.shape[-1])), axis=-1
    )
    return picked


@dataclass(frozen=True, eq=False)
class SelfStress:
    """Reactions that hold each other without any load, a column for each combination (…, d = m), many of them zero.

    joints: in the order force, moment along t_1, t_2, p    (…, n, 6, d)
    chords: (…, m, d)
    """

    joints: Array
    chords: Array


def self_stress(state: MaximalState, rows: Array, spaces: LoopSpaces) -> SelfStress:
    """Chord multipliers that do no work on any joint motion, and what the joints transmit then.

    rows: φ_q of the chords                                 (…, m, 6n)
    """
    n = state.model.n_bodies
    chords = np.where(spaces.redundant[..., None, :], spaces.left, 0.0)
    loads = np.swapaxes(np.swapaxes(rows, -1, -2) @ chords, -1, -2)  # (…, d, 6n)
    of_bodies = loads.reshape(*loads.shape[:-1], n, 6)
    each = [along_pins(state, transmitted_wrenches(state, of_bodies[..., k, :, :])) for k in range(loads.shape[-2])]
    return SelfStress(np.stack(each, axis=-1), chords)


def in_self_stress(model: RobotModel, stress: SelfStress) -> dict[str, NDArray[np.bool_]]:
    """Which multipliers and components of joint wrenches take part in a self-stress, by the name of the answer."""
    combinations = range(stress.chords.shape[-1])
    columns = [
        transmission(model, *in_sizes_of_loops(model, stress.joints[..., d], stress.chords[..., d]))
        for d in combinations
    ]
    involved = {name: np.zeros(array.shape, dtype=bool) for name, array in columns[0].items()}
    for column in columns:
        of_joints, of_chords = np.abs(column["joint_wrenches"]), np.abs(column["chord_multipliers"])
        largest = np.maximum(of_joints.max(axis=(-2, -1), initial=0.0), of_chords.max(axis=-1, initial=0.0))
        limit = SELF_STRESS_SHARE * np.where(largest > 0, largest, np.inf)
        for name, array in column.items():
            involved[name] |= np.abs(array) > limit.reshape(*limit.shape, *(1,) * (array.ndim - limit.ndim))
    return involved


def in_sizes_of_loops(model: RobotModel, joints: Array, chords: Array) -> tuple[Array, Array]:
    """Wrenches of joints (…, n, 6) and chord multipliers (…, m) with moments by the size of the loops [N], so that they
    compare with forces."""
    loops = model.loops.in_sizes
    return joints / np.repeat([1.0, loops.length_unit], 3), chords * (loops.row_units / loops.length_unit)


_usual: WeakKeyDictionary[RobotModel, dict[str, NDArray[np.bool_]]] = WeakKeyDictionary()


def in_self_stress_usually(model: RobotModel) -> dict[str, NDArray[np.bool_]]:
    """in_self_stress at the regular pose of the model: what is undetermined in all but singular poses."""
    if model not in _usual:
        q = model.regular_pose
        state = Arguments(model, {"q": q}).rooted_state()
        stress = self_stress(
            state, chord_rows(state)[0], model.loops.spaces(model.loops.jacobian(model.loops.links(q)))
        )
        _usual[model] = in_self_stress(model, stress)
    return _usual[model]
