"""Settings classes as options: every command that reads a robot has the same ones, in groups."""

import dataclasses
import json
import re

import pytest
import typer

from crosscheck.commands.application import COMMANDS
from crosscheck.commands.program.reading_options import ReadingOptions
from crosscheck.commands.program.settings import as_command

READING = ("--lock", "--chain", "--gravity", "--mimic", "--loops", "--repair", "--xacro", "--xacro-package")
READERS = [
    *("crosscheck", "judge", "questions", "show", "view", "export", "vectors", "inspect", "identify", "simulate"),
    *("recording", "excite", "bench"),
]


def groups(help_text):
    """Options by the heading under which --help shows them."""
    found, heading = {}, None
    for line in help_text.splitlines():
        if re.match(r"\S.*:$", line):
            heading = line.rstrip(":")
        elif heading and (option := re.match(r"  (?:-\w, )?(--[\w-]+)", line)):
            found.setdefault(heading, []).append(option.group(1))
    return found


@pytest.mark.parametrize("command", READERS)
def test_every_command_reads_a_robot_alike(program, command):
    assert tuple(groups(program(command, "--help").out)["Reading the robot"]) == READING


@pytest.mark.parametrize("command", [name for _, name, _ in COMMANDS])
def test_few_options_come_first(program, command):
    found = groups(program(command, "--help").out)
    assert len(found["Options"]) <= 8  # with --help
    if sum(map(len, found.values())) > 24:
        assert next(iter(found)) == "Options"
        assert len(found["Options"]) <= 6


def test_a_repair_that_a_message_names(program, small_arm):
    small_arm.write_text(
        small_arm.read_text().replace('lower="-1" upper="2"', 'lower="2" upper="-1"'), encoding="utf-8"
    )
    refused = program("show", small_arm)
    assert refused.code == 2
    assert "--repair limits" in refused.err
    assert program("show", small_arm, "--repair", "limits").code == 0


def test_gravity_and_chain_of_any_command(program, small_arm, tmp_path):
    out = tmp_path / "r.json"
    done = program("show", small_arm, "--chain", "base", "fore", "--gravity", 0, 0, -1.62, "--json", out)
    assert done.code == 0
    record = json.loads(out.read_text(encoding="utf-8"))
    assert [joint["name"] for joint in record["joints"]] == ["z_shoulder", "y_elbow"]
    assert record["gravity"] == [0, 0, -1.62]


@pytest.mark.parametrize(
    ("text", "repair"),
    [
        ("inertials-from-meshes=2700", {"density": 2700.0, "total_mass": None, "links": "missing"}),
        ("inertials-from-meshes=20kg,all", {"density": None, "total_mass": 20.0, "links": "all"}),
        ("inertials-from-meshes=5,hand,finger", {"density": 5.0, "total_mass": None, "links": ["hand", "finger"]}),
    ],
)
def test_inertials_from_meshes(text, repair):
    (found,) = ReadingOptions(repair=[text]).reading.repair
    assert vars(found) == repair


@pytest.mark.parametrize(
    ("option", "value", "message"),
    [
        ("repair", "inertials-from-meshes=heavy", "give inertials-from-meshes=2700 for a density"),
        ("xacro", "prefix", "--xacro prefix: give NAME=VALUE"),
        ("lock", "elbow=soft", "'soft' is not a number"),
    ],
)
def test_other_texts(option, value, message):
    with pytest.raises(typer.BadParameter, match=message):
        _ = ReadingOptions(**{option: [value]}).reading


def test_xacro_and_loops():
    options = ReadingOptions(xacro=["prefix=left_"], xacro_package=["arms=/opt/arms"], loops="none")
    assert options.reading.xacro.arguments == {"prefix": "left_"}
    assert options.reading.xacro.packages == {"arms": "/opt/arms"}
    assert options.reading.loops == ()


def test_the_function_has_a_parameter_for_each_field():
    seen = []

    def run(options: ReadingOptions) -> None:
        seen.append(options)

    names = [field.name for field in dataclasses.fields(ReadingOptions)]
    as_command(run)(**dict.fromkeys(names) | {"lock": ["a"], "mimic": "locked"})
    assert seen[0].reading.stated == ("lock", "mimic")
