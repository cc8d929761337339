"""Every number on the page and in the JSON file of `graphdyn crosscheck`, computed again beside it."""

import dataclasses
import json
import math
import re

import numpy as np
import pytest
from planting import SAMPLES, SEED
from shown.blocks import texts
from shown.pages import COMMAND, comparison_page, facts, plots, rows

import graphdyn
from crosscheck.commands.crosscheck.folder_report import RobotSummary, compared_row, counts, failed_row, folder_report
from crosscheck.commands.crosscheck.record import robot_record
from crosscheck.commands.crosscheck.report import crosscheck_report
from crosscheck.comparing.baseline import BaselineIdentification
from crosscheck.comparing.conditioning import Conditioning
from crosscheck.comparing.error_record import ErrorTable
from crosscheck.quantities.states import cases
from crosscheck.report.records.record import plain
from crosscheck.report.report import Code, Group, Picture, Prose, Table

TWO_DIGITS = 0.051
"""Relative: errors of pages have two digits."""


@pytest.fixture(scope="module")
def record(small_comparison):
    return json.loads(json.dumps(plain(robot_record(small_comparison))))


@pytest.fixture(scope="module")
def page(small_comparison):
    return comparison_page([small_comparison], COMMAND)


@pytest.fixture(scope="module")
def report(small_comparison):
    return crosscheck_report([small_comparison])


def of_bound(quantity):
    error, bound = quantity["max_relative_error"], quantity["bound"]
    return error / bound if bound else math.inf if error else 0.0


def two_digits(text):
    return math.inf if text == "∞" else float(text)


class TestErrors:
    def test_from_the_single_errors(self, record, small_comparison):
        """Quantiles are errors that occurred."""
        for name, found in record["quantities"].items():
            result = small_comparison.quantities[name]
            errors = sorted(result.errors.tolist())
            assert found["max_relative_error"] == errors[-1]
            assert found["quantiles"] == {
                level: np.quantile(errors, float(level), method="higher") for level in ("0", "0.5", "0.9", "0.99", "1")
            }
            assert found["agrees"] == (errors[-1] <= found["bound"])
            assert max(found["by_case"].values()) == max(found["by_route"].values()) == errors[-1]
            if found["worst"]:
                assert found["by_case"][found["worst"]["case"]] == errors[-1]
                assert found["by_route"][found["worst"]["route"]] == errors[-1]

    def test_largest_of_cases_and_routes(self, small_comparison):
        """Of all parts, the largest of each case and route, and the state of the largest of all; NaN is infinite."""
        first, second, *_ = cases(small_comparison.model, SAMPLES, SEED)
        table = ErrorTable()
        for route, case, errors in (
            ("urdf", first, [1e-3, 4e-3]), ("urdf", first, [2e-3, 1e-3]), ("model", first, [1e-3, 3e-3]),
            ("model", second, [5e-3]), ("urdf", second, [2e-3]),
        ):  # fmt: skip
            table.add(route, case, {"momentum": np.array(errors)})
        table.add("model", second, {"mass_matrix": np.array([np.nan])})
        found = table.results()
        momentum = found["momentum"]
        assert momentum.by_case == {first.name: 4e-3, second.name: 5e-3}
        assert momentum.by_route == {"urdf": 4e-3, "model": 5e-3}
        assert momentum.errors.tolist() == [1e-3, 4e-3, 2e-3, 1e-3, 1e-3, 3e-3, 5e-3, 2e-3]
        assert (momentum.worst.case, momentum.worst.route) == (second.name, "model")
        assert momentum.worst.q == tuple(second.q[0])
        assert found["mass_matrix"].max_relative_error == math.inf

    def test_verdicts(self, page, record):
        name, cells = next(iter(rows(page, "The verdict on every robot").items()))
        quantities = record["quantities"]
        agreeing = sum(quantity["agrees"] for quantity in quantities.values())
        nearest = max(quantities, key=lambda one: of_bound(quantities[one]))
        assert name == "small.urdf"
        assert cells[:4] == ["✓ agrees", "3", f"{agreeing} of {len(quantities)}", nearest]
        assert two_digits(cells[4]) == pytest.approx(quantities[nearest]["max_relative_error"], rel=TWO_DIGITS)
        assert two_digits(cells[5]) == pytest.approx(quantities[nearest]["bound"], rel=TWO_DIGITS)

    def test_curves(self, page, record, small_comparison):
        """Errors as parts of their bounds over states from 1, of the eight nearest to their bounds."""
        (x, curves), *_ = plots(page)
        (drawn,) = curves.values()
        quantities = record["quantities"]
        order = sorted((n for n in quantities if quantities[n]["bound"] and quantities[n]["worst"]),
                       key=lambda n: of_bound(quantities[n]), reverse=True)  # fmt: skip
        assert list(drawn) == order[:8]
        assert x.tolist() == list(range(1, len(x) + 1))
        for name, y in drawn.items():
            errors = small_comparison.quantities[name].errors
            np.testing.assert_allclose(y[: len(errors)], errors / quantities[name]["bound"], rtol=1e-6)
            assert np.isnan(y[len(errors) :]).all()

    def test_worst_states(self, report, record):
        """Of all single states the nearest to its bound first; each with its error, bound, case and route."""
        (section,) = [one for one in report.sections if one.verdict]
        quantities = record["quantities"]
        with_state = sorted((n for n in quantities if quantities[n]["worst"]), key=lambda n: -of_bound(quantities[n]))
        (words,) = [b.text for b in section.blocks if isinstance(b, Prose) and b.title == "The worst state"]
        (others,) = [b for b in section.blocks if isinstance(b, Group) and b.title.startswith("Worst states")]
        said = [
            words.split("bound: ", 1)[1].split(". This")[0],
            *(b.title for b in others.blocks if isinstance(b, Code)),
        ]
        assert len(said) == len(with_state)
        for text, name in zip(said, with_state, strict=True):
            one = quantities[name]
            title, error, bound, where = re.fullmatch(r"(\w+), (\S+) with the bound (\S+), (.*)", text).groups()
            assert title == name
            assert two_digits(error) == pytest.approx(one["max_relative_error"], rel=TWO_DIGITS)
            assert two_digits(bound) == pytest.approx(one["bound"], rel=TWO_DIGITS)
            assert where == f"{one['worst']['case']} ({one['worst']['route']})"


class TestConditioning:
    def test_extremes(self, record, small_comparison):
        """Over all states of all cases."""
        matrices, systems = [], []
        for case in cases(small_comparison.model, SAMPLES, SEED):
            matrices.append(graphdyn.mass_matrix(case.model, case.q))
            systems += [graphdyn.kkt_system(case.model, q, v, 0 * q) for q, v in zip(case.q, case.v, strict=True)]
        found = record["conditioning"]
        for name, values in {
            "mass_matrix_condition": np.concatenate([np.linalg.cond(one) for one in matrices]),
            "kkt_condition": np.array([np.linalg.cond(one.matrix) for one in systems]),
            "constraint_condition": np.array([np.linalg.cond(one.constraint_jacobian) for one in systems]),
        }.items():
            assert found[name] == pytest.approx([values.min(), values.max()], rel=1e-6)
        assert (found["constraint_rank"], found["kkt_rank"]) == ([15, 15], [33, 33])

    def test_merged(self):
        """The smaller of both smallest, the larger of both largest, whichever comes first."""
        one = Conditioning((15, 15), (2.0, 7.0), (33, 33), (10.0, 20.0), (3.0, 4.0))
        other = Conditioning((14, 15), (3.0, 5.0), (32, 33), (5.0, 30.0), (1.0, 9.0))
        both = Conditioning((14, 15), (2.0, 7.0), (32, 33), (5.0, 30.0), (1.0, 9.0))
        assert one.merged(other) == other.merged(one) == both

    def test_page(self, page, record):
        table, found = rows(page, "Smallest and largest over all states"), record["conditioning"]
        shown = {
            "φ_q, constraints": ("constraint", "15"),
            "KKT, Eq. (111)": ("kkt", "33"),
            "M, mass matrix": ("mass_matrix", "3"),
        }
        for name, (key, full) in shown.items():
            *_, said_full, condition = table[name]
            low, high = (f"{x:.3g}" for x in found[f"{key}_condition"])
            assert (said_full, condition) == (full, f"{low} … {high}")

    def test_base_parameters(self, page, record):
        found, said = record["identification"], facts(page)
        assert said["number"] == f"{found['rank']} with our regressor, {found['rank_there']} with Pinocchio's"
        assert said["condition number"] == f"{found['condition_number']:.3g}"
        kept, left_out = re.fullmatch(r"smallest kept (\S+), largest left out (\S+)", said["pivots"]).groups()
        assert (float(kept), float(left_out)) == pytest.approx(found["gap"], rel=TWO_DIGITS)
        assert float(kept) > 1e6 * float(left_out)
        between, own = re.fullmatch(
            r"(\S+) between the estimates, (\S+) from the model's own", said["difference"]
        ).groups()
        assert (float(between), float(own)) == pytest.approx((found["difference"], found["error"]), rel=TWO_DIGITS)


def test_distribution(report, small_comparison):
    """Every error of every quantity is in its row."""
    (section,) = [one for one in report.sections if one.verdict]
    (picture,) = [b for b in section.blocks if isinstance(b, Picture) and "distributed" in b.title]
    drawn = {row.name: row for row in picture.draw.keywords["rows"]}
    assert list(drawn) == list(small_comparison.quantities)
    for name, row in drawn.items():
        result = small_comparison.quantities[name]
        assert row.errors.tolist() == result.errors.tolist()
        assert row.bound == result.quantity.tolerance.bound


def test_joints(report, small_comparison):
    (section,) = [one for one in report.sections if one.verdict]
    groups = [block.blocks for block in section.blocks if isinstance(block, Group)]
    (table,) = [block for blocks in groups for block in blocks if block.title == "Joints and bodies"]
    assert texts(table) == [
        [str(k), joint.name, joint.kind, body.name, f"{body.mass:.4g}"]
        for k, (joint, body) in enumerate(
            zip(small_comparison.model.joints, small_comparison.model.bodies, strict=True), 1
        )
    ]


def test_verdict_in_words(small_comparison, wrong_comparison, record):
    """Of one robot its quantities, of several the robots."""
    one, two = ([small_comparison], [small_comparison, wrong_comparison])
    every = len(record["quantities"])
    assert crosscheck_report(one).verdict.reason == f"{every} of {every} quantities are within their bounds."
    assert crosscheck_report(two).verdict.reason == "1 of 2 robots agree on every quantity."
    lost = [{"robot": "x", "message": "no"}]
    assert crosscheck_report(two, lost).verdict.reason.endswith("quantity. 1 could not be compared.")


def test_base_parameters_that_differ(small_comparison):
    found = BaselineIdentification(12, 13, 1234.5, (2e-3, 3e-17), 4e-14, 7e-13)
    said = facts(comparison_page([dataclasses.replace(small_comparison, identification=found)], COMMAND))
    assert said["number"] == "12 with our regressor, 13 with Pinocchio's"
    assert said["condition number"] == "1.23e+03"
    assert said["pivots"] == "smallest kept 2.0e-03, largest left out 3.0e-17"
    assert said["difference"] == "4.0e-14 between the estimates, 7.0e-13 from the model's own"


class TestFolder:
    def test_row(self, record):
        """The quantity whose error takes the largest part of its bound."""
        quantities = record["quantities"]
        nearest = max(quantities, key=lambda one: of_bound(quantities[one]))
        row = compared_row(record)
        one = quantities[nearest]
        assert (row.nearest, row.error, row.bound) == (nearest, one["max_relative_error"], one["bound"])
        assert row.verdict == "agrees"
        lost = {**quantities, "momentum": {**quantities["momentum"], "max_relative_error": None, "agrees": False}}
        spoilt = compared_row({**record, "quantities": lost, "agrees": False})
        assert (spoilt.nearest, spoilt.error, spoilt.verdict) == ("momentum", math.inf, "DISAGREES")

    def test_page(self, small_comparison, wrong_comparison):
        """Each robot in the table of its verdict; details of each that was compared, the worst first."""
        comparisons = [
            dataclasses.replace(comparison, robot=f"arms/{name}.urdf", file=f"arms/{name}.urdf")
            for name, comparison in (("good", small_comparison), ("bad", wrong_comparison))
        ]
        rows_of = [compared_row(plain(robot_record(comparison))) for comparison in comparisons]
        routes = {"verdict": "kinematics only", "routes": ("urdf", "model")}
        light = dataclasses.replace(rows_of[0], robot="arms/light.urdf", **routes)
        lost = failed_row({"robot": "arms/lost.urdf", "message": "no\n link in arms/lost.urdf"})
        report = folder_report([*rows_of, light, lost], comparisons)
        assert (report.verdict.words, report.verdict.state) == ("DISAGREES", "disagrees")
        section, *details, _ = report.sections
        everything, *others = [block for block in section.blocks if isinstance(block, Table)]
        shown = {row[0]: row[1:] for row in texts(everything)}
        assert list(shown) == ["good.urdf", "bad.urdf", "light.urdf", "lost.urdf"]
        for comparison, name, taken in zip(comparisons, shown, ("both", "model"), strict=False):
            quantities = plain(robot_record(comparison))["quantities"]
            part = max(map(of_bound, quantities.values()))
            verdict, routes, nearest, *numbers, reason = shown[name]
            assert (verdict, routes) == ("agrees" if part <= 1 else "DISAGREES", taken)
            assert of_bound(quantities[nearest]) == part
            assert numbers == [f"{quantities[nearest][key]:.1e}" for key in ("max_relative_error", "bound")]
            assert (reason == "") == (part <= 1)
        assert shown["light.urdf"][:2] == ["kinematics only", "both"]
        assert shown["lost.urdf"] == ["refused", "–", "–", "–", "–", "no link in lost.urdf"]
        assert [(block.title, [row[0] for row in texts(block)]) for block in others] == [
            ("DISAGREES: 1", ["bad.urdf"]), ("refused: 1", ["lost.urdf"]),
            ("kinematics only: 1", ["light.urdf"]), ("agrees: 1", ["good.urdf"]),
        ]  # fmt: skip
        assert [row.link for row in everything.rows] == ["robot-2", "robot-1", None, None]
        assert [(one.key, one.verdict.state) for one in details] == [("robot-1", "disagrees"), ("robot-2", "agrees")]

    def test_counts(self):
        def row(verdict, *routes):
            return RobotSummary("a", verdict, routes, None, None, None, "")

        many = [row("agrees", "urdf", "model"), row("agrees", "model"), row("kinematics only", "model"),
                row("DISAGREES", "urdf", "model"), failed_row({"robot": "b", "message": "no"})]  # fmt: skip
        assert counts(many) == (
            "5 robots: agrees 2, DISAGREES 1, kinematics only 1, refused 1; 2 by the route 'model' alone"
        )
