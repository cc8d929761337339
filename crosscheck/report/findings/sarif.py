"""Findings as SARIF 2.1.0 (Static Analysis Results Interchange Format, OASIS 2020), with what code scanning needs.

Written by hand: the object model of the standard's authors (sarif-om) has had no release since 2020.
"""

from __future__ import annotations

import json
from collections.abc import Collection, Sequence
from importlib.metadata import version
from typing import Any

from crosscheck.report.findings.checks import CommandFinding, fingerprints, uri
from crosscheck.report.plain_text import bounded, printable
from graphdyn import InvalidInput

FINGERPRINT = "graphdyn/v1"
"""Name of our fingerprints in a SARIF file."""

SCHEMA = "https://json.schemastore.org/sarif-2.1.0.json"
HOME = "https://github.com/graphdyn/graphdyn"
HELP = {
    "inspect": f"{HOME}/blob/main/docs/loading.md#codes",
    "judge": f"{HOME}/blob/main/docs/judge.md#the-diagnoses",
    "crosscheck": f"{HOME}/blob/main/docs/agreement.md",
}
"""Pages that explain the codes of a command."""


def sarif(command: str, findings: Sequence[CommandFinding], known: Collection[str] | None = None) -> bytes:
    """The content of a SARIF file.

    command: name of the command, under which code scanning keeps its findings apart from those of others
    known: fingerprints of a baseline; None where there is none
    """
    rules = list(dict.fromkeys(finding.code for finding in findings))
    results = [
        _result(finding, fingerprint, rules.index(finding.code), known)
        for finding, fingerprint in zip(findings, fingerprints(findings), strict=True)
    ]
    driver = {
        "name": "graphdyn",
        "version": version("graphdyn"),
        "informationUri": HOME,
        "rules": [_rule(command, code, findings) for code in rules],
    }
    run = {
        "tool": {"driver": driver},
        "automationDetails": {"id": _category(command)},
        "columnKind": "unicodeCodePoints",
        "results": results,
    }
    document = {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}
    return (json.dumps(document, indent=2, ensure_ascii=False) + "\n").encode()


def _rule(command: str, code: str, findings: Sequence[CommandFinding]) -> dict[str, Any]:
    """code: of some of the findings; the first of them has level and help of all"""
    first = next(finding for finding in findings if finding.code == code)
    words = code.replace("-", " ")
    return {
        "id": code,
        "shortDescription": {"text": f"{words[0].upper()}{words[1:]}"},
        "help": {"text": _said(first.remedy or first.message)},
        "helpUri": HELP.get(command, HOME),
        "defaultConfiguration": {"level": first.level},
    }


def _result(finding: CommandFinding, fingerprint: str, rule: int, known: Collection[str] | None) -> dict[str, Any]:
    location: dict[str, Any] = {
        "physicalLocation": {
            "artifactLocation": {"uri": uri(finding.file)},
            "region": {"startLine": max(finding.line, 1)},
        }
    }
    if finding.element:
        location["logicalLocations"] = [{"fullyQualifiedName": _said(finding.element)}]
    state = {} if known is None else {"baselineState": "unchanged" if fingerprint in known else "new"}
    return {
        "ruleId": finding.code,
        "ruleIndex": rule,
        "level": finding.level,
        "message": {"text": _said(finding.text)},
        "locations": [location],
        "partialFingerprints": {FINGERPRINT: fingerprint},
        **state,
    }


def _said(text: str) -> str:
    return printable(bounded(text))


def _category(command: str) -> str:
    """Under which code scanning keeps the findings of a command apart from others; the slash ends it."""
    return f"graphdyn-{command}/"


def baseline_in(content: bytes, name: str, command: str) -> dict[str, str]:
    """The fingerprints in a SARIF file that the command wrote earlier, and the file that each is about, as in it.

    name: of the file

    Raises InvalidInput, with the name, for any other file.
    """
    try:
        runs = [run for run in json.loads(content)["runs"] if run["automationDetails"]["id"] == _category(command)]
        found = {
            result["partialFingerprints"][FINGERPRINT]: _file_of(result) for run in runs for result in run["results"]
        }
    except (ValueError, LookupError, TypeError, RecursionError):
        runs, found = [], {}
    if not runs or not all(isinstance(text, str) for pair in found.items() for text in pair):
        raise InvalidInput(f"{name}: is no SARIF file of graphdyn {command}; write one with --sarif, and give that")
    return found


def _file_of(result: Any) -> str:
    file: str = result["locations"][0]["physicalLocation"]["artifactLocation"]["uri"]
    return file
