"""docs/museum: its codes without faults are right, the judge says of each bug what the page says."""

import json
import re
import sys

import numpy as np
import pytest
from long_check import few
from shared_data import REPOSITORY

import crosscheck

DOCS = REPOSITORY / "docs"
MUSEUM = DOCS / "museum"
sys.path.append(str(MUSEUM))

import plain_codes as plain  # noqa: E402
import run as museum  # noqa: E402

PAGE = (DOCS / "museum.md").read_text(encoding="utf-8")
ROWS = re.findall(r"^\| (.*) \| .* \| (\d{4}) \| .* \| ([\w, ]+) \|$", PAGE, re.MULTILINE)
EVERY_DAY = ("inertial rotation lost", "model cached for ever", "spatial for classical acceleration")


@pytest.mark.filterwarnings("ignore::urdf.AxisNotNormalizedWarning")
def test_the_codes_of_the_museum_are_right():
    arm = plain.Reader().arm(MUSEUM / "arm.urdf")
    tool = plain.rotation_of_rpy(0, 0.4, 0), np.array([0.02, 0, 0.12])
    spatial, places = plain.Spatial(arm), plain.Kinematics(arm, tool)
    judgment = crosscheck.judge(
        str(MUSEUM / "arm.urdf"),
        samples=3,
        frame="tool",
        inverse_dynamics=plain.NewtonEuler(arm).inverse_dynamics,
        gravity_torque=plain.NewtonEuler(arm).gravity_torque,
        bias_torque=lambda q, v: spatial.inverse_dynamics(q, v, 0 * v),
        mass_matrix=spatial.mass_matrix,
        coriolis_matrix=spatial.coriolis_matrix,
        frame_placement=places.frame_placement,
        frame_jacobian=places.frame_jacobian,
        frame_acceleration=places.frame_acceleration,
        center_of_mass=places.center_of_mass,
        potential_energy=places.potential_energy,
        kinetic_energy=places.kinetic_energy,
    )
    assert all(function.agrees for function in judgment.functions.values())


def test_the_page_shows_every_exhibit_with_its_threads():
    assert [row[0].removesuffix(" †") for row in ROWS] == [
        x.story for hall in museum.HALLS for x in museum.in_hall(hall)
    ]
    assert len(ROWS) == len(museum.EXHIBITS) >= 40
    assert len({x.name for x in museum.EXHIBITS}) == len(ROWS)
    for link in (link for x in museum.EXHIBITS for link in x.links):
        assert re.fullmatch(r"https://github.com/[\w.-]+/[\w.-]+/(issues|pull)/\d+", link)
        assert f"({link})" in PAGE
    counts = {outcome: sum(row[2].split(", ")[-1] == outcome for row in ROWS) for outcome in museum.OUTCOMES}
    assert f"{len(ROWS)} bugs of " in PAGE
    assert ", ".join(f"{counts[outcome]} {outcome}" for outcome in museum.OUTCOMES) in PAGE


@pytest.mark.parametrize("name", few([x.name for x in museum.EXHIBITS], *EVERY_DAY))
def test_the_judge_says_of_each_bug_what_the_page_says(name):
    (known,) = (x for x in museum.EXHIBITS if x.name == name)
    (outcomes,) = (row[2] for row in ROWS if row[0].removesuffix(" †") == known.story)
    found = {museum.shown(known, robot, samples=100)["outcome"] for robot in known.robots}
    assert found == set(outcomes.split(", "))


def test_outcomes():
    def claim(message, status="confirmed", also=(), kind="frame"):
        return {"kind": kind, "status": status, "message": message, "also": list(also)}

    truth = ("axis",)
    assert museum.outcome(truth, True, []) == "missed"
    assert museum.outcome(truth, False, [claim("the axis")]) == "named"
    assert museum.outcome(truth, False, [claim("the mass", also=["the axis"])]) == "candidates"
    assert museum.outcome(truth, False, [claim("the axis"), claim("the mass")]) == "candidates"
    assert museum.outcome(truth, False, [claim("the mass")]) == "WRONG"
    assert museum.outcome(truth, False, [claim("axis somewhere", "unknown", kind="unknown")]) == "unnamed"
    assert museum.outcome(truth, False, [claim("only where the axis", "located", kind="region")]) == "named"


def test_the_command_writes_verdicts_and_the_page(tmp_path, monkeypatch, capsys):
    verdicts, page = tmp_path / "museum.json", tmp_path / "museum.md"
    monkeypatch.setattr(sys, "argv", ["run.py", "--only", "angular rows", "--samples", "5", "--json", str(verdicts)])
    assert museum.main() == 0
    assert "1 bugs of 1 libraries and robots: 1 named" in capsys.readouterr().out
    (row,) = json.loads(verdicts.read_text())["rows"]
    assert row["outcome"] == "named"
    rows = [row | {"exhibit": x.name, "robot": robot} for x in museum.EXHIBITS for robot in x.robots]
    verdicts.write_text(json.dumps({"rows": rows}))
    page.write_text(PAGE, encoding="utf-8")
    monkeypatch.setattr(sys, "argv", ["run.py", "--verdicts", str(verdicts), "--page", str(page)])
    assert museum.main() == 0
    written = page.read_text(encoding="utf-8")
    assert len(written.splitlines()) == len(PAGE.splitlines())
    assert f"{len(museum.EXHIBITS)} named" in written
    monkeypatch.setattr(sys, "argv", ["run.py", "--only", "no such bug"])
    with pytest.raises(SystemExit):
        museum.main()
