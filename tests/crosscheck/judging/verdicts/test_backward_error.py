"""crosscheck.judge: accelerations are judged a second time, by the torques that they need."""

import math
import sys

import numpy as np
import pytest
from faults.textbook_faults import WRIST_LOCKED
from long_check import few
from shared_data import ARMS, existing

import crosscheck
import graphdyn
import urdf
from crosscheck.commands.judge.record import record as record_of
from crosscheck.commands.judge.report import judge_report
from crosscheck.reference.pinocchio_model import PinocchioAnswers
from crosscheck.report.records.record import plain
from crosscheck.report.text import as_text

SAMPLES = 5


def single_precision(model):
    """M⁻¹ (τ − h), the last step rounded to single precision."""

    def forward_dynamics(q, v, tau):
        mass, rest = graphdyn.mass_matrix(model, q), tau - graphdyn.bias_torque(model, q, v)
        return np.linalg.solve(mass.astype(np.float32), rest.astype(np.float32))

    return forward_dynamics


def wrong_gravity(model):
    other = model.with_gravity(model.gravity * 9.811 / np.linalg.norm(model.gravity))
    return lambda q, v, tau: graphdyn.forward_dynamics(other, q, v, tau).a


class TestBackwardError:
    """The scale of accelerations has cond(M), up to 1e6 on arms, which hides faults; backward errors do not."""

    @pytest.mark.parametrize("robot", few(["kr500", "ur5", "kinova"], "ur5"))
    def test_single_precision(self, robot):
        judgment = crosscheck.judge(robot, forward_dynamics=single_precision(urdf.load(robot)), samples=SAMPLES)
        function = judgment.functions["forward_dynamics"]
        assert not judgment.agrees
        assert judgment.decided
        assert set(function.backward_errors) == set(judgment.references)
        for backward in function.backward_errors.values():
            assert 1e-8 < backward.max() < 1e-6
        assert "single precision" in judgment.diagnoses[0].message

    def test_gravity_where_the_condition_number_hides_it(self):
        """The worst conditioned arm among the makers' files."""
        model = urdf.load(existing(ARMS / "j2s6s200_standalone.urdf"))
        judgment = crosscheck.judge(model, forward_dynamics=wrong_gravity(model), samples=SAMPLES)
        function = judgment.functions["forward_dynamics"]
        assert function.backward_errors["graphdyn"].max() > 4e-5
        assert [diagnosis.kind for diagnosis in judgment.diagnoses] == ["gravity"]

    @pytest.mark.usefixtures("undiagnosed")
    def test_an_error_that_only_the_backward_error_shows(self):
        """A part in a hundred million of the acceleration, in the direction that needs most torque."""
        short = urdf.load("ur5", lock=WRIST_LOCKED)

        def forward_dynamics(q, v, tau):
            a = graphdyn.forward_dynamics(short, q, v, tau).a
            heaviest = np.linalg.eigh(graphdyn.mass_matrix(short, q))[1][:, -1]
            return a + 1e-8 * np.abs(a).max() * heaviest

        judgment = crosscheck.judge(short, forward_dynamics=forward_dynamics, samples=SAMPLES)
        function = judgment.functions["forward_dynamics"]
        assert function.within(function.errors)
        assert not function.within(function.backward_errors)
        assert not function.agrees
        text = as_text(judge_report(judgment), width=140)
        rows = {line.split("│")[1].strip(): line for line in text.splitlines() if line.startswith("│")}
        assert "agrees" in rows["forward_dynamics"]
        assert "DISAGREES" in rows["backward_error"]
        worst = int(np.argmax(function.backward_errors["graphdyn"]))
        assert f"{function.backward_errors['graphdyn'][worst]:.1e}" in rows["backward_error"]
        written = plain(record_of(judgment, ["graphdyn", "judge"]))["functions"]["forward_dynamics"]
        assert written["backward_errors"]["graphdyn"]["1"] == function.backward_errors["graphdyn"][worst]
        assert list(function.worst.answer) == list(forward_dynamics(*map(np.array, function.worst.arguments.values())))

    @pytest.mark.parametrize("value", [math.nan, math.inf, 1e300])
    @pytest.mark.filterwarnings("ignore::RuntimeWarning")
    @pytest.mark.usefixtures("undiagnosed")
    def test_no_finite_answer(self, ur5, value):
        judgment = crosscheck.judge(ur5, forward_dynamics=lambda q, v, tau: value + 0 * q, samples=SAMPLES)
        function = judgment.functions["forward_dynamics"]
        for error in function.backward_errors.values():
            assert (np.isinf(error) if not math.isfinite(value) else error > 0.01).all()
        assert not judgment.agrees

    def test_only_accelerations_have_one(self, textbook):
        judgment = crosscheck.judge("ur5", inverse_dynamics=textbook.inverse_dynamics, samples=SAMPLES)
        assert judgment.functions["inverse_dynamics"].backward_errors == {}

    def test_a_reference_that_differs_backward_decides_nothing(self, textbook, monkeypatch):
        """Pinocchio's accelerations are off by what the forward scale does not notice."""
        original = PinocchioAnswers.a.func

        def accelerations(there):
            a, heaviest = original(there), np.linalg.eigh(there.mass_matrix)[1][..., -1]
            return a + 1e-8 * np.abs(a).max() * heaviest

        monkeypatch.setattr(PinocchioAnswers, "a", property(accelerations))
        monkeypatch.setitem(sys.modules, "flint", None)
        judgment = crosscheck.judge("ur5", forward_dynamics=textbook.forward_dynamics, samples=SAMPLES)
        function = judgment.functions["forward_dynamics"]
        assert function.within(function.references_differ)
        assert not judgment.decided
        assert judgment.verdict == "UNDECIDED"
