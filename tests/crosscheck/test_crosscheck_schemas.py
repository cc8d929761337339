"""Every JSON file that the program writes follows the published schema of its format."""

import json
import math
import re
from pathlib import Path

import pytest
from jsonschema import Draft202012Validator, ValidationError
from planting import mixed_tree
from typer.testing import CliRunner

import crosscheck
from crosscheck.cli import app
from crosscheck.report.comparisons import as_json

ROOT = Path(__file__).parents[2]
SCHEMAS = {path.name: json.loads(path.read_text(encoding="utf-8")) for path in (ROOT / "docs/schemas").glob("*.json")}
PLANTED = 1e-9


def file_name(form):
    """ "graphdyn show 1" → "show-1.schema.json"."""
    program, command, version = form.split(" ")
    assert program == "graphdyn"
    return f"{command}-{version}.schema.json"


def check(record):
    Draft202012Validator(SCHEMAS[file_name(record["format"])]).validate(record)


@pytest.fixture
def written(tmp_path):
    """The JSON that a command writes, and its exit code."""

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
            "graphdyn crosscheck 1",
            "graphdyn robots 1",
            "graphdyn errata 1",
            "graphdyn show 1",
            "graphdyn judge 1",
        } <= formats
        assert {file_name(form) for form in formats} == set(SCHEMAS)

    def test_a_missing_field_is_noticed(self, written):
        record, _ = written("robots")
        del record["robots"][0]["licence"]
        with pytest.raises(ValidationError, match="'licence' is a required property"):
            check(record)

    def test_a_new_field_is_welcome(self, written):
        record, _ = written("robots")
        record["new"] = record["robots"][0]["new"] = 1
        assert Draft202012Validator(SCHEMAS["robots-1.schema.json"]).is_valid(record)


class TestCrosscheck:
    def test_agreement(self, written, small_arm):
        record, code = written("crosscheck", small_arm, "--samples", 2, "--lock", "y_elbow=0.2")
        assert code == 0
        check(record)

    def test_failures(self, written, small_arm):
        record, code = written("crosscheck", small_arm, "ur55", "--samples", 1)
        assert code == 2
        assert record["failures"]
        check(record)

    def test_disagreement(self, written, small_arm, plant):
        plant.referee_value("tau", lambda x: x * (1 + PLANTED))
        record, code = written("crosscheck", small_arm, "--samples", 1)
        assert code == 1
        check(record)

    def test_not_finite(self, written, small_arm, plant):
        plant.referee_value("tau", lambda _: math.nan)
        record, code = written("crosscheck", small_arm, "--samples", 1)
        assert code == 1
        assert record["robots"][0]["quantities"]["torque"]["max_relative_error"] is None
        check(record)

    def test_kinematics_only(self, written, kinematics_only):
        record, code = written("crosscheck", kinematics_only, "--samples", 1)
        assert code == 0
        assert record["robots"][0]["identification"] is None
        check(record)

    def test_a_model_without_a_file(self):
        record = as_json(crosscheck.compare(mixed_tree(), 1))
        assert record["file"] is None
        schema = SCHEMAS["crosscheck-1.schema.json"]
        Draft202012Validator({"$ref": "#/$defs/robot", "$defs": schema["$defs"]}).validate(record)


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
