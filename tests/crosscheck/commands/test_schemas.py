"""Every JSON file that the program writes follows the published schema of its format."""

import json
import math
import re

import numpy as np
import pytest
from faults.planted_records import planted
from jsonschema import Draft202012Validator, ValidationError
from long_check import few
from planting import PLANTED
from shared_data import REPOSITORY
from typer.testing import CliRunner

import urdf
from crosscheck.commands import app
from crosscheck.commands.crosscheck import record as crosscheck_records
from crosscheck.commands.errata import record as errata_records
from crosscheck.commands.judge import record as judge_records
from crosscheck.commands.program import own_process
from crosscheck.commands.show import record as show_records
from crosscheck.commands.show.description import describe
from crosscheck.paper.errata import Effect
from crosscheck.report.records.record import plain

ROOT = REPOSITORY
SCHEMAS = {path.name: json.loads(path.read_text(encoding="utf-8")) for path in (ROOT / "docs/schemas").glob("*.json")}


def file_name(form):
    """ "graphdyn show 1" → "show-1.schema.json"."""
    program, command, version = form.split(" ")
    assert program == "graphdyn"
    return f"{command}-{version}.schema.json"


def check(record):
    Draft202012Validator(SCHEMAS[file_name(record["format"])]).validate(record)


@pytest.fixture
def written(tmp_path, monkeypatch):
    """The JSON that a command writes, and its exit code; user code runs in this process."""
    monkeypatch.setattr(own_process, "tell", lambda _: None)

    def run(*arguments):
        path = tmp_path / "record.json"
        done = CliRunner().invoke(app, [*map(str, arguments), "--json", str(path)])
        return json.loads(path.read_text(encoding="utf-8")), done.exit_code

    return run


@pytest.fixture
def kinematics_only(small_arm):
    """The same arm without a single <inertial>."""
    bare = re.sub(r"<inertial>.*?</inertial>", "", small_arm.read_text(encoding="utf-8"), flags=re.DOTALL)
    small_arm.write_text(bare, encoding="utf-8")
    return small_arm


class TestSchemas:
    @pytest.mark.parametrize("name", sorted(SCHEMAS))
    def test_valid(self, name):
        Draft202012Validator.check_schema(SCHEMAS[name])
        assert file_name(SCHEMAS[name]["properties"]["format"]["const"]) == name
        assert f"](schemas/{name})" in (ROOT / "docs/json.md").read_text(encoding="utf-8")

    @pytest.mark.parametrize("name", sorted(SCHEMAS))
    def test_every_field_is_described_and_required(self, name):
        """Also in nested records; other fields may come."""

        def inspect(schema):
            for field, inner in schema.get("properties", {}).items():
                referred = SCHEMAS[name]["$defs"][inner["$ref"].split("/")[-1]] if "$ref" in inner else {}
                assert inner.get("description") or referred.get("description"), field
                assert field in schema["required"]
                assert schema.get("additionalProperties") is not False
            for inner in schema.values():
                if isinstance(inner, dict):
                    inspect(inner)

        inspect(SCHEMAS[name])

    def test_every_format_has_one(self):
        sources = "".join(path.read_text(encoding="utf-8") for path in (ROOT / "crosscheck").rglob("*.py"))
        formats = set(re.findall(r'"(graphdyn [a-z]+ \d+)"', sources))
        assert {
            "graphdyn crosscheck 3",
            "graphdyn robots 1",
            "graphdyn errata 1",
            "graphdyn show 1",
            "graphdyn judge 2",
        } <= formats
        assert {file_name(form) for form in formats} == set(SCHEMAS)

    def test_generated_from_the_records(self, tmp_path):
        """Else: python -m crosscheck.commands.schemas docs/schemas"""
        from crosscheck.commands.schemas import main

        folder = tmp_path / "new"
        main(["program", str(folder)])
        assert {path.name: json.loads(path.read_text(encoding="utf-8")) for path in folder.iterdir()} == SCHEMAS
        with pytest.raises(SystemExit, match=r"usage: python -m crosscheck.commands.schemas FOLDER"):
            main(["program"])

    def test_a_missing_field_is_noticed(self, written):
        record, _ = written("robots")
        del record["robots"][0]["licence"]
        with pytest.raises(ValidationError, match="'licence' is a required property"):
            check(record)

    def test_a_new_field_is_welcome(self, written):
        record, _ = written("robots")
        record["new"] = record["robots"][0]["new"] = 1
        assert Draft202012Validator(SCHEMAS["robots-1.schema.json"]).is_valid(record)


class TestNumbers:
    @pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
    @pytest.mark.parametrize("kind", [float, np.float64, np.float32])
    def test_not_finite_is_null(self, number, kind):
        assert plain({"one": kind(number), "many": (kind(number), kind(1))}) == {"one": None, "many": [None, 1.0]}
        assert plain(np.array([[number], [2]])) == [[None], [2.0]]

    def test_of_numpy(self):
        record = plain([np.int64(1), np.bool_(True), np.float64(0.5), np.array(3), np.array([True])])
        assert record == [1, True, 0.5, 3, [True]]
        assert [type(item) for item in record] == [int, bool, float, int, list]

    @pytest.mark.parametrize("number", few([math.nan, math.inf], math.inf))
    def test_every_number_that_may_be_null(self, number, small_arm, small_comparison, wrong_judgment):
        """Of the formats whose records are quickly made; those of paper, bench and identify are tested beside them."""
        for record in (
            crosscheck_records.record([small_comparison], [], []),
            judge_records.record(wrong_judgment, []),
            show_records.record(describe(urdf.load(small_arm), "arm")),
            errata_records.record([Effect("A1", "arm", "error", np.ones(2), np.zeros(2))]),
        ):
            spoiled = plain(planted(record, SCHEMAS[file_name(plain(record)["format"])], number))
            assert spoiled != plain(record)
            check(json.loads(json.dumps(spoiled, allow_nan=False)))


@pytest.mark.usefixtures("random_states_alone")
class TestCrosscheck:
    def test_agreement(self, written, small_arm):
        record, code = written("crosscheck", small_arm, "--samples", 2, "--lock", "y_elbow=0.2")
        assert code == 0
        check(record)

    def test_failures(self, written, pendulum):
        record, code = written("crosscheck", pendulum, "ur55", "--samples", 1)
        assert code == 2
        assert record["failures"]
        check(record)

    def test_disagreement(self, written, pendulum, plant):
        plant.pinocchio_value("tau", lambda x: x * (1 + PLANTED))
        record, code = written("crosscheck", pendulum, "--samples", 1)
        assert code == 1
        check(record)

    def test_not_finite(self, written, pendulum, plant):
        plant.pinocchio_value("tau", lambda _: math.nan)
        record, code = written("crosscheck", pendulum, "--samples", 1)
        assert code == 1
        assert record["robots"][0]["quantities"]["inverse_dynamics"]["max_relative_error"] is None
        check(record)

    def test_kinematics_only(self, written, kinematics_only):
        record, code = written("crosscheck", kinematics_only, "--samples", 1)
        assert code == 0
        assert record["robots"][0]["identification"] is None
        check(record)

    def test_a_model_without_a_file(self, wrong_comparison):
        record = plain(crosscheck_records.robot_record(wrong_comparison))
        assert record["file"] is None
        schema = SCHEMAS["crosscheck-3.schema.json"]
        Draft202012Validator({"$ref": "#/$defs/RobotRecord", "$defs": schema["$defs"]}).validate(record)


class TestOthers:
    @pytest.mark.parametrize("answer", ["-graphdyn.inverse_dynamics(arm, q, v, a).tau", "0 * q / 0"])
    @pytest.mark.filterwarnings("ignore::RuntimeWarning")  # 0 / 0
    def test_judge(self, written, tmp_path, answer):
        code_file = tmp_path / "foreign_code.py"
        code_file.write_text(f"import graphdyn\narm = graphdyn.kr500()\ndef f(q, v, a):\n    return {answer}\n")
        record, code = written("judge", "kr500", "--inverse-dynamics", f"{code_file}:f", "--samples", 1)
        assert code == 1
        assert record["diagnoses"]
        check(record)

    @pytest.mark.parametrize("arguments", [("show", "kr500"), ("show", "z1", "--lock", "jointGripper")], ids=" ".join)
    def test_show(self, written, arguments):
        record, code = written(*arguments)
        assert code == 0
        check(record)

    def test_show_kinematics_only(self, written, kinematics_only):
        record, code = written("show", kinematics_only)
        assert code == 0
        assert record["system"]["condition_number"] is None
        check(record)

    def test_robots(self, written):
        record, code = written("robots")
        assert code == 0
        check(record)

    def test_errata(self, written):
        record, code = written("errata", "--samples", 10)
        assert code == 0
        check(record)
