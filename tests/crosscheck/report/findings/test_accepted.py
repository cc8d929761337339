"""Baselines and waivers: which findings count."""

from dataclasses import replace
from datetime import date

import pytest

from crosscheck.report.findings.checks import CommandFinding, RobotCheck, fingerprints
from crosscheck.report.findings.counted import count
from crosscheck.report.findings.waivers import read_waivers
from graphdyn import InvalidInput

HEAVY = CommandFinding("heavy-link", "warning", "arm", "link 'base'", "robots/arm.urdf", 3, "41 kg", fails=True)
LIGHT = replace(HEAVY, code="tiny-mass", element="link 'tip'")
MISSING = replace(HEAVY, code="no-such-file", element="", bad_input=True)
TODAY = date(2026, 6, 30)
WAIVER = '[[waiver]]\ncode = "heavy-link"\nreason = "cast iron"\n'


@pytest.fixture
def waivers(tmp_path):
    """waivers(text): those for inspect."""

    def read(text, command="inspect"):
        path = tmp_path / "waivers.toml"
        path.write_text(text, encoding="utf-8")
        return read_waivers(path, command)

    return read


def known(*findings):
    return dict.fromkeys(fingerprints(findings), "robots/arm.urdf")


def counted(findings, baseline=None, waivers=()):
    return count([RobotCheck("arm", "check", tuple(findings))], baseline or {}, waivers, TODAY)


def test_only_what_is_not_in_the_baseline_counts():
    found = counted([HEAVY, LIGHT, replace(HEAVY, line=9)], known(HEAVY))
    assert (found.new, found.known, found.gone) == ((1, 2), (0,), 0)
    assert found.failing == [LIGHT, replace(HEAVY, line=9)]
    assert found.forgiven == {0: "in the baseline"}


def test_what_is_gone_is_counted():
    before = known(HEAVY, LIGHT, replace(HEAVY, line=9))
    assert counted([HEAVY], before).gone == 2
    assert counted([HEAVY], dict.fromkeys(before, "robots/another.urdf")).gone == 0  # nobody has looked at it


def test_warnings_that_do_not_fail_are_new_without_failing():
    found = counted([replace(HEAVY, fails=False)])
    assert (found.new, found.failing) == ((0,), [])


def test_files_that_are_not_there_are_never_accepted(waivers):
    text = WAIVER.replace("heavy-link", "no-such-file")
    assert counted([MISSING], known(MISSING), waivers(text)).failing == [MISSING]


@pytest.mark.parametrize(
    ("more", "covered"),
    [
        ("", True), ("element = \"link 'base'\"", True), ("element = \"link 'base\"", False),
        ('file = "robots/arm.urdf"', True), ('file = "robots/*.urdf"', True), ('file = "*.xacro"', False),
        ("until = 2026-06-30", True), ("until = 2026-06-29", False),
    ],
)  # fmt: skip
def test_what_a_waiver_covers(waivers, more, covered):
    found = counted([HEAVY, LIGHT], waivers=waivers(WAIVER + more))
    assert found.failing == ([LIGHT] if covered else [HEAVY, LIGHT])
    assert found.forgiven == ({0: "waived: cast iron"} if covered else {})


def test_unused_and_expired_waivers(waivers):
    other = WAIVER.replace("heavy-link", "crlf")
    text = WAIVER + other + WAIVER + "until = 2020-01-01\n" + other + 'file = "another.urdf"'
    found = counted([HEAVY], waivers=waivers(text))
    assert [waiver.text for waiver in found.unused] == ["waiver 2 (crlf)"]
    assert [waiver.text for waiver in found.expired] == ["waiver 3 (heavy-link)"]


def test_a_waiver_is_for_one_command(waivers):
    text = WAIVER + WAIVER.replace("heavy-link", "disagreement") + 'command = "crosscheck"'
    assert [waiver.code for waiver in waivers(text)] == ["heavy-link"]
    assert [(waiver.number, waiver.code) for waiver in waivers(text, "crosscheck")] == [(2, "disagreement")]


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (WAIVER + '[[waiver]]\ncode = "x"', "waiver 2: 'reason' is missing; write why the finding is accepted"),
        ('[[waiver]]\nreason = "x"', "waiver 1: 'code' is missing; write the code of the finding"),
        (WAIVER.replace("cast iron", " "), "waiver 1: 'reason' is no text, or empty; write reason = "),
        (WAIVER + "element = 3", "waiver 1: 'element' is no text, or empty; write element = "),
        (WAIVER + 'until = "2027-01-01"', "waiver 1: 'until' is no date; write the last day without quotes, such as"),
        (WAIVER + "until = 2027-01-01T00:00:00", "waiver 1: 'until' is no date"),
        (WAIVER + "line = 3", "waiver 1: knows no 'line'; give code, element, file, command, reason, until"),
        ('[waiver]\ncode = "x"', "'waiver' is no list of tables; write each waiver below a line \\[\\[waiver\\]\\]"),
        ('[[waivers]]\ncode = "x"', "knows no 'waivers'; write each waiver below a line"),
        ("[[waiver", "is no TOML: "),
    ],
)
def test_a_bad_file_is_told_with_its_entry(waivers, text, message):
    with pytest.raises(InvalidInput, match=f"waivers.toml: {message}"):
        waivers(text)
