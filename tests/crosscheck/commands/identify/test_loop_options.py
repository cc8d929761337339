"""`graphdyn identify --controller`: the loop of a recording on the command line."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from identified import closed_loop_data
from typer.testing import CliRunner

import urdf
from crosscheck.commands.application import app
from crosscheck.commands.program import own_process
from crosscheck.identifying.methods.loop_methods import with_exogeneity
from graphdyn.identification import Problem, WeightedLeastSquares, compare_methods

CONTROL = """
from identified import closed_loop_data

plant = closed_loop_data.two_axes()

def pd():
    return plant.controller(2e-3, plant.start)

def nothing():
    return 3
"""

TRUE_FRICTION = 25.0
"""[N m] Coulomb friction of the second axis."""

OPTIONS = ["--robot", "arm.urdf", "--cutoff", "50", "--min-speed", "0.05", "--terms", "viscous,coulomb,rotor"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A recording of two axes in a loop, the robot, and the controller as a file."""
    folder, plant = tmp_path_factory.mktemp("loop"), closed_loop_data.two_axes()
    run = plant.record(3.0, position=2e-4, velocity=1e-3, torque=1.0)
    names = plant.model.joint_names
    head = ",".join(["time_s", *(f"q_{j}" for j in names), *(f"tau_{j}" for j in names)])
    table = np.column_stack([run.time, run.q, run.tau])
    np.savetxt(folder / "log.csv", table, delimiter=",", header=head, comments="", fmt="%.12g")
    urdf.save(plant.model, folder / "arm.urdf")
    (folder / "control.py").write_text(CONTROL, encoding="utf-8")
    return folder


@pytest.fixture
def program(folder, monkeypatch):
    """Runs the command in the folder; gives exit code and everything that was printed."""
    monkeypatch.chdir(folder)
    monkeypatch.setattr(own_process, "tell", lambda _: None)

    def run(*arguments):
        done = CliRunner().invoke(app, ["identify", "log.csv", *OPTIONS, "--poses", "10", *arguments])
        return done.exit_code, " ".join(done.output.replace("│", " ").split())

    return run


@pytest.mark.usefixtures("unexamined")
def test_everything_at_once(program, folder):
    """The regressor is not exogenous, in every result; least squares alone has wrong friction."""
    loop = ["--controller", "control.py:pd", "--control-rate", "1000", "--torque-hold", "0.001"]
    _, said = program(*loop, "--methods", "wls,iv,didim,cloe,clie", "--json", "found.json")
    assert "tau in the middle of a hold of 0.001 s" in said
    assert re.search(
        r"WLS: the regressor is not exogenous at O1, O2 \(Durbin-Wu-Hausman, p = \S+\): least squares", said
    )
    found = json.loads((folder / "found.json").read_text())
    methods = {one["name"]: one for one in found["methods"]}
    assert all(one["failure"] is None for one in methods.values())
    assert all(one["settings"]["exogeneity p"] < 1e-9 for one in methods.values())
    assert found["exogeneity"].startswith("the regressor is not exogenous at O1, O2 (Durbin-Wu-Hausman, p = ")
    assert re.search(r"exogeneity the regressor is not exogenous at O1, O2", said)
    place = [one["name"] for one in found["base_parameters"]].index("FC_2")
    error = {name: abs(one["base_values"][place] - TRUE_FRICTION) for name, one in methods.items()}
    assert error["WLS"] > 5
    assert all(error[name] < 2 for name in ("IDIM-IV", "DIDIM", "CLOE", "CLIE"))


@pytest.mark.usefixtures("unexamined")
@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "IDIM-IV: failed: needs the controller of the loop in which the recording was made"),
        (
            ("--controller", "control.py:nothing"),
            "control.py:nothing makes a int; a PDControl or ComputedTorqueControl",
        ),
        ((), "exogeneity not tested: the test needs the simulated loop of the recording (controller and reference)"),
        (("--control-rate", "100"), "--control-rate 100: give Hz above zero, and a --controller"),
        (("--torque-hold", "-1"), "--torque-hold -1: give seconds, 0 for none"),
        (("--controller", "control.py:pd", "--control-rate", "700"), "are no multiples of each other"),
    ],
)
def test_messages(program, options, message):
    _, said = program(*options, "--methods", "iv")
    assert message in said


def test_why_exogeneity_is_not_tested():
    """No time, no simulation: every result says so."""
    run = closed_loop_data.two_axes().record(0.3)
    problem = Problem(run.torque_model, replace(run.exact, time=None))
    comparison, words = with_exogeneity(compare_methods(problem, [WeightedLeastSquares()], poses=1), problem, run.loop)
    assert words == comparison.results[0].estimate.remarks[-1]
    assert words.startswith("exogeneity of the regressor not tested: WLS: needs the time of every sample")


def test_the_simulated_robot_has_no_loop():
    done = CliRunner().invoke(app, ["identify", "--torque-hold", "0.1"])
    assert "--torque-hold needs a LOG" in done.output
