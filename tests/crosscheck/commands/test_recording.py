"""`graphdyn recording`: exit codes, the mapping that is written, page, JSON file; and commands that print it."""

import json
import re
import shlex

import numpy as np
import pytest
from identified.small_study import ARM
from jsonschema import Draft202012Validator
from shared_data import REPOSITORY

from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED

SCHEMA = json.loads((REPOSITORY / "docs/schemas/recording-1.schema.json").read_text(encoding="utf-8"))


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """A robot, a log with two clocks that agree, and one whose torques are currents."""
    (tmp_path / "small.urdf").write_text(ARM, encoding="utf-8")
    t = np.arange(0, 4, 0.01)
    q = np.column_stack([np.sin(2 * t), 2 * np.cos(1.5 * t)])
    columns = np.column_stack([t, t, q, np.cos(q)])
    for name, effort in (("log.csv", "tau_{}_Nm"), ("currents.csv", "current_{}")):
        head = ["stamp_s", "bag_t_s", "q_1_rad", "q_2_rad", effort.format(1), effort.format(2)]
        np.savetxt(tmp_path / name, columns, header=",".join(head), comments="", delimiter=",")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def axes(folder):
    """The log as a controller in German writes it: axes, degrees, semicolons and decimal commas."""
    table = np.loadtxt("log.csv", delimiter=",", skiprows=1)
    head = ["Zeit [s]", "A1 Ist [Grad]", "A2 Ist [Grad]", "A1 Moment [Nm]", "A2 Moment [Nm]"]
    columns = np.column_stack([table[:, 0], np.degrees(table[:, 2:4]), table[:, 4:]])
    rows = [";".join(f"{x:.5f}".replace(".", ",") for x in row) for row in columns]
    (folder / "axes.csv").write_text("\n".join([";".join(head), *rows, ""]), encoding="utf-8")


@pytest.mark.usefixtures("axes")
def test_what_is_printed_leads_to_a_mapping(program, folder):
    """The option for what is not recognized, then the command that writes the mapping, then the one that reads it."""
    told = program("recording", "axes.csv", "--robot", "small.urdf")
    assert told.code == DISAGREED
    option, value = shlex.split(re.search(r"--take 'q=[^']*'", told.out)[0])
    assert value == "q=A* Ist [Grad]"
    said = program("recording", "axes.csv", "--robot", "small.urdf", option, value, "--unit", "q=deg")
    assert said.code == AGREED
    writing, reading = (shlex.split(line)[1:] for line in said.out.splitlines() if line.startswith("graphdyn "))
    assert not (folder / "columns.toml").exists()
    assert program(*writing).code == AGREED
    assert (folder / "columns.toml").is_file()
    assert reading == ["identify", "axes.csv", "--robot", "small.urdf", "--mapping", "columns.toml"]
    used = program(*reading, "--cutoff", "8", "--methods", "wls", "--folds", "1000")  # read, then refused
    assert "mapping" not in used.err


@pytest.mark.usefixtures("unexamined")
def test_identify_prints_the_command_that_helps(program, folder):
    stopped = program("identify", "log.csv", "--robot", "small.urdf", "--lock", "elbow=0.1")
    assert stopped.code == BAD_INPUT
    printed = re.search(r"`graphdyn (.*?)` shows what is recognized, and writes one", stopped.err)[1]
    assert printed == "recording log.csv --robot small.urdf --lock elbow=0.1 --write-mapping columns.toml"
    assert (
        f"`graphdyn {printed}`".replace(" --lock elbow=0.1", "")
        in program("view", "small.urdf", "--play", "log.csv").err
    )
    stopped = program("identify", "log.csv", "--robot", "small.urdf")
    printed = shlex.split(re.search(r"`graphdyn (.*?)`", stopped.err)[1])
    done = program(*printed)
    assert done.code == AGREED, done.err
    assert (folder / "columns.toml").is_file()
    following = done.out[done.out.index("graphdyn identify") :].splitlines()[0].split()
    assert following[1:] == ["identify", "log.csv", "--robot", "small.urdf", "--mapping", "columns.toml"]
    used = program(*following[1:], "--cutoff", "8", "--methods", "wls", "--folds", "1000")  # read, then refused
    assert "mapping" not in used.err


def test_identify_prints_the_command_where_no_torque_is_recognized(program, folder):
    table = np.loadtxt("log.csv", delimiter=",", skiprows=1)[:, [0, 2, 3, 4, 5]]
    for name, columns in (("motion.csv", ""), ("currents.csv", ",current_1,current_2")):
        head = f"stamp_s,q_1_rad,q_2_rad{columns}"
        np.savetxt(name, table[:, : head.count(",") + 1], header=head, comments="", delimiter=",")
    stopped = program("identify", "currents.csv", "--robot", "small.urdf")
    assert stopped.code == BAD_INPUT
    assert "currents.csv: currents instead of torques (current_1, current_2); `graphdyn recording" in stopped.err
    stopped = program("identify", "motion.csv", "--robot", "small.urdf")
    assert "motion.csv: no columns are recognized as torques; `graphdyn recording motion.csv" in stopped.err


@pytest.mark.usefixtures("unpictured")
def test_what_is_left_to_be_said(program, folder):
    done = program("recording", "currents.csv", "--robot", "small.urdf", "--write-mapping", "m.toml",
                   "--json", "r.json", "--html", "r.html")  # fmt: skip
    assert done.code == DISAGREED
    assert "currents.csv: not yet\n400 rows; left to be said: tau." in done.out
    assert "--gain G,G or --unit 'tau=N m'" in done.out.replace("\n", " ")
    text = (folder / "m.toml").read_text(encoding="utf-8")
    assert "# STILL TO BE SAID: these are currents: their gains [N m/A at the joints] are not known" in text
    record = json.loads((folder / "r.json").read_text(encoding="utf-8"))
    Draft202012Validator(SCHEMA).validate(record)
    assert record["mapping"] == text
    assert [choice["quantity"] for choice in record["open"]] == ["tau"]
    assert "current_*" in (folder / "r.html").read_text(encoding="utf-8")
    assert program("recording", "currents.csv", "--robot", "small.urdf", "--gain", "2,3").code == AGREED


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--unit", "q"), "--unit q: give QUANTITY=…, with one of time, q, v, tau"),
        (("--rate", "0"), "--rate 0: give Hz above zero"),
        (("--gain", "1,2,3"), "gain has 3 numbers, the robot 2 joints"),
    ],
)
def test_refusals(program, folder, arguments, message):
    done = program("recording", "log.csv", "--robot", "small.urdf", *arguments)
    assert done.code == BAD_INPUT
    assert message in done.err
