"""What recording leaves out: operations on known numbers, repetitions, signs, and what nobody asks for."""

import numpy as np
import pytest
from random_trees import NAMED

import urdf
from graphdyn.compiler.interpreter import Interpreter
from graphdyn.compiler.native import CompiledProgram
from graphdyn.compiler.programs import Request, trace
from graphdyn.scalars.expressions import Expression, Recorder
from graphdyn.scalars.vectors import scalars


class Sheet:
    """A recorder with two inputs."""

    def __init__(self):
        self.recorder = Recorder()
        self.x, self.y = self.recorder.inputs("q", 2)

    def program(self, *answers):
        return self.recorder.program({"answer": list(answers)}, {})

    def cost(self, *answers):
        return self.program(*answers).arithmetic

    def value(self, answer, x, y):
        """By walking the operations in Python."""
        program, values = self.program(answer), []
        rules = {
            "constant": lambda value: value,
            "input": lambda _, column: (x, y)[column],
            "+": lambda a, b: values[a] + values[b],
            "-": lambda a, b: values[a] - values[b],
            "*": lambda a, b: values[a] * values[b],
            "/": lambda a, b: values[a] / values[b],
            "negate": lambda a: -values[a],
        }
        for kind, *arguments in program.operations:
            values.append(rules[kind](*arguments))
        return values[program.outputs["answer"][0]]


@pytest.fixture
def sheet():
    return Sheet()


FOLDS = {
    "x + 0": (lambda x, y: x + 0.0, 0),
    "0 + x": (lambda x, y: 0.0 + x, 0),
    "x - 0": (lambda x, y: x - 0.0, 0),
    "0 - x": (lambda x, y: 0.0 - x, 1),
    "0 x": (lambda x, y: 0.0 * x, 0),
    "x 0, an integer": (lambda x, y: x * 0, 0),
    "1 x": (lambda x, y: 1.0 * x, 0),
    "x 1, an integer": (lambda x, y: x * 1, 0),
    "x (-1)": (lambda x, y: x * -1.0, 1),
    "0 - (0 - x)": (lambda x, y: 0.0 - (0.0 - x), 0),
    "2 x": (lambda x, y: 2.0 * x, 1),
    "2 - x": (lambda x, y: 2.0 - x, 1),
    "1 / x": (lambda x, y: 1.0 / x, 1),
    "x / y": (lambda x, y: x / y, 1),
    "x / 2": (lambda x, y: x / 2.0, 1),
    "x / 3, an integer": (lambda x, y: x / 3, 1),
    "x / a number of NumPy": (lambda x, y: x / np.float64(3.0), 1),
    "a number of NumPy / x": (lambda x, y: np.float64(3.0) / x, 1),
    "x / 1": (lambda x, y: x / 1.0, 0),
    "x / (-1)": (lambda x, y: x / -1.0, 1),
    "0 / x": (lambda x, y: 0.0 / x, 0),
    "(-x) / y + x / y": (lambda x, y: (-x) / y + x / y, 2),
    "x / (-y) + x / y": (lambda x, y: x / (-y) + x / y, 2),
    "(-x) / (-y)": (lambda x, y: (-x) / (-y), 1),
    "3 / (-x) + 3 / x": (lambda x, y: 3.0 / (-x) + 3.0 / x, 2),
    "+x": (lambda x, y: +x, 0),
    "x⁰": (lambda x, y: x**0, 0),
    "x¹": (lambda x, y: x**1, 0),
    "x²": (lambda x, y: x**2, 1),
    "x³": (lambda x, y: x**3, 2),
    "x⁸": (lambda x, y: x**8, 3),
    "x⁻²": (lambda x, y: x**-2, 2),
    "x + (-y)": (lambda x, y: x + (-y), 1),
    "(-x) + y": (lambda x, y: (-x) + y, 1),
    "x - (-y)": (lambda x, y: x - (-y), 1),
    "3 - (-y)": (lambda x, y: 3.0 - (-y), 1),
    "(-x) 3": (lambda x, y: (-x) * 3.0, 2),
    "(-x) (-y)": (lambda x, y: (-x) * (-y), 1),
    "(-x) y + x y": (lambda x, y: (-x) * y + x * y, 2),
    "x y - y x": (lambda x, y: x * y - y * x, 2),
    "(x + y) (y + x)": (lambda x, y: (x + y) * (y + x), 2),
}
"""What is written, and how many operations it may cost."""


@pytest.mark.parametrize("name", FOLDS)
def test_folding_keeps_the_value_and_saves_operations(sheet, name):
    written, cost = FOLDS[name]
    answer = written(sheet.x, sheet.y)
    assert sheet.cost(answer) == cost
    for x, y in ((3.0, 5.0), (-0.25, 7.0), (2.0, -2.0)):
        assert sheet.value(answer, x, y) == written(x, y)


def test_known_results_are_numbers(sheet):
    for known in (0.0 * sheet.x, sheet.y * 0.0, 0.0 / sheet.x, sheet.x**0):
        assert isinstance(known, float)
    assert isinstance(sheet.x + 0.0, Expression)


@pytest.mark.parametrize("zero", [0.0, 0, -0.0, np.float64(0.0)])
def test_dividing_by_a_known_zero_is_an_error(sheet, zero):
    with pytest.raises(ZeroDivisionError, match="divided by a number that is known to be zero"):
        sheet.x / zero


@pytest.mark.parametrize("exponent", [0.5, 2.0, "2"])
def test_powers_are_of_integers(sheet, exponent):
    with pytest.raises(TypeError, match="unsupported operand"):
        sheet.x**exponent


def test_arrays_divide_by_element(sheet):
    rows = np.array([sheet.x, 3.0, sheet.y], dtype=object)
    assert [type(x) for x in rows / sheet.x] == [Expression] * 3
    assert sheet.cost(*(rows / sheet.x)) == 3
    assert sheet.cost(*(sheet.x / rows)) == 3


AWKWARD = (0.0, -0.0, np.inf, -np.inf, np.nan, 1e308, -1e308, 5e-324, 3e-310, 1.0, -1.0, 3.0, 0.1)
"""Zeros, what is not finite, what overflows or underflows, and numbers whose quotients are rounded."""


@pytest.mark.parametrize("lanes", [1, 2, 4, 8])
def test_quotients_and_powers_are_those_of_ieee_754(lanes):
    """Bit for bit on NumPy (one lane) and compiled, as NumPy divides and multiplies; NaN as NaN."""
    rng = np.random.default_rng(0)
    pairs = [(x, y) for x in AWKWARD for y in AWKWARD]
    q = np.array([*pairs, *(rng.normal(size=(2000, 2)) * 10.0 ** rng.integers(-300, 300, (2000, 2)))])
    recorder = Recorder()
    x, y = recorder.inputs("q", 2)
    program = recorder.program({"answer": [x / y, x / 3.0, 7.0 / x, 1.0 / y, x**3, x**-2]}, {})
    found = np.empty((len(q), 6))
    backend = Interpreter(program) if lanes == 1 else CompiledProgram(program, lanes)
    backend.bind({"q": q}, {"answer": found})(0, len(q))
    x, y = q.T
    with np.errstate(all="ignore"):
        expected = np.stack([x / y, x / 3.0, 7.0 / x, 1.0 / y, x * x * x, 1.0 / (x * x)], axis=-1)
    assert np.array_equal(np.isnan(found), np.isnan(expected))
    sound = ~np.isnan(expected)
    assert np.array_equal(found[sound].view(np.int64), expected[sound].view(np.int64))


def test_signs_go_outside_so_that_products_are_shared(sheet):
    x, y = sheet.x, sheet.y
    assert sheet.cost(x * y, -x * y, x * -y, -x * -y) == 2


def test_sine_and_cosine_are_computed_once(sheet):
    x = sheet.x
    assert sheet.cost(x.sine, x.sine * x.sine, x.cosine, 2.0 * x.sine) == 4


def test_vectors_of_scalars_multiply_like_matrices(sheet):
    matrix, vector = scalars([[0.0, 2.0], [1.0, 0.0]]), np.array([sheet.x, sheet.y], dtype=object)
    first, second = matrix @ vector
    assert sheet.cost(first, second) == 1
    assert second is sheet.x
    assert sheet.value(first, 3.0, 5.0) == 10.0


def test_programs_hold_what_is_asked_for_and_nothing_else(sheet):
    unwanted, wanted = sheet.x.sine * 3.0 + sheet.y, sheet.x * sheet.y
    program = sheet.program(wanted, 4.0)
    assert unwanted.number not in program.outputs["answer"]
    assert sorted(kind for kind, *_ in program.operations) == ["*", "constant", "input", "input"]
    assert [program.constant(number) for number in program.outputs["answer"]] == [None, 4.0]
    for number, (kind, *arguments) in enumerate(program.operations):
        assert kind in ("constant", "input") or all(k < number for k in arguments)
    assert program.length == 1 + 30  # one product, one column that is not constant


def test_programs_of_one_array_are_shorter(sheet):
    everything = ("tau", "body_accelerations", "multipliers", "joint_wrenches")
    model = NAMED["branched"]
    whole = trace(model, Request("inverse_dynamics", everything))
    parts = [trace(model, Request("inverse_dynamics", (name,))) for name in everything]
    assert all(part.arithmetic < whole.arithmetic for part in parts)
    assert whole.arithmetic < sum(part.arithmetic for part in parts)
    assert set(parts[0].outputs) == {"tau"}


MOST_OPERATIONS = {
    ("inverse_dynamics", ("tau",)): 460,
    ("inverse_dynamics", ("tau", "body_accelerations", "multipliers", "joint_wrenches")): 770,
    ("forward_dynamics", ("a",)): 1020,
    ("forward_dynamics", ("a", "body_accelerations", "multipliers", "joint_wrenches")): 1640,
    ("bias_torque", ("bias_torque",)): 430,
    ("gravity_torque", ("gravity_torque",)): 155,
    ("mass_matrix", ("mass_matrix",)): 300,
    ("joint_torque_regressor", ("joint_torque_regressor",)): 960,
    ("body_regressor", ("body_regressor",)): 345,
    ("maximal_state", ("position", "rotation", "velocity")): 365,
}
"""Of the UR5: counted, and rounded up. A simplification that is lost costs ten percent and more."""


@pytest.mark.parametrize(("verb", "outputs"), MOST_OPERATIONS)
def test_operations_of_a_six_axis_arm(verb, outputs):
    assert trace(urdf.load("ur5"), Request(verb, outputs)).arithmetic <= MOST_OPERATIONS[verb, outputs]
