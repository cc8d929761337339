"""`graphdyn repair`: lists, mends, tells, and the commands that are printed."""

import json
import re
import shlex
from pathlib import Path

import pytest
from inspected.sample import changed
from jsonschema import Draft202012Validator
from mutants.mutant import mutant
from shared_data import REPOSITORY

import urdf
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.commands.program.repair_commands import TAKEN

SCHEMA = json.loads((REPOSITORY / "docs/schemas/repair-1.schema.json").read_text(encoding="utf-8"))
CROSSED = ('lower="-1" upper="2"', 'lower="2" upper="-1"')


@pytest.fixture
def crossed(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "my arm.urdf"
    path.write_text(changed(*CROSSED), encoding="utf-8")
    return path


def printed_command(text):
    """The words behind `graphdyn` of the command that is printed."""
    return shlex.split(re.search(r"graphdyn (repair .*? --out \S+)", " ".join(text.split()))[1])


@pytest.mark.parametrize("asked", ["crosscheck", "show", "view"])
def test_a_command_that_refuses_a_file_prints_what_mends_it(program, crossed, asked):
    refused = program(asked, crossed.name)
    assert refused.code == BAD_INPUT
    error, mended = refused.err.splitlines()
    assert error.startswith("error: my arm.urdf:")
    assert program(*printed_command(mended)).code == AGREED
    assert urdf.inspect("repaired.urdf").usable


def test_what_no_repair_mends_is_the_error_alone(program, tmp_path):
    path = tmp_path / "arm.urdf"
    path.write_text(changed('<mass value="2.5"/>', '<mass value="-2"/>'), encoding="utf-8")
    refused = program("show", path)
    assert refused.code == BAD_INPUT
    assert len(refused.err.splitlines()) == 1


def test_no_command_is_told_for_a_file_that_cannot_be_edited(program, crossed):
    """Such as one in UTF-16, which is read."""
    crossed.write_text(changed('rpy="0 0 0"', 'rpy="1.5708 0 0"'), encoding="utf-16")
    assert "graphdyn repair" not in program("inspect", crossed.name).out
    refused = program("repair", crossed.name, "--list")
    assert (refused.code, "save it as UTF-8 first" in refused.err) == (BAD_INPUT, True)


@pytest.mark.parametrize("asked", ["inspect", "repair"])
def test_what_is_printed_can_be_typed_as_it_stands(program, crossed, asked):
    told = program(asked, crossed.name, *["--list"] * (asked == "repair"))
    done = program(*printed_command(told.out))
    assert done.code == AGREED
    assert "1 change, written to repaired.urdf" in done.out
    assert "lower 2 and upper -1 exchanged" in done.out
    assert urdf.inspect("repaired.urdf").usable


def inspected_and_repaired(program, content):
    """Inspect a file and type every command that is told; every code, and how many findings it has left."""
    Path("damaged.urdf").write_bytes(content)
    before = urdf.inspect("damaged.urdf")
    told = program("inspect", "damaged.urdf").out
    for command in dict.fromkeys(re.findall(r"^\s*graphdyn (repair .*)$", told, re.MULTILINE)):
        words = shlex.split(command)
        assert program(*words).code == AGREED
        after = urdf.inspect(words[-1])
        for taken in words[words.index("--take") + 1 : -2 : 2]:
            code = next(code for code, take in TAKEN.items() if take == taken)
            yield code, sum(one.code == code for one in after.findings), before


@pytest.mark.parametrize("seeds", [range(12), pytest.param(range(12, 200), marks=pytest.mark.long)], ids=["12", "200"])
def test_commands_told_of_damaged_files_mend_them(program, tmp_path, monkeypatch, seeds):
    """Typed as they stand: there are fewer findings of this code, or none."""
    monkeypatch.chdir(tmp_path)
    told = [one for k in seeds for one in inspected_and_repaired(program, mutant("urdf", 5, k).content)]
    assert len(told) >= len(seeds) / 4
    for code, left, before in told:
        assert left < sum(one.code == code for one in before.findings), code


def test_json(program, crossed):
    done = program("repair", crossed.name, "--take", "limits-crossed", "--out", "out.urdf", "--json", "x.json")
    record = json.loads((crossed.parent / "x.json").read_text(encoding="utf-8"))
    Draft202012Validator(SCHEMA).validate(record)
    assert (done.code, record["robot"], record["path"]) == (AGREED, "my arm.urdf", "out.urdf")
    assert record["changes"] == list(urdf.repair(crossed, None, ["limits"]).changes)


AMBIGUOUS = (
    'ixx="0.11" ixy="0" ixz="0" iyy="0.13" iyz="0" izz="0.17"',
    'ixx="0.04" ixy="0.01" ixz="0.18" iyy="0.19" iyz="0.01" izz="0.04"',
)

LISTED = """Repairs of my arm.urdf: 1 change possible
Nothing is written

Written by
graphdyn repair 'my arm.urdf' --take limits --out repaired.urdf

--take limits: 1 change
line 23: <limit> of joint 'shoulder': lower 2 and upper -1 exchanged

Doubtful, and left as it is, because it is not clear what is right
line 4: <inertial> of link 'upper': no body has this tensor; it fits with ixx and ixz exchanged or ixz and izz exchanged
"""


def test_what_is_listed(program, crossed):
    """What is sure with the repair that makes it, what is ambiguous in a line; the latter is never taken."""
    text = crossed.read_text(encoding="utf-8").replace(*AMBIGUOUS)
    crossed.write_text(text, encoding="utf-8")
    assert program("repair", crossed.name, "--list").out == LISTED
    crossed.write_text(changed(*AMBIGUOUS), encoding="utf-8")
    unsure = program("repair", crossed.name, "--list")
    assert (unsure.code, unsure.out.splitlines()[:2]) == (
        AGREED,
        ["Repairs of my arm.urdf: no sure change", "1 inertial is doubtful, see below"],
    )
    taken = program("repair", crossed.name, "--take", "indefinite-inertia", "--out", "out.urdf")
    assert (taken.code, (crossed.parent / "out.urdf").exists()) == (DISAGREED, False)


def test_many_changes_of_a_kind_are_cut_in_the_list(program, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    joint = '<joint name="j{}" type="fixed"><parent link="a{}"/><child link="a{}"/><origin rpy="1.5708 0 0"/></joint>'
    chain = "".join(f'<link name="a{k}"/>' + (joint.format(k, k - 1, k) if k else "") for k in range(9))
    moving = '<link name="m"/><joint name="m" type="continuous"><parent link="a8"/><child link="m"/></joint>'
    Path("many.urdf").write_text(f'<robot name="r">{chain}{moving}</robot>', encoding="utf-8")
    told = program("repair", "many.urdf", "--list", "--json", "many.json").out.splitlines()
    assert "--take angles: 8 changes" in told
    assert (sum("1.5708 0 0 made" in line for line in told), told[-1]) == (6, "and 2 more")
    assert len(json.loads(Path("many.json").read_text(encoding="utf-8"))["changes"]) == 8


def test_nothing_to_repair(program, crossed):
    crossed.write_text(changed(), encoding="utf-8")
    done = program("repair", crossed.name, "--list")
    assert (done.code, "nothing to repair" in done.out) == (AGREED, True)
    assert program("repair", crossed.name, "--take", "axis", "--out", "out.urdf").code == DISAGREED
    assert list(crossed.parent.iterdir()) == [crossed]
    assert "graphdyn repair" not in program("inspect", crossed.name).out


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ([], "give --take NAME for each repair, or --list to see what could be repaired"),
        (["--list", "--take", "axis"], "give --take NAME for each repair, or --list"),
        (["--take", "axis"], "--take needs --out FILE, for the repaired copy"),
        (
            ["--take", "x", "--out", "out.urdf"],
            "no repair is called 'x'; known: angles, axis, geoms, inertials",
        ),
        (["--take", "inertials-from-meshes=x", "--out", "o.urdf"], "--take inertials-from-meshes=x: give inertials-"),
    ],
)
def test_bad_input(program, crossed, arguments, message):
    done = program("repair", crossed.name, *arguments)
    assert done.code == BAD_INPUT
    assert message in " ".join(done.err.split())
    assert list(crossed.parent.iterdir()) == [crossed]
