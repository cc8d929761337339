"""`graphdyn show` of robots with loops: what it says is what the analysis finds."""

import json
from dataclasses import replace

import numpy as np
import pytest
from robots.mechanisms import at, four_bar, rod
from shown.approved import approve_record, approve_report
from typer.testing import CliRunner

import graphdyn
import urdf
from crosscheck.commands import app
from crosscheck.commands.show.description import describe
from crosscheck.commands.show.record import record as record_of
from crosscheck.commands.show.report import show_report
from crosscheck.report.html import page
from crosscheck.report.pictures.stick_figure import pose, pose_text
from crosscheck.report.records.record import plain, versions
from graphdyn import Chord, Coupling, Joint

LINKAGE = four_bar()
NOT_HELD = ("force p", "moment t1", "moment t2")
"""What nothing determines in a linkage in a plane across p."""


def show(*arguments):
    return CliRunner().invoke(app, ["show", *map(str, arguments)])


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    path = tmp_path_factory.mktemp("linkage") / "linkage.urdf"
    urdf.save(LINKAGE.with_gravity((0, 0, -9.81)), path)
    return path


@pytest.fixture(scope="module")
def record():
    return plain(record_of(describe(LINKAGE, "four-bar")))


def test_analysis(record):
    loops = record["loops"]
    counted = ("n_rows", "rank", "usual_rank", "singular", "mobility", "infinitesimal_mobility")
    assert [loops[name] for name in (*counted, "grubler_mobility")] == [20, 17, 17, False, 1, 0, -2]
    (chord,) = loops["chords"]
    assert [chord[name] for name in ("name", "kind", "body_i", "body_j")] == ["closing", "hinge", "coupler", "rocker"]
    assert (chord["xyz_i"], chord["xyz_j"], chord["joints"]) == ([2, 0, 0], [1.5, 0, 0], ["a", "b", "c"])
    assert (loops["incidence"], loops["actuated"]) == ([[0], [1], [-1]], ["a"])
    assert len(loops["self_stresses"]) == 3


def test_undetermined_reactions_are_null_with_the_mask_beside(record):
    loops = record["loops"]
    assert loops["undetermined"] == [f"{name} {part}" for name in ("a", "b", "c", "closing") for part in NOT_HELD]
    assert json.loads(json.dumps(loops, allow_nan=False)) == loops
    for reaction in loops["reactions"]:
        free = [part in NOT_HELD for part in reaction["directions"]]
        assert [value is None for value in reaction["values"]] == free == [not x for x in reaction["determined"]]
    zero = np.zeros(3)
    answer = graphdyn.inverse_dynamics(LINKAGE, loops["q"], zero, zero)
    assert loops["reactions"][1]["values"] == plain(answer.joint_wrenches[1])
    assert loops["reactions"][3]["values"] == plain(answer.chord_multipliers)


def test_chord_rows_stand_after_couplings_in_the_equations():
    """Two driven bars beside the linkage and 15 chord rows: more than the 11 equations of a body."""
    driven = [Joint(f"d{k}", "revolute", 0, at(0.0, 0.0, k), np.array([0.0, 0.0, 1.0])) for k in (1, 2)]
    chords = (*LINKAGE.chords, *(Chord(f"again {k}", "hinge", 2, at(2, 0, 0), 3, at(1.5, 0, 0)) for k in (1, 2)))
    model = replace(
        LINKAGE,
        bodies=(*LINKAGE.bodies, rod("bar 1"), rod("bar 2")),
        joints=(*LINKAGE.joints, *driven),
        couplings=(Coupling("d1", {"a": 1.0}), Coupling("d2", {"a": 2.0})),
        chords=chords,
    )
    system = describe(model, "linkage").system
    assert (system.size, len(system.q)) == (11 * 5 + 2 + 15, 3)
    pattern = system.pattern
    assert np.array_equal(pattern, pattern.T)
    bodies = np.array([[row[6 * k : 6 * k + 6].any() for k in range(5)] for row in pattern])
    assert np.array_equal(bodies[57:], 15 * [[False, True, True, False, False]])  # coupler and rocker
    assert np.array_equal(bodies[55:57], [[True, False, False, True, False], [True, False, False, False, True]])


def test_terminal_and_page(file):
    done = show(file)
    assert (done.exit_code, done.stderr) == (0, "")
    for said in (
        "17 of 20 constraint rows; 3 depend on the others",
        "1; after Grübler and Kutzbach it would be -2",
        "12 of 23 components of the reactions",
        "an empty cell: nothing determines",
        "chord 1  │",
    ):
        assert said in done.stdout
    model = urdf.load(file)
    text = page(show_report(describe(model, "linkage")), ["graphdyn", "show", "linkage"], versions())
    for said in ("A pose that closes the loops", "◇ and c: chords", ">c1<"):
        assert said in text


def test_picture_is_drawn_in_a_closed_pose():
    assert np.abs(LINKAGE.loops.gaps(pose(LINKAGE))).max() < 1e-12
    assert pose_text(LINKAGE) == "A pose that closes the loops"


def test_given_state(file, tmp_path):
    q, v, _ = graphdyn.assemble(LINKAGE, [0.7, 0.0, 1.0], [1.0, 0, 0], [0, 0, 0], hold=["a"])
    state, out = tmp_path / "state.json", tmp_path / "out.json"
    state.write_text(json.dumps({"q": q.tolist(), "v": v.tolist()}))
    assert show(file, "--state", state, "--json", out).exit_code == 0
    found = json.loads(out.read_text())
    assert found["loops"]["q"] == found["state"]["q"] == q.tolist()
    model = urdf.load(file)
    assert found["state"]["bias_torque"] == graphdyn.bias_torque(model, q, v).tolist()


def test_random_state_is_closed(file):
    assert show(file, "--state", "random:3").exit_code == 0


@pytest.mark.parametrize(
    ("state", "said"),
    [
        ("0.7,0,1", r"the loop of chord 'closing' is open by"),
        ("CLOSED;1,0,0", r"the velocity opens the loop of chord 'closing'"),
    ],
)
def test_open_state_is_refused(file, state, said):
    q = ",".join(repr(float(x)) for x in LINKAGE.closed_pose)
    done = show(file, f"--state={state.replace('CLOSED', q)}")
    assert (done.exit_code, done.stdout) == (2, "")
    assert said in " ".join(done.stderr.split())


def test_unknown_motors(tmp_path):
    """The torques at the motors are null, with the reason; what is determined is known all the same."""
    path, out = tmp_path / "linkage.urdf", tmp_path / "out.json"
    urdf.save(replace(LINKAGE, actuated=None).with_gravity((0, 0, -9.81)), path)
    done = show(path, "--state", "random", "--json", out)
    assert done.exit_code == 0
    found = json.loads(out.read_text())
    assert (found["state"]["gravity_torque"], found["state"]["bias_torque"]) == (None, None)
    assert "which joints have motors is not known" in found["loops"]["reactions_missing"]
    assert {value for reaction in found["loops"]["reactions"] for value in reaction["values"]} == {None}
    assert len(found["loops"]["undetermined"]) == 12


def test_a_linkage_that_closes_only_stretched(tmp_path):
    """It is described, with why nothing is known of its reactions."""
    path = tmp_path / "stretched.urdf"
    urdf.save(four_bar(1, 1, 1, 3).with_gravity((0, 0, -9.81)), path)
    told = show(path)
    assert told.exit_code == 0
    assert "0, and 2 infinitesimal" in told.output
    assert "motions of a, b, c keep them closed to first order only" in " ".join(told.output.split())


def test_whole(record):
    approve_record("show_loops", record, without=("versions",))
    approve_report("show_loops", show_report(describe(LINKAGE, "four-bar")))
