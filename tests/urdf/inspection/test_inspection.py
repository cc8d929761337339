"""What urdf.inspect says: a tiny file for every code, and every message."""

import re
from pathlib import Path

import numpy as np
import pytest
from inspected.cases import CASES
from inspected.sample import (
    AXIS,
    CLEAN,
    FORE,
    FORE_INERTIAL,
    INERTIA,
    LIMIT,
    MASS,
    MESH_CODES,
    SHOULDER,
    TOOL,
    changed,
)
from mutants.material import RICH
from shared_data import REPOSITORY
from urdf_text import joint, link, robot_text

import urdf
from urdf import errors
from urdf.inspection import inspecting
from urdf.inspection.findings import SEVERITIES
from urdf.inspection.remedies import OTHER_READERS, REMEDIES

ALWAYS = ("rotor-inertia", "mass-matrix")
"""Codes of a file without a flaw."""


@pytest.fixture
def inspected(tmp_path):
    """The report of a file with this content."""

    def run(content):
        path = tmp_path / "arm.urdf"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return urdf.inspect(path)

    return run


def of_code(report, code):
    return [finding for finding in report.findings if finding.code == code]


@pytest.mark.parametrize("code", CASES)
def test_finding(inspected, code):
    case = CASES[code]
    report = inspected(changed(*case.changes))
    finding = of_code(report, code)[0]
    assert (finding.severity, finding.element, finding.line) == (case.severity, case.element, case.line)
    assert (finding.message, finding.remedy) == (case.message, case.remedy)
    if case.severity == "error":
        assert report.verdict == "refused"
        assert finding.text in report.reasons
        with pytest.raises(urdf.URDFError):
            urdf.load(report.path)


DOCUMENTS = {
    "empty-file": (b" \n", "the file is empty"),
    "text-before-xml": (b'Expanded.\n<robot name="r"/>', "not well-formed XML: Start tag expected"),
    "xml-version": (b'<?xml version="0.0"?><robot name="r"/>', "not well-formed XML: Unsupported version '0.0'"),
    "malformed-xml": (b'<robot name="r">\n<link name="a">\n</robot>', "not well-formed XML: Opening and ending tag"),
    "not-a-robot": (b"<sdf/>", "the root element is <sdf>, not <robot>"),
    "no-links": (b'<robot name="r"/>', "there is no <link>. Pinocchio refuses the file, yourdfpy loads it"),
    "xml-entities": (
        b'<!DOCTYPE r [<!ENTITY a "b">]><robot name="&a;"/>',
        "the document declares XML entities. Pinocchio leaves entities out of numbers: a mass becomes 0",
    ),
    "document-type": (
        b'<!DOCTYPE r SYSTEM "r.dtd"><robot name="a"/>',
        "the document has a document type declaration",
    ),
}


@pytest.mark.parametrize("code", DOCUMENTS)
def test_document_beyond_reading(inspected, code):
    content, message = DOCUMENTS[code]
    report = inspected(content)
    assert report.codes == (code,)
    (finding,) = report.findings
    assert finding.severity == "error"
    assert finding.message.startswith(message)
    assert finding.remedy
    assert finding.message.endswith(OTHER_READERS.get(code, ""))
    assert report.verdict == "refused"


def test_a_flawless_file(inspected):
    report = inspected(CLEAN)
    assert report.codes == ALWAYS
    assert (report.verdict, report.reasons, report.usable) == ("dynamics", (), True)
    assert [report.count(severity) for severity in SEVERITIES] == [0, 0, 2]


def test_byte_order_mark_and_line_ends(inspected):
    report = inspected(b"\xef\xbb\xbf" + CLEAN.replace("\n", "\r\n").encode())
    assert report.usable
    mark, ends = of_code(report, "byte-order-mark"), of_code(report, "crlf")
    assert [finding.message for finding in mark] == ["the file begins with a byte-order mark"]
    assert [finding.message for finding in ends] == ["lines that end with CR LF: 37"]


def test_placeholders(inspected):
    names = ("base", "a", "b", "c")
    links = [link(name, None if name == "base" else 1.0) for name in names]
    joints = [joint(f"to_{name}", names[k], name) for k, name in enumerate(names[1:])]
    (finding,) = of_code(inspected(robot_text("r", *links, *joints)), "placeholder-inertials")
    assert finding.severity == "warning"
    assert finding.message == ("all 3 moving links with <inertial> have the same mass, 1 kg, and tensor: placeholders")
    assert finding.remedy == "give the real ones: the numbers computed from these mean nothing"


def test_joints_out_of_order(inspected):
    elbow = re.search(r'  <joint name="elbow".*?</joint>\n', CLEAN, re.DOTALL).group()
    shoulder = re.search(r'  <joint name="shoulder".*?</joint>\n', CLEAN, re.DOTALL).group()
    report = inspected(changed(shoulder + elbow, elbow + shoulder))
    (finding,) = of_code(report, "joint-order")
    assert (finding.severity, finding.element) == ("note", "joint 'elbow'")
    assert finding.message == (
        "it comes before joint 'shoulder', which carries its parent link; load numbers parents first. "
        "Pinocchio sorts siblings by name: compare joints by name"
    )
    assert finding.remedy == "identify joints by their names, not by the order of the file"


class TestDegrees:
    """The same oddity, more or less severe."""

    @pytest.mark.parametrize(
        ("changes", "code", "severity", "message"),
        [
            ((AXIS, '<axis xyz="0 0 2"/>'), "axis-not-normalized", "warning", "the axis has length 2"),
            ((LIMIT, ""), "limits-missing", "warning", "without <limit>. Pinocchio refuses"),
            (('izz="0.17"', 'izz="0.241"'), "triangle-inequality", "note", "exceeds the sum 0.24 kg m²"),
            ((MASS, '<mass value="0"/>'), "zero-mass", "warning", "the mass is zero but the inertia tensor is not"),
            (('upper="2"', 'upper="-1"'), "limits-zero", "note", "are both -1: the joint cannot move"),
            (
                (TOOL, f'<link name="tool"><inertial><mass value="0"/>{FORE}</inertial></link>'),
                "zero-mass",
                "note",
                "the mass is zero but the inertia tensor is not",
            ),
            (
                ("</robot>", '<p:property xmlns:p="http://ros.org/wiki/xacro"/></robot>'),
                "xacro-tags",
                "note",
                "xacro elements that are left in and ignored: 1 ('xacro:property')",
            ),
        ],
    )
    def test_severity(self, inspected, changes, code, severity, message):
        (finding,) = of_code(inspected(changed(*changes)), code)
        assert finding.severity == severity
        assert message in finding.message

    @pytest.mark.parametrize("angle", ["1.57", "3.14159", "-1.570796", "6.2832"])
    def test_truncated_angles(self, inspected, angle):
        report = inspected(changed('xyz="0.3 0 0" rpy="0 0 0"', f'xyz="0.3 0 0" rpy="{angle} 0 0"'))
        assert "rpy-truncated" in report.codes

    @pytest.mark.parametrize("angle", [repr(np.pi / 2), repr(-np.pi), "0.000001", "1.5", "0.5"])
    def test_other_angles(self, inspected, angle):
        report = inspected(changed('xyz="0.3 0 0" rpy="0 0 0"', f'xyz="0.3 0 0" rpy="{angle} 0 0"'))
        assert report.codes == ALWAYS

    def test_a_continuous_joint_needs_no_limits(self, inspected):
        report = inspected(changed(SHOULDER, SHOULDER.replace("revolute", "continuous"), LIMIT, ""))
        assert "limits-missing" not in report.codes

    def test_endless_limits_do_not_cross(self, inspected):
        report = inspected(changed('lower="-1" upper="2"', 'lower="1.8e308" upper="2"'))
        assert "limits-crossed" not in report.codes

    def test_a_link_that_never_moves_is_not_judged(self, inspected):
        bad = f'<link name="base"><inertial><mass value="1"/>{INERTIA.replace("0.11", "-9")}</inertial></link>'
        assert inspected(changed('<link name="base"/>', bad)).codes == (*ALWAYS, "root-inertia")


class TestSeveral:
    def test_all_faults_at_once(self, inspected):
        report = inspected(
            changed(
                '<robot name="arm">', "<robot>", MASS, "<mass/>", "0.05", "0,05", SHOULDER, SHOULDER[:-17] + ">",
                'xyz="0.3 0 0"', 'xyz="0.3 0"', '<child link="tool"/>', '<child link="tol"/>',
            )
        )  # fmt: skip
        errors_found = {finding.code for finding in report.findings if finding.severity == "error"}
        assert errors_found == {
            "missing-name", "missing-mass", "malformed-number", "missing-type", "wrong-number-of-entries",
            "missing-link", "several-roots",
        }  # fmt: skip
        assert len(report.reasons) == report.count("error") == 7

    def test_the_first_fault_is_the_one_that_load_raises(self, inspected):
        report = inspected(changed(MASS, "<mass/>", 'xyz="0.3 0 0"', 'xyz="0.3 0"'))
        with pytest.raises(urdf.MissingEntry) as caught:
            urdf.load(report.path)
        first = report.findings[0]
        assert (first.code, first.line, first.element) == (caught.value.code, caught.value.line, caught.value.element)

    def test_order_of_the_report(self, inspected):
        report = inspected(changed(MASS, "<mass/>", AXIS, '<axis xyz="0 0 -2"/>', "0.05", "5", "30", "-30"))
        ranks = [(SEVERITIES.index(finding.severity), finding.line or 0) for finding in report.findings]
        assert ranks == sorted(ranks)

    def test_every_name_of_a_long_list_is_not_told(self, inspected):
        shelves = "".join(f'<link name="shelf_{k}"/>' for k in range(30))
        (finding,) = of_code(inspected(changed("</robot>", shelves + "</robot>")), "several-roots")
        assert "'shelf_18' and 11 more. Pinocchio refuses" in finding.message

    def test_an_endless_name_is_shortened(self, inspected):
        name = "n" * 5000
        report = inspected(changed(TOOL, f'<link name="{name}"/>'))
        assert max(len(finding.text) for finding in report.findings) < 500

    def test_too_many_findings(self, inspected, monkeypatch):
        monkeypatch.setattr(inspecting, "MAX_FINDINGS", 2)
        report = inspected(changed('"0.11"', '"x"', '"0.13"', '"y"', '"0.17"', '"z"'))
        (finding,) = of_code(report, "more-findings")
        assert report.count("error") == 2
        assert finding.message == "only the first 2 findings of a kind are listed"
        assert finding.remedy == "correct these first"


class TestVerdict:
    def test_kinematics_only(self, inspected):
        report = inspected(changed(FORE_INERTIAL, ""))
        assert (report.verdict, report.usable) == ("kinematics only", False)
        assert report.reasons == (CASES["mass-matrix-singular"].message,)

    def test_every_body_has_mass_and_the_matrix_is_singular(self, inspected):
        """A point mass on the axis of its joint."""
        point = FORE_INERTIAL.replace("0.05", "0").replace("0.06", "0").replace("0.02", "0").replace("0 0 0.4", "0 0 0")
        report = inspected(changed(FORE_INERTIAL, point))
        assert report.verdict == "kinematics only"
        assert "(bodies without mass or inertia: 'fore')" in report.reasons[0]

    def test_canceled_inertia(self, inspected):
        report = inspected(changed('xyz="0 0 0.4"', 'xyz="0 0 0"', 'iyy="0.06"', 'iyy="0"'))
        assert report.verdict == "kinematics only"
        assert "(every body has mass)" in report.reasons[0]

    def test_what_only_the_model_refuses(self, inspected, monkeypatch):
        def refuse(*_arguments):
            raise urdf.InvalidRobot("impossible", "none")

        monkeypatch.setattr(inspecting, "build", refuse)
        report = inspected(CLEAN)
        assert (report.verdict, report.reasons) == ("refused", ("impossible",))
        assert report.findings[0].code == "invalid-robot"

    def test_a_mass_matrix_that_overflows(self, inspected):
        """Where a mimic joint puts its link out of reach of all numbers."""
        report = inspected(RICH.replace('offset="0.01"', 'offset="1e308"'))
        (finding,) = of_code(report, "mass-matrix-not-examined")
        assert finding.message.startswith("the mass matrix is larger than any number over 5 random states")

    def test_more_bodies_than_are_examined(self, inspected):
        names = [f"l{k}" for k in range(202)]
        joints = [joint(f"j{k}", names[k], names[k + 1]) for k in range(201)]
        report = inspected(robot_text("r", *map(link, names), *joints))
        (finding,) = of_code(report, "mass-matrix-not-examined")
        assert finding.message == "201 moving bodies: the mass matrix of more than 200 is not examined"
        assert finding.remedy == "no action needed"
        assert report.verdict == "dynamics"


class TestFiles:
    def test_a_name_of_the_catalog(self):
        report = urdf.inspect("kr500")
        assert report.robot == "kr500"
        assert report.path.endswith("kr500.urdf")
        assert report.usable

    def test_no_such_file(self):
        report = urdf.inspect("ur55")
        (finding,) = report.findings
        assert (finding.code, report.verdict, report.path) == ("no-such-file", "refused", None)
        assert finding.message == "'ur55' is neither a file nor a robot of the catalog"
        assert "ur5" in finding.remedy

    def test_a_folder(self, tmp_path):
        assert urdf.inspect(tmp_path).codes == ("no-such-file",)

    def test_an_unreadable_file(self, tmp_path, monkeypatch):
        def denied(*_arguments, **_options):
            raise PermissionError(13, "Permission denied")

        path = tmp_path / "arm.urdf"
        path.write_text(CLEAN, encoding="utf-8")
        monkeypatch.setattr(Path, "open", denied)
        (finding,) = urdf.inspect(path).findings
        assert (finding.code, finding.severity) == ("unreadable-file", "error")
        assert finding.message == "the file cannot be read: [Errno 13] Permission denied"
        assert finding.remedy == "check its path and permissions"


TABLE_CODES = (
    *("malformed-toml", "missing-key", "unknown-key", "invalid-value", "half-a-limit", "exchanged-limits"),
    *("invalid-inertia", "duplicate-name"),
)
"""Of tables of Denavit-Hartenberg parameters, which are read whole or not at all."""


def test_every_code_has_a_case():
    """Read from the sources: what can be found is found here or in the tests of hostile files."""
    package = Path(urdf.__file__).parent
    rules = "".join(path.read_text(encoding="utf-8") for path in (package / "inspection").rglob("*.py"))
    told = set(re.findall(r'(?:about|of_file)\(\s*"([a-z-]+)"', rules))
    told |= {f"{name}-{how}" for name in ("effort", "velocity") for how in ("zero", "negative")}
    told |= {"unread-dynamics", "unknown-attribute", "unknown-element"}
    assert told == {code for remedies in REMEDIES.values() for code in remedies}
    strict = "".join(
        (package / name).read_text(encoding="utf-8")
        for name in ("reading/checks.py", "document/tree.py", "document/numbers.py")
    )
    written = told | set(re.findall(r'(?:[A-Z]\w+,|BadNumber\()\s*"([a-z]+(?:-[a-z]+)+|cycle)"', strict))
    written |= {f"missing-{tag}" for tag in ("mass", "inertia", "parent", "child", "axis")}
    written |= {getattr(kind, "default_code", "") for kind in vars(errors).values()} - {""}
    elsewhere = {
        *MESH_CODES,
        "byte-order-mark",
        "crlf",
        "inertia-across-link",
        "invalid-robot",
        "invalid-xacro",
        "joint-order",
        "mass-matrix-not-examined",
        "more-findings",
        "other-density",
        "no-such-file",
        "placeholder-inertials",
        "too-large",
        "unreadable-file",
        "xacro-complaint",
        "xacro-expanded",
        "xacro-not-installed",
        "invalid-dh",
        *TABLE_CODES,
        "invalid-mjcf",
        "mujoco-not-installed",
        "xml-limits",
    }
    assert written <= {*CASES, *DOCUMENTS, *elsewhere}
    assert len(written) > 70
    assert set(OTHER_READERS) <= {*CASES, *DOCUMENTS, *elsewhere}
    page = (REPOSITORY / "docs" / "loading.md").read_text(encoding="utf-8")
    assert {*CASES, *DOCUMENTS, *elsewhere} == set(
        re.findall(r"`([a-z]+(?:-[a-z0-9]+)*)`", page.split("| severity |")[1])
    )
