"""--sarif, --junit, --baseline and --waivers: files, exit codes and headlines of the commands that take them."""

import json
import xml.etree.ElementTree as tree
from dataclasses import replace

import numpy as np
import pytest
from inspected.planted_lines import planted_faults, reported
from inspected.sample import CLEAN, INERTIA, MASS, changed
from shown.sarif_rules import results_of

import crosscheck
from crosscheck.commands.crosscheck.checks import crosscheck_checks
from crosscheck.commands.crosscheck.record import robot_record
from crosscheck.commands.judge.checks import judge_checks
from crosscheck.commands.program.functions import place_of
from crosscheck.report.records.record import plain

NEGATIVE = changed(MASS, '<mass value="-2.5"/>')
DOUBTFUL = changed(INERTIA, INERTIA.replace("0.11", "0.9"))
SHARE = 13
"""Every so many planted faults are told in every change; tests/tools/files/reported_lines.py has all of them."""


@pytest.fixture
def here(tmp_path, monkeypatch):
    """A folder with a robot of each kind, in which commands run."""
    monkeypatch.chdir(tmp_path)
    for name, text in (("clean", CLEAN), ("negative", NEGATIVE), ("doubtful", DOUBTFUL)):
        (tmp_path / f"{name}.urdf").write_text(text, encoding="utf-8")
    return tmp_path


def findings(path):
    return {
        (result["ruleId"], place["artifactLocation"]["uri"], place["region"]["startLine"], result["level"])
        for result in results_of(json.loads(path.read_text(encoding="utf-8")))
        for place in [result["locations"][0]["physicalLocation"]]
    }


@pytest.mark.parametrize("fault", list(planted_faults())[::SHARE], ids=lambda fault: fault.name)
def test_a_fault_is_told_where_it_stands(fault, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert reported(fault, tmp_path) == {(fault.file, fault.line)}


class TestInspect:
    def test_files(self, program, here):
        done = program("inspect", here, "--sarif", "r.sarif", "--junit", "r.xml")
        assert done.code == 1
        assert findings(here / "r.sarif") == {
            ("negative-mass", "negative.urdf", 6, "error"), ("triangle-inequality", "doubtful.urdf", 7, "warning"),
            ("inconsistent-body", "doubtful.urdf", 3, "warning"),
        }  # fmt: skip
        root = tree.parse(here / "r.xml").getroot()
        failed = [case for case in root.iter("testcase") if case.find("failure") is not None]
        assert [(case.get("name"), case.get("file"), case.get("line")) for case in failed] == [
            ("negative-mass", "negative.urdf", "6")
        ]
        assert program("inspect", "clean.urdf", "--junit", "r.xml").code == 0  # replaces its own file

    def test_what_fails(self, program, here):
        assert program("inspect", "doubtful.urdf").code == 0
        assert program("inspect", "doubtful.urdf", "--fail-on", "warning").code == 1

    def test_kinematics_only_is_an_error(self, program, here):
        (here / "massless.urdf").write_text(changed(MASS, '<mass value="0"/>', INERTIA, INERTIA.replace("0.1", "0.0")))
        program("inspect", "massless.urdf", "--sarif", "r.sarif")
        assert {code for code, *_, level in findings(here / "r.sarif") if level == "error"} <= {"mass-matrix-singular"}

    def test_a_baseline(self, program, here):
        program("inspect", "negative.urdf", "--sarif", "known.sarif")
        moved = NEGATIVE.replace("<link", "\n\n<link", 1).replace("-2.5", "-7")
        (here / "negative.urdf").write_text(moved, encoding="utf-8")
        done = program("inspect", "negative.urdf", "--baseline", "known.sarif", "--sarif", "now.sarif")
        assert done.code == 0
        assert done.out.startswith("negative.urdf: nothing new\nAccepted: 1 in the baseline. Without that: refused.\n")
        (result,) = results_of(json.loads((here / "now.sarif").read_text(encoding="utf-8")))
        assert result["baselineState"] == "unchanged"

    def test_a_new_finding(self, program, here):
        program("inspect", "clean.urdf", "--sarif", "known.sarif")
        (here / "clean.urdf").write_text(NEGATIVE, encoding="utf-8")
        done = program("inspect", "clean.urdf", "--baseline", "known.sarif")
        assert done.code == 1
        assert done.out.startswith("clean.urdf: 1 new finding\nclean.urdf:6: <mass> of link 'upper': mass -2.5 kg is")
        assert "→ give a mass of at least 0. Nothing that was accepted was found." in done.out.replace("\n", " ")

    def test_waivers(self, program, here):
        waiver = '[[waiver]]\ncode = "{}"\nreason = "{}"\n'
        texts = (waiver.format("negative-mass", "buoyant"), waiver.format("crlf", "x"))
        (here / "w.toml").write_text("".join(texts), encoding="utf-8")
        done = program("inspect", "negative.urdf", "--waivers", "w.toml", "--sarif", "r.sarif", "--junit", "r.xml")
        assert done.code == 0
        assert done.out.startswith(
            "negative.urdf: every finding is waived\nAccepted: 1 waived. Without that: refused.\n"
        )
        assert "<mass> of link 'upper': buoyant [negative-mass]\n" in done.out
        assert "waiver 2 (crlf) covers no finding here; remove it if" in done.out
        assert findings(here / "r.sarif") == set()
        skipped = next(tree.parse(here / "r.xml").getroot().iter("skipped"))
        assert skipped.get("message").startswith("waived: buoyant: negative.urdf:6: error: ")

    def test_an_expired_waiver(self, program, here):
        text = '[[waiver]]\ncode = "negative-mass"\nreason = "x"\nuntil = 2001-02-03\n'
        (here / "w.toml").write_text(text, encoding="utf-8")
        done = program("inspect", "negative.urdf", "--waivers", "w.toml")
        assert done.code == 1
        assert done.out.startswith("negative.urdf: 1 finding without waiver\n")
        assert "waiver 1 (negative-mass) ended on 2001-02-03: its findings count again" in done.out

    def test_waivers_of_a_good_file(self, program, here):
        (here / "w.toml").write_text('[[waiver]]\ncode = "crlf"\nreason = "x"\n', encoding="utf-8")
        done = program("inspect", "clean.urdf", "--waivers", "w.toml")
        assert done.code == 0
        assert done.out.startswith("clean.urdf: good for dynamics\n")

    @pytest.mark.parametrize("option", ["--baseline", "--waivers"])
    def test_bad_files_end_it_before_the_work(self, program, here, option):
        (here / "bad").write_text("[[waiver]]\n", encoding="utf-8")
        done = program("inspect", "clean.urdf", option, "bad", "--sarif", "r.sarif")
        assert done.code == 2
        assert done.err.startswith("error: bad: ")
        assert not (here / "r.sarif").exists()
        assert program("inspect", "clean.urdf", option, "none").err == (
            "error: none: no such file or directory; check the name and the folder\n"
        )

    def test_a_file_that_is_not_there(self, program, here):
        done = program("inspect", "nonsense", "clean.urdf", "--sarif", "r.sarif")
        assert done.code == 2
        assert findings(here / "r.sarif") == {("no-such-file", "nonsense", 1, "error")}
        assert program("inspect", "nonsense", "clean.urdf", "--baseline", "r.sarif").code == 2


class TestCrosscheck:
    def test_a_refused_file(self, program, here):
        done = program("crosscheck", "negative.urdf", "--sarif", "r.sarif", "--junit", "r.xml")
        assert done.code == 2
        assert findings(here / "r.sarif") == {("negative-mass", "negative.urdf", 6, "error")}
        again = program("crosscheck", "negative.urdf", "--baseline", "r.sarif")
        assert again.code == 0
        assert again.out.startswith("graphdyn against Pinocchio: nothing new\n")

    @pytest.mark.usefixtures("in_this_process", "random_states_alone")
    def test_a_folder(self, program, here):
        (here / "doubtful.urdf").unlink()
        done = program("crosscheck", here, "--samples", 1, "--jobs", 1, "--sarif", "r.sarif", "--junit", "r.xml")
        assert done.code == 2
        assert findings(here / "r.sarif") == {("negative-mass", "negative.urdf", 6, "error")}
        root = tree.parse(here / "r.xml").getroot()
        assert (root.get("failures"), len(root)) == ("1", 2)
        assert int(root.get("tests")) > 100

    def test_a_disagreement(self, wrong_comparison):
        checks = crosscheck_checks([plain(robot_record(wrong_comparison))], [])
        assert {check.name for check in checks} == set(wrong_comparison.quantities) | set(wrong_comparison.not_compared)
        wrong = {name for name, quantity in wrong_comparison.quantities.items() if not quantity.agrees}
        found = {finding.element: finding for check in checks for finding in check.findings}
        assert set(found) == wrong
        finding = found["mass_matrix"]
        assert finding.message.startswith("graphdyn and Pinocchio disagree: relative error ")
        assert (finding.code, finding.level, finding.fails, finding.bad_input) == ("disagreement", "error", True, False)

    def test_what_was_not_compared(self, wrong_comparison):
        record = plain(robot_record(replace(wrong_comparison, not_compared={"x": "no mass"})))
        assert crosscheck_checks([record], [])[-1].skipped == "not compared: no mass"

    def test_not_with_exact_values(self, program, words):
        refused = program("crosscheck", "ur5", "--exact", "1", "--sarif", "r.sarif")
        assert refused.code == 2
        assert "--sarif is not for --exact, which measures errors" in words(refused.err)


def opposite(q, v, a):
    return -q


class TestJudge:
    def test_a_function_is_told_where_it_is_defined(self, here):
        robot = here / "clean.urdf"
        judgment = crosscheck.judge(robot, samples=2, inverse_dynamics=opposite, gravity_torque=np.zeros_like)
        place = place_of(opposite)
        assert place == (__file__, opposite.__code__.co_firstlineno)
        wrong, other = judge_checks(judgment, {"inverse_dynamics": place})
        assert (wrong.name, other.name) == ("inverse_dynamics", "gravity_torque")
        assert {(finding.file, finding.line) for finding in wrong.findings} == {place}
        assert {(finding.file, finding.line) for finding in other.findings} == {(judgment.file, 1)}
        assert all(finding.fails and finding.level == "error" for finding in (*wrong.findings, *other.findings))
        assert {finding.code for finding in other.findings} == {
            diagnosis.kind.replace("_", "-") for diagnosis in judgment.diagnoses if "gravity" in diagnosis.function
        }

    def test_what_is_compiled_has_no_place(self):
        assert place_of(abs) is None

    @pytest.mark.usefixtures("in_this_process")
    def test_the_command(self, program, here):
        code = "import numpy as np\n\n\ndef g(q):\n    return np.zeros(2)\n"
        (here / "code.py").write_text(code, encoding="utf-8")
        done = program(
            "judge", "clean.urdf", "--function", "gravity_torque=code.py:g", "--samples", 2, "--sarif", "r.sarif"
        )
        assert done.code == 1
        assert {(file, line) for _, file, line, _ in findings(here / "r.sarif")} == {("code.py", 4)}
