"""Checks as JUnit XML, which CI systems show as tests: a suite per robot, a test case per check.

What fails the command is a failure; waived findings and those of a baseline are skipped tests; the rest is output.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import groupby

from lxml import etree

from crosscheck.report.findings.checks import CommandFinding, RobotCheck, path_here
from crosscheck.report.plain_text import bounded, printable


def junit(command: str, checks: Sequence[RobotCheck], forgiven: Mapping[int, str]) -> bytes:
    """The content of a JUnit file.

    forgiven: why a finding does not count, by its number among those of all checks
    """
    root = etree.Element("testsuites", name=f"graphdyn {command}")
    first = 0
    for robot, group in groupby(checks, lambda check: check.robot):
        suite = etree.SubElement(root, "testsuite", name=_said(path_here(robot)))
        for check in group:
            reasons = [forgiven.get(first + k, "") for k in range(len(check.findings))]
            first += len(check.findings)
            _case(suite, command, check, reasons)
        _count(suite)
    _count(root)
    content: bytes = etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)
    return content


def _case(suite: etree._Element, command: str, check: RobotCheck, reasons: Sequence[str]) -> None:
    name = _said(path_here(check.robot))
    case = etree.SubElement(suite, "testcase", classname=f"{command}.{name}", name=_said(check.name))
    failing: list[CommandFinding] = []
    others: list[CommandFinding] = []
    forgiven: list[str] = []
    for finding, reason in zip(check.findings, reasons, strict=True):
        if reason:
            forgiven.append(f"{reason}: {_line(finding)}")
        else:
            (failing if finding.fails else others).append(finding)
    if failing:
        case.set("file", _said(path_here(failing[0].file)))
        case.set("line", str(failing[0].line))
        failure = etree.SubElement(case, "failure", message=_said(failing[0].text), type=failing[0].code)
        failure.text = "\n".join(map(_line, failing))
    elif skipped := check.skipped or "; ".join(forgiven):
        etree.SubElement(case, "skipped", message=_said(skipped))
    if others:
        etree.SubElement(case, "system-out").text = "\n".join(map(_line, others))


def _line(finding: CommandFinding) -> str:
    return _said(f"{finding.place}: {finding.level}: {finding.text} [{finding.code}]")


def _said(text: str) -> str:
    return printable(bounded(text))


def _count(element: etree._Element) -> None:
    """Numbers of the test cases within, as readers expect them."""
    for name, tag in (("tests", "testcase"), ("failures", "failure"), ("skipped", "skipped")):
        element.set(name, str(sum(1 for _ in element.iter(tag))))
    element.set("errors", "0")
