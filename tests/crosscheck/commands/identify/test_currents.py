"""`graphdyn identify --currents`: gains are found, stated, and convert the log; what nothing fixes is refused."""

import json

import numpy as np
import pytest
from identified.loaded_arm import WEIGHED, LoadedArm, currents, random_gains, robot, write_log
from jsonschema import Draft202012Validator
from shared_data import REPOSITORY

from crosscheck.commands.program.exits import AGREED, BAD_INPUT

SCHEMA = json.loads((REPOSITORY / "docs/schemas/identify-3.schema.json").read_text(encoding="utf-8"))
JOINTS = robot().independent_joints

FOUR_SIGMA = 4.0
"""Standard deviations within which all of six gains of a fixed seed are."""


@pytest.fixture(scope="module")
def gains():
    return random_gains(np.random.default_rng(3), 6)


@pytest.fixture(scope="module")
def folder(tmp_path_factory, gains):
    """Logs of currents: empty.csv, weight.csv, and reversed.csv, whose third column has the other sign."""
    place, rng = tmp_path_factory.mktemp("logs"), np.random.default_rng(1)
    arm = LoadedArm.of(robot(), rng)
    signs = np.where(np.arange(6) == 2, -1.0, 1.0)
    for name, load, sign in (("empty", None, 1.0), ("weight", WEIGHED, 1.0), ("reversed", None, signs)):
        samples = currents(arm.motion(rng, 20.0, load), sign * gains, rng)
        write_log(place / f"{name}.csv", samples, JOINTS, "current_{} [A]")
    return place


@pytest.fixture
def run(program, folder, monkeypatch):
    monkeypatch.chdir(folder)
    options = ("--robot", "ur5", "--cutoff", 8, "--methods", "wls", "--terms", "viscous,coulomb,offset", "--poses", 20)
    return lambda *arguments: program("identify", *arguments, *options)


@pytest.mark.usefixtures("unexamined", "unpictured")
def test_a_known_load(run, folder, gains):
    """Gains with deviations in the report, the page, the JSON file and the file of gains; torques are identified."""
    done = run(
        *("empty.csv", "--currents", "payload=4:weight.csv", "--write-gains", "gains.toml"),
        *("--json", "i.json", "--html", "i.html"),
    )
    assert done.code == AGREED, f"{done.err}{done.out}"
    assert "Gains: torque per unit of the recorded column" in done.out
    assert "from a load of 4 kg" in done.out
    record = json.loads((folder / "i.json").read_text(encoding="utf-8"))
    Draft202012Validator(SCHEMA).validate(record)
    found = record["currents"]
    off = np.array(found["gains"]["values"]) - gains
    assert (np.abs(off) < FOUR_SIGMA * np.array(found["gains"]["deviations"])).all()
    assert found["recordings"] == ["empty.csv", "weight.csv"]
    assert len(found["base_deviations"]) == record["rank"]
    assert min(found["base_deviations"]) > 0
    assert "What the gains add to the base parameters" in (folder / "i.html").read_text(encoding="utf-8")
    assert 'recordings = ["empty.csv", "weight.csv"]' in (folder / "gains.toml").read_text(encoding="utf-8")
    torque = record["comparison"][0]
    assert torque["mean_error"] < 0.1


@pytest.mark.usefixtures("unexamined")
def test_gravity_fixes_five_of_six_gains(run, folder):
    """The sixth is refused with a remedy, which works."""
    refused = run("empty.csv", "--currents", "cad")
    assert refused.code == BAD_INPUT
    message = " ".join(refused.err.split())
    assert "nothing fixes the gain of wrist_3_joint: not gravity of the links of the file, within 5 %" in message
    assert 'in a file with joints = ["wrist_3_joint"]' in message
    text = 'joints = ["wrist_3_joint"]\ngains = [9.0]\nrelative_deviations = [0.5]\n'
    (folder / "last.toml").write_text(text, encoding="utf-8")
    done = run("empty.csv", "--currents", "cad", "--currents", "last.toml")
    assert done.code == AGREED, f"{done.err}{done.out}"


@pytest.mark.long
def test_gains_of_the_same_recording(run, folder, gains):
    values = ", ".join(map(str, gains))
    text = f"joints = {json.dumps(JOINTS)}\ngains = [{values}]\nrelative_deviations = [{', '.join(['0.03'] * 6)}]\n"
    (folder / "same.toml").write_text(f'{text}recordings = ["empty.csv"]\n', encoding="utf-8")
    done = run("empty.csv", "--currents", "same.toml")
    assert done.code == AGREED, f"{done.err}{done.out}"
    assert "same.toml: a recording called empty.csv gave these gains" in " ".join(done.err.split())


def test_a_reversed_current(run, gains):
    done = run("reversed.csv", "--currents", ",".join(map(str, gains)))
    assert done.code == BAD_INPUT
    message = "the current of elbow_joint runs against the torque: reverse its sign in the mapping"
    assert message in " ".join(done.err.split())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["empty.csv", "--currents", "CAD"], "--currents CAD: give cad, payload=M:LOADED"),
        (["empty.csv", "--currents", "cad", "--currents", "cad"], "--currents cad: there are two of this kind"),
        (["empty.csv", "--currents", "payload=4"], "--currents payload=4: give payload=M:LOADED"),
        (["empty.csv", "--currents", "payload=4@0,0:weight.csv"], "give payload=M:LOADED or payload=M@X,Y,Z:LOADED"),
        (
            ["empty.csv", "--currents", "payload=0:weight.csv"],
            "the mass of the known load is 0 kg; give one above zero",
        ),
        (["empty.csv", "--currents", "1,2"], "one number above zero, or one for each of 6 joints"),
        (["empty.csv", "--currents", "cad", "--currents-error", 3], "--currents-error 3: give a relative deviation"),
        (["empty.csv", "--currents-error", 0.1], "--currents-error is for --currents; give it too"),
        (["empty.csv", "--write-gains", "g.toml"], "--write-gains is for --currents; give it too"),
        (["--currents", "cad"], "--currents needs a LOG; without one the robot is simulated"),
        (["empty.csv", "--currents", "cad", "--jobs", 1], "--currents needs the recording in memory"),
        (["empty.csv", "--currents", "cad", "--known-torque", "x.py:f"], "--known-torque is in N m, which --currents"),
    ],
)
def test_bad_input(run, arguments, message):
    done = run(*arguments)
    assert done.code == BAD_INPUT
    assert message in " ".join(done.err.split())
