"""What an inspection finds, in words, with what Pinocchio 4.1 and yourdfpy 0.0.60 do there; the report of all of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

from lxml import etree

from urdf.document.elements import describe, file_of, line_of
from urdf.errors import URDFError, one_line

Severity = Literal["error", "warning", "note"]
SEVERITIES: tuple[Severity, ...] = ("error", "warning", "note")
"""Severities in this order: urdf.load refuses the file; it loads, but its dynamics are doubtful; good to know."""

Verdict = Literal["dynamics", "kinematics only", "refused"]

NO_FORWARD_DYNAMICS = ("mass-matrix-singular", "mass-matrix-indefinite", "loop-cannot-close", "infinitesimal-mobility")
"""Codes of the findings that leave a robot fit for kinematics only."""


@dataclass(frozen=True)
class Finding:
    """One fault or oddity.

    code: stable name of its kind ("negative-mass")
    severity: error: urdf.load refuses the file; warning: it loads, its dynamics are doubtful; note: good to know
    element: "link 'wrist'", "<mass> of link 'wrist'"; None for the file as a whole
    line: in the file, from 1; None where it is not known
    file: where the line is, if not in the inspected file: one that it includes, or one beside it
    message: what is there, and what Pinocchio and yourdfpy do with it; remedy: what to do about it
    """

    code: str
    severity: Severity
    element: str | None
    line: int | None
    message: str
    remedy: str
    file: str | None = None

    @property
    def text(self) -> str:
        """Element and message in one sentence."""
        return self.message if self.element is None else f"{self.element}: {self.message}"


@dataclass(frozen=True)
class Inspection:
    """All findings of one file.

    robot: path or name as given; path: of the file, None where there is none
    findings: errors, warnings, notes, each in the order of the file
    """

    robot: str
    path: str | None
    findings: tuple[Finding, ...]

    @property
    def verdict(self) -> Verdict:
        """ "refused": urdf.load raises; "kinematics only": torques do not determine accelerations; else "dynamics"."""
        if self.count("error"):
            return "refused"
        return "kinematics only" if self.reasons else "dynamics"

    @property
    def reasons(self) -> tuple[str, ...]:
        """Why the verdict is not "dynamics"; empty where it is."""
        errors = [finding.text for finding in self.findings if finding.severity == "error"]
        return tuple(errors) or tuple(finding.text for finding in self.findings if finding.code in NO_FORWARD_DYNAMICS)

    @property
    def usable(self) -> bool:
        """Fit for dynamics."""
        return self.verdict == "dynamics"

    @property
    def codes(self) -> tuple[str, ...]:
        """Each code once, in the order of the findings."""
        return tuple(dict.fromkeys(finding.code for finding in self.findings))

    def count(self, severity: Severity) -> int:
        """Number of findings of this severity."""
        return sum(finding.severity == severity for finding in self.findings)


def report(robot: str, path: str | None, findings: list[Finding]) -> Inspection:
    """The report of these findings: by severity, then by line, those of the whole file first."""
    here = [replace(finding, file=None) if finding.file in (path, robot) else finding for finding in findings]
    in_order = sorted(here, key=lambda each: (SEVERITIES.index(each.severity), each.file or "", each.line or 0))
    return Inspection(robot, path, tuple(in_order))


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
"""What Pinocchio and yourdfpy do by code of a finding, silently unless they refuse; codes that make no difference to
them are not listed."""


NOTHING = "no action needed"
"""Begins the remedy of what is fine as it is."""

REMEDIES: Mapping[Severity, Mapping[str, str]] = {
    "error": {
        "unreadable-file": "check its path and permissions",
    },
    "warning": {
        "axis-not-normalized": "write a unit vector",
        "center-outside-mesh": "give it in the link frame, in meters; or correct the placement or the scale "
        "of the mesh",
        "duplicate-material": "keep one of them",
        "effort-below-gravity": "give masses in kg, and the effort in N m or N at the joint, behind the gear",
        "effort-below-inertia": "give masses in kg, and the effort in N m or N at the joint, behind the gear",
        "effort-negative": "write the limit",
        "far-center-of-mass": "give it in meters, in the link frame; it may be in millimeters",
        "friction-negative": "write the friction",
        "heavy-link": "compare its mass with the data sheet, and with a link of another robot of this family",
        "gyration-radius": "give kg, m and kg m²; the tensor may be in kg mm² or g mm², or about another point",
        "idle-degrees-of-freedom": "lock one joint of each (lock=, --lock), or state more motors",
        "incomplete-joint-part": "correct it",
        "inconsistent-body": "correct mass, center of mass and tensor",
        "indefinite-inertia": "correct the tensor; a sign may be wrong, or entries swapped",
        "independent-contradiction": "mark as independent as many joints as there are degrees of freedom, "
        "so that they determine all others",
        "infinitesimal-mobility": "correct the lengths, or lock these joints (lock=, --lock)",
        "inertia-unlike-mesh": "compare them link by link: urdf.inspect(…, meshes='detail'), "
        "graphdyn inspect --meshes detail",
        "limits-missing": "write it",
        "loop-cannot-close": "correct the loop, or the links on its way",
        "mass-matrix-ill-conditioned": "look for inertials that are far too small or too large",
        "mass-matrix-indefinite": "correct the inertials that no real body can have",
        "mass-matrix-singular": "give all moving links mass and inertia",
        "mesh-density": "give the mass in kg and the mesh in meters, with its scale; "
        "a part of the link may not be drawn",
        "missing-inertial": "write an <inertial>",
        "name-spacing": "write blanks, or none",
        "number-spacing": "separate numbers by blanks, and put none after a single number",
        "other-encoding": "save it in UTF-8",
        "placeholder-inertials": "give the real ones: the numbers computed from these mean nothing",
        "processing-instruction": "remove them",
        "reserved-name": "rename it",
        "singular-inertia": "give all moments",
        "suspicious-lengths": "give lengths in meters; they may be in millimeters",
        "suspicious-masses": "give masses in kg; they may be in grams or tonnes",
        "tiny-mass": "give the mass in kg; it looks like a placeholder",
        "triangle-inequality": "correct the tensor: it must be about the center of mass, in kg m²",
        "unbound-joints": "state the loops, couplings or mimic joints that they would follow from: in the file, in the "
        "YAML file of its name beside it, or as loops= (--loops)",
        "unexpanded-text": "expand the file with xacro",
        "unread-dynamics": "change the model after loading it, if that matters",
        "unknown-attribute": "correct its name, or remove it",
        "unknown-element": "correct its name, or remove it",
        "urdf-version": "remove it",
        "velocity-negative": "write the limit",
        "xacro-complaint": "expand the file with xacro and check the result",
        "xacro-tags": "expand the file with xacro: what they stand for is missing",
        "zero-inertia": "give the tensor",
        "zero-mass": "give the mass",
    },
    "note": {
        "axis-missing": "write <axis>",
        "axis-not-normalized": "write it with more digits",
        "byte-order-mark": NOTHING,
        "continuous-joint": "compare angles modulo 2π",
        "crlf": NOTHING,
        "default-namespace": "remove xmlns=… from <robot>",
        "effort-below-gravity": NOTHING,
        "effort-zero": "write the limit",
        "equal-inertials": "give each link its own, if forces matter",
        "extra-namespaces": "remove them",
        "fused-mass": "no action needed; urdf.fused_links gives the shares",
        "heaviest-link": "compare its mass with the data sheet",
        "heavy-link": NOTHING,
        "inertia-of-mesh": "correct the inertial where the factor is large, or load with "
        "repair=[urdf.InertialsFromMeshes(…)] (--repair inertials-from-meshes=…)",
        "inertial-origin-missing": "write <origin>, if that is not meant",
        "inertial-rotated": NOTHING,
        "isotropic-inertia": "give the measured tensor, if forces matter",
        "joint-dynamics": "add it to the torques, if it matters",
        "joint-order": "identify joints by their names, not by the order of the file",
        "joint-origin-missing": "write <origin>, if that is not meant",
        "limits-zero": "write the range",
        "loop-rows": "no action needed; graphdyn.assemble closes states",
        "loops-not-examined": NOTHING,
        "mass-matrix": NOTHING,
        "mass-matrix-not-examined": NOTHING,
        "massless-closing-link": "no action needed, if other bodies of the loop have mass",
        "mesh-files": NOTHING,
        "mimic-joint": "no action needed; mimic='independent' (--mimic independent) makes it a joint of its own, "
        "mimic='locked' (--mimic locked) holds it still",
        "more-findings": "correct these first",
        "negative-axis": NOTHING,
        "non-ascii": "make sure that other tools read it",
        "oblique-axis": NOTHING,
        "off-diagonal-inertia": NOTHING,
        "prismatic-joint": NOTHING,
        "root-inertia": NOTHING,
        "rotor-inertia": "add it to the mass matrix, if you know it",
        "rpy-truncated": "write all digits: 1.5707963267948966",
        "shared-name": "give one of them another name",
        "slash-in-name": "some tools take it for a namespace or a folder",
        "triangle-inequality": "write more digits",
        "unlike-twin": "give both the same, if they are mirror images",
        "unknown-joint-dynamics": "correct their names, or give damping and friction",
        "velocity-zero": "write the limit",
        "xacro-expanded": NOTHING,
        "xacro-tags": "remove them",
        "zero-mass": "no action needed: the body has mass from other links",
    },
}
"""Remedy of a finding by severity and code, of all that urdf.load does not refuse."""


def found(
    code: str,
    problem: str,
    element: str | None,
    line: int | None,
    file: str | None,
    severity: Severity | None = None,
) -> Finding:
    """A finding of REMEDIES. severity: for codes that have several; by default the highest of the code."""
    possible = [one for one in SEVERITIES if code in REMEDIES[one]]
    severity = severity or possible[0]
    return Finding(code, severity, element, line, told(code, problem), REMEDIES[severity][code], file)


def about(code: str, element: etree._Element, problem: str, severity: Severity | None = None) -> Finding:
    """A finding about an element."""
    return found(code, problem, describe(element), line_of(element), file_of(element), severity)


def of_file(
    code: str,
    problem: str,
    line: int | None = None,
    severity: Severity | None = None,
    at: etree._Element | None = None,
) -> Finding:
    """A finding about the file as a whole; line, or at: the first place."""
    if at is None:
        return found(code, problem, None, line, None, severity)
    return found(code, problem, None, line_of(at), file_of(at), severity)


def refusal(error: URDFError) -> Finding:
    """What urdf.load raises, as a finding."""
    file = None if error.path is None else str(error.path)
    return Finding(error.code, "error", error.element, error.line, told(error.code, error.problem), error.remedy, file)


def told(code: str, problem: str) -> str:
    """The problem on one line, and what Pinocchio and yourdfpy do."""
    problem = one_line(problem)
    return f"{problem}. {OTHER_READERS[code]}" if code in OTHER_READERS else problem
