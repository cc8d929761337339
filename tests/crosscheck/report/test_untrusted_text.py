"""Names and messages of others on a terminal, on a page and in JSON; output in encodings that lack what reports use."""

import json
import re
import sys
from html.parser import HTMLParser

import numpy as np
import pytest
from long_check import LONG

import urdf
from crosscheck.commands.program import console, own_process
from crosscheck.commands.program.console import spelled
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, INTERNAL_ERROR
from crosscheck.report.html import page
from crosscheck.report.pictures.svg import picture
from crosscheck.report.plain_text import INVISIBLE_CHARACTERS, MAX_MESSAGE, printable
from crosscheck.report.report import (
    CharacterPicture,
    Code,
    Column,
    Facts,
    Group,
    Hover,
    Lines,
    Note,
    Notes,
    Panel,
    Plot,
    Prose,
    Report,
    Row,
    Section,
    Series,
    Table,
    Verdict,
)
from crosscheck.report.text import as_text

HOSTILE = "a\x1b]0;b\x07\x9b31m\r\n\x08\u202ec\u200bd\u2066e"
"""A title of the window, a color by one character, an overwritten line, a reversed one, and what cannot be seen."""

SHOWN = r"a\x1b]0;b\x07\x9b31m\r\n\x08\u202ec\u200bd\u2066e"

IN_XML = "\x9b31m\u202ec&#13;&#10;d"
"""XML has no other control characters."""

FILE = "arm\x1b[31m\n\u202e.urdf"


def unseen(text):
    return sorted({character for character in INVISIBLE_CHARACTERS.findall(text) if character not in "\n\t"})


class TestPrintable:
    def test_characters(self):
        assert printable(HOSTILE) == SHOWN
        assert printable("two\nlines\there", keep="\n\t") == "two\nlines\there"

    @pytest.mark.parametrize("text", ["τ = M(q) q̈ ± 2 σ", "Werkzeughälter 工具", "می‌خواهم", "🦾", "a b"])
    def test_all_else_stays(self, text):
        assert printable(text) == text

    def test_what_a_message_repeats_of_a_file_is_bounded(self, capsys):
        console.say(f"error: x.toml: rate is '{'9' * 10**6}'; give samples per second")
        said = capsys.readouterr().err
        assert len(said) < 2 * MAX_MESSAGE
        assert said.startswith("error: x.toml: rate is '999")
        assert said.endswith("'; give samples per second\n")

    def test_bytes_of_a_file_name_that_are_no_text(self):
        assert printable(b"a\xff".decode(errors="surrogateescape")) == r"a\udcff"


def everything(text):
    """A report that has a text everywhere."""
    verdict = Verdict("disagrees", text, text)
    column = Column(text, "name", meaning=text, unit=text)
    words = Column("words", "text", form=lambda value: f"{value}{text}")
    return Report(
        text,
        verdict,
        (
            Section(
                "one",
                text,
                (
                    Table(
                        (column, words), (Row((text, 1)), Row((Hover(text, text), verdict))), caption=text, title=text
                    ),
                    Table((column,), (Row((text,)),), caption=text, compact=True),
                    Facts(((text, text),), title=text),
                    Notes((Note(text, text, text),), title=text),
                    Prose(text, title=text),
                    Code(text, title=text),
                    Lines((text,), title=text),
                    CharacterPicture(lambda _: [text], caption=text, title=text),
                    Group((Prose(text),), title=text, key="group"),
                    Plot(np.arange(2.0), text, (Panel(text, (Series(text, np.arange(2.0)),), text),), text, text),
                ),
                verdict,
            ),
        ),
    )


class TestReports:
    @pytest.mark.parametrize("width", [20, 60, 140])
    def test_on_a_terminal(self, width):
        text = as_text(everything(HOSTILE), width)
        assert unseen(text) == []
        assert SHOWN[:8] in text

    def test_lines_of_their_own_would_deceive(self):
        """Code has lines, and cells inside the frames of their tables; the compact table has none."""
        assert re.findall(r"^x\b", as_text(everything("a\nx"), 140), re.MULTILINE) == ["x", "x"]

    def test_on_a_page(self):
        text = page(everything(HOSTILE), ["graphdyn", HOSTILE], {HOSTILE: HOSTILE})
        assert unseen(text) == []
        assert text.count(r"\x1b]0;b") > 20
        HTMLParser().feed(text)

    def test_in_a_picture(self):
        """XML cannot hold control characters at all."""
        drawn = picture("p", HOSTILE, (2, 1), lambda axes: axes.text(0.5, 0.5, HOSTILE.replace("\n", "")))
        assert unseen(drawn) == []
        assert r"\x1b]0;b" in drawn

    def test_letters_that_the_font_of_the_picture_lacks(self):
        """The page has its own fonts: no warning, and the letters stay."""
        assert "工具" in picture("p", "", (2, 1), lambda axes: axes.text(0.5, 0.5, "工具"))


@pytest.fixture
def arm(small_arm, tmp_path):
    text = small_arm.read_text(encoding="utf-8")
    for name in ("upper", "y_elbow", "tool", "small"):
        text = text.replace(f'"{name}"', f'"{name}{IN_XML}"')
    path = tmp_path / FILE
    path.write_text(text, encoding="utf-8")
    small_arm.unlink()
    return path


def leaves(record):
    if isinstance(record, dict | list):
        for item in record.values() if isinstance(record, dict) else record:
            yield from leaves(item)
    elif isinstance(record, str):
        yield record


@pytest.fixture
def clean(program, tmp_path):
    """clean("show", …): what the command says, after a look at every character of its output."""

    def run(*arguments, files=True):
        outputs = (tmp_path / "r.json", tmp_path / "r.html") if files else ()
        done = program(*arguments, *(("--json", outputs[0], "--html", outputs[1]) if files else ()))
        assert done.code != INTERNAL_ERROR, done.err
        for text in (done.out, done.err, *(path.read_text(encoding="utf-8") for path in outputs if path.exists())):
            assert unseen(text) == []
        return done

    return run


class TestCommands:
    """Every command that reads files of others."""

    @pytest.mark.parametrize(
        ("command", "options"),
        [("show", ()), ("inspect", ()), pytest.param("crosscheck", ("--samples", 1), marks=LONG)],
    )
    def test_names(self, clean, arm, tmp_path, command, options):
        done = clean(command, arm, *options)
        assert r"arm\x1b[31m\n\u202e.urdf" in done.out.replace("\n", "") or command == "inspect"
        record = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))
        assert any(FILE in leaf for leaf in leaves(record))  # with the names as they are

    @LONG
    def test_a_folder(self, clean, arm):
        clean("crosscheck", arm.parent, "--samples", 1, "--jobs", 1)

    def test_judged(self, clean, arm, tmp_path, monkeypatch):
        (tmp_path / "own.py").write_text(f"def M(q):\n    raise ValueError({HOSTILE!r})\n", encoding="utf-8")
        monkeypatch.setattr(sys, "path", [*sys.path])
        monkeypatch.setattr(own_process, "tell", lambda _: None)
        done = clean("judge", arm, "--mass-matrix", f"{tmp_path}/own.py:M")
        assert done.code == BAD_INPUT
        assert f"raised ValueError: {SHOWN}" in done.err
        assert done.err.count("\n") == 1

    def test_identified(self, clean, arm, tmp_path):
        clean("identify", "--robot", arm, "--seconds", 2, "--methods", "wls", "--cutoff", 10, "--poses", 1)

    def test_columns_of_a_recording(self, clean, arm, tmp_path):
        log = tmp_path / "log.csv"
        log.write_text(HOSTILE.replace("\r\n", "") + ",b\n1,2\n3,4\n", encoding="utf-8")
        done = clean("identify", log, "--robot", arm)
        assert done.code == BAD_INPUT
        assert r"\x1b]0;b" in done.err

    @pytest.mark.parametrize(
        "arguments",
        [
            ("crosscheck", HOSTILE),
            ("crosscheck", "kr500", "--lock", f"{HOSTILE}={HOSTILE}"),
            ("crosscheck", "kr500", f"--{HOSTILE}"),
            ("show", "kr500", "--json", f"no/{HOSTILE}/r.json"),
            ("judge", "ur5", "--mass-matrix", f"{HOSTILE}.py:{HOSTILE}"),
            (HOSTILE,),
            (f"--{HOSTILE}",),
        ],
    )
    def test_what_was_typed(self, clean, arguments, monkeypatch):
        monkeypatch.setattr(own_process, "tell", lambda _: None)
        done = clean(*arguments, files=False)
        assert done.code == BAD_INPUT
        assert r"\x1b]0;b" in done.err

    def test_an_error_of_the_program(self, program, monkeypatch):
        def broken(*_arguments, **_options):
            raise ZeroDivisionError(HOSTILE)

        monkeypatch.setattr(urdf, "load", broken)
        done = program("--debug", "show", "kr500")
        assert done.code == INTERNAL_ERROR
        assert unseen(done.err) == []
        assert done.err.splitlines()[-1].startswith(r"internal error: ZeroDivisionError: a\x1b]0;b")

    def test_warnings(self, capsys):
        console.warn(UserWarning(HOSTILE))
        assert capsys.readouterr().err == f"warning: {SHOWN}\n"

    @pytest.mark.parametrize("terminal", [True, False])
    def test_progress(self, capsys, monkeypatch, terminal):
        monkeypatch.setattr(console, "PROGRESS_INTERVAL", 0.0)
        if terminal:
            monkeypatch.setenv("FORCE_COLOR", "1")
            monkeypatch.setattr(console.err, "is_interactive", True)
        with console.progress(HOSTILE, 1) as advance:
            advance(HOSTILE, 1)
        said = capsys.readouterr().err
        assert SHOWN in said
        assert "\u202e" not in said

    def test_codes_of_emoji_are_names(self, capsys):
        console.say("/tmp/:x:/[red]arm.urdf")
        assert capsys.readouterr().err == "/tmp/:x:/[red]arm.urdf\n"


class TestEncodings:
    @pytest.mark.parametrize(
        ("text", "ascii"),
        [
            ("‖τ‖ ≤ 10⁻³ N m", "|tau| <= 10-3 N m"),
            ("q̈, Ṁ − 2C, Σ, ά", "q, M - 2C, Sigma, alpha"),
            ("a … b → c · d × e", "a ... b -> c * d * e"),
            ("ärm, 工具", r"arm, \u5de5\u5177"),
            ("✓ ✗ –", "+ x -"),
        ],
    )
    def test_spelled(self, text, ascii):
        assert spelled(text) == ascii

    @pytest.mark.parametrize(
        ("encoding", "command"),
        [
            pytest.param("ascii", ("show", "kr500"), marks=LONG),
            ("ascii", ("show", "τ")),
            ("latin-1", ("judge", "--help")),
            pytest.param("cp1252", ("judge", "--help"), marks=LONG),
            pytest.param("ascii", ("inspect", "kr500"), marks=LONG),
            pytest.param("latin-1", ("show", "kr500"), marks=LONG),
            pytest.param("latin-1", ("show", "τ"), marks=LONG),
        ],
    )
    def test_of_the_terminal(self, script, encoding, command):
        done = script(*command, env={"PYTHONIOENCODING": encoding, "PYTHONUTF8": "0"}, encoding=encoding)
        assert done.code == (BAD_INPUT if "τ" in command else AGREED)
        assert "internal error" not in done.err
        assert "tau" in done.out + done.err or "kr500" in command

    def test_json_is_always_utf_8(self, script):
        done = script("robots", "--json", "-", env={"PYTHONIOENCODING": "ascii"})
        assert json.loads(done.out)["robots"]

    def test_streams_of_utf_8_are_left_alone(self, program):
        assert re.search("[│┃]", program("robots").out)
