"""Numbers to test exported code with: states, and what the equations answer there."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from graphdyn.export.functions import ExportedFunction
from graphdyn.layout import Array
from graphdyn.verbs.assembly import assemble

VECTOR_STATES = 20
"""States of a test: two batches and a half in double precision."""

TOLERANCE = {"double": 1e-9, "single": 1e-4}
"""Largest error, as a share of the largest number of an array: far above rounding, which grows with the condition of
the mass matrix, and far below any mistake in a formula."""

SPREAD = 3.0
"""Standard deviation of accelerations, torques, wrenches and the motion of the base."""


def vectors(function: ExportedFunction, rng: np.random.Generator) -> tuple[dict[str, Array], dict[str, Array]]:
    """Inputs and outputs, arrays (N, …) by name. Raises InconsistentState where loops do not close."""
    from scipy.spatial.transform import Rotation  # imported where first used: import graphdyn stays light

    model = function.model
    q, v = model.random_state(rng, VECTOR_STATES)
    x: dict[str, Array] = {}
    for name in function.inputs:
        x[name] = rng.normal(scale=SPREAD, size=(VECTOR_STATES, *function.shape(name)))
    known: Mapping[str, Array] = {"q": q, "v": v, "base_rotation": Rotation.random(VECTOR_STATES, rng).as_matrix()}
    x |= {name: array for name, array in known.items() if name in x}
    if model.chords and "a" in x:
        *_, x["a"] = assemble(model, q, v, x["a"])
    return x, function.expected(x)
