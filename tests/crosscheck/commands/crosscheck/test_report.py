"""Comparisons as text and as data."""

import dataclasses
import json
import math
import os
import re
import stat

import pytest
from planting import SAMPLES, SEED, compared
from rich.cells import cell_len
from shown.approved import approve
from shown.pages import first_cells, text_rows

import crosscheck
from crosscheck.commands.crosscheck.record import robot_record
from crosscheck.commands.crosscheck.report import crosscheck_report
from crosscheck.quantities import COMPARED
from crosscheck.report.records.record import as_bytes, plain, versions
from crosscheck.report.report import WIDE_LINE_CHARACTERS
from crosscheck.report.text import as_text
from graphdyn import Body
from urdf.document.files import write_whole


@pytest.fixture(scope="module")
def comparison(tree):
    return compared(tree)


@pytest.fixture(scope="module")
def massless(tree):
    """The same robot without any inertia: kinematics only."""
    bodies = tuple(Body(body.name, 0.0, 0 * body.center_of_mass, 0 * body.inertia) for body in tree.bodies)
    return compared(dataclasses.replace(tree, bodies=bodies))


def printed(*comparisons, width=140):
    return as_text(crosscheck_report(comparisons), width)


def cells(text):
    """Cells of the rows of the tables, by the first."""
    return {row[0]: row[1:] for row in text_rows(text)}


class TestText:
    def test_every_quantity_with_its_bound(self, comparison):
        rows = cells(printed(comparison))
        for name, result in comparison.quantities.items():
            error, bound = f"{result.max_relative_error:.1e}", f"{result.quantity.tolerance.bound:.1e}"
            assert rows[name][:3] == ["agrees", error, bound]

    @pytest.mark.parametrize("width", [72, 100, 120, 160, 240])
    def test_the_table_of_one_robot_is_whole_at_every_width(self, comparison, width):
        text = printed(comparison, width=width)
        assert max(map(cell_len, text.splitlines())) <= width
        assert "…" not in "".join(line for line in text.splitlines() if line.startswith("│"))
        assert set(comparison.quantities) <= set(first_cells(text))
        assert ("┃ against Pinocchio's" in text) == (width >= WIDE_LINE_CHARACTERS)
        assert ("┃ scale" in text) == (width >= 2 * WIDE_LINE_CHARACTERS)

    def test_heading(self, comparison, tree):
        first, _, _, robot, what, *_ = printed(comparison).splitlines()
        assert first.rstrip() == f"graphdyn against Pinocchio on {tree.name}: agrees"
        assert robot.rstrip() == f"{tree.name}: agrees"
        assert what.rstrip() == f"3 joints; {SAMPLES} random states and the special ones, seed {SEED}; routes: model"

    @pytest.mark.usefixtures("random_states_alone")
    def test_heading_names_locked_joints(self, small_arm):
        assert ", locked: a_slide = 0;" in printed(crosscheck.compare(small_arm, 1, lock=["a_slide"]))

    def test_what_is_left_out_is_said_once(self, massless):
        text = " ".join(printed(massless).split())
        forward = [name for name, quantity in COMPARED.items() if quantity.solves]
        assert text.count(f"not compared: {', '.join(forward)}: ") == 1
        assert "singular" in text
        massive = [name for name, quantity in COMPARED.items() if quantity.massive]
        assert text.count(f"not compared: {', '.join(massive)}: no body has mass: kinematics only") == 1

    def test_massless_robot_agrees_in_what_it_has(self, massless):
        """Torques vanish on both sides: zero differs from zero by zero, not by 0/0."""
        assert massless.agrees
        assert massless.quantities["inverse_dynamics"].max_relative_error == 0
        assert massless.identification is None
        assert set(massless.quantities) | set(massless.not_compared) == set(COMPARED) - {"frame_placement"}


class TestOverview:
    @pytest.mark.parametrize("width", [60, 80, 120, 200])
    def test_groups_fit_the_width(self, comparison, width):
        several = [dataclasses.replace(comparison, robot=f"robot{k}") for k in range(6)]
        lines = printed(*several, width=width).splitlines()
        table = [line for line in lines if line.startswith(("┏", "┃", "┡", "│", "├", "└"))]
        assert max(map(cell_len, table)) <= width
        assert "…" not in "".join(table)
        headings = [line for line in table if line.startswith("┃") and "bound" in line]
        for k in range(6):  # each robot in one table, its name not cut
            assert sum(f"robot{k}" in line for line in headings) == 1
        names = first_cells("\n".join(table))
        for name in comparison.quantities:
            assert names.count(name) == len(headings)

    def test_narrow_means_more_tables(self, comparison):
        several = [comparison] * 6
        assert printed(*several, width=60).count("┏") > printed(*several, width=120).count("┏") >= 1

    def test_missing_quantity_is_a_dash(self, comparison, massless):
        assert cells(printed(comparison, massless, width=120))["backward_error"][-1] == "–"

    def test_a_disagreement_comes_first_and_is_marked(self, comparison):
        torque = dataclasses.replace(comparison.quantities["inverse_dynamics"], max_relative_error=math.inf)
        broken = dataclasses.replace(comparison, quantities={**comparison.quantities, "inverse_dynamics": torque})
        rows = cells(printed(comparison, broken, width=120))
        assert next(iter(rows)) == "inverse_dynamics"
        assert rows["inverse_dynamics"][-1] == "∞ ✗"
        assert rows["verdict"] == ["", "agrees", "DISAGREES"]
        report = crosscheck_report([comparison, broken])
        assert report.verdict.words == "DISAGREES"
        assert report.verdict.reason == "1 of 2 robots agree on every quantity."


class TestData:
    def test_finite_and_complete(self, comparison):
        record = plain(robot_record(comparison))
        text = json.dumps(record, allow_nan=False)  # refuses NaN and infinity
        assert json.loads(text) == json.loads(json.dumps(record))
        assert record["agrees"] is True
        assert set(record["quantities"]) == set(comparison.quantities)
        assert {field.name for field in dataclasses.fields(crosscheck.Comparison)} - {"model", "reading"} < set(record)

    def test_infinities_become_null(self, comparison):
        """The condition number of a singular matrix; an error that could not be measured."""
        torque = dataclasses.replace(comparison.quantities["inverse_dynamics"], max_relative_error=math.inf)
        broken = dataclasses.replace(
            comparison,
            conditioning=dataclasses.replace(comparison.conditioning, kkt_condition=(1.0, math.inf)),
            quantities={**comparison.quantities, "inverse_dynamics": torque},
        )
        record = plain(robot_record(broken))
        assert record["conditioning"]["kkt_condition"] == [1.0, None]
        assert record["quantities"]["inverse_dynamics"]["max_relative_error"] is None
        assert record["agrees"] is record["quantities"]["inverse_dynamics"]["agrees"] is False
        json.dumps(record, allow_nan=False)


class TestWriting:
    def test_whole_file(self, tmp_path):
        path = tmp_path / "x.json"
        write_whole(path, as_bytes(plain({"q̈": [1.5, None]})))
        assert json.loads(path.read_text(encoding="utf-8")) == {"q̈": [1.5, None]}
        assert list(tmp_path.iterdir()) == [path]

    @pytest.mark.skipif(os.name != "posix", reason="permissions of POSIX files")
    def test_usual_permissions(self, tmp_path):
        """Not those of a temporary file, which only its owner may read."""
        write_whole(tmp_path / "x.json", b"{}")
        (tmp_path / "y.json").write_text("{}")
        modes = {stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("x.json", "y.json")}
        assert len(modes) == 1

    def test_characters_that_cannot_be_seen_are_escaped(self):
        """As JSON may: whoever prints the file is safe, and whoever reads it gets the same characters."""
        record = {"name\u202e": "a\x1b\x9b\n\u202e\udcff τ ẍ 中"}
        written = as_bytes(record)
        assert b"\\u009b" in written
        assert "τ ẍ 中" in written.decode()
        assert not re.search("[\x00-\x09\x0b-\x1f\x7f-\x9f\u202e]", written.decode())
        assert json.loads(written) == record


def test_versions_name_every_library():
    numbers = versions()
    assert {"graphdyn", "pinocchio", "numpy"} < set(numbers)
    assert all(number and number[0].isdigit() for number in numbers.values())


def test_whole(wrong_comparison):
    approve("crosscheck", printed(wrong_comparison), rounding=r"residual|^(\| )+joint\d \(model\) \|$")
