"""docs/peers: the command that judges other libraries, with those that the tests have; all glue is in the page."""

import json
import subprocess
import sys

import pytest
from shared_data import REPOSITORY
from urdf_text import joint, link, robot_text

DOCS = REPOSITORY / "docs"
GLUE = sorted((DOCS / "peers").glob("peer_*.py"))
MOVES = '<axis xyz="0 1 0"/><limit lower="-9" upper="9" effort="1" velocity="1"/>'


def run(*arguments):
    command = [sys.executable, str(DOCS / "peers/run.py"), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=False)


@pytest.fixture
def damped(tmp_path):
    """A pendulum whose joint has damping, which MuJoCo counts and the judge does not ask for."""
    path = tmp_path / "damped.urdf"
    swing = joint("swing", "base", "rod", more=MOVES + '<dynamics damping="0.5"/>')
    path.write_text(robot_text("damped", link("base"), link("rod", xyz="0.1 0 0.3"), swing))
    return path


def test_peers_are_judged_and_causes_undone(damped, tmp_path):
    answers = tmp_path / "peers.json"
    ended = run("--peers", "pinocchio", "mujoco", "--robots", damped, "--json", answers)
    assert ended.returncode == 0, ended.stderr
    pinocchio, mujoco = json.loads(answers.read_text())["rows"]
    assert pinocchio["peer"] == "pinocchio"
    assert pinocchio["agrees"]
    assert "damped: agrees" in ended.stdout
    assert not mujoco["agrees"]
    assert mujoco["errors"]["inverse_dynamics"] > 1e-3
    assert {"kind": "friction", "status": "confirmed"}.items() <= mujoco["diagnoses"][0].items()
    assert mujoco["undone"] == ["damping"]
    assert max(mujoco["errors_undone"].values()) < 1e-12
    assert "agrees without damping" in ended.stdout


def test_a_file_that_a_library_does_not_read_is_a_verdict(tmp_path):
    path = tmp_path / "weightless.urdf"
    rod = joint("swing", "base", "rod", more=MOVES)
    path.write_text(robot_text("weightless", link("base"), link("rod", None), rod))
    ended = run("--peers", "mujoco", "--robots", path)
    assert ended.returncode == 0, ended.stderr
    assert "does not read the file: ValueError: Error: mass and inertia of moving bodies must be larger" in ended.stdout
    assert "no set of causes undone makes it agree" in ended.stdout


def test_a_process_that_ends_is_a_failure():
    ended = run("--peers", "mujoco", "--robots", "no_such_robot")
    assert ended.returncode == 1
    assert "no_such_robot: ended with code 1: " in ended.stdout
    assert "RobotNotFound" in ended.stdout


@pytest.mark.parametrize("path", GLUE, ids=lambda path: path.stem)
def test_glue_compiles_and_is_in_the_page(path):
    compile(path.read_text(encoding="utf-8"), path.name, "exec")
    assert path.name in (DOCS / "peers.md").read_text(encoding="utf-8")
