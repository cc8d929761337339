"""crosscheck.judge: what it says, as text, as JSON and in the test suites of others."""

import dataclasses
import json
import math
import re

import numpy as np
import pytest
from rich.cells import cell_len

import crosscheck
from crosscheck.commands.judge.record import record as record_of
from crosscheck.commands.judge.report import judge_report
from crosscheck.report.records.record import plain
from crosscheck.report.text import as_text

pytest_plugins = ["pytester"]


@pytest.fixture
def wrong(wrong_judgment):
    return wrong_judgment


class TestTexts:
    def test_assert_correct_shows_the_diagnosis(self, textbook):
        upside_down = textbook.but(gravity=-textbook.gravity)
        with pytest.raises(crosscheck.WrongDynamics) as caught:
            crosscheck.assert_correct("ur5", inverse_dynamics=upside_down.inverse_dynamics, samples=1)
        message = str(caught.value)
        assert isinstance(caught.value, AssertionError)
        assert "ur5: DISAGREES" in message
        assert "gravity has the opposite sign [gravity]" in message
        assert "remedy " in message
        assert caught.value.judgment.diagnoses

    def test_assert_correct_returns(self, textbook):
        assert crosscheck.assert_correct("ur5", inverse_dynamics=textbook.inverse_dynamics, samples=1).agrees

    def test_alternatives_are_shown(self, wrong):
        several = dataclasses.replace(wrong, diagnoses=(dataclasses.replace(wrong.diagnoses[0], also=("one", "two")),))
        assert "equivalent faults  one; or two" in as_text(judge_report(several))

    def test_an_unexplained_deviation(self, wrong):
        unknown = dataclasses.replace(wrong, diagnoses=(dataclasses.replace(wrong.diagnoses[0], explains=math.inf),))
        assert "unexplained  the whole deviation" in as_text(judge_report(unknown))

    @pytest.mark.parametrize("width", [80, 120])
    def test_fits_the_terminal(self, wrong, width):
        text = as_text(judge_report(wrong), width)
        assert max(map(cell_len, text.splitlines())) <= width
        assert re.search(r"│ inverse_dynamics │ DISAGREES │ +\d", text)
        assert ("relative to" in text) == (width == 120)

    def test_json(self, wrong):
        record = json.loads(json.dumps(plain(record_of(wrong, [])), allow_nan=False))
        assert record["verdict"] == "disagrees"
        function = record["functions"]["inverse_dynamics"]
        assert set(function["errors"]) == set(wrong.references)
        assert function["errors"]["pinocchio"]["1"] > function["bound"]
        assert set(function["worst"]["arguments"]) == {"q", "v", "a"}
        (diagnosis,) = record["diagnoses"]
        assert diagnosis["kind"] == "coriolis"

    def test_infinities_become_null(self):
        judgment = crosscheck.judge("ur5", inverse_dynamics=lambda q, v, a: q * np.nan, samples=1)
        record = plain(record_of(judgment, []))
        assert record["functions"]["inverse_dynamics"]["errors"]["graphdyn"]["1"] is None
        json.dumps(record, allow_nan=False)


class TestPlugin:
    """Two lines in a foreign test suite."""

    SUITE = """
        import graphdyn

        arm = graphdyn.kr500()

        def rnea(q, v, a):
            return graphdyn.inverse_dynamics(arm, q, v, a).tau

        def test_right(judge_dynamics):
            judge_dynamics("kr500", inverse_dynamics=rnea, samples=2)

        def test_wrong(judge_dynamics):
            judge_dynamics("kr500", inverse_dynamics=lambda *state: -rnea(*state), samples=2)
    """

    ROBOTS = """
        import pytest
        from crosscheck.reference.pinocchio_model import PinocchioModel

        def test_right(agrees_with_pinocchio):
            assert agrees_with_pinocchio("kr500", samples=1).agrees

        def test_wrong(agrees_with_pinocchio, monkeypatch):
            turned = PinocchioModel.turned
            monkeypatch.setattr(PinocchioModel, "turned", lambda self, base, gravity: turned(self, base, 2 * gravity))
            agrees_with_pinocchio("kr500", samples=1)
    """

    def test_robots(self, pytester):
        """Pinocchio is given twice the gravity: both sides of the torque, and their difference."""
        pytester.makepyfile(self.ROBOTS)
        outcome = pytester.runpytest_inprocess()
        outcome.assert_outcomes(passed=1, failed=1)
        outcome.stdout.fnmatch_lines(
            ["*graphdyn and Pinocchio disagree on 'kr500'*", "*gravity_torque*DISAGREES*",
             "*inverse_dynamics where its error is largest: *", "*entry*graphdyn*Pinocchio*difference*",
             "*graphdyn and Pinocchio on kr500: DISAGREES. * quantities are beyond their bounds.*"]
        )  # fmt: skip

    def test_fixture(self, pytester):
        pytester.makepyfile(self.SUITE)
        outcome = pytester.runpytest_inprocess()
        outcome.assert_outcomes(passed=1, failed=1)
        outcome.stdout.fnmatch_lines(["*all torques have the opposite sign*"])

    def test_installed(self, pytester):
        """The entry point announces it; it costs no import of Pinocchio, and its message none that only pages need."""
        pytester.makepyfile(
            """
            import sys, numpy, crosscheck, pytest
            from graphdyn import Body, Joint, Placement, RobotModel

            def test(judge_dynamics):
                assert "pinocchio" in sys.modules
                body = Body("body", 1.0, [0.1, 0.2, 0.3], numpy.eye(3))
                robot = RobotModel("pendulum", (body,), (Joint("joint", "revolute", 0, Placement(), [0.0, 1.0, 0.0]),))
                with pytest.raises(crosscheck.WrongDynamics, match="DISAGREES"):
                    judge_dynamics(robot, inverse_dynamics=lambda q, v, a: q, samples=1)
                assert not {"jinja2", "matplotlib"} & set(sys.modules)
            """
        )
        pytester.makeconftest("import sys\nassert 'pinocchio' not in sys.modules\n")
        pytester.runpytest_subprocess().assert_outcomes(passed=1)
