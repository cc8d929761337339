"""`graphdyn payload`: the terminal, the JSON file, the page, the file of gains, and bad input."""

import json
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from identified.loaded_arm import WANTED, WEIGHED, LoadedArm, currents, random_gains, robot, write_log
from jsonschema import Draft202012Validator
from shared_data import REPOSITORY

from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.identifying.data_quality.data_quality import QualityFinding

SCHEMA = json.loads((REPOSITORY / "docs/schemas/payload-1.schema.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Logs of currents."""
    place, rng = tmp_path_factory.mktemp("logs"), np.random.default_rng(1)
    arm, gains = LoadedArm.of(robot(), rng), random_gains(rng, 6)
    joints = robot().independent_joints
    for name, load in (("empty", None), ("weight", WEIGHED), ("load", WANTED)):
        write_log(place / f"{name}.csv", currents(arm.motion(rng, 20.0, load), gains, rng), joints)
    return place


@pytest.fixture
def run(program, folder, monkeypatch):
    monkeypatch.chdir(folder)
    return lambda *arguments: program("payload", *arguments, "--robot", "ur5", "--cutoff", 8)


@pytest.mark.usefixtures("unpictured")
def test_gains_and_then_a_load(run, folder):
    first = run("empty.csv", "weight.csv", "--mass", 4, "--write-gains", "gains.toml")
    assert first.code == AGREED, first.err
    assert "Payload of ur5: 6 of 6 gains" in first.out
    done = run("empty.csv", "load.csv", "--gains", "gains.toml", "--json", "p.json", "--html", "p.html")
    assert done.code == AGREED, f"{done.err}{done.out}"
    record = json.loads((folder / "p.json").read_text(encoding="utf-8"))
    Draft202012Validator(SCHEMA).validate(record)
    mass, sigma = record["load"]["mass"], record["load"]["mass_deviation"]
    assert abs(mass - WANTED[0]) < 3 * sigma
    assert f"Payload of ur5: {mass:.4g} ± {sigma:.2g} kg" in done.out
    assert f"{mass:.4g} ± {sigma:.2g} kg" in (folder / "p.html").read_text(encoding="utf-8")
    assert record["recordings"] == ["empty.csv", "load.csv"]


def check_currents_without_gains(run):
    done = run("empty.csv", "load.csv")
    assert done.code == DISAGREED
    assert "the columns may be currents" in " ".join(done.out.split())


@pytest.mark.long
def test_currents_without_gains(run):
    check_currents_without_gains(run)


def test_units_that_the_data_quality_tells_are_said_by_the_gains(run, monkeypatch):
    unit = QualityFinding("torque-unit", "fault", (), "the torques are 10 times too large", "check the unit")
    told = SimpleNamespace(faults=(unit,))
    monkeypatch.setattr("crosscheck.identifying.payload.fitted_currents.data_quality", lambda *_: told)
    check_currents_without_gains(run)
    other = replace(unit, code="exchanged-torques", message="the torques of two joints are exchanged")
    told.faults = (unit, other)
    done = run("empty.csv", "load.csv")
    assert done.code == DISAGREED
    assert "the torques of two joints are exchanged" in " ".join(done.out.split())
    assert "10 times too large" not in " ".join(done.out.split())


def test_trusted_links(run):
    done = run("empty.csv", "load.csv", "--trust", 0.05)
    assert done.code == AGREED, f"{done.err}{done.out}"
    assert "gravity of the links of the file, within 5 %" in " ".join(done.out.split())


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["empty.csv"], "EMPTY LOADED: 1 recordings are given; give two"),
        (["empty.csv", "load.csv", "--center", "0,0,0.1"], "--center 0,0,0.1: say with --mass how heavy this load is"),
        (["empty.csv", "load.csv", "--mass", 4, "--center", "0,0"], "--center 0,0: give three numbers, X,Y,Z [m]"),
        (["empty.csv", "load.csv", "--calibration", "weight.csv"], "--calibration weight.csv: say with --mass"),
        (["empty.csv", "load.csv", "--gains-error", 0.1], "is the error of --gains; give them too"),
        (["empty.csv", "load.csv", "--gains", "1,2"], "one number above zero, or one for each of 6 joints"),
        (["empty.csv", "load.csv", "--gains", 9, "--gains-error", 2], "--gains-error 2: give a relative deviation"),
        (["empty.csv", "load.csv", "--gains", "g.toml", "--gains-error", 0.1], "the file has deviations of its own"),
        (["empty.csv", "load.csv", "--gains", "gone.toml"], "gone.toml: "),
        (["empty.csv", "load.csv", "--payload-on", "hand"], "hand"),
    ],
)
def test_bad_input(run, arguments, message):
    done = run(*arguments)
    assert done.code == BAD_INPUT
    assert message in " ".join(done.err.split())
