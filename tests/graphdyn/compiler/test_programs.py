"""Which outputs vouch for which inputs, and what is watched instead of all of them."""

import numpy as np
import pytest
from back_ends import COMPILED, on
from random_trees import NAMED, random_state

import graphdyn
from graphdyn import InvalidInput
from graphdyn.compiler.programs import Request, sufficient, trace
from graphdyn.scalars.expressions import Recorder


def guarded(outputs):
    """Names of what is watched for the inputs a, b, c, d."""
    recorder = Recorder()
    inputs = recorder.inputs("x", 4)
    results = outputs(*inputs)
    names = {x.number: name for x, name in zip(inputs, "abcd", strict=True)}
    names.update({x.number: f"y{k}" for k, x in enumerate(results)})
    return [names[x.number] for x in sufficient(recorder, inputs, results)]


@pytest.mark.parametrize(
    ("outputs", "expected"),
    [
        (lambda a, b, c, d: [a * b + c - d], ["y0"]),
        (lambda a, b, c, d: [a * b, c * d], ["y0", "y1"]),
        (lambda a, b, c, d: [a * b, a * b * c], ["y1", "d"]),
        (lambda a, b, c, d: [a + b, 2.0 * c], ["y0", "c", "d"]),  # an input is as cheap as an output
        (lambda a, b, c, d: [a * b / c - d], ["y0", "c"]),  # 1 / ∞ is zero
        (lambda a, b, c, d: [a * b / (c.sine + d)], ["y0", "d"]),  # 1 / NaN is NaN
        (lambda a, b, c, d: [1.0 / (a + b + c + d)], ["a", "b", "c", "d"]),
        (lambda a, b, c, d: [(1.0 / (a + b)).sine + c], ["a", "b", "c", "d"]),
    ],
)
def test_outputs_vouch_for_inputs(outputs, expected):
    assert guarded(outputs) == expected


@pytest.mark.parametrize("back_end", ["numpy", *COMPILED])
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_every_argument_is_looked_at(back_end, value):
    """Each joint of each argument, in an arm whose torques two outputs vouch for."""
    model = NAMED["kr500"]
    assert len(trace(model, Request("inverse_dynamics", ("tau",))).guards["finite"]) == 2
    with on(back_end):
        for verb, third in ((graphdyn.joint_torques, "a"), (graphdyn.joint_accelerations, "tau")):
            for place, name in enumerate(("q", "v", third)):
                for joint in range(6):
                    arrays = [x.copy() for x in random_state(model, 1, (9,))]
                    arrays[place][7, joint] = value
                    with pytest.raises(InvalidInput, match=rf"{name} contains .*{value}.* at row 7"):
                        verb(model, *arrays, method="recursive")


@pytest.mark.parametrize("back_end", ["numpy", *COMPILED])
def test_what_overflows_is_no_fault_of_the_arguments(back_end):
    """Finite arguments are not refused where the torques are infinite."""
    q, v, a = random_state(NAMED["kr500"], 2, (9,))
    with on(back_end):
        torques = graphdyn.joint_torques(NAMED["kr500"], q, v * 1e200, a, method="recursive")
    assert not np.isfinite(torques).all()


@pytest.mark.parametrize("back_end", ["numpy", *COMPILED])
def test_far_angles_are_found_beside_nan_and_overflow(back_end):
    """The sum of squares is NaN or too large; an angle far away still keeps its digits."""
    model = NAMED["kr500"]
    q, v, a = random_state(model, 3, (9,))
    far, turns = q.copy(), 2 * np.pi * np.round(1e7 / (2 * np.pi))
    far[3, 1] += turns
    with on(back_end):
        expected = graphdyn.joint_torques(model, q, v, a, method="recursive")
        for row, value in ((5, np.nan), (5, 1e200)):
            spoilt = far.copy()
            spoilt[row, 2] = value
            found = graphdyn.joint_torques(model, spoilt, v, a, method="recursive", check=False)
            assert np.abs(found[3] - expected[3]).max() < 1e-8 * np.abs(expected[3]).max()  # 1e7 rad in 53 bits
            assert np.array_equal(found[0], expected[0])
