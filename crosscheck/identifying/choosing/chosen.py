"""Torque models with the terms of the drives that the recording chooses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from crosscheck.identifying.choosing.ladder import Ladder, climbed
from crosscheck.identifying.methods.candidate_models import CandidateModel
from crosscheck.identifying.preparing.preparation import Preparation
from crosscheck.recordings import Recording
from graphdyn import RobotModel


def with_chosen_drives(
    models: Sequence[CandidateModel],
    robot: RobotModel,
    recording: Recording,
    preparation: Preparation,
    *,
    memory: bool = True,
) -> tuple[list[CandidateModel], dict[str, Ladder]]:
    """The torque models, those whose drives are to be chosen with their terms, and how these were chosen, by name.

    recording: differentiated rows of the fit; memory: whether terms may have memory
    """
    found, ladders = [], dict[str, Ladder]()
    for model in models:
        if model.choose_drives:
            ladder = climbed(robot, model.terms, model.known, recording, preparation, memory=memory)
            ladders[model.name] = ladder
            model = replace(model, terms=(*model.terms, *ladder.model.terms), choose_drives=False)
        found.append(model)
    return found, ladders
