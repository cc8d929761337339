"""Programs in equal steps: each operation once, after its operands, with the numbers of the program."""

import numpy as np
import pytest
from random_trees import NAMED, random_state

import graphdyn
from graphdyn.export.functions import AS_THEY_ARE, exported_functions
from graphdyn.export.steps import KINDS, in_steps


@pytest.mark.parametrize("width", [1, 16])
def test_steps_compute_the_program(width):
    model = NAMED["mixed_chain"]
    (function,) = exported_functions(model, ["joint_accelerations"], AS_THEY_ARE)
    program, x = function.program, dict(zip(("q", "v", "tau"), random_state(model, 1), strict=True))
    steps = in_steps(program, width)
    assert sorted(steps.row) == list(range(len(program.operations)))
    assert len(set(steps.row.values())) == len(steps.row)
    rows = np.full(steps.rows, np.nan)
    for place, k in enumerate(steps.first):
        kind, *of = program.operations[k]
        at = [rows[steps.row[j]] for j in of if kind not in ("constant", "input")]
        if kind == "constant":
            rows[place] = of[0]
        elif kind == "input":
            rows[place] = x[of[0]][of[1]]
        else:
            rows[place] = {"sine": np.sin, "cosine": np.cos, "+": np.add, "-": np.subtract, "*": np.multiply}[kind](*at)
    apply = dict(zip(KINDS, (np.multiply, np.add, np.subtract, np.divide, lambda a, _: -a), strict=True))
    used = set(steps.row.values())
    for at, (left, right, kind) in enumerate(zip(steps.left, steps.right, steps.kind, strict=True)):
        first = len(steps.first) + at * width
        for place in range(width):
            if first + place in used:
                rows[first + place] = apply[KINDS[kind[place]]](rows[left[place]], rows[right[place]])
    found = rows[[steps.row[k] for k in program.outputs["a"]]]
    expected = graphdyn.joint_accelerations(model, x["q"], x["v"], x["tau"])
    assert np.abs(found - expected).max() <= 1e-12 * np.abs(expected).max()
