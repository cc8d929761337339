"""Names with line breaks, control characters and escape sequences: every message stays one line that prints."""

import warnings

import numpy as np
import pytest
from inspected.sample import CLEAN, TOOL, changed
from urdf_text import joint, link, robot_text

import urdf
from urdf.errors import one_line
from urdf.inspection.findings import of_file

ODD = "a\nb\r\x1b[31m\x9bc\u2028d"
SAID = r"a\nb\r\x1b[31m\x9bc\u2028d"
IN_XML = "a&#10;b&#13;&#155;c&#x2028;d"
SAID_IN_XML = r"a\nb\r\x9bc\u2028d"
"""Without the escape character, which XML does not allow."""


def is_one_line(text):
    return text.isprintable()


def test_one_line():
    assert one_line(ODD) == SAID
    assert one_line("Gelenk ä, 工具 🤖: ½ m²") == "Gelenk ä, 工具 🤖: ½ m²"


def test_every_finding():
    assert of_file("crlf", f"found {ODD}", 1).message == f"found {SAID}"


@pytest.fixture
def folder(tmp_path):
    """A folder whose name has line breaks."""
    path = tmp_path / ODD
    path.mkdir()
    return path


def refusal(source, **options):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        with pytest.raises(urdf.URDFError) as caught:
            urdf.load(source, **options)
    error = caught.value
    assert is_one_line(str(error)), str(error)
    assert all(map(is_one_line, (error.problem, error.remedy, error.element or "")))
    return error


def odd_file(folder, text):
    path = folder / "arm.urdf"
    path.write_text(text, encoding="utf-8", newline="")
    return path


class TestFileNames:
    def test_a_missing_file(self, folder):
        assert SAID in str(refusal(folder / "none.urdf"))
        (finding,) = urdf.inspect(folder / "none.urdf").findings
        assert is_one_line(finding.text)
        assert SAID in finding.message

    def test_a_fault(self, folder):
        error = refusal(odd_file(folder, changed('value="2.5"', 'value="x"')))
        assert f"/{SAID}/arm.urdf:6: <mass>" in str(error)
        assert error.path == folder / "arm.urdf"

    def test_a_warning(self, folder):
        path = odd_file(folder, changed('xyz="0 0 1"', 'xyz="0 0 2"'))
        with pytest.warns(urdf.AxisNotNormalizedWarning) as caught:
            urdf.load(path)
        assert is_one_line(str(caught[0].message))

    def test_saving(self, folder):
        model = urdf.load("kr500")
        with pytest.warns(urdf.GravityNotSavedWarning) as caught:
            urdf.save(model, folder / "out.urdf")
        assert is_one_line(str(caught[0].message))
        assert urdf.load(folder / "out.urdf").n_bodies == 6

    def test_a_folder_in_place_of_a_file(self, folder):
        with pytest.raises(OSError) as caught:  # noqa: PT011 (which one is up to the system)
            urdf.save(urdf.load(CLEAN), folder / "none" / "out.urdf")
        assert is_one_line(str(caught.value))


FAULTS = {
    "an odd link twice": ('name="tool"', f'name="{IN_XML}"', 'name="base"', f'name="{IN_XML}"'),
    "an odd parent": ('<parent link="base"/>', f'<parent link="{IN_XML}"/>'),
    "an odd child": ('<child link="upper"/>', f'<child link="{IN_XML}"/>'),
    "an odd type": ('type="fixed"', f'type="{IN_XML}"'),
    "an odd number": ('value="2.5"', f'value="{IN_XML}"'),
    "several odd roots": (TOOL, f'{TOOL}<link name="{IN_XML}"/>'),
    "an odd loop": ("</robot>", f'<loop name="{IN_XML}"/></robot>'),
    "an odd root element": ("<robot ", "<robots ", "</robot>", "</robots>"),
}


@pytest.mark.parametrize("case", FAULTS)
def test_faults(folder, case):
    path = odd_file(folder, changed(*FAULTS[case]))
    error = refusal(path)
    if case != "an odd root element":
        assert SAID_IN_XML in str(error)
    for finding in urdf.inspect(path).findings:
        assert is_one_line(finding.text), finding
        assert is_one_line(finding.remedy), finding


def odd_robot(*more):
    links = [link("base"), link("tip"), link(IN_XML), *more]
    limits = '<limit lower="-1" upper="1" effort="1" velocity="1"/>'
    joints = [joint("first", "base", IN_XML, more=limits), joint(f"{IN_XML}2", IN_XML, "tip", more=limits)]
    return robot_text(IN_XML, *links, *joints)


class TestArguments:
    """What the caller gives, beside what the file says."""

    @pytest.mark.parametrize(
        "options",
        [
            {"lock": ODD},
            {"lock": [ODD]},
            {"lock": {"first": ODD}},
            {"lock": ["first", "a\nb\r\x9bc\u2028d2"]},
            {"chain": (ODD, "tip")},
            {"chain": ("tip", "a\nb\r\x9bc\u2028d")},
            {"chain": ODD},
            {"repair": (ODD,)},
            {"repair": ODD},
        ],
    )
    def test_refusals(self, folder, options):
        refusal(odd_file(folder, odd_robot()), **options)

    def test_names_of_the_catalog(self):
        assert SAID[3:] in str(refusal(ODD.replace("\n", "")).problem)


class TestUpdating:
    def updated(self, folder, mass):
        mount = joint("mount", IN_XML, "tool", "fixed")
        path = odd_file(folder, odd_robot(link("tool")).replace("</robot>", mount + "</robot>"))
        parameters = np.array(urdf.load(path).inertial_parameters)
        parameters[0] = mass
        return urdf.update(path, folder / "out.urdf", parameters)

    def test_notes(self, folder):
        (note,) = self.updated(folder, 2.5).notes
        assert is_one_line(note)
        assert SAID_IN_XML in note

    def test_refusals(self, folder):
        with pytest.raises(urdf.CannotUpdate) as caught:
            self.updated(folder, 0.5)
        assert is_one_line(str(caught.value))
        assert SAID_IN_XML in str(caught.value)


def test_warnings(folder):
    text = odd_robot().replace("<inertial>", "<none>").replace("</inertial>", "</none>")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        urdf.load(odd_file(folder, text))
    assert {warning.category for warning in caught} == {urdf.MissingInertialWarning, urdf.UnreadWarning}
    assert all(is_one_line(str(warning.message)) for warning in caught)
    assert SAID_IN_XML in str(caught[-1].message)
    for finding in urdf.inspect(folder / "arm.urdf").findings:
        assert is_one_line(finding.text), finding
