"""The dynamics body after body, compiled for the robot at hand: graphdyn._projected for many samples.

The arguments are arrays of one common leading shape (graphdyn._arrays.joint_arrays, unchecked); external wrenches are
absent where there are none.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from graphdyn import _projected as projected
from graphdyn._arrays import with_wrenches
from graphdyn._base_motion import BaseMotion
from graphdyn._errors import GraphDynError
from graphdyn._frame_choice import FrameChoice
from graphdyn._model import RobotModel
from graphdyn._projected import Arguments, Specification, refuse_singular
from graphdyn.kernels.batch import Evaluation, Options, evaluate
from graphdyn.layout import Array


def answers(
    model: RobotModel,
    specification: Specification,
    recursion: str,
    outputs: tuple[str, ...],
    x: Arguments,
    base: BaseMotion | None,
    options: Options,
    out: Mapping[str, Array] | None,
    frame: FrameChoice | None = None,
) -> dict[str, Array]:
    """These outputs of a recursion, which agrees with the specification. Raises SingularMassMatrix."""
    answer = evaluate(model, recursion, outputs, x, base, options, out, frame)
    if answer.suspects.size:
        _decide(model, answer, specification, x, base)
    return answer.arrays


def _decide(
    model: RobotModel, answer: Evaluation, specification: Specification, x: Arguments, base: BaseMotion | None
) -> None:
    """Refuse samples with a singular mass matrix; solve those that merely have a small pivot by projection."""
    batch = x["q"].shape[:-1]
    index = np.unravel_index(answer.suspects, batch) if batch else ()
    chosen = with_wrenches(model, {name: array[index] for name, array in x.items()})
    there = None if base is None else base.at(batch, index)
    if not model.chords:  # whose specification refuses by itself
        rows = list(zip(*index, strict=True)) if batch else None
        refuse_singular(model, projected.mass_matrix(model, chosen, there)["mass_matrix"], rows)
    try:
        solved = specification(model, chosen, there, False)
    except GraphDynError:
        if model.chords:  # that of all samples names the row
            specification(model, with_wrenches(model, x), base, False)
        raise
    for name, array in answer.arrays.items():
        array[index] = solved[name]
