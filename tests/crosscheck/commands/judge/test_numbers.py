"""Every number on the page and in the JSON file of `graphdyn judge`, computed again beside it."""

import dataclasses
import json

import numpy as np
import pytest
from faults.judged_functions import DIAGNOSIS, STATES, judged, judgment
from shown.approved import approve_report
from shown.blocks import cells, tables, texts

import crosscheck
import graphdyn
from crosscheck.commands.judge.record import record as record_of
from crosscheck.commands.judge.report import judge_report
from crosscheck.judging.judgment import FailedState, FittedNumber
from crosscheck.report.records.record import plain
from crosscheck.report.report import Facts, Picture, Plot

TWO_DIGITS = 0.051
"""Relative: errors of pages have two digits."""

ERROR_NAMES = ("errors", "references_differ", "backward_errors", "references_differ_backward")
NUMBERS = (FittedNumber("m", 2.5, 4.0, "kg"), FittedNumber("c_x", 0.125, -0.25, "m"))


@pytest.fixture(scope="module")
def function(tree):
    """Accelerations under test: every error differs from all others, one is no number, three states have no answer."""
    rng = np.random.default_rng(12)
    of = {name: {} for name in ERROR_NAMES}
    for name in ERROR_NAMES:
        for reference in ("graphdyn", "pinocchio") if "differ" not in name else ("pinocchio",):
            of[name][reference] = 10 ** rng.uniform(-14, -2, STATES)
    of["backward_errors"]["pinocchio"][7] = np.nan
    failures = tuple(FailedState(number, f"fails at {number}") for number in (3, 7, 11))
    return dataclasses.replace(
        judged(tree, "forward_dynamics", 1.25), **of, backward_scale="torques", bound=1e-6, failures=failures,
        repeated=10 ** rng.uniform(-14, -8, STATES),
    )  # fmt: skip


@pytest.fixture(scope="module")
def shown(tree, function):
    """The judgment, its record as written, and its report."""
    diagnosis = dataclasses.replace(DIAGNOSIS, numbers=NUMBERS)
    found = judgment(tree, function, diagnoses=(diagnosis,))
    return json.loads(json.dumps(plain(record_of(found, ["judge"])), allow_nan=False)), judge_report(found)


def finite(errors):
    return np.where(np.isnan(errors), np.inf, errors)


def test_quantiles(shown, function):
    """Half, nine of ten and all states have no larger error; null where it is infinite."""
    of = shown[0]["functions"]["forward_dynamics"]
    for name in ERROR_NAMES:
        for reference, errors in getattr(function, name).items():
            ordered = np.sort(finite(errors))
            for level, share in (("0.5", 0.5), ("0.9", 0.9), ("1", 1.0)):
                value = of[name][reference][level]
                wanted = ordered[int(np.ceil(share * (STATES - 1)))]
                assert value == (wanted if np.isfinite(wanted) else None)
    assert of["repeated"]["1"] == function.repeated.max()
    assert of["agrees"] is False
    assert [failure["number"] for failure in of["failures"]] == [3, 7, 11]


def test_largest_errors(shown, function):
    rows = cells(tables(shown[1], "errors")[0])
    for name, errors in {"forward_dynamics": function.errors, "backward_error": function.backward_errors}.items():
        verdict, ours, theirs, bound, _ = rows[name]
        assert verdict == "UNDECIDED"
        for text, reference in ((ours, "graphdyn"), (theirs, "pinocchio")):
            largest = finite(errors[reference]).max()
            assert text == "∞" if np.isinf(largest) else float(text) == pytest.approx(largest, rel=TWO_DIGITS)
        assert bound == "1.0e-06"


def test_in_detail(shown, function):
    """Median and largest of every comparison, distribution and course over the states."""
    found = {}
    for table in tables(shown[1], "forward_dynamics"):
        if [column.title for column in table.columns[2:]] == ["median", "largest", "bound"]:
            found |= cells(table)
    titles = {
        "errors": "against {}", "references_differ": "{} against graphdyn",
        "backward_errors": "torques of {}", "references_differ_backward": "{} by torques of graphdyn",
    }  # fmt: skip
    every = {
        titles[name].format(reference): finite(errors)
        for name in ERROR_NAMES
        for reference, errors in getattr(function, name).items()
    }
    assert set(found) == set(every)
    for name, (verdict, median, largest, _) in found.items():
        errors = np.sort(every[name])
        assert verdict == ("agrees" if errors[-1] <= 1e-6 else "DISAGREES")
        assert float(median) == pytest.approx(errors[STATES // 2 - 1], rel=TWO_DIGITS)
        assert largest == "∞" if np.isinf(errors[-1]) else float(largest) == pytest.approx(errors[-1], rel=TWO_DIGITS)
    (section,) = [one for one in shown[1].sections if one.key == "forward_dynamics"]
    (picture,) = [block for block in section.blocks if isinstance(block, Picture)]
    assert {row.name: row.errors.tolist() for row in picture.draw.keywords["rows"]} == {
        name: errors.tolist() for name, errors in every.items()
    }
    (plot,) = [block for block in section.blocks if isinstance(block, Plot)]
    assert plot.x.tolist() == list(range(1, STATES + 1))
    for series in plot.panels[0].series:
        errors = every[series.name]
        np.testing.assert_array_equal(series.y, np.where(np.isinf(errors), np.nan, errors))


def test_states_without_an_answer(shown):
    """Counted from 1 where people read."""
    (section,) = [one for one in shown[1].sections if one.key == "errors"]
    (facts,) = [b for b in section.blocks if isinstance(b, Facts) and b.title == "States without an answer"]
    assert facts.items == (("forward_dynamics", "states 4, 8, 12"),)
    (table,) = [one for one in tables(shown[1], "forward_dynamics") if one.title == "States without an answer"]
    assert texts(table) == [["4", "fails at 3"], ["8", "fails at 7"], ["12", "fails at 11"]]


def test_fitted_numbers(shown):
    (diagnosis,) = shown[0]["diagnoses"]
    assert diagnosis["numbers"] == [
        {"name": "m", "theirs": 2.5, "ours": 4.0, "difference": -1.5, "unit": "kg"},
        {"name": "c_x", "theirs": 0.125, "ours": -0.25, "difference": 0.375, "unit": "m"},
    ]
    (table,) = tables(shown[1], "diagnoses")
    assert texts(table) == [["m", "2.5", "4", "-1.5", "kg"], ["c_x", "0.125", "-0.25", "0.375", "m"]]
    assert diagnosis["explains"] == 3e-16


def test_worst_call(shown, function, tree):
    """Answers of both at the state that is told, entry by entry."""
    worst = shown[0]["functions"]["forward_dynamics"]["worst"]
    q, v, tau = (np.array(worst["arguments"][name]) for name in ("q", "v", "tau"))
    expected = np.linalg.solve(graphdyn.mass_matrix(tree, q), tau - graphdyn.bias_torque(tree, q, v))
    assert worst["expected"] == pytest.approx(expected.tolist())
    assert worst["answer"] == pytest.approx((1.25 * expected).tolist())
    (table,) = [one for one in tables(shown[1], "forward_dynamics") if one.title == "The worst call"]
    for (name, said, answer, difference), joint, value in zip(texts(table), tree.joint_names, expected, strict=True):
        assert name == joint
        assert (float(said), float(answer)) == pytest.approx((value, 1.25 * value), rel=1e-8)
        assert float(difference) == pytest.approx(0.25 * value, rel=TWO_DIGITS)


def test_errors_of_a_judged_function(tree, undiagnosed):
    """The worst state is the one with the largest relative error, and its error that of the torques there."""
    wrong = np.array([1.0, 1.0, 1 + 1e-4])

    def inverse_dynamics(q, v, a):
        return wrong * graphdyn.inverse_dynamics(tree, q, v, a).tau

    function = crosscheck.judge(tree, inverse_dynamics=inverse_dynamics, samples=3).functions["inverse_dynamics"]
    worst = function.worst
    q, v, a = (np.array(worst.arguments[name]) for name in "qva")
    tau = graphdyn.inverse_dynamics(tree, q, v, a).tau
    assert worst.expected == pytest.approx(tau)
    assert worst.answer == pytest.approx(wrong * tau)
    assert 0 < function.errors["graphdyn"].max() <= 1e-4 * (1 + 1e-6) * np.abs(tau[2]) / np.abs(tau).max()
    assert function.errors["pinocchio"] == pytest.approx(function.errors["graphdyn"], rel=1e-6)


def test_whole(shown, wrong_judgment):
    approve_report("judge", shown[1])
    approve_report("judge_wrong", judge_report(wrong_judgment))
