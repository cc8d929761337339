"""Automatic differentiation of recorded scalars, operation by operation and through each other."""

import numpy as np
import pytest

from graphdyn.compiler.interpreter import Interpreter
from graphdyn.scalars.differentiation import directional, gradient, jacobian, substituted
from graphdyn.scalars.expressions import Recorder

ROUNDING = 1e-14
"""Of some ten operations on numbers near one, against the derivative worked out by hand."""

AT = np.array([0.7, -1.3])


def values(results, recorder):
    """Of recorded scalars at x, y = AT."""
    program = recorder.program({"out": results}, {})
    out = np.empty((1, len(results)))
    Interpreter(program).bind({"x": AT[None]}, {"out": out})(0, 1)
    return out[0]


FUNCTIONS = {
    "sum": (lambda x, y: x + y + 2.0, lambda x, y: (1, 1)),
    "difference": (lambda x, y: 3.0 - x - y, lambda x, y: (-1, -1)),
    "product": (lambda x, y: x * y * 2.0, lambda x, y: (2 * y, 2 * x)),
    "quotient": (lambda x, y: x / y, lambda x, y: (1 / y, -x / y**2)),
    "reciprocal": (lambda x, y: 1.0 / (x * y), lambda x, y: (-1 / (x**2 * y), -1 / (x * y**2))),
    "negative": (lambda x, y: -(x * x) + -y, lambda x, y: (-2 * x, -1)),
    "sine": (lambda x, y: (x * y).sine, lambda x, y: (y * np.cos(x * y), x * np.cos(x * y))),
    "cosine": (lambda x, y: (x - y).cosine, lambda x, y: (-np.sin(x - y), np.sin(x - y))),
    "power": (lambda x, y: x**3 * y, lambda x, y: (3 * x**2 * y, x**3)),
    "shared": (
        lambda x, y: (x.sine * y) * (x.sine * y) + x.sine,
        lambda x, y: (2 * np.sin(x) * np.cos(x) * y**2 + np.cos(x), 2 * np.sin(x) ** 2 * y),
    ),
    "one only": (lambda x, y: x.cosine, lambda x, y: (-np.sin(x), 0)),
}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_derivatives_by_hand(name):
    function, expected = FUNCTIONS[name]
    recorder = Recorder()
    x, y = recorder.inputs("x", 2)
    result = function(x, y)
    by_hand = np.array(expected(*AT), dtype=float)
    assert values(gradient(result, [x, y]), recorder) == pytest.approx(by_hand, rel=ROUNDING, abs=ROUNDING)
    along = directional([result, 5.0], [x, y], [2.0, y])
    assert values(along, recorder) == pytest.approx([2 * by_hand[0] + AT[1] * by_hand[1], 0.0], rel=ROUNDING)


def test_second_derivatives():
    recorder = Recorder()
    x, y = recorder.inputs("x", 2)
    rows = jacobian(gradient(x * x * y.sine, [x, y]), [x, y])
    u, w = AT
    expected = [2 * np.sin(w), 2 * u * np.cos(w), 2 * u * np.cos(w), -(u**2) * np.sin(w)]
    assert values(list(rows.ravel()), recorder) == pytest.approx(expected, rel=ROUNDING)


def test_what_does_not_depend_on_a_variable_records_nothing():
    recorder = Recorder()
    x, y = recorder.inputs("x", 2)
    product = y.sine * y
    before = len(recorder.operations)
    assert gradient(product, [x]).tolist() == [0.0]
    assert gradient(3.0, [x, y]).tolist() == [0.0, 0.0]
    assert directional([product, 3.0], [x], [1.0]) == [0.0, 0.0]
    assert directional([3.0], [x], [1.0]) == [0.0]
    assert len(recorder.operations) == before


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_what_is_held_counts_as_a_constant(sign):
    """Although it is computed from the variables, and also where its sign was moved outside."""
    recorder = Recorder()
    x, y = recorder.inputs("x", 2)
    product = sign * (x * y)
    rows = jacobian([product * x + product.sine * y, product], [x, y], held=[product, 4.0])
    u, w = AT
    expected = [sign * u * w, np.sin(sign * u * w), 0.0, 0.0]
    assert values(list(rows.ravel()), recorder) == pytest.approx(expected, rel=ROUNDING)


def test_substitution():
    recorder = Recorder()
    x, y = recorder.inputs("x", 2)
    a, b = recorder.placeholders("y", 2)
    result = (a * x + b.sine) / (a - y) - b.cosine
    placed = substituted([result, a, x, 4.0], {a: x * y, b: -2.0 * x})
    u, w = AT
    first = (u * w * u + np.sin(-2 * u)) / (u * w - w) - np.cos(-2 * u)
    assert values(placed, recorder) == pytest.approx([first, u * w, u, 4.0], rel=ROUNDING)
    assert substituted([1.0, 2.0], {a: x}) == [1.0, 2.0]
    program = recorder.program({"out": placed}, {})
    assert program.inputs == {"x": 2}
    assert not any(operation[:2] == ("input", "") for operation in program.operations)
