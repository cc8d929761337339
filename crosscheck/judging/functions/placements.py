"""Functions that answer where a frame of the robot is."""

from __future__ import annotations

import numpy as np

import graphdyn
from crosscheck.judging.functions.known_function import Chosen, KnownFunction
from crosscheck.judging.functions.pinocchio_answers import PinocchioAnswers
from crosscheck.judging.judged_states import JudgedStates
from crosscheck.referee.scales import center_offset, largest, relative
from graphdyn.layout import Array


def _placement(states: JudgedStates, chosen: Chosen) -> Array:
    assert states.frame is not None
    return homogeneous(*graphdyn.frame_placement(states.model, states.q, states.frame))


def _placement_of_pinocchio(there: PinocchioAnswers, chosen: Chosen) -> Array:
    return homogeneous(*there.frame_placement())


def homogeneous(rotation: Array, position: Array) -> Array:
    """[[R, p], [0, 1]] (N, 4, 4) from R (N, 3, 3) and p (N, 3)."""
    placed = np.zeros((len(position), 4, 4))
    placed[:, :3, :3], placed[:, :3, 3], placed[:, 3, 3] = rotation, position, 1.0
    return placed


def _errors(answer: Array, reference: Array, states: JudgedStates, chosen: Chosen) -> Array:
    place = (slice(None), slice(0, 3), 3)
    reach = largest(states.origins) + center_offset(states.model)
    turned, shifted = answer.copy(), relative(answer[place], reference[place], reach)
    turned[place] = reference[place]
    return np.maximum(largest(turned - reference), shifted)


PLACEMENTS = (
    KnownFunction(
        "frame_placement", ("q",), (4, 4), "m",
        ours=_placement,
        errors=_errors,
        scale="rotations: 1; positions: largest position of a link, offset of a center of mass",
        code="np.vstack([np.column_stack(graphdyn.frame_placement(model, q, {frame!r})), [0, 0, 0, 1]])",
        pinocchio=_placement_of_pinocchio,
        needs_frame=True,
    ),
)  # fmt: skip
