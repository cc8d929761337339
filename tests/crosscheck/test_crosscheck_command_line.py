"""The program: exit codes, files, messages. In process through its entry point, and as the installed script."""

import errno
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from planting import Plant, mixed_tree

import crosscheck
import urdf
from crosscheck import command_line
from crosscheck.command_line import AGREED, BAD_INPUT, DEFAULT_ROBOTS, DISAGREED
from crosscheck.errata import ERRATA
from crosscheck.pinocchio_model import PinocchioModel
from crosscheck.quantities import BY_NAME
from crosscheck.report import JSON_FORMAT, versions
from crosscheck.states import cases
from graphdyn import __version__, inverse_dynamics

REPRODUCED = 1e-3
"""An error of 1e-9, computed a second time from the recorded state: rounding is 1e-15 of the same scale."""

PLANTED = 1e-9
COMMANDS = ("crosscheck", "robots", "errata")


class Outcome:
    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err


@pytest.fixture
def program(monkeypatch, capsys):
    """program("crosscheck", "ur5"): exit code and what was written, through main as the script calls it."""

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["graphdyn", *map(str, arguments)])
        with pytest.raises(SystemExit) as caught:
            command_line.main()
        captured = capsys.readouterr()
        return Outcome(caught.value.code or 0, captured.out, captured.err)

    return run


@pytest.fixture
def script(tmp_path):
    """The installed program, in a folder without sources."""
    path = shutil.which("graphdyn", path=os.path.dirname(sys.executable)) or shutil.which("graphdyn")
    if path is None:
        pytest.skip("the program graphdyn is not installed; pip install -e .")

    def run(*arguments):
        finished = subprocess.run(
            [path, *map(str, arguments)], cwd=tmp_path, capture_output=True, text=True, check=False, encoding="utf-8"
        )
        return Outcome(finished.returncode, finished.stdout, finished.stderr)

    return run


@pytest.fixture
def wrong_torque(plant: Plant):
    plant.referee_value("tau", lambda x: x * (1 + PLANTED))


@pytest.fixture
def no_work(monkeypatch):
    """Comparing anything fails the test."""

    def compare(*_arguments, **_options):
        raise AssertionError("the work began")

    monkeypatch.setattr(command_line, "compare", compare)
    monkeypatch.setattr(command_line, "measure", compare)


@pytest.fixture
def full_disk(monkeypatch):
    """The disk takes one byte of a file and no more."""
    original = Path.write_bytes

    def write_bytes(path, content):
        original(path, content[:1])
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))

    monkeypatch.setattr(Path, "write_bytes", write_bytes)


class TestExitCodes:
    def test_agreement(self, program, small_arm):
        done = program("crosscheck", small_arm, "--samples", 2)
        assert done.code == AGREED == 0
        assert done.err == ""
        assert "DISAGREES" not in done.out
        for name in BY_NAME:
            assert name in done.out

    def test_disagreement(self, program, small_arm, wrong_torque):
        done = program("crosscheck", small_arm, "--samples", 2)
        assert done.code == DISAGREED == 1
        (row,) = [line for line in done.out.splitlines() if line.startswith("│") and "DISAGREES" in line]
        assert row.split("│")[1].strip() == "torque"

    def test_one_of_several_disagrees(self, program, small_arm, wrong_torque):
        """The plant strikes the first robot only; the verdict is of all."""
        done = program("crosscheck", small_arm, "kr500", "--samples", 2)
        assert done.code == DISAGREED
        assert re.search(r"│ verdict +│ +│ +DISAGREES │ +agrees │", done.out)
        (row,) = [line for line in done.out.splitlines() if "✗" in line]
        assert re.fullmatch(r"│ torque +│ +[\d.e-]+ │ +[\d.e-]+ ✗ │ +[\d.e-]+ │", row)

    def test_bad_file_is_one_line_and_the_others_go_on(self, program, small_arm, tmp_path):
        broken = tmp_path / "broken.urdf"
        broken.write_text("<robot name='x'>\n", encoding="utf-8")
        done = program("crosscheck", broken, small_arm, "--samples", 2)
        assert done.code == BAD_INPUT == 2
        assert done.err.startswith(f"error: {broken}:")
        assert done.err.count("\n") == 1
        assert "Traceback" not in done.err + done.out
        assert f"{small_arm}: agrees" in done.out.replace("\n", "")

    def test_one_unreadable_robot_leaves_the_others_their_result(self, program, small_arm, monkeypatch):
        original = command_line.compare

        def compare(robot, *arguments, **options):
            if robot == "gone.urdf":
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), robot)
            return original(robot, *arguments, **options)

        monkeypatch.setattr(command_line, "compare", compare)
        done = program("crosscheck", "gone.urdf", small_arm, "--samples", 1)
        assert done.code == BAD_INPUT
        assert re.fullmatch(r"error: .*Permission denied.*gone\.urdf.*\n", done.err)
        assert f"{small_arm}: agrees" in done.out.replace("\n", "")

    def test_bad_file_outweighs_disagreement(self, program, small_arm, wrong_torque):
        assert program("crosscheck", small_arm, "no_such_robot", "--samples", 2).code == BAD_INPUT

    def test_unknown_name(self, program):
        done = program("crosscheck", "ur55")
        assert done.code == BAD_INPUT
        assert re.fullmatch(r"error: 'ur55' is neither a file nor a robot .*ur5.*\n", done.err)

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (["crosscheck", "kr500", "--samples", "0"], "'--samples'"),
            (["crosscheck", "kr500", "--samples", "many"], "'--samples'"),
            (["crosscheck", "kr500", "--lock", "O1=soft"], "'soft' is not a number"),
            (["crosscheck", "kr500", "ur5", "--lock", "O1"], "--lock needs exactly one robot"),
            (["crosscheck", "--lock", "O1"], "--lock needs exactly one robot"),
            (["crosscheck", "kr500", "--speed", "1"], "--speed"),
            (["errata", "--samples", "9"], "'--samples'"),
            (["nonsense"], "nonsense"),
        ],
    )
    def test_bad_options(self, program, no_work, arguments, message):
        done = program(*arguments)
        assert done.code == BAD_INPUT
        assert message in done.err
        assert "Traceback" not in done.err

    def test_warnings_are_one_line_each(self, program, small_arm):
        small_arm.write_text(small_arm.read_text().replace('xyz="0 1 0"', 'xyz="0 2 0"'))
        done = program("crosscheck", small_arm, "--samples", 1)
        assert done.code == AGREED
        assert re.fullmatch(r"warning: .*axis not of unit length.*'y_elbow' \(2\)\n", done.err)


class TestLockOption:
    def test_value(self, program, small_arm, tmp_path):
        record = tmp_path / "r.json"
        done = program(
            "crosscheck", small_arm, "--lock", "y_elbow=0.3", "--lock", "a_slide", "--samples", 1, "--json", record
        )
        assert done.code == AGREED
        (robot,) = json.loads(record.read_text(encoding="utf-8"))["robots"]
        assert robot["locked"] == {"y_elbow": 0.3, "a_slide": 0.0}
        assert robot["n_bodies"] == 1

    def test_unknown_joint(self, program, small_arm):
        done = program("crosscheck", small_arm, "--lock", "elbow")
        assert done.code == BAD_INPUT
        assert re.fullmatch(r"error: .*cannot lock 'elbow'.*\n", done.err)


class TestDefaults:
    def test_without_arguments_the_six_arms(self, program, monkeypatch):
        seen, comparison = [], crosscheck.compare(mixed_tree(), 1)

        def compare(robot, samples, seed, *, lock=None, progress=None):
            seen.append((robot, lock))
            return comparison

        monkeypatch.setattr(command_line, "compare", compare)
        assert program("crosscheck").code == AGREED
        assert seen == [(name, dict(lock) or None) for name, lock in DEFAULT_ROBOTS]

    def test_seed_and_samples_arrive(self, program, small_arm, tmp_path):
        record = tmp_path / "r.json"
        program("crosscheck", small_arm, "--samples", 3, "--seed", 11, "--json", record)
        (robot,) = json.loads(record.read_text(encoding="utf-8"))["robots"]
        assert (robot["samples"], robot["seed"]) == (3, 11)


class TestJson:
    def test_content(self, program, small_arm, tmp_path):
        path = tmp_path / "result.json"
        assert program("crosscheck", small_arm, "--samples", 2, "--json", path).code == AGREED
        record = json.loads(path.read_text(encoding="utf-8"))
        assert record["format"] == JSON_FORMAT
        assert record["versions"] == versions()
        assert record["command"][:3] == ["graphdyn", "crosscheck", str(small_arm)]
        assert record["agrees"] is True
        assert record["failures"] == []
        (robot,) = record["robots"]
        assert robot["robot"] == str(small_arm)
        assert robot["routes"] == ["urdf", "model"]
        assert set(robot["quantities"]) == set(BY_NAME)
        for name, result in robot["quantities"].items():
            tolerance = BY_NAME[name].tolerance
            assert (result["bound"], result["bound_reason"]) == (tolerance.bound, tolerance.why)
            assert result["agrees"] is (result["max_relative_error"] <= result["bound"]) is True
        assert robot["identification"]["rank"] == robot["identification"]["rank_there"]

    def test_worst_state_is_enough_to_reproduce(self, program, small_arm, tmp_path, monkeypatch):
        """From the file alone: robot, case, q, v, a give the recorded error again."""
        Plant(monkeypatch).referee_model(
            lambda model: model.with_inertial_parameters(
                model.inertial_parameters * np.where(np.arange(30) == 10, 1 + PLANTED, 1.0)
            )
        )
        path = tmp_path / "result.json"
        assert program("crosscheck", small_arm, "--samples", 3, "--seed", 2, "--json", path).code == DISAGREED
        (record,) = json.loads(path.read_text(encoding="utf-8"))["robots"]
        torque = record["quantities"]["torque"]
        worst = torque["worst"]
        assert worst["route"] == "model"  # the file itself is right
        model = urdf.load(record["robot"])
        case = next(c for c in cases(model, record["samples"], record["seed"]) if c.name == worst["case"])
        q, v, a = (np.array([worst[name]]) for name in "qva")
        referee = PinocchioModel.from_model(case.model)
        reference = referee.evaluate(q, v, a, np.zeros_like(q), np.zeros((*q.shape, 6)))
        error = np.abs(inverse_dynamics(case.model, q, v, a).tau - reference.tau).max()
        scale = max(np.abs(reference.tau).max(), np.abs(reference.joint_wrenches).max())
        assert error / scale == pytest.approx(torque["max_relative_error"], rel=REPRODUCED)

    def test_failures(self, program, small_arm, tmp_path):
        path = tmp_path / "result.json"
        assert program("crosscheck", "ur55", small_arm, "--samples", 1, "--json", path).code == BAD_INPUT
        record = json.loads(path.read_text(encoding="utf-8"))
        assert record["agrees"] is False
        (failure,) = record["failures"]
        assert failure["robot"] == "ur55"
        assert "neither a file nor a robot" in failure["message"]
        assert [robot["robot"] for robot in record["robots"]] == [str(small_arm)]

    def test_device_as_file(self, program, small_arm):
        assert program("crosscheck", small_arm, "--samples", 1, "--json", os.devnull).code == AGREED

    def test_infinite_error_is_null(self, program, small_arm, plant, tmp_path):
        plant.referee_value("bias", lambda _: np.nan)
        path = tmp_path / "result.json"
        assert program("crosscheck", small_arm, "--samples", 1, "--json", path).code == DISAGREED
        result = json.loads(path.read_text(encoding="utf-8"))["robots"][0]["quantities"]["bias_torque"]
        assert result["max_relative_error"] is None
        assert result["agrees"] is False

    @pytest.mark.parametrize("command", ["crosscheck", "errata", "robots"])
    @pytest.mark.parametrize(("name", "reason"), [("no/such/folder.json", "does not exist"), (".", "is a folder")])
    def test_unwritable_is_refused_before_the_work(self, program, no_work, tmp_path, command, name, reason):
        done = program(command, "--json", tmp_path / name)
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
        monkeypatch.setattr(command_line.os, "access", lambda *_: False)
        done = program("crosscheck", "--json", tmp_path / "result.json")
        assert done.code == BAD_INPUT
        assert "no permission to write there" in done.err

    def test_a_full_disk_leaves_nothing_and_is_no_disagreement(self, program, small_arm, tmp_path, full_disk):
        folder = tmp_path / "results"
        folder.mkdir()
        done = program("crosscheck", small_arm, "--samples", 1, "--json", folder / "result.json")
        assert done.code == BAD_INPUT
        assert re.fullmatch(r"error: .*No space left on device.*result\.json.*\n", done.err)
        assert list(folder.iterdir()) == []

    def test_an_old_file_survives_a_failure(self, program, small_arm, tmp_path, full_disk):
        path = tmp_path / "result.json"
        path.write_text("precious", encoding="utf-8")
        assert program("crosscheck", small_arm, "--samples", 1, "--json", path).code == BAD_INPUT
        assert path.read_text(encoding="utf-8") == "precious"


class TestOtherCommands:
    def test_robots(self, program, tmp_path):
        path = tmp_path / "robots.json"
        done = program("robots", "--json", path)
        assert done.code == AGREED
        listed = json.loads(path.read_text(encoding="utf-8"))["robots"]
        assert [entry["name"] for entry in listed] == [entry.name for entry in urdf.robots()]
        for name in ("kr500", "ur5", "z1"):
            assert re.search(rf"│ {name} +│", done.out)

    def test_errata(self, program, tmp_path):
        path = tmp_path / "errata.json"
        done = program("errata", "--samples", 20, "--json", path)
        assert done.code == AGREED
        effects = json.loads(path.read_text(encoding="utf-8"))["effects"]
        assert {effect["erratum"] for effect in effects} == set(ERRATA)
        assert {effect["robot"] for effect in effects} == {"kr500", "ur5"}
        for name, sentence in ERRATA.items():
            assert f"{name}: {sentence}" in done.out

    def test_version(self, program):
        done = program("--version")
        assert done.code == AGREED
        numbers = dict(line.split() for line in done.out.splitlines())
        assert numbers == versions()
        assert numbers["graphdyn"] == __version__

    @pytest.mark.parametrize("command", [(), *((name,) for name in COMMANDS)])
    def test_help(self, program, command):
        done = program(*command, "--help")
        assert done.code == AGREED
        assert re.search(r"Usage: .*graphdyn", done.out)
        if command:
            assert f"Example: graphdyn {command[0]}" in done.out
            assert "--json" in done.out
        else:
            assert all(name in done.out for name in COMMANDS)

    def test_every_command_is_tested(self):
        assert {info.name for info in command_line.app.registered_commands} == set(COMMANDS)

    def test_nothing_asked_is_help_and_nothing_done(self, program):
        done = program()
        assert done.code == BAD_INPUT
        assert re.search(r"Usage: .*graphdyn", done.out + done.err)


class TestOutput:
    def test_no_progress_where_nobody_watches(self, program, small_arm):
        """A bar in a log file is noise: standard error stays empty, standard output has no control characters."""
        done = program("crosscheck", small_arm, "--samples", 2)
        assert done.err == ""
        assert "\x1b" not in done.out

    def test_names_are_not_markup(self, program, small_arm, tmp_path):
        """Brackets in a path are brackets, not rich's markup."""
        folder = tmp_path / "[bold]x["
        (folder / "y]").mkdir(parents=True)
        path = folder / "y]" / "[red]arm.urdf"
        shutil.copy(small_arm, path)
        done = program("crosscheck", path, "--samples", 1)
        assert done.code == AGREED
        assert str(path) in done.out.replace("\n", "")
        several = program("crosscheck", path, small_arm, "--samples", 1)
        assert several.code == AGREED
        assert str(path) in several.out.replace("\n", "")

    def test_disagreement_of_such_a_name(self, small_arm, tmp_path, wrong_torque):
        path = tmp_path / "[red]arm.urdf"
        shutil.copy(small_arm, path)
        with pytest.raises(crosscheck.Disagreement) as caught:
            crosscheck.assert_agrees(path, 1)
        table = str(caught.value).split("\n", 1)[1]
        assert "[red]arm.urdf: DISAGREES" in table.replace("\n", "")


class TestInstalledScript:
    def test_agreement(self, script, small_arm, tmp_path):
        record = tmp_path / "r.json"
        done = script("crosscheck", small_arm, "--samples", 2, "--json", record)
        assert done.code == AGREED
        assert done.err == ""
        assert json.loads(record.read_text(encoding="utf-8"))["command"][:2] == ["graphdyn", "crosscheck"]

    def test_bad_file(self, script, tmp_path):
        broken = tmp_path / "broken.urdf"
        broken.write_bytes(b"\xff\xfe<robot")
        done = script("crosscheck", broken)
        assert done.code == BAD_INPUT
        assert done.err.startswith(f"error: {broken}:")
        assert done.err.count("\n") == 1

    def test_version(self, script):
        done = script("--version")
        assert done.code == AGREED
        assert f"graphdyn {__version__}" in done.out.splitlines()
