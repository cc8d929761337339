"""Findings as SARIF and JUnit: the rules of both, fingerprints, and names of others in them."""

import json
import xml.etree.ElementTree as tree
from dataclasses import replace

import pytest
from shown.sarif_rules import results_of

from crosscheck.report.findings.checks import CommandFinding, RobotCheck, fingerprints
from crosscheck.report.findings.junit import junit
from crosscheck.report.findings.sarif import baseline_in, sarif
from graphdyn import InvalidInput

FINDING = CommandFinding(
    "negative-mass", "error", "arm.urdf", "<mass> of link 'wrist'", "arm.urdf", 12, "mass -1 kg", "correct it", True
)
NOTE = CommandFinding("crlf", "note", "arm.urdf", "", "arm.urdf", 1, "lines end with CR LF")
HOSTILE = replace(
    FINDING, robot="a\x1b[31m.urdf", file="a b/ä#\x07\udcff.urdf", message="<&\u202e\x00\ud800", element="'\x1b'"
)


def log(*findings, known=None):
    return json.loads(sarif("inspect", findings, known))


class TestSarif:
    def test_rules(self):
        first, second, note = results_of(log(FINDING, replace(FINDING, line=30), NOTE))
        assert first["message"]["text"] == "<mass> of link 'wrist': mass -1 kg → correct it"
        assert first["locations"][0]["logicalLocations"] == [{"fullyQualifiedName": "<mass> of link 'wrist'"}]
        place = first["locations"][0]["physicalLocation"]
        assert (place["artifactLocation"]["uri"], place["region"]["startLine"]) == ("arm.urdf", 12)
        assert [each["ruleIndex"] for each in (first, second, note)] == [0, 0, 1]
        assert "logicalLocations" not in note["locations"][0]

    def test_nothing_found(self):
        assert results_of(log()) == []

    def test_characters_of_others(self):
        (result,) = results_of(log(HOSTILE))
        assert result["message"]["text"].isprintable()
        assert result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] == "a%20b/%C3%A4%23%07%FF.urdf"

    def test_places(self, tmp_path, monkeypatch):
        """Below the working folder relative to it, elsewhere with the whole path."""
        monkeypatch.chdir(tmp_path)
        files = ("robots/arm.urdf", tmp_path / "robots" / "arm.urdf", "robots/../arm.urdf", "../arm.urdf")
        results = results_of(log(*(replace(FINDING, file=str(file)) for file in files)))
        uris = [result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] for result in results]
        assert uris == ["robots/arm.urdf", "robots/arm.urdf", "arm.urdf", (tmp_path.parent / "arm.urdf").as_uri()]

    def test_a_baseline_marks_what_is_new(self):
        known = baseline_in(sarif("inspect", [FINDING]), "known.sarif", "inspect")
        moved, other = results_of(log(replace(FINDING, line=99, message="mass -2 kg"), NOTE, known=known))
        assert (moved["baselineState"], other["baselineState"]) == ("unchanged", "new")

    @pytest.mark.parametrize(
        "content",
        [b"", b"[]", b"{}", b'{"runs": 3}', b"[" * 10**5, sarif("crosscheck", [FINDING]),
         sarif("inspect", [FINDING]).replace(b"graphdyn/v1", b"other/v1")],
    )  # fmt: skip
    def test_what_is_no_baseline(self, content):
        with pytest.raises(InvalidInput, match=r"^x: is no SARIF file of graphdyn inspect; write one with --sarif"):
            baseline_in(content, "x", "inspect")


class TestFingerprints:
    def test_lines_and_numbers_do_not_count(self):
        assert fingerprints([FINDING]) == fingerprints([replace(FINDING, line=1, message="other", remedy="other")])

    @pytest.mark.parametrize("change", [{"code": "x"}, {"element": "x"}, {"file": "x"}])
    def test_code_element_and_file_do(self, change):
        assert fingerprints([FINDING]) != fingerprints([replace(FINDING, **change)])

    def test_equal_ones_are_numbered(self):
        first, other, second = fingerprints([FINDING, NOTE, replace(FINDING, line=40)])
        assert (first[:-1], first[-1], second[-1]) == (second[:-1], "1", "2")
        assert other.endswith(":1")

    def test_of_files_elsewhere_the_name_counts(self, tmp_path, monkeypatch):
        """The catalog lies in another folder on every machine."""
        monkeypatch.chdir(tmp_path)
        first, other = (fingerprints([replace(FINDING, file=f"/{place}/ur5.urdf")]) for place in "ab")
        assert first == other


class TestJunit:
    CHECKS = (
        RobotCheck("arm.urdf", "negative-mass", (FINDING, replace(FINDING, line=30))),
        RobotCheck("arm.urdf", "crlf", (NOTE,)),
        RobotCheck("hand.urdf", "mass_matrix", skipped="not compared: no mass"),
        RobotCheck("hand.urdf", "momentum"),
    )

    def test_read_back(self):
        root = tree.fromstring(junit("inspect", self.CHECKS, {}))
        assert [root.get(name) for name in ("tests", "failures", "skipped", "errors")] == ["4", "1", "1", "0"]
        arm, hand = root.findall("testsuite")
        assert (arm.get("name"), arm.get("tests"), hand.get("skipped")) == ("arm.urdf", "2", "1")
        failed, passed = arm.findall("testcase")
        assert (failed.get("classname"), failed.get("name")) == ("inspect.arm.urdf", "negative-mass")
        assert (failed.get("file"), failed.get("line")) == ("arm.urdf", "12")
        failure = failed.find("failure")
        assert (failure.get("message"), failure.get("type")) == (FINDING.text, "negative-mass")
        assert [line.partition(" ")[0] for line in failure.text.splitlines()] == ["arm.urdf:12:", "arm.urdf:30:"]
        assert passed.find("system-out").text == "arm.urdf:1: note: lines end with CR LF [crlf]"
        assert hand[0].find("skipped").get("message") == "not compared: no mass"
        assert not list(hand[1])

    def test_forgiven(self):
        """One of two is left; then none."""
        one, both = ({1: "in the baseline"}, {0: "waived: cast iron", 1: "in the baseline"})
        (left,) = tree.fromstring(junit("inspect", self.CHECKS[:1], one)).iter("failure")
        assert left.text.count("\n") == 0
        root = tree.fromstring(junit("inspect", self.CHECKS[:1], both))
        assert (root.get("failures"), root.get("skipped")) == ("0", "1")
        message = next(root.iter("skipped")).get("message")
        assert message.startswith("waived: cast iron: arm.urdf:12: error: <mass> of link 'wrist'")
        assert "in the baseline: arm.urdf:30: " in message

    def test_characters_of_others(self):
        root = tree.fromstring(junit("inspect", [RobotCheck(HOSTILE.robot, "x", (HOSTILE,))], {}))
        assert "\\u202e\\x00" in next(root.iter("failure")).get("message")
