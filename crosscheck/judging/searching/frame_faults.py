"""Faults of functions of one frame: another frame, an inverted placement, rates of angles in place of ω."""

from __future__ import annotations

import dataclasses
import warnings
from collections.abc import Iterator

import numpy as np

from crosscheck.judging.faults.fault import AXES
from crosscheck.judging.searching.found_fault import AnswerFault
from crosscheck.judging.states import JudgedStates
from crosscheck.quantities import FUNCTIONS, Quantity
from crosscheck.quantities.measures import Chosen, linear_first
from graphdyn.layout import Array


def other_frames(known: Quantity, states: JudgedStates) -> Iterator[AnswerFault]:
    if known.name == "frame_placement":
        yield AnswerFault(
            "frame", "the placement is inverted: the world seen from the frame", "invert it",
            lambda s, c: np.asarray(np.linalg.inv(known.of_graphdyn(s, c)), dtype=float),
        )  # fmt: skip
        yield AnswerFault(
            "frame", "the placement is inverted, but its translation is not turned: -p, not -Rᵀ p", "invert it",
            lambda s, c: _rotation_transposed(known.of_graphdyn(s, c)) * _SIGNS_OF_INVERSE,
        )  # fmt: skip
        yield AnswerFault(
            "frame", "the last row is (0, 0, 0, 0), not (0, 0, 0, 1)", "a placement ends with (0, 0, 0, 1)",
            lambda s, c: np.concatenate([(x := known.of_graphdyn(s, c))[:, :3], 0 * x[:, 3:]], axis=1),
        )  # fmt: skip
        for order, shift in (("x, y, z, w", 1), ("w, x, y, z", -1)):
            yield AnswerFault(
                "frame", f"the quaternion of the rotation is taken in the order {order}, which is not its own",
                "tell whether w is the first or the last number",
                lambda s, c, shift=shift: _reordered(known.of_graphdyn(s, c), shift),  # type: ignore[misc]
            )  # fmt: skip
        yield AnswerFault(
            "frame", "the rotation is transposed", "its columns are the axes of the frame in world axes",
            lambda s, c: _rotation_transposed(known.of_graphdyn(s, c)),
        )  # fmt: skip
    if known.name in ("frame_jacobian", "frame_velocity"):
        yield from _rates_of_angles(known)
    assert states.frame is not None
    own = states.model.frame(states.frame)
    for other in (*states.model.body_names, *(frame.name for frame in states.model.frames)):
        if other != own.name:
            yield AnswerFault(
                "frame", f"the answers are those of frame '{other}'", f"frame '{own.name}' is asked for",
                lambda s, c, name=other: known.of_graphdyn(dataclasses.replace(s, frame=name), c),  # type: ignore[misc]
            )  # fmt: skip


ANGLES = {"roll, pitch and yaw": "xyz", "yaw, pitch and roll": "ZYX", "the Euler angles of z, y, z": "ZYZ"}
"""Angles of an attitude, in the notation of scipy: about fixed axes in small letters, about those that turn in capital
ones."""

MAX_LOCK = 1e5
"""Condition number of the axes of the angles beyond which their rates are rounding: gimbal lock."""


def _rates_of_angles(known: Quantity) -> Iterator[AnswerFault]:
    """Rates of angles in place of an angular velocity, the analytic Jacobian."""
    for what, sequence in ANGLES.items():
        yield AnswerFault(
            "frame", f"the angular part is of the rates of {what}, not of the angular velocity",
            "the geometric Jacobian is asked for: ω, not the rates of angles",
            lambda s, c, sequence=sequence: _with_rates(known, sequence, s, c),  # type: ignore[misc]
            lambda s, sequence=sequence: np.linalg.cond(_axes_of_angles(s, sequence)) > MAX_LOCK,  # type: ignore[misc]
        )  # fmt: skip


def _axes_of_angles(states: JudgedStates, sequence: str) -> Array:
    """The axes about which the angles turn the frame, as columns, in world axes (N, 3, 3)."""
    from scipy.spatial.transform import Rotation  # imported where first used

    R = FUNCTIONS["frame_placement"].of_graphdyn(states, {})[:, :3, :3]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # gimbal lock at special states
        angles = Rotation.from_matrix(R).as_euler(sequence)
    fixed = sequence.islower()
    axes = [AXES[letter.lower()] + 0 * R[:, 0] for letter in sequence]
    turn = np.eye(3) + 0 * R
    for k in (2, 1, 0) if fixed else (0, 1, 2):  # the axis of each angle, after the turns that come later or before
        axes[k] = np.einsum("nij,nj->ni", turn, axes[k])
        turn = turn @ Rotation.from_rotvec(angles[:, k, None] * AXES[sequence[k].lower()]).as_matrix()
    return np.stack(axes, axis=-1)


def _with_rates(known: Quantity, sequence: str, states: JudgedStates, chosen: Chosen) -> Array:
    answer = known.of_graphdyn(states, chosen)
    angular = known.of_graphdyn(states, {**chosen, "reference": "local_world_aligned", "order": "linear first"})
    angular = np.moveaxis(angular, known.six, -1)[..., 3:]
    vectors = np.moveaxis(angular.reshape(len(angular), -1, 3), -1, -2)
    solved = np.linalg.pinv(_axes_of_angles(states, sequence)) @ vectors
    rates = np.moveaxis(solved, -1, -2).reshape(angular.shape)
    linear = np.moveaxis(linear_first(answer, chosen, known.six), known.six, -1)[..., :3]
    found = np.moveaxis(np.concatenate([linear, rates], axis=-1), -1, known.six)
    return linear_first(found, chosen, known.six)


def _reordered(placed: Array, shift: int) -> Array:
    """The placements with the numbers of their quaternions shifted; w is positive, as most functions give it."""
    from scipy.spatial.transform import Rotation  # imported where first used

    found = placed.copy()
    quaternions = Rotation.from_matrix(placed[:, :3, :3]).as_quat()
    quaternions = quaternions * np.where(quaternions[:, 3:] < 0, -1.0, 1.0)
    found[:, :3, :3] = Rotation.from_quat(np.roll(quaternions, shift, axis=1)).as_matrix()
    return found


_SIGNS_OF_INVERSE = np.array([[1, 1, 1, -1], [1, 1, 1, -1], [1, 1, 1, -1], [1, 1, 1, 1]])
"""Signs of the numbers of a placement whose translation is reversed."""


def _rotation_transposed(placed: Array) -> Array:
    found = placed.copy()
    found[:, :3, :3] = np.swapaxes(placed[:, :3, :3], -1, -2)
    return found
