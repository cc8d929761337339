"""What loading warns of stands on the terminal, above all else on every page, unfolded, and in the JSON file."""

import json
import re

import pytest
from lxml import html

from crosscheck.commands.program.delivery import deliver
from crosscheck.commands.program.exits import AGREED
from crosscheck.commands.program.options import ReportOptions
from crosscheck.commands.program.output_files import OutputFile
from crosscheck.report.report import Report

AXIS = "axis not of unit length, normalized: joint 'swing' (2)"
NO_MASS = "moving links of mass zero: 'bob'; they have no weight"
NO_INERTIAL = "moving links without <inertial>: 'bob'; their mass is zero and forward dynamics are not determined"


@pytest.fixture
def odd(pendulum):
    """odd("old", "new"): a pendulum with another part."""

    def odd(*change):
        text = pendulum.read_text(encoding="utf-8")
        assert re.search(change[0], text)
        pendulum.write_text(re.sub(*change, text, count=1, flags=re.DOTALL), encoding="utf-8")
        return pendulum

    return odd


def shown(file, place):
    """The warnings of a page, and whether any of them is in something that is closed."""
    root = html.fromstring(file.read_text(encoding="utf-8"))
    items = root.xpath(f"{place}/li")
    assert not any(item.xpath("ancestor::details") for item in items)
    return [" ".join(item.text_content().split()) for item in items]


CHANGES = (
    (('<axis xyz="0 1 0"/>', '<axis xyz="0 2 0"/>'), AXIS),
    (("<inertial>.*?</inertial>", ""), NO_INERTIAL),
    (('<mass value="[^"]*"/>', '<mass value="0"/>'), NO_MASS),
)


@pytest.mark.usefixtures("unpictured")
@pytest.mark.parametrize(
    ("command", "change", "said"),
    [
        *((("show",), *change) for change in CHANGES),
        (("view",), *CHANGES[0]),
        (("crosscheck", "--samples", 1), *CHANGES[1]),
    ],
)
def test_pages(program, odd, tmp_path, command, change, said):
    path, file = odd(*change), tmp_path / "page.html"
    done = program(command[0], path, *command[1:], "--html", file)
    assert done.code == AGREED
    assert f"warning: {path}: {said}" in " ".join(done.err.split())
    place = '//ul[@id="warnings"]' if command == ("view",) else '//header/ul[@class="warnings"]'
    found = shown(file, place)
    assert [text.removeprefix("warning ") for text in found] == [f"{path}: {said}"]


@pytest.mark.parametrize(
    "command",
    [
        ("show", "--json"), ("crosscheck", "--samples", 1, "--json"), ("simulate", "--duration", 0.01, "--json"),
        ("export", "--to"), ("questions", "--for", "inverse_dynamics", "--out"),
    ],
)  # fmt: skip
def test_json(program, odd, tmp_path, command):
    path, file = odd('<axis xyz="0 1 0"/>', '<axis xyz="0 2 0"/>'), tmp_path / "record.json"
    assert program(command[0], path, *command[1:], file).code == AGREED
    assert json.loads(file.read_text(encoding="utf-8"))["warnings"] == [f"{path}: {AXIS}"]


@pytest.mark.usefixtures("unpictured")
def test_warnings_of_one_command_are_not_those_of_the_next(program, odd, small_arm, tmp_path):
    file = tmp_path / "page.html"
    assert program("show", odd('<axis xyz="0 1 0"/>', '<axis xyz="0 2 0"/>')).code == AGREED
    assert program("show", small_arm, "--html", file).code == AGREED
    assert shown(file, '//ul[@class="warnings"]') == []


def test_every_command_delivers_them(tmp_path, monkeypatch):
    """A long one too is not folded, and what a hostile file is called is not markup."""
    monkeypatch.setattr("crosscheck.commands.program.delivery.warned", ["<b>" + "long " * 200, "other"])
    deliver(Report("any", None, ()), ReportOptions(html_file=OutputFile(str(tmp_path / "page.html"))))
    first, second = shown(tmp_path / "page.html", '//header/ul[@class="warnings"]')
    assert first.startswith("warning <b>long long")
    assert len(first) > 1000
    assert second == "warning other"
