"""Mutants of robot files: nothing crashes, hangs, contradicts itself, or differs from Pinocchio without a finding.

Some hundred mutants, or as many as GRAPHDYN_MUTANTS says, of the seed GRAPHDYN_MUTANTS_SEED. The table of a long run:
`python tests/tools damaged_files 20000 --format urdf --seed 1`.
"""

import os

import numpy as np
import pytest
from deadly_tasks import ends_at_two
from inspected.sample import CLEAN, LIMIT, changed
from mutants import processes
from mutants.formats import robot
from mutants.mutant import mutant
from mutants.outcomes import Trial
from mutants.processes import run, table, unexpected
from mutants.trial import CLAIMS, trial

import urdf
from urdf.inspection import inspecting

MANY = int(os.environ.get("GRAPHDYN_MUTANTS", "120"))
SEED = int(os.environ.get("GRAPHDYN_MUTANTS_SEED", "0"))


def test_mutants():
    results = run(["urdf"], SEED, range(MANY), 1)
    assert len(results) == MANY
    assert unexpected(results) == []
    outcomes = {result.trial.outcome for result in results}
    assert {"refused", "agrees", "kinematics only", "explained"} <= outcomes, table(results)


def test_a_mutant_is_known_by_its_number():
    assert [mutant("urdf", 3, k) for k in range(20)] == [mutant("urdf", 3, k) for k in range(20)]
    assert len({mutant("urdf", 3, k).content for k in range(50)}) > 40
    assert mutant("urdf", 3, 0) != mutant("urdf", 4, 0)


class TestTheTrialCanFail:
    """A fault planted in what is tried shows."""

    def expect(self, path, message):
        found = trial(path)
        assert found.outcome == "unexpected"
        assert message in found.detail

    def test_clean(self, written):
        assert trial(written(CLEAN)) == Trial("agrees")

    def test_foreign_error(self, written, monkeypatch):
        monkeypatch.setattr(urdf, "inspect", lambda path: {}["finding"])
        self.expect(written(CLEAN), "KeyError: 'finding'")

    def test_warning_of_numpy(self, written, monkeypatch):
        monkeypatch.setattr(urdf, "load", lambda path: np.ones(1) / np.zeros(1))
        self.expect(written(CLEAN), "RuntimeWarning: divide by zero")

    def test_output(self, written, monkeypatch):
        monkeypatch.setattr(urdf, "inspect", lambda path: os.write(2, b"from C\n"))
        self.expect(written(CLEAN), "the inspection writes ['from C']")

    def test_load_refuses_what_inspect_accepts(self, written, monkeypatch):
        report = urdf.inspect(written(CLEAN))
        monkeypatch.setattr(urdf, "inspect", lambda path: report)
        self.expect(written(changed('value="2.5"', 'value="-2.5"')), "load refuses")

    def test_load_accepts_what_inspect_refuses(self, written, monkeypatch):
        model = urdf.load(written(CLEAN))
        monkeypatch.setattr(urdf, "load", lambda path: model)
        self.expect(written(changed('value="2.5"', 'value="x"')), "load accepts what inspect refuses")

    def test_warning_without_finding(self, written, monkeypatch):
        monkeypatch.setattr(inspecting, "link_findings", lambda structure: iter(()))
        self.expect(written(changed("<inertial>", "<mass>", "</inertial>", "</mass>")), "load warns of")

    def test_other_number(self, written, monkeypatch):
        model = urdf.load(written(changed('xyz="0 0 0.4"', 'xyz="0 0 0.400000001"')))
        monkeypatch.setattr(urdf, "load", lambda path: model)
        self.expect(written(CLEAN), "without a finding: {'inverse_dynamics'")

    def test_other_number_beside_a_finding_that_explains_another(self, written, monkeypatch):
        model = urdf.load(written(changed('xyz="0 0 0.4"', 'xyz="0 0 0.400000001"')))
        monkeypatch.setattr(urdf, "load", lambda path: model)
        path = written(changed('value="2.5"', 'value="2.5 "'))
        self.expect(path, "not explained by ('number-spacing',): {'inverse_dynamics'")

    def test_other_number_beside_lost_digits(self, written, monkeypatch):
        far = ('xyz="0.1 0.2 0.3"', 'xyz="1e8 0.2 0.3"')
        assert trial(written(changed(*far))).outcome != "unexpected"
        model = urdf.load(written(changed(*far, 'xyz="0 0 0.4"', 'xyz="0 0 0.400000001"')))
        monkeypatch.setattr(urdf, "load", lambda path: model)
        self.expect(written(changed(*far)), "without a finding: {")

    def test_refusal_of_pinocchio(self, written, monkeypatch):
        monkeypatch.setattr(inspecting, "reader_findings", lambda document: iter(()))
        self.expect(written(changed('lower="-1"', 'lower="-1 "')), "without a finding: Pinocchio cannot read")

    def test_false_claim(self, written, monkeypatch):
        path = written(changed('value="2.5"', 'value="-2.5"'))
        report = urdf.inspect(path)
        finding = report.findings[0]
        claims = type(finding)(finding.code, "error", finding.element, finding.line, CLAIMS[0], "")
        monkeypatch.setattr(urdf, "inspect", lambda path: type(report)("", "", (claims,)))
        self.expect(path, "Pinocchio loads the file, though")


class TestExplained:
    """Where two readers differ and a finding says why, the mended file shows that nothing else differs."""

    def test_position_limits_of_version_1_2(self, written):
        versioned = ('name="arm"', 'name="arm" version="1.2"')
        for limits in ('upper="2" ', 'lower="-1" upper="2" '):
            path = written(changed(*versioned, limits, ""))
            assert trial(path) == Trial("explained", ("limits-missing",))
        path = written(changed(*versioned, LIMIT, ""))
        assert trial(path) == Trial("explained", ("limits-missing",))

    @pytest.mark.parametrize("between", ["", "\n"])
    def test_a_part_with_two_faults_twice(self, written, between):
        part = '<safety_controller soft_lower_limit="1 2" k_velocity="x"/>'
        path = written(changed(LIMIT, LIMIT + part + between + part))
        assert trial(path) == Trial("explained", ("incomplete-joint-part",))

    def test_names_with_line_breaks(self, written):
        path = written(changed('name="elbow"', 'name="el\nbow"'))
        assert trial(path) == Trial("explained", ("name-spacing",))

    @pytest.mark.parametrize(
        ("name", "old", "new", "code"),
        [
            ("kr500", '"0.5225 0.0 0.0"', '"522499999999.99994 0.0 0.0"', "far-center-of-mass"),
            ("rich", '"0.3 0 0" rpy="1.57', '"300000000000.0 0 0" rpy="1.57', "suspicious-lengths"),
        ],
    )
    def test_digits_lost_in_computing(self, written, name, old, new, code):
        """Long levers that cancel: Pinocchio's two routes differ by 2e-5 too, though their models are the same."""
        text = robot(name).decode()
        assert old in text
        assert trial(written(text.replace(old, new, 1))) == Trial("explained", (code,))


def test_a_process_that_ends_is_unexpected_and_the_rest_goes_on(monkeypatch):
    monkeypatch.setattr(processes, "_work", ends_at_two)
    results = run(["urdf"], 0, range(4), 1)
    assert [result.number for result in results] == [0, 1, 2, 3]
    assert unexpected(results) == [
        f"urdf 2 ({', '.join(mutant('urdf', 0, 2).kinds)}): its process ended, or it took longer than 120 s"
    ]
