"""--json and --html of graphdyn crosscheck: what is in them, whole or not at all."""

import json
import os
import re

import numpy as np
import pytest
from planting import PLANTED, Plant

import urdf
from crosscheck.commands.program import output_files
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.quantities import COMPARED
from crosscheck.quantities.states import cases
from crosscheck.reference.pinocchio_model import PinocchioAnswers, PinocchioModel
from crosscheck.report.records.record import taking_part
from graphdyn import inverse_dynamics

REPRODUCED = 1e-3
"""An error of 1e-9, computed a second time from the recorded state: rounding is 1e-15 of the same scale."""


def test_worst_state_is_enough_to_reproduce(program, small_arm, tmp_path, monkeypatch):
    """From the file alone: robot, case, q, v, a give the recorded error again."""
    Plant(monkeypatch).pinocchio_model(
        lambda model: model.with_inertial_parameters(
            model.inertial_parameters * np.where(np.arange(30) == 10, 1 + PLANTED, 1.0)
        )
    )
    path = tmp_path / "result.json"
    assert program("crosscheck", small_arm, "--samples", 3, "--seed", 2, "--json", path).code == DISAGREED
    (record,) = json.loads(path.read_text(encoding="utf-8"))["robots"]
    torque = record["quantities"]["inverse_dynamics"]
    worst = torque["worst"]
    assert worst["route"] == "model"  # the file itself is right
    model = urdf.load(record["robot"])
    case = next(c for c in cases(model, record["samples"], record["seed"]) if c.name == worst["case"])
    q, v, a = (np.array([worst[name]]) for name in "qva")
    pinocchio = PinocchioModel.from_model(case.model)
    reference = PinocchioAnswers(pinocchio, case.model, q, v, a, np.zeros_like(q))
    error = np.abs(inverse_dynamics(case.model, q, v, a).tau - reference.tau).max()
    scale = max(np.abs(reference.tau).max(), np.abs(reference.joint_wrenches).max())
    assert error / scale == pytest.approx(torque["max_relative_error"], rel=REPRODUCED)


@pytest.mark.usefixtures("random_states_alone")
class TestJson:
    def test_content(self, program, small_arm, tmp_path):
        path = tmp_path / "result.json"
        assert program("crosscheck", small_arm, "--samples", 2, "--json", path).code == AGREED
        record = json.loads(path.read_text(encoding="utf-8"))
        assert record["format"] == "graphdyn crosscheck 3"
        assert record["versions"] == taking_part()
        assert record["command"][:3] == ["graphdyn", "crosscheck", str(small_arm)]
        assert record["agrees"] is True
        assert record["failures"] == []
        (robot,) = record["robots"]
        assert robot["robot"] == str(small_arm)
        assert robot["routes"] == ["urdf", "model"]
        assert set(robot["quantities"]) == set(COMPARED)
        for name, result in robot["quantities"].items():
            tolerance = COMPARED[name].tolerance
            assert (result["bound"], result["bound_reason"]) == (tolerance.bound, tolerance.why)
            assert result["agrees"] is (result["max_relative_error"] <= result["bound"]) is True
        assert robot["identification"]["rank"] == robot["identification"]["rank_there"]

    def test_failures(self, program, pendulum, tmp_path):
        path = tmp_path / "result.json"
        assert program("crosscheck", "ur55", pendulum, "--samples", 1, "--json", path).code == BAD_INPUT
        record = json.loads(path.read_text(encoding="utf-8"))
        assert record["agrees"] is False
        (failure,) = record["failures"]
        assert failure["robot"] == "ur55"
        assert "neither a file nor a robot" in failure["message"]
        assert [robot["robot"] for robot in record["robots"]] == [str(pendulum)]

    def test_device_as_file(self, program, pendulum):
        assert program("crosscheck", pendulum, "--samples", 1, "--json", os.devnull).code == AGREED

    def test_infinite_error_is_null(self, program, pendulum, plant, tmp_path):
        plant.pinocchio_quantity("bias_torque", lambda _: np.nan)
        path = tmp_path / "result.json"
        assert program("crosscheck", pendulum, "--samples", 1, "--json", path).code == DISAGREED
        result = json.loads(path.read_text(encoding="utf-8"))["robots"][0]["quantities"]["bias_torque"]
        assert result["max_relative_error"] is None
        assert result["agrees"] is False

    @pytest.mark.parametrize(
        "command",
        [
            ("crosscheck", "--json"),
            ("crosscheck", "--html"),
            ("show", "kr500", "--json"),
            ("show", "kr500", "--html"),
            ("errata", "--json"),
            ("robots", "--json"),
        ],
        ids=" ".join,
    )
    @pytest.mark.parametrize(("name", "reason"), [("no/such/folder.json", "does not exist"), (".", "is a folder")])
    def test_unwritable_is_refused_before_the_work(self, program, no_work, tmp_path, command, name, reason):
        done = program(*command, tmp_path / name)
        assert done.code == BAD_INPUT
        assert reason in done.err
        assert done.out == ""
        assert list(tmp_path.iterdir()) == []

    @pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="the superuser may write everywhere")
    def test_folder_without_permission_is_refused_before_the_work(self, program, no_work, tmp_path):
        tmp_path.chmod(0o500)
        try:
            done = program("crosscheck", "--json", tmp_path / "result.json")
        finally:
            tmp_path.chmod(0o700)
        assert done.code == BAD_INPUT

    def test_a_file_that_may_not_be_written_is_refused_before_the_work(self, program, no_work, tmp_path, monkeypatch):
        monkeypatch.setattr(output_files.os, "access", lambda *_: False)
        done = program("crosscheck", "--json", tmp_path / "result.json")
        assert done.code == BAD_INPUT
        assert "no permission to write there" in done.err

    def test_a_full_disk_leaves_nothing_and_is_no_disagreement(self, program, pendulum, tmp_path, full_disk):
        folder = tmp_path / "results"
        folder.mkdir()
        done = program("crosscheck", pendulum, "--samples", 1, "--json", folder / "result.json")
        assert done.code == BAD_INPUT
        assert re.fullmatch(r"error: .*result\.json: no space left on device; make room, .*\n", done.err)
        assert list(folder.iterdir()) == []

    def test_an_old_file_survives_a_failure(self, program, pendulum, tmp_path, full_disk):
        path = tmp_path / "result.json"
        path.write_text("precious", encoding="utf-8")
        assert program("crosscheck", pendulum, "--samples", 1, "--json", path).code == BAD_INPUT
        assert path.read_text(encoding="utf-8") == "precious"


@pytest.mark.usefixtures("random_states_alone", "unpictured")
class TestHtml:
    def test_beside_json(self, program, pendulum, tmp_path, wrong_torque):
        page, record = tmp_path / "r.html", tmp_path / "r.json"
        done = program("crosscheck", pendulum, "ur55", "--samples", 1, "--html", page, "--json", record)
        assert done.code == BAD_INPUT
        html = page.read_text(encoding="utf-8")
        assert "pendulum.urdf" in html
        assert "DISAGREES" in html
        assert "is neither a file nor a robot" in html
        assert json.loads(record.read_text(encoding="utf-8"))["agrees"] is False

    @pytest.mark.parametrize("command", [("crosscheck", "--samples", 1), ("show",)], ids=lambda command: command[0])
    def test_a_full_disk_leaves_nothing(self, program, pendulum, tmp_path, full_disk, command):
        folder = tmp_path / "results"
        folder.mkdir()
        done = program(*command, pendulum, "--html", folder / "r.html")
        assert done.code == BAD_INPUT
        assert re.fullmatch(r"error: .*r\.html.*: no space left on device; make room, or write elsewhere\n", done.err)
        assert list(folder.iterdir()) == []
