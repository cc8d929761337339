"""What the benchmark refuses, and who is left out of it."""

import os
import shutil
import sys
from dataclasses import replace

import numpy as np
import pytest
from typer.testing import CliRunner

from crosscheck.bench import benchmark
from crosscheck.bench.cold import in_fresh_process
from crosscheck.bench.forms import peers
from crosscheck.bench.forms.peers import CasadiRefuses
from crosscheck.bench.forms.pinocchio_forms import instruction_set
from crosscheck.bench.states import random_states
from crosscheck.commands import app
from crosscheck.reference.mujoco_model import MujocoModel, MujocoRefuses
from crosscheck.reference.pinocchio_model import PinocchioModel, PinocchioRefuses
from graphdyn import Body, InvalidInput, Joint, Placement, RobotModel, kr500
from graphdyn.errors import not_installed


@pytest.fixture(scope="module")
def states():
    return random_states(kr500(), 3, 1)


class TestRefusals:
    @pytest.mark.parametrize("option", ["--samples", "--threads"])
    def test_numbers(self, option):
        done = CliRunner().invoke(app, ["bench", option, "0"])
        assert done.exit_code == 2
        assert f"invalid value for '{option}'" in done.output

    def test_unknown_robot(self):
        done = CliRunner().invoke(app, ["bench", "--robot", "ur55"])
        assert done.exit_code == 2
        assert "ur55" in done.output

    def test_coupled_joints(self):
        done = CliRunner().invoke(app, ["bench", "--robot", "panda", "--quick", "--samples", "2"])
        assert done.exit_code == 2
        assert "robot 'panda': panda_finger_joint2 is coupled, and the functions of Pinocchio" in done.output
        assert "read it with --mimic independent or --mimic locked" in " ".join(done.output.split())

    def test_folder_does_not_exist(self, tmp_path):
        done = CliRunner().invoke(app, ["bench", "--json", str(tmp_path / "no" / "bench.json")])
        assert done.exit_code == 2
        assert "does not exist" in done.output

    def test_threads_of_the_function(self):
        with pytest.raises(InvalidInput, match="threads is 0; give a number from 1, or None for all cores"):
            benchmark.benchmark("kr500", kr500(), 10, 0, 0, True, False, lambda *_: None)

    def test_no_mujoco(self, states, tmp_path, monkeypatch):
        monkeypatch.setitem(sys.modules, "mujoco", None)
        others = peers.Peers(states, tmp_path)
        assert "the package mujoco is not installed" in others.left_out["mujoco"]

    def test_no_casadi(self, states, tmp_path, monkeypatch):
        monkeypatch.setitem(sys.modules, "casadi", None)
        others = peers.Peers(states, tmp_path)
        found = others.contenders("inverse_dynamics", (1,))
        assert peers.CASADI_NAME not in {contender.name for contender in found}
        assert others.left_out["casadi"] == not_installed("casadi", "peers")

    def test_no_c_compiler(self, states, tmp_path, monkeypatch):
        pytest.importorskip("casadi")
        monkeypatch.setattr(shutil, "which", lambda _: None)
        with pytest.raises(CasadiRefuses, match=r"generates C code, and there is no C compiler \(cc\)"):
            peers.casadi_dynamics(False, states, tmp_path)

    def test_the_c_compiler_fails(self, states, tmp_path, monkeypatch):
        pytest.importorskip("casadi")
        failing = tmp_path / "cc"
        failing.write_text("#!/bin/sh\necho no space left >&2\nexit 1\n", encoding="utf-8")
        failing.chmod(0o755)
        monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}{os.environ['PATH']}")
        with pytest.raises(CasadiRefuses, match="the C compiler fails on CasADi's code: no space left"):
            peers.casadi_dynamics(False, states, tmp_path)

    def test_a_process_that_fails(self, tmp_path):
        with pytest.raises(RuntimeError, match=r"the task first_calls in a process of its own failed.*model\.pickle"):
            in_fresh_process("first_calls", tmp_path)

    def test_another_order_of_joints(self):
        """Breadth first here, depth first there."""
        body = Body("", 1.0, np.zeros(3), np.eye(3))
        bodies = tuple(replace(body, name=f"b{k}") for k in range(3))
        joints = tuple(
            Joint(f"j{k}", "revolute", inside, Placement(), np.eye(3)[2]) for k, inside in enumerate((0, 0, 1))
        )
        model = RobotModel("bush", bodies, joints)
        with pytest.raises(PinocchioRefuses, match="'bush': Pinocchio has other coordinates, or another order"):
            PinocchioModel.from_model(model).bare_calls()
        pytest.importorskip("mujoco")
        with pytest.raises(MujocoRefuses, match="MuJoCo has the joints in another order"):
            MujocoModel(model).rollout(np.zeros((1, 3)), np.zeros((1, 3)), np.zeros((1, 3)), 1)

    def test_instruction_set_is_not_known(self, monkeypatch):
        assert instruction_set() != "unknown"
        monkeypatch.setitem(sys.modules, "eigenpy", None)
        assert instruction_set() == "unknown"
