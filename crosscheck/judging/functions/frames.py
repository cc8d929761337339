"""Functions that answer where a frame of the robot is.

Functions that answer how a frame of the robot moves.
"""

from __future__ import annotations

import numpy as np

import graphdyn
from crosscheck.judging.functions.known_function import Chosen, KnownFunction, Measure
from crosscheck.judging.functions.measures import ORDER, linear_first, parts_relative_to
from crosscheck.judging.functions.pinocchio_answers import PinocchioAnswers
from crosscheck.judging.states.judged_states import JudgedStates
from crosscheck.quantities.scales import center_offset, largest, relative
from graphdyn.layout import ANGULAR, Array


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


TWIST_REFERENCES = ("local_world_aligned", "world", "local")
"""Where the axes and the point of a twist are: at the frame in world axes, at the world's origin, at the frame."""

BY_REFERENCE = {"reference": TWIST_REFERENCES, **ORDER}


def _reach(states: JudgedStates) -> Array:
    """Largest lever and distance from the world's origin [m]."""
    return states.sizes.lever + largest(states.origins)


def _unit(states: JudgedStates) -> Array:
    return 1.0 + 0.0 * states.sizes.lever


def _velocity(states: JudgedStates) -> Array:
    return states.sizes.velocity + _omega(states) * largest(states.origins)


def _omega(states: JudgedStates) -> Array:
    return largest(states.motion.velocity[..., ANGULAR])


def _acceleration(states: JudgedStates) -> Array:
    return states.sizes.acceleration + states.sizes.turn * largest(states.origins)


def _turn(states: JudgedStates) -> Array:
    return states.sizes.turn


def _of_frame(
    verb: str,
    arguments: tuple[str, ...],
    shape: tuple[int | str, ...],
    unit: str,
    errors: Measure,
    scale: str,
    *,
    accelerates: bool = False,
) -> KnownFunction:
    """A verb of graphdyn; accelerates: it takes classical= beside reference=."""

    def ours(states: JudgedStates, chosen: Chosen) -> Array:
        options = {"classical": chosen["acceleration"] == "classical"} if accelerates else {}
        given = (getattr(states, name) for name in arguments)
        found: Array = getattr(graphdyn, verb)(
            states.model, *given, states.frame, reference=chosen["reference"], **options
        )
        return linear_first(found, chosen, axis=-len(shape))

    def theirs(there: PinocchioAnswers, chosen: Chosen) -> Array | None:
        spatial = "_spatial" if chosen.get("acceleration") == "spatial" else ""
        found = there.of_frame(f"{verb}{spatial}", chosen["reference"])
        return None if found is None else linear_first(found, chosen, axis=-len(shape))

    said = ", classical={classical}" if accelerates else ""
    return KnownFunction(
        verb,
        arguments,
        shape,
        unit,
        ours,
        errors,
        scale,
        f"graphdyn.{verb}(model, {', '.join(arguments)}, {{frame!r}}, reference={{reference!r}}{said})",
        theirs,
        conventions={**BY_REFERENCE, **({"acceleration": ("classical", "spatial")} if accelerates else {})},
        needs_frame=True,
    )


FRAMES = (
    _of_frame(
        "frame_jacobian", ("q",), (6, "n"), "m or 1, 1 or 0",
        parts_relative_to(_reach, _unit, axis=-2),
        "linear rows: lever, distance from the world's origin; angular rows: 1",
    ),
    _of_frame(
        "frame_jacobian_derivative", ("q", "v"), (6, "n"), "m/s or 1/s, 1/s or 0",
        parts_relative_to(_velocity, _omega, axis=-2),
        "linear rows: ‖ω‖ × (lever, distance from the world's origin); angular rows: ‖ω‖",
    ),
    _of_frame(
        "frame_velocity", ("q", "v"), (6,), "m/s, rad/s",
        parts_relative_to(_velocity, _omega),
        "linear: ‖ω‖ × (lever, distance from the world's origin) + slide rate; angular: ‖ω‖",
    ),
    _of_frame(
        "frame_acceleration", ("q", "v", "a"), (6,), "m/s², rad/s²",
        parts_relative_to(_acceleration, _turn),
        "linear: (‖ω̇‖ + ‖ω‖²) × (lever, distance from the world's origin) + slides; angular: ‖ω̇‖ + ‖ω‖²",
        accelerates=True,
    ),
)  # fmt: skip
