"""Which frame a verb speaks of, and in which axes: the arguments of the frame verbs that are not arrays."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

from graphdyn._errors import InvalidInput
from graphdyn._model import RobotModel, check_model

Reference = Literal["world", "local", "local_world_aligned"]


@dataclass(frozen=True)
class FrameChoice:
    """name: of a frame of the robot; reference, classical: as in the frame verbs."""

    name: str
    reference: Reference
    classical: bool = True


def frame_choice(model: RobotModel, name: str, reference: str, classical: bool = True) -> FrameChoice:
    """Raises UnknownFrame for an unknown name, InvalidInput for an unknown reference."""
    check_model(model)
    for known in get_args(Reference):
        if reference == known:
            return FrameChoice(model.frame(name).name, known, bool(classical))
    raise InvalidInput(f"reference is {reference!r}; use one of {', '.join(get_args(Reference))}")
