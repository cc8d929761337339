"""What recording leaves out: operations on known numbers, repetitions, signs, and what nobody asks for."""

import numpy as np
import pytest
from random_trees import NAMED

import urdf
from graphdyn.kernels.expressions import Expression, Recorder
from graphdyn.kernels.programs import Request, record
from graphdyn.kernels.vectors import scalars


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
    for known in (0.0 * sheet.x, sheet.y * 0.0):
        assert isinstance(known, float)
    assert isinstance(sheet.x + 0.0, Expression)


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
    whole = record(model, Request("inverse_dynamics", everything))
    parts = [record(model, Request("inverse_dynamics", (name,))) for name in everything]
    assert all(part.arithmetic < whole.arithmetic for part in parts)
    assert whole.arithmetic < sum(part.arithmetic for part in parts)
    assert set(parts[0].outputs) == {"tau"}


MOST_OPERATIONS = {
    ("inverse_dynamics", ("tau",)): 460,
    ("inverse_dynamics", ("tau", "body_accelerations", "multipliers", "joint_wrenches")): 770,
    ("forward_dynamics", ("a",)): 1020,
    ("forward_dynamics", ("a", "body_accelerations", "multipliers", "joint_wrenches")): 1640,
    ("bias_torque", ("bias_torque",)): 430,
    ("mass_matrix", ("mass_matrix",)): 300,
    ("joint_torque_regressor", ("joint_torque_regressor",)): 960,
    ("body_regressor", ("body_regressor",)): 345,
    ("maximal_state", ("position", "rotation", "velocity")): 365,
}
"""Of the UR5: counted, and rounded up. A simplification that is lost costs ten percent and more."""


@pytest.mark.parametrize(("verb", "outputs"), MOST_OPERATIONS)
def test_operations_of_a_six_axis_arm(verb, outputs):
    assert record(urdf.load("ur5"), Request(verb, outputs)).arithmetic <= MOST_OPERATIONS[verb, outputs]
