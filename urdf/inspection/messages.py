"""Findings in words, with what Pinocchio 4.1 and yourdfpy 0.0.60 do in the same case, silently unless they refuse."""

from __future__ import annotations

from lxml import etree

from urdf.document.elements import describe, line_of
from urdf.errors import URDFError, one_line
from urdf.inspection.findings import Finding, Severity

_BOTH_LOAD = "Pinocchio and yourdfpy load it as it stands"
_BOTH_REFUSE = "Pinocchio and yourdfpy refuse the file"
_UNREADABLE = "Pinocchio gives a link with such a number mass 0 or a tensor of zero and refuses such a joint"
_PINOCCHIO_REFUSES = "Pinocchio refuses the file, yourdfpy loads it"

OTHER_READERS = {
    "axis-not-normalized": "Pinocchio normalizes it, yourdfpy does not",
    "continuous-joint": "In Pinocchio such a joint has two coordinates (cosine, sine), so that nq is not nv",
    "cycle": "Pinocchio leaves these links out, yourdfpy loads them",
    "default-namespace": "Pinocchio ignores it, yourdfpy finds no link at all",
    "duplicate-element": "Pinocchio and yourdfpy take the first",
    "duplicate-material": _PINOCCHIO_REFUSES,
    "duplicate-name": _PINOCCHIO_REFUSES,
    "effort-negative": _PINOCCHIO_REFUSES,
    "empty-file": _BOTH_REFUSE,
    "friction-negative": _PINOCCHIO_REFUSES,
    "fused-mass": "Pinocchio does the same",
    "inconsistent-body": _BOTH_LOAD,
    "incomplete-joint-part": "Pinocchio refuses the file",
    "indefinite-inertia": _BOTH_LOAD,
    "invalid-loop": "Pinocchio and yourdfpy load the tree without it",
    "joint-dynamics": "Pinocchio reads them too and leaves them out of rnea",
    "joint-order": "Pinocchio sorts siblings by name: compare joints by name",
    "limits-crossed": _BOTH_LOAD,
    "limits-missing": "Pinocchio refuses a revolute or prismatic joint without <limit>, and a <limit> without effort "
    'or velocity, and takes a missing lower or upper as 0 (in a file with version="1.2" it refuses that too)',
    "mimic-joint": "Pinocchio and yourdfpy load it as an independent joint unless asked otherwise",
    "missing-inertia": "Pinocchio gives the link a tensor of zero, yourdfpy takes 1 for ixx, iyy, izz and 0 for the "
    "others",
    "missing-inertial": "Pinocchio gives the link mass 0, yourdfpy none",
    "missing-link": _PINOCCHIO_REFUSES,
    "missing-mass": "Pinocchio gives the link mass 0, yourdfpy mass 0 or none",
    "missing-name": "Pinocchio and yourdfpy refuse a missing name, and load an empty one of a joint or robot",
    "missing-parent": _BOTH_REFUSE,
    "missing-type": _PINOCCHIO_REFUSES,
    "negative-mass": "Pinocchio loads it and loses the center of mass, yourdfpy loads it as it stands",
    "no-links": _PINOCCHIO_REFUSES,
    "not-finite": f"{_UNREADABLE}, yourdfpy keeps the value",
    "malformed-number": f"{_UNREADABLE}, yourdfpy refuses the file",
    "number-too-large": _BOTH_LOAD,
    "processing-instruction": _PINOCCHIO_REFUSES,
    "reserved-name": "Pinocchio loads the file and confuses the two, yourdfpy loads it",
    "root-inertia": "Pinocchio keeps it apart, as inertia of the universe",
    "several-roots": _PINOCCHIO_REFUSES,
    "singular-inertia": _BOTH_LOAD,
    "text-before-xml": "Pinocchio loads the file, yourdfpy refuses it",
    "triangle-inequality": _BOTH_LOAD,
    "two-parents": _BOTH_LOAD,
    "unexpanded-number": f"{_UNREADABLE}, yourdfpy refuses the file",
    "quaternion-origin": "Pinocchio reads it in files of version 1.1 and later, yourdfpy does not",
    "unknown-attribute": "Pinocchio and yourdfpy do not read it either",
    "unknown-element": "Pinocchio and yourdfpy do not read it either",
    "unread-dynamics": "Pinocchio and yourdfpy do not read it either",
    "unsupported-constraint": "Pinocchio and yourdfpy load the tree without it",
    "unsupported-joint": "Pinocchio knows floating and planar joints, yourdfpy loads any type",
    "urdf-version": _PINOCCHIO_REFUSES,
    "velocity-negative": _PINOCCHIO_REFUSES,
    "wrong-number-of-entries": f"{_UNREADABLE}, yourdfpy refuses all but such an axis",
    "xml-entities": "Pinocchio leaves entities out of numbers: a mass becomes 0",
    "xml-version": "Pinocchio and yourdfpy load it nevertheless",
    "zero-axis": _BOTH_LOAD,
    "zero-inertia": _BOTH_LOAD,
    "zero-mass": _BOTH_LOAD,
}
"""Behavior of other readers by code of a finding: what Pinocchio and yourdfpy do. Codes that make no difference to them
are not listed."""


def about(code: str, severity: Severity, element: etree._Element, problem: str, remedy: str) -> Finding:
    """A finding about an element."""
    return Finding(code, severity, describe(element), line_of(element), told(code, problem), remedy)


def of_file(code: str, severity: Severity, line: int | None, problem: str, remedy: str) -> Finding:
    """A finding about the file as a whole; line: the first place."""
    return Finding(code, severity, None, line, told(code, problem), remedy)


def refusal(error: URDFError) -> Finding:
    """What urdf.load raises, as a finding."""
    return Finding(error.code, "error", error.element, error.line, told(error.code, error.problem), error.remedy)


def told(code: str, problem: str) -> str:
    """The problem on one line, and what Pinocchio and yourdfpy do."""
    problem = one_line(problem)
    return f"{problem}. {OTHER_READERS[code]}" if code in OTHER_READERS else problem
