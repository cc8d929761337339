"""The smallest example of a fault: as few numbers other than zero as there can be, and a test that fails with it."""

import functools

import numpy as np
import pytest
from faults.textbook import TextbookArm
from slips.planted import PLANTED_SLIPS

import urdf
from crosscheck.commands.judge.report import judge_report
from crosscheck.judging.judge import judge
from crosscheck.report.snippets import smallest_test
from crosscheck.report.text import as_text

pytestmark = pytest.mark.usefixtures("undiagnosed")  # smallest examples are looked for whatever the fault

SAMPLES = 10


def judged(function, name="inverse_dynamics", robot="ur5", **options):
    judgment = judge(robot, **{name: function}, samples=SAMPLES, **options)
    return judgment, judgment.functions[name]


@functools.cache
def arm():
    return TextbookArm.of(urdf.load("ur5"))


def entries(call):
    return sum(x != 0 for values in call.arguments.values() for x in values)


@pytest.mark.parametrize("slip", PLANTED_SLIPS[2::20], ids=str)
def test_a_slip_needs_two_entries_at_most(slip):
    _, function = judged(slip.function(urdf.load("ur5")))
    assert entries(function.smallest) <= 2
    assert np.abs(np.subtract(function.smallest.answer, function.smallest.expected)).max() > 1e-6


def test_a_term_of_gravity_needs_none_and_one_of_the_mass_matrix_one():
    _, weightless = judged(arm().but(gravity=np.zeros(3)).inverse_dynamics)
    assert entries(weightless.smallest) == 0
    _, heavy = judged(lambda q, v, a: arm().inverse_dynamics(q, v, a) + 2 * a)
    assert heavy.smallest.arguments["a"] == (1, 0, 0, 0, 0, 0)
    assert entries(heavy.smallest) == 1


def test_what_needs_many_entries_is_shrunk_and_rounded():
    def wrong(q, v, a):
        return arm().inverse_dynamics(q, v, a) + 10 * v[0] * v[1] * v[2] * v[3]

    judgment, function = judged(wrong)
    assert entries(function.smallest) == 4
    assert all(round(x, 1) == x for x in function.smallest.arguments["v"])
    assert "inverse_dynamics: the smallest example" in as_text(judge_report(judgment))


def test_the_report_says_the_call_and_the_first_joint():
    judgment, _ = judged(lambda q, v, a: arm().inverse_dynamics(q, v, a) + np.eye(6)[2] * v[4])
    text = " ".join(as_text(judge_report(judgment)).split())
    assert "q = 0; v = 0 but for 'wrist_2_joint' 1; a = 0" in text
    assert "joint 'elbow_joint': " in text
    assert "1 of 6 entries deviate" in text


@pytest.mark.parametrize("name", ["inverse_dynamics", "mass_matrix", "forward_dynamics"])
def test_the_test_to_paste_fails_with_the_fault_and_passes_without(name):
    order = tuple(reversed(urdf.load("ur5").joint_names))

    def in_order(function):
        def reordered(*arguments):
            answer = function(*(x[::-1] for x in arguments))
            return answer[::-1] if answer.ndim == 1 else answer[::-1, ::-1]

        return reordered

    right, wrong = (in_order(getattr(x, name)) for x in (arm(), arm().but(masses=1.5 * arm().masses)))
    judgment, function = judged(wrong, name, joint_names=order)
    names = {name: wrong}
    exec(smallest_test(judgment, function), names)
    with pytest.raises(AssertionError):
        names[f"test_{name}_at_the_smallest_example"]()
    names[name] = right
    names[f"test_{name}_at_the_smallest_example"]()


def test_calls_stay_within_the_limits():
    model = urdf.load("panda")
    _, function = judged(TextbookArm.of(model).but(gravity=np.zeros(3)).inverse_dynamics, robot="panda")
    q = np.array(function.smallest.arguments["q"])
    lower, upper = np.array([(joint.limits.lower, joint.limits.upper) for joint in model.joints]).T
    assert ((lower <= q) & (q <= upper)).all()


def test_right_functions_and_those_that_keep_something_have_none():
    judgment, right = judged(arm().inverse_dynamics)
    assert right.smallest is None
    assert smallest_test(judgment, right) is None
    calls = []

    def counting(q, v, a):
        calls.append(q)
        return arm().inverse_dynamics(q, v, a) + len(calls)

    assert judged(counting)[1].smallest is None
