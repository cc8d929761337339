"""Both sides of every threshold, as numbers: what lies just below is told, or read, otherwise than what lies above."""

import warnings
from collections import Counter

import pytest
from inspected.sample import AXIS, FORE, INERTIA, LIMIT, MASS, changed
from urdf_text import joint, link, robot_text

import urdf
from urdf.document.document import check_size
from urdf.errors import TooLarge, listed, shortened


@pytest.fixture
def severities():
    """severities(text): the codes that inspect finds, with their severity."""

    def run(text):
        return {finding.code: finding.severity for finding in urdf.inspect(text).findings}

    return run


def tensor(ixx, iyy, izz):
    return f'<inertia ixx="{ixx}" ixy="0" ixz="0" iyy="{iyy}" iyz="0" izz="{izz}"/>'


def mass(value):
    return (MASS, f'<mass value="{value}"/>')


def upper(*moments):
    return (INERTIA, tensor(*moments))


def fore(*moments):
    return (FORE, tensor(*moments))


def center(xyz):
    return ('xyz="0.1 0.2 0.3"', f'xyz="{xyz}"')


def axis(xyz):
    return (AXIS, f'<axis xyz="{xyz}"/>')


def elbow(xyz, rpy="0 0 0"):
    return ('xyz="0.3 0 0" rpy="0 0 0"', f'xyz="{xyz}" rpy="{rpy}"')


def rolled(angle):
    return elbow("0 0 0", f"{angle} 0 0")


QUARTER = 1.5707963267948966
SMALL_FORE = ('xyz="0 0 0.4"', 'xyz="0 0 0.05"', 'xyz="0 0 0.2"', 'xyz="0 0 0.01"')

SIDES = {
    # of what is refused
    "a mass of 1e60": ("number-too-large", mass("1e60"), None, mass("1.0001e60"), "error"),
    "a moment of 1e60": ("number-too-large", upper("-1e60", 1, 1), None, upper("-1.0001e60", 1, 1), "error"),
    "a length of 1e60": ("number-too-large", elbow("0 1e60 0"), None, elbow("0 1.0001e60 0"), "error"),
    "an angle of 1e60": (
        "number-too-large", elbow("0 0 0", "1e60 0 0"), None, elbow("0 0 0", "1.0001e60 0 0"), "error",
    ),
    "an axis of 1e-60": ("zero-axis", axis("0 1.001e-60 0"), None, axis("0 0.999e-60 0"), "error"),
    # of masses and tensors
    "100 mg": ("tiny-mass", mass("1e-4"), None, mass("0.9999e-4"), "warning"),
    "no mass": ("tiny-mass", (*mass("0"), *upper(0, 0, 0)), None, mass("1e-9"), "warning"),
    "a rounded triangle": (
        "triangle-inequality", upper(0.11, 0.13, 0.2448), "note", upper(0.11, 0.13, 0.2450), "warning",
    ),
    "an exact triangle": (
        "triangle-inequality", upper(0.11, 0.13, 0.24 + 4e-13), None, upper(0.11, 0.13, 0.24 + 6e-13), "note",
    ),
    "a triangle off by a hundredth": (
        "triangle-inequality", upper(0.11, 0.13, 0.24), None, upper(0.11, 0.13, 0.2424), "note",
    ),
    "a negative moment": (
        "indefinite-inertia", upper(-2e-13, 0.13, 0.13), None, upper(-3e-13, 0.13, 0.13), "warning",
    ),
    "a moment of zero": ("singular-inertia", upper(3e-13, 0.13, 0.13), None, upper(2e-13, 0.13, 0.13), "warning"),
    "an eigenvalue": (
        "inconsistent-body",
        (*center("0 0 0"), *upper(0.11, 0.13, 0.24 + 4.9e-9)), None,
        (*center("0 0 0"), *upper(0.11, 0.13, 0.24 + 5.1e-9)), "warning",
    ),
    "a radius of 2 m": (
        "gyration-radius",
        (*elbow("0.5 0 0"), *upper(9, 9, 9.99)), None,
        (*elbow("0.5 0 0"), *upper(9, 9, 10.01)), "warning",
    ),
    "a radius of five times the link": (
        "gyration-radius", upper(8, 8, 8.74), None, upper(8, 8, 8.76), "warning",
    ),
    "a radius of five times 0.1 m": (
        "gyration-radius",
        (*SMALL_FORE, *fore(0.3, 0.3, 0.374)), None, (*SMALL_FORE, *fore(0.3, 0.3, 0.376)), "warning",
    ),
    "a center at 50 m": ("far-center-of-mass", center("0 -49.9 0"), None, center("0 -50.1 0"), "warning"),
    # of axes and angles
    "a unit axis": ("axis-not-normalized", axis("0 0 1.0000000009"), None, axis("0 0 1.0000000011"), "note"),
    "a rounded axis": ("axis-not-normalized", axis("0 0 0.9901"), "note", axis("0 0 0.9899"), "warning"),
    "a straight axis": ("oblique-axis", axis("0.99e-6 0 1"), None, axis("1.01e-6 0 1"), "note"),
    "an exact angle": (
        "rpy-truncated", rolled(QUARTER + 0.9e-12), None, rolled(QUARTER + 1.1e-12), "note",
    ),
    "another angle": (
        "rpy-truncated", rolled(QUARTER - 2.01e-3), None, rolled(QUARTER - 1.99e-3), "note",
    ),
    "many turns": (
        "rpy-truncated", rolled(5 * QUARTER + 1e-3), None, rolled(4 * QUARTER + 1e-3), "note",
    ),
    "an endless limit": (
        "limits-crossed",
        ('lower="-1" upper="2"', 'lower="1.79769e308" upper="2"'), None,
        ('lower="-1" upper="2"', 'lower="1.79768e308" upper="2"'), "error",
    ),
    # of whole robots: a reach of 1 m, 4 kg
    "a reach of 2 cm": (
        "suspicious-lengths",
        ('xyz="0 0 0.5"', 'xyz="0 0 0.0101"', *elbow("0.005 0 0"), 'xyz="0 0 0.2"', 'xyz="0 0 0.005"'), None,
        ('xyz="0 0 0.5"', 'xyz="0 0 0.0099"', *elbow("0.005 0 0"), 'xyz="0 0 0.2"', 'xyz="0 0 0.005"'), "warning",
    ),
    "a reach of 50 m": (
        "suspicious-lengths", ('xyz="0 0 0.5"', 'xyz="0 0 49.4"'), None, ('xyz="0 0 0.5"', 'xyz="0 0 49.6"'), "warning",
    ),
    "50 g": (
        "suspicious-masses",
        (*mass("0.04"), 'value="1.5"', 'value="0.0101"'), None,
        (*mass("0.04"), 'value="1.5"', 'value="0.0099"'), "warning",
    ),
    "5 t": ("suspicious-masses", mass("4998.4"), None, mass("4998.6"), "warning"),
}  # fmt: skip
"""Per threshold: the code, a change on one side and the severity there, None where it is not found, and the other."""


@pytest.mark.parametrize("case", SIDES)
def test_findings(severities, case):
    code, quiet, severity, loud, other = SIDES[case]
    assert severities(changed(*quiet)).get(code) == severity
    assert severities(changed(*loud)).get(code) == other


def test_limits_may_be_larger(severities):
    assert "number-too-large" not in severities(changed(LIMIT, LIMIT.replace('"2"', '"1e300"')))


@pytest.mark.parametrize(("number", "found"), [(2, False), (3, True)])
def test_equal_inertials(severities, number, found):
    names = ["base", *"abc"[:number]]
    links = [link(name, None if name == "base" else 1.0) for name in names]
    joints = [joint(f"to_{name}", names[k], name) for k, name in enumerate(names[1:])]
    assert ("placeholder-inertials" in severities(robot_text("r", *links, *joints))) == found


@pytest.mark.parametrize(("heavier", "found"), [(0.9e8, False), (1.1e8, True)])
def test_ill_conditioned(severities, heavier, found):
    """Two slides at right angles: M = diag(m_1 + m_2, m_2), with the condition number 1 + m_1 / m_2."""
    slides = (
        joint("x", "base", "a", "prismatic"),
        joint("y", "a", "b", "prismatic", '<axis xyz="0 1 0"/>'),
    )
    text = robot_text("r", link("base", None), link("a", heavier), link("b", 1.0), *slides)
    assert ("mass-matrix-ill-conditioned" in severities(text)) == found


@pytest.mark.parametrize(("number", "code"), [(200, "mass-matrix"), (201, "mass-matrix-not-examined")])
def test_many_bodies(severities, number, code):
    names = [f"l{k}" for k in range(number + 1)]
    joints = [joint(f"j{k}", names[k], names[k + 1], more='<axis xyz="0 0 1"/>') for k in range(number)]
    found = severities(robot_text("r", *map(link, names), *joints))
    assert {code, "mass-matrix", "mass-matrix-not-examined"} & set(found) == {code}


@pytest.mark.parametrize(("length", "warned"), [("1.0000000009", False), ("1.0000000011", True)])
def test_normalized_axes(length, warned):
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        urdf.load(changed(*axis(f"0 0 {length}")))
    assert [warning.category for warning in caught] == [urdf.AxisNotNormalizedWarning] * warned


@pytest.mark.parametrize(("angle", "warned"), [("0.9e-9", False), ("1.1e-9", True)])
def test_tilted_base(angle, warned):
    text = changed('xyz="0 0 0.5" rpy="0 0 0"', f'xyz="0 0 0.5" rpy="{angle} 0 0"')
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        urdf.load(text, chain=("upper", "tool"))
    assert [warning.category for warning in caught] == [urdf.ChainWarning] * warned


@pytest.mark.parametrize(
    ("text", "limit"), [("1.79769e308", None), ("1.79768e308", 1.79768e308), ("-1.79769e308", None)]
)
def test_no_limit(text, limit):
    (first, _) = urdf.load(changed('velocity="3"', f'velocity="{text}"')).joints
    assert first.limits.velocity == limit


class TestSizes:
    @pytest.mark.parametrize(
        ("content", "refused"),
        [
            (b" " * 10_000_000, None),
            (b" " * 10_000_001, "larger than 10 MB"),
            (b"<" * 150_000, None),
            (b"<" * 150_001, "150001 tags, more than 150000"),
        ],
        ids=["10 MB", "more", "150,000 tags", "more tags"],
    )
    def test_content(self, tmp_path, content, refused):
        if refused is None:
            check_size(content, tmp_path)
        else:
            with pytest.raises(TooLarge, match=refused):
                check_size(content, tmp_path)

    @pytest.mark.parametrize(("number", "refused"), [(100, False), (101, True)])
    def test_attributes(self, severities, number, refused):
        many = " ".join(f'a{k}="1"' for k in range(number))
        assert ("too-large" in severities(changed("<origin ", f"<visual {many}/><origin "))) == refused

    @pytest.mark.parametrize(("number", "refused"), [(2000, False), (2001, True)])
    def test_links_and_joints(self, severities, number, refused):
        links = [f'<link name="l{k}"/>' for k in range(number)]
        assert ("too-large" in severities(robot_text("r", *links))) == refused
        joints = [joint(f"j{k}", "a", "a") for k in range(number)]
        assert ("too-large" in severities(robot_text("r", *joints))) == refused

    @pytest.mark.parametrize(("number", "limited"), [(1000, False), (1001, True)])
    def test_findings(self, number, limited):
        links = [f'<link name="l{k}"><inertial/></link>' for k in range((number - 1) // 2)]
        extra = [] if number % 2 else ['<link name="x"><inertial><mass value="1"/></inertial></link>']
        report = urdf.inspect(robot_text("r", *links, *extra))
        codes = Counter(finding.code for finding in report.findings if finding.severity == "error")
        assert codes.total() == 1000
        assert ("more-findings" in report.codes) == limited


class TestWords:
    def test_shortened(self):
        assert shortened("x" * 80) == "x" * 80
        assert shortened("x" * 40 + "y" + "z" * 40) == "x" * 40 + " … " + "z" * 40

    def test_listed(self):
        assert listed(["a"] * 20) == ", ".join(["'a'"] * 20)
        assert listed(["a"] * 21) == ", ".join(["'a'"] * 20) + " and 1 more"
