"""Where Pinocchio's reader takes a file otherwise: each finding says what Pinocchio then really does."""

import warnings

import numpy as np
import pytest
from inspected.sample import CLEAN, LIMIT, TOOL, changed

import urdf
from crosscheck.reference.pinocchio_model import PinocchioModel, PinocchioRefuses

REFUSED = "Pinocchio refuses the file"


def messages(path, code):
    """Of the findings with this code; load must accept the file without a Python warning."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        urdf.load(path)
        return [finding.message for finding in urdf.inspect(path).findings if finding.code == code]


def torque_there(path):
    """Pinocchio's torques of the file's robot in one state."""
    model = urdf.load(path)
    ones = np.ones((1, model.n_bodies))
    return PinocchioModel.from_urdf(path, model).rnea(ones, ones, ones)


def refuses(path):
    try:
        torque_there(path)
    except PinocchioRefuses:
        return True
    return False


INERTIA = '<inertia ixx="0.11" ixy="0" ixz="0" iyy="0.13" iyz="0" izz="0.17"/>'
NO_TENSOR = '<inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/>'


class TestSpacing:
    """urdfdom takes any blank before a number, none behind a single one, and only blanks between three."""

    @pytest.mark.parametrize(
        "changes",
        [
            ('value="2.5"', 'value=" \t\n2.5"'),
            ('"0 0 1"', '"  0   0 1  "'),
            ('"0 0 1"', '"0 \t0 \n1"'),
            ('value="2.5"', "value='2.5'"),
        ],
    )
    def test_read_everywhere(self, written, changes):
        path = written(changed(*changes))
        assert messages(path, "number-spacing") == []
        assert torque_there(path) == pytest.approx(torque_there(written(CLEAN)), abs=1e-12)

    @pytest.mark.parametrize("new", ['value="2.5 "', 'value="2.5\n"', "value = '2.5\t'", 'value="2.5&#32;"'])
    def test_mass(self, written, new):
        path = written(changed('value="2.5"', new))
        (message,) = messages(path, "number-spacing")
        assert message.endswith("in value that not every reader accepts. Pinocchio gives the link mass 0")
        nothing = changed(INERTIA, NO_TENSOR, 'value="2.5"', 'value="0"')
        found = torque_there(path)
        with pytest.warns(urdf.ZeroMassWarning, match="'upper'"):
            assert found == pytest.approx(torque_there(written(nothing)), abs=1e-12)

    def test_center_of_mass(self, written):
        path = written(changed('xyz="0.1 0.2 0.3"', 'xyz="0.1\t0.2 0.3"'))
        (message,) = messages(path, "number-spacing")
        assert message.endswith("in xyz that not every reader accepts. Pinocchio gives the link mass 0")

    @pytest.mark.parametrize("new", ['izz="0.17 "', 'ixx="0.11\t"'])
    def test_tensor(self, written, new):
        path = written(changed(f"{new.rstrip(' ').split('=')[0]}=" + ('"0.17"' if "izz" in new else '"0.11"'), new))
        (message,) = messages(path, "number-spacing")
        assert message.endswith("Pinocchio gives the link a tensor of zero")
        assert torque_there(path) == pytest.approx(torque_there(written(changed(INERTIA, NO_TENSOR))), abs=1e-12)

    @pytest.mark.parametrize(
        "changes", [('"0 0 1"', '"0\n0 1"'), ('lower="-1"', 'lower="-1 "'), ('"0.3 0 0"', '"0.3\t0 0"')]
    )
    @pytest.mark.parametrize("namespace", ["", ' xmlns="http://www.ros.org"'])
    def test_joint(self, written, changes, namespace):
        path = written(changed("<robot", f"<robot{namespace}", *changes))
        (message,) = messages(path, "number-spacing")
        assert message.endswith(REFUSED)
        assert refuses(path)

    def test_other_blanks_are_no_blanks(self, written):
        """Python takes a no-break space for a blank, XML and everyone else do not."""
        path = written(changed('value="2.5"', 'value="2.5\u00a0"'))
        with pytest.raises(urdf.InvalidNumber, match=r"value=\"2\.5\\xa0\": '2\.5\\xa0' is not a number"):
            urdf.load(path)


@pytest.mark.parametrize(
    ("place", "part", "problem"),
    [
        ("fixed", "<limit/>", "without effort, velocity;"),
        ("fixed", '<limit effort="-1" velocity="1"/>', None),
        ("fixed", '<limit effort="x" velocity="1"/>', "effort=\"x\": 'x' is not a number;"),
        ("fixed", "<dynamics/>", "without damping or friction;"),
        ("fixed", "<mimic/>", "without joint;"),
        ("moving", "<dynamics/>", "without damping or friction;"),
        ("moving", "<safety_controller/>", "without k_velocity;"),
        ("moving", '<safety_controller k_velocity=""/>', 'k_velocity="" has 0 entries, expected 1;'),
        ("moving", '<calibration rising="x"/>', "rising=\"x\": 'x' is not a number;"),
        ("fixed", '<axis xyz="x"/>', None),
        ("moving", "<calibration/>", None),
        ("moving", '<safety_controller k_velocity="1"/><safety_controller/>', None),
    ],
)
def test_parts_that_dynamics_do_not_need(written, place, part, problem):
    old = 'type="fixed">' if place == "fixed" else LIMIT
    path = written(changed(old, old + part))
    found = messages(path, "incomplete-joint-part")
    assert found == ([] if problem is None else [f"{problem} dynamics do not need it. {REFUSED}"])
    assert refuses(path) == (problem is not None)


@pytest.mark.parametrize(
    ("document", "late"),
    [
        (f"<?a b?>\n{CLEAN}", 0),
        (f"<?a b?><?c d?><!-- c -->{CLEAN}", 0),
        (f"<!-- c --><?a b?>{CLEAN}", 1),
        (f"{CLEAN}<?a b?>", 1),
        (changed(TOOL, f"{TOOL}<?a b?><?c d?>"), 2),
    ],
)
def test_processing_instructions(written, document, late):
    path = written(document)
    found = messages(path, "processing-instruction")
    told = f"processing instructions <?…?> within the document: {late}. {REFUSED}, yourdfpy loads it"
    assert found == ([told] if late else [])
    assert refuses(path) == bool(late)


def encoded(encoding, name="töol"):
    text = f'<?xml version="1.0" encoding="{encoding}"?>' + changed('"tool"', f'"{name}"', '"tool"', f'"{name}"')
    return text.encode(encoding)


@pytest.mark.parametrize("encoding", ["utf-16", "utf-32"])
def test_encodings_that_pinocchio_refuses(written, encoding):
    path = written(encoded(encoding))
    (message,) = messages(path, "other-encoding")
    assert message.endswith(REFUSED)
    assert refuses(path)


def test_encoding_by_byte_order_mark_alone(written):
    path = written(CLEAN.encode("utf-16"))
    assert messages(path, "other-encoding") == [f"the text is encoded in UTF-16. {REFUSED}"]
    assert refuses(path)


def test_ascii_within_another_encoding(written):
    """Bytes that another program has inserted, which in UTF-16 are other characters."""
    before, tag, after = CLEAN.partition("<axis")
    path = written(before.encode("utf-16") + b"<robot/>" + (tag + after).encode("utf-16-le"))
    assert messages(path, "other-encoding") == [f"the text is encoded in UTF-16. {REFUSED}"]
    assert refuses(path)


@pytest.mark.parametrize("encoding", ["UTF-16", "ISO-8859-1"])
def test_the_declared_encoding_of_a_text_says_nothing(encoding):
    text = changed("<robot", f'<?xml version="1.0" encoding="{encoding}"?><robot', '"0 0 1"', '"0\t0 1"')
    report = urdf.inspect(text.replace('"tool"', '"töol"'))
    assert "other-encoding" not in report.codes
    assert "number-spacing" in report.codes


def test_encoding_that_writes_ascii_otherwise(written):
    """In UTF-7, +- is a plus."""
    text = '<?xml version="1.0" encoding="utf-7"?>' + changed('value="2.5"', 'value="+2.5"')
    path = written(text.encode("utf-7"))
    (message,) = messages(path, "other-encoding")
    assert message == "the text is encoded in utf-7. Pinocchio reads it as UTF-8, with other names or numbers"
    assert torque_there(path) != pytest.approx(torque_there(written(CLEAN)))


def test_encoding_that_pinocchio_takes_for_utf_8(written):
    path = written(encoded("iso-8859-1"))
    (message,) = messages(path, "other-encoding")
    assert message == "the text is encoded in iso-8859-1. Pinocchio reads it as UTF-8, with other names or numbers"
    model = urdf.load(path)
    assert model.frames[0].name == "töol"
    with pytest.raises(PinocchioRefuses, match="Pinocchio has no link 'töol'"):
        PinocchioModel.from_urdf(path, model).frame_placements(np.zeros((1, 2)), ["töol"])


@pytest.mark.parametrize("content", [encoded("utf-8"), encoded("iso-8859-1", "tool"), CLEAN.encode()])
def test_encodings_that_say_the_same(written, content):
    assert messages(written(content), "other-encoding") == []


@pytest.mark.parametrize("version", ["1.0", "1.1", "1.2", "1", "1.3", "2.0"])
def test_version(written, version):
    path = written(changed('name="arm"', f'name="arm" version="{version}"'))
    assert bool(messages(path, "urdf-version")) == refuses(path) == (version not in ("1.0", "1.1", "1.2"))


class TestNamespaces:
    """A tag counts as it is written, here and in Pinocchio."""

    INERTIAL = changed("<inertial>", '<inertial xmlns="urn:other">')
    PREFIXED = changed("<inertial>", '<n:inertial xmlns:n="urn:x">', "</inertial>", "</n:inertial>")
    SAME = PREFIXED.replace("<robot", '<robot xmlns="urn:x"')

    def test_other_default_namespace_inside(self, written):
        assert urdf.load(written(self.INERTIAL)).bodies[0].mass == 2.5
        assert torque_there(written(self.INERTIAL)) == pytest.approx(torque_there(written(CLEAN)), abs=1e-12)

    @pytest.mark.parametrize("text", [PREFIXED, SAME])
    def test_prefix(self, written, text):
        path = written(text)
        unread = pytest.warns(urdf.UnreadWarning, match="URDF knows no <n:inertial> in <link>")
        with unread, pytest.warns(urdf.MissingInertialWarning, match="'upper'"):
            model = urdf.load(path)
        assert model.bodies[0].mass == 0
        assert urdf.inspect(path).codes.count("missing-inertial") == 1

    def test_root_with_a_prefix(self, written):
        path = written(CLEAN.replace("<robot", '<n:robot xmlns:n="urn:x"').replace("</robot", "</n:robot"))
        with pytest.raises(urdf.MalformedXML, match="the root element is <n:robot>, not <robot>"):
            urdf.load(path)

    def test_update_goes_by_the_same_tags(self, written, tmp_path):
        with pytest.warns(urdf.UnreadWarning), pytest.warns(urdf.MissingInertialWarning):
            model = urdf.load(written(self.PREFIXED))
        parameters = np.array(model.inertial_parameters)
        parameters[:10] = urdf.load(written(CLEAN)).inertial_parameters[:10]
        with pytest.warns(urdf.UnreadWarning), pytest.warns(urdf.MissingInertialWarning):
            urdf.update(written(self.PREFIXED), tmp_path / "new.urdf", parameters)
        with pytest.warns(urdf.UnreadWarning):
            assert urdf.load(tmp_path / "new.urdf").bodies[0].mass == 2.5


def test_an_axis_too_short_for_its_square(written):
    """Pinocchio leaves it as it is, and the joint does not turn."""
    path = written(changed('"0 0 1"', '"0 0 1e-170"'))
    with pytest.raises(
        urdf.InvalidNumber, match="the axis has length 1e-170, too short to normalize; give a direction"
    ):
        urdf.load(path)
    assert urdf.inspect(path).codes[0] == "zero-axis"


def test_attribute_names_beyond_ascii(written, capfd):
    """They once sent yourdfpy to a parser that guesses, with a word on standard error."""
    path = written(changed('<robot name="arm">', '<robot name="arm" größe="1">'))
    assert urdf.load(path).n_bodies == 2
    assert capfd.readouterr() == ("", "")


def test_joint_with_the_name_of_pinocchios_ground(written):
    path = written(changed('name="shoulder"', 'name="universe"'))
    model = urdf.load(path)
    said = "Pinocchio calls the ground 'universe' and confuses it with the joint of this name; rename the joint"
    for build in (lambda: PinocchioModel.from_urdf(path, model), lambda: PinocchioModel.from_model(model)):
        with pytest.raises(PinocchioRefuses, match=f"robot 'arm': {said}"):
            build()
