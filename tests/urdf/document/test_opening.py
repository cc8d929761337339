"""What urdf.load and urdf.inspect take: paths, text, bytes, open files."""

import io
from pathlib import Path

import pytest
from inspected.sample import CLEAN, changed
from numpy.testing import assert_array_equal

import urdf

UMLAUT = changed('"tool"', '"Werkzeughälter 工具"', '"tool"', '"Werkzeughälter 工具"')


@pytest.fixture
def written(tmp_path):
    def write(name, text, encoding="utf-8"):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(text if isinstance(text, bytes) else text.encode(encoding))
        return path

    return write


def same(model):
    plain = urdf.load(CLEAN)
    assert model.joint_names == plain.joint_names
    assert_array_equal(model.inertial_parameters, plain.inertial_parameters)
    assert_array_equal(model.gravity, [0, 0, -9.81])


@pytest.mark.parametrize(
    "name", ["two words.urdf", "Ärmchen 机器人.urdf", "ordner é/a b.urdf", "a#b?.urdf", "a\nb.urdf", "arm.xml"]
)
def test_paths(written, name):
    path = written(name, CLEAN)
    same(urdf.load(path))
    same(urdf.load(str(path)))
    assert urdf.inspect(str(path)).robot == str(path)


@pytest.mark.parametrize(
    "text",
    [
        CLEAN,
        CLEAN.encode(),
        CLEAN.replace("\n", " "),
        "\n \t" + CLEAN,
        "\ufeff" + CLEAN,
        "\ufeff".encode() + CLEAN.encode(),
        CLEAN.encode("utf-16"),
        CLEAN.replace("\n", "\r\n"),
        CLEAN.replace("\n", "\r\n").encode(),
        "<!-- drawn by hand -->" + CLEAN,
        '<?xml version="1.0" encoding="utf-8"?>\n' + CLEAN,
        '<?xml version="1.0" encoding="ISO-8859-1"?>\n' + CLEAN,
        b'<?xml version="1.0" encoding="ISO-8859-1"?>\n' + CLEAN.encode("latin-1"),
    ],
    ids=[
        "text", "bytes", "one line", "space before", "mark", "mark in bytes", "utf-16", "crlf", "crlf in bytes",
        "comment before", "utf-8", "latin-1 said, text given", "latin-1",
    ],
)  # fmt: skip
def test_xml_itself(text):
    same(urdf.load(text))
    assert urdf.inspect(text).usable
    stream = io.BytesIO(text) if isinstance(text, bytes) else io.StringIO(text)
    same(urdf.load(stream))
    assert not stream.closed


def test_text_is_what_it_is_whatever_encoding_it_declares():
    declared = '<?xml version="1.0" encoding="ISO-8859-1"?>\n' + UMLAUT
    assert urdf.load(declared).frames[0].name == "Werkzeughälter 工具"


def test_bytes_are_what_they_declare():
    content = b'<?xml version="1.0" encoding="ISO-8859-1"?>\n' + changed('"tool"', '"ä"', '"tool"', '"ä"').encode(
        "latin-1"
    )
    assert urdf.load(content).frames[0].name == "ä"


@pytest.mark.parametrize("mode", ["r", "rb"])
def test_open_files(written, mode):
    path = written("arm.urdf", CLEAN)
    with path.open(mode) as file:
        same(urdf.load(file))
    with path.open(mode) as file:
        report = urdf.inspect(file)
    assert (report.robot, report.path) == (str(path), str(path))


BROKEN = changed('<mass value="2.5"/>', "<mass/>")


@pytest.mark.parametrize(
    ("source", "where"),
    [
        (BROKEN, "<text>"),
        (BROKEN.encode(), "<bytes>"),
        (io.StringIO(BROKEN), "<file>"),
        (io.BytesIO(BROKEN.encode()), "<file>"),
    ],
    ids=["text", "bytes", "text file", "binary file"],
)
def test_messages_say_where(source, where):
    with pytest.raises(urdf.MissingEntry, match=rf"{where}:6: <mass> of link 'upper': attribute 'value'") as caught:
        urdf.load(source)
    assert caught.value.path == Path(where)
    if isinstance(source, str | bytes):
        report = urdf.inspect(source)
        assert (report.robot, report.path, report.findings[0].line) == (where, where, 6)


def test_messages_name_the_open_file(written):
    path = written("arm.urdf", BROKEN)
    with path.open() as file, pytest.raises(urdf.MissingEntry, match=r"arm\.urdf:6: <mass>"):
        urdf.load(file)


class TestRefused:
    @pytest.mark.parametrize("source", [5, None, object()])
    def test_what_is_no_source(self, source):
        with pytest.raises(
            urdf.RobotNotFound, match="is not a robot; give a name, a path, XML as text or bytes, or an open file"
        ):
            urdf.load(source)
        assert urdf.inspect(source).codes == ("no-such-file",)

    def test_a_stream_of_something_else(self):
        class Numbers:
            def read(self, _count):
                return 5

        with pytest.raises(urdf.RobotNotFound, match=r"read\(\) of the file returns int; open it as text or binary"):
            urdf.load(Numbers())

    def test_text_before_the_xml(self):
        for text in ("Expanded by hand.\n" + CLEAN, b"Expanded by hand.\n" + CLEAN.encode()):
            with pytest.raises(urdf.MalformedXML, match="Start tag expected") as caught:
                urdf.load(text)
            assert caught.value.code == "text-before-xml"

    def test_half_a_character(self):
        with pytest.raises(
            urdf.MalformedXML, match="character 14 of the text is half of a surrogate pair; give the file"
        ):
            urdf.load('<robot name="a\ud800"/>'[:13] + "\ud800" + '"/>')

    def test_a_null_character(self):
        with pytest.raises(urdf.MalformedXML, match="not well-formed XML"):
            urdf.load(CLEAN.replace("upper", "up\0per"))

    @pytest.mark.parametrize("source", ["", b"", "x" * 5000, "a\0b"])
    def test_nothing_and_no_path(self, source):
        with pytest.raises((urdf.RobotNotFound, urdf.MalformedXML)) as caught:
            urdf.load(source)
        assert len(str(caught.value)) < 500

    def test_an_endless_stream(self):
        with Path("/dev/zero").open("rb") as file, pytest.raises(urdf.TooLarge, match="the file is larger than 10 MB"):
            urdf.load(file)

    def test_too_much_text(self):
        with pytest.raises(urdf.TooLarge, match="<text>: the file is larger than 10 MB"):
            urdf.load("<!--" + "x" * 10_000_000 + "-->" + CLEAN)

    def test_a_stream_is_read_to_its_end_once(self):
        stream = io.StringIO(CLEAN)
        urdf.load(stream)
        with pytest.raises(urdf.MalformedXML):
            urdf.load(stream)
