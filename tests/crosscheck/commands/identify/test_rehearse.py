"""`graphdyn identify --rehearse`: sentences, tables, files and exit codes, for motions of a small arm."""

import json

import numpy as np
import pytest
from identified.small_study import ARM
from jsonschema import Draft202012Validator
from shared_data import REPOSITORY

from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED

SCHEMA = json.loads((REPOSITORY / "docs/schemas/rehearsal-1.schema.json").read_text(encoding="utf-8"))

QUICK = ("--robot", "small.urdf", "--rate", "50", "--cutoff", "5", "--runs", "4")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A robot, a motion of both joints, and one of the elbow alone, as `graphdyn excite --out` writes them."""
    (tmp_path / "small.urdf").write_text(ARM, encoding="utf-8")
    t = np.arange(0, 10.01, 0.05)
    q = np.column_stack([np.sin(1.3 * t) + 0.5 * np.sin(2.9 * t), 0.8 * np.cos(1.1 * t) + 0.7 * np.sin(2.3 * t)])
    head = "time [s],shoulder.q [rad],elbow.q [rad]"
    np.savetxt(tmp_path / "motion.csv", np.column_stack([t, q]), header=head, comments="", delimiter=",")
    np.savetxt(tmp_path / "one.csv", np.column_stack([t, 0 * t, q[:, 1]]), header=head, comments="", delimiter=",")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_a_motion_that_tells_all(program, folder):
    done = program("identify", "--rehearse", "motion.csv", *QUICK, "--json", "r.json", "--html", "r.html")
    assert done.code == AGREED, done.err
    text = " ".join(done.out.split())
    assert "base parameters are determined by motion.csv" in text
    assert "5 % of each joint's torque, correlated over 0.1 s" in text
    assert "fore: its mass of 1.5 kg will be known to ±" in text
    record = json.loads((folder / "r.json").read_text(encoding="utf-8"))
    Draft202012Validator(SCHEMA).validate(record)
    assert record["complete"]
    assert record["conditions"] == {
        "torque_noise": 0.05, "noise_time": 0.1, "position_noise": 2e-5, "friction": 0.05, "cad_error": 0.2,
        "rate": 50.0, "runs": 4, "seed": 0,
    }  # fmt: skip
    assert [method["name"] for method in record["methods"]] == ["WLS", "consistent", "consistent, entropic prior"]
    assert len(record["base_parameters"]) == record["rank"] == record["structural_rank"]
    assert "What will be known of the links" in (folder / "r.html").read_text(encoding="utf-8")


def test_a_motion_that_does_not(program, folder):
    done = program("identify", "--rehearse", "one.csv", *QUICK, "--methods", "wls,graph", "--json", "r.json")
    assert done.code == DISAGREED, done.err
    text = " ".join(done.out.split())
    assert "base parameters stay unknown one.csv does not determine them; it does not move shoulder" in text
    assert "Not determined individually by this motion: " in text
    record = json.loads((folder / "r.json").read_text(encoding="utf-8"))
    Draft202012Validator(SCHEMA).validate(record)
    assert record["still_joints"] == ["shoulder"]
    assert [method["name"] for method in record["methods"] if method["failure"]] == ["graph method"]


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("log.csv", "--rehearse", "motion.csv", *QUICK), "--rehearse and LOG exclude each other"),
        (("--rehearse", "motion.csv"), "--robot is missing; --rehearse needs the robot that will move"),
        (("--rehearse", "motion.csv", *QUICK, "--folds", "5"), "--folds is for recordings; leave it out with --reh"),
        (
            ("--rehearse", "motion.csv", *QUICK, "--terms", "viscous", "--terms", "coulomb"),
            "--terms is given several times; --rehearse takes one torque model",
        ),
        (("--robot", "ur5", "--torque-noise", "0.1"), "--torque-noise is for the rehearsal of a motion; give --reh"),
        (("--rehearse", "motion.csv", *QUICK, "--cad-error", "2"), "cad_error is 2; give a relative error between"),
    ],
)
def test_refusals(program, folder, arguments, message):
    done = program("identify", *arguments)
    assert done.code == BAD_INPUT
    assert message in " ".join(done.err.split())
