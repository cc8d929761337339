"""graphdyn judge: user code by name, exit codes, output."""

import dataclasses
import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
from long_check import few

import urdf
from crosscheck.commands.judge.command import JudgeOptions
from crosscheck.commands.judge.programs import ProgramOptions, user_programs
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.judging.exchange import program as exchanged
from crosscheck.judging.exchange.protocols import PROTOCOLS_BY_NAME


class TestJudge:
    """One robot, functions from elsewhere."""

    def test_right(self, program, my_code):
        done = program("judge", "ur5", "--inverse-dynamics", "my_code.py:rnea", "--samples", 2)
        assert done.code == AGREED
        assert done.out.startswith(
            "Your functions on ur5: agrees\n"
            "Every function gives the same numbers as every reference implementation (graphdyn, "
        )
        assert re.search(r"^robot +ur5: 6 joints", done.out, re.MULTILINE)
        assert "2 random states and special ones, seed 0" in done.out

    def test_wrong(self, program, my_code, tmp_path):
        done = program(
            "judge", "ur5", "--inverse-dynamics", "my_code:upside_down", "--samples", 2, "--json", tmp_path / "x.json"
        )
        assert done.code == DISAGREED
        assert "inverse_dynamics: gravity has the opposite sign [gravity]" in done.out
        record = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
        assert record["format"] == "graphdyn judge 2"
        assert record["diagnoses"][0]["kind"] == "gravity"
        assert record["command"][:3] == ["graphdyn", "judge", "ur5"]

    def test_undecided(self, program, my_code, plant, monkeypatch):
        monkeypatch.setitem(sys.modules, "flint", None)
        plant.pinocchio_value("tau", lambda x: 1.01 * x)
        done = program("judge", "ur5", "--inverse-dynamics", "my_code.py:rnea", "--samples", 2)
        assert done.code == DISAGREED
        assert "UNDECIDED" in done.out
        assert "the reference implementations disagree" in done.out

    def test_all_options(self, program, my_code):
        names = ",".join(urdf.load("ur5").joint_names)
        options = ("--joint-names", names, "--seed", 3, "--tolerance", "1e-12", "--samples", 1)
        assert program("judge", "ur5", "--inverse-dynamics", "my_code.py:rnea", *options).code == AGREED

    def test_lock(self, program, my_code):
        done = program("judge", "ur5", "--inverse-dynamics", "my_code.py:rnea", "--lock", "wrist_3_joint")
        assert done.code == BAD_INPUT  # the user code does not know of the lock
        assert "inverse_dynamics raised" in done.err

    def test_any_function_of_the_table(self, program, my_code, tmp_path):
        """A function of a frame, with a convention; what it follows is on the terminal and in the JSON file."""
        given = ("--function", "frame_jacobian=my_code.py:jacobian", "--frame", "wrist_3_link", "--samples", 3)
        done = program("judge", "ur5", *given, "--json", tmp_path / "x.json")
        assert done.code == AGREED
        assert "Conventions that the answers follow" in done.out
        assert re.search(r"frame_jacobian +reference: local, order: linear first", done.out)
        written = json.loads((tmp_path / "x.json").read_text(encoding="utf-8"))
        assert written["frame"] == "wrist_3_link"
        assert written["functions"]["frame_jacobian"]["conventions"] == {"reference": "local", "order": "linear first"}
        assert program("judge", "ur5", *given, "--convention", "reference=local").code == AGREED
        other = program("judge", "ur5", *given, "--convention", "reference=world")
        assert other.code == DISAGREED
        assert "follow another convention: reference is 'local', not 'world' [convention]" in other.out

    def test_loads_batches_chain_gravity_precision(self, program, my_code):
        loaded = ("--inverse-dynamics", "my_code.py:loaded", "--external-wrenches", "--batched")
        assert program("judge", "ur5", *loaded, "--precision", "single", "--samples", 3).code == AGREED
        cut = ("--chain", "base_link", "wrist_3_link", "--gravity", 0, 0, -1.62, "--beyond-limits", "--samples", 3)
        done = program("judge", "ur5", "--inverse-dynamics", "my_code.py:rnea", *cut)
        assert done.code == DISAGREED
        assert "gravity is 9.81 m/s², not 1.62 m/s²" in done.out

    def test_states_without_an_answer(self, program, my_code):
        done = program("judge", "ur5", "--inverse-dynamics", "my_code.py:picky", "--samples", 20)
        assert done.code == DISAGREED
        assert "States without an answer" in done.out
        assert re.search(r"inverse_dynamics +states \d+, \d+", done.out)
        assert "[no_answer]" in done.out

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            (("--function", "rnea"), "--function rnea: give NAME=FILE.py:FUNCTION"),
            (("--function", "no_such=my_code.py:rnea"), "there is no function 'no_such' to judge; known are "),
            (
                ("--function", "inverse_dynamics=my_code.py:rnea", "--inverse-dynamics", "my_code.py:rnea"),
                "--function inverse_dynamics=my_code.py:rnea: inverse_dynamics is given twice",
            ),
            (
                ("--inverse-dynamics", "my_code.py:rnea", "--convention", "reference"),
                "--convention reference: give NAME=WAY",
            ),
            (("--function", "frame_jacobian=my_code.py:jacobian"), "give frame=, the name of a link"),
        ],
    )
    def test_refused(self, program, my_code, options, message):
        done = program("judge", "ur5", *options)
        assert done.code == BAD_INPUT
        assert message in " ".join(re.sub("[│╭╰─╮╯]", " ", done.err).split())

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("rnea", "--inverse-dynamics rnea: give FILE.py:FUNCTION or MODULE:FUNCTION"),
            ("no.py:rnea", "there is no file no.py"),
            ("my_code.py:number", "number is not a function in my_code.py"),
            ("my_code.py:aba", "aba does not exist in my_code.py"),
            ("no_such_module:f", "importing no_such_module raised ModuleNotFoundError"),
        ],
    )
    def test_names_that_lead_nowhere(self, program, my_code, text, message):
        done = program("judge", "ur5", "--inverse-dynamics", text)
        assert done.code == BAD_INPUT
        assert message in " ".join(re.sub("[│╭╰─╮╯]", " ", done.err).split())

    def test_no_function(self, program):
        done = program("judge", "ur5")
        assert done.code == BAD_INPUT
        assert "no function to judge; give at least one of" in " ".join(re.sub("[│╭╰─╮╯]", " ", done.err).split())

    def test_foreign_exception(self, program, my_code):
        done = program("judge", "ur5", "--inverse-dynamics", "my_code.py:broken")
        assert done.code == BAD_INPUT
        line = Path("my_code.py").read_text(encoding="utf-8").splitlines().index("def broken(q, v, a):") + 2
        raised = f"error: inverse_dynamics raised RuntimeError: out of ideas ({{}}, line {line}, in broken); at q = ["
        assert done.err.startswith(raised.format(Path("my_code.py").resolve()))


def test_every_option_of_the_setting():
    """Each changes its own field alone."""
    usual = JudgeOptions(robot="ur5").setting
    assert (usual.robot, usual.samples, usual.seed, usual.bound) == ("ur5", 100, 0, 1e-9)
    same = {
        "samples": 7, "seed": 3, "beyond_limits": True, "frame": "hand", "external_wrenches": True, "batched": True,
        "precision": "single", "tolerance": 1e-4,
    }  # fmt: skip
    cases = [({name: value}, {name: value}) for name, value in same.items()]
    cases.append(({"joint_names": "a, b"}, {"joint_names": ["a", "b"]}))
    cases.append(({"convention": ["order=angular first"]}, {"conventions": {"order": "angular first"}}))
    for options, fields in cases:
        found = JudgeOptions(robot="ur5", **options).setting
        assert found == dataclasses.replace(usual, reading=found.reading, **fields)
    assert JudgeOptions(robot="ur5", lock=["a=0.5"]).setting.reading.locked == {"a": 0.5}


def test_options_of_programs_and_libraries(monkeypatch, tmp_path):
    """Each reaches its program; all end with the context."""
    kept, closed = [], []

    class Recorded:
        def __init__(self, *given):
            kept.append(given)

        def close(self):
            closed.append(self)

    library = tmp_path / "libarm.so"
    library.touch()
    monkeypatch.setattr(exchanged, "ProgramFunction", Recorded)
    monkeypatch.setattr(exchanged, "library_function", Recorded)
    options = ProgramOptions(
        command=["gravity_torque=arm --fast 'a b'"], library=[f"inverse_dynamics={library}:rnea"],
        protocol="json", time_limit=2.5, restart_after=7,
    )  # fmt: skip
    with user_programs(options) as found:
        assert list(found) == ["gravity_torque", "inverse_dynamics"]
        assert closed == []
    what = "--command gravity_torque=arm --fast 'a b'"
    assert kept == [(["arm", "--fast", "a b"], what, PROTOCOLS_BY_NAME["json"], 2.5, 7), (library, "rnea", 2.5)]
    assert closed == list(found.values())


SLOW = """
import time

def sleeps(q):
    time.sleep(1000)

def catches(q):
    while True:
        try:
            time.sleep(1000)
        except Exception:
            pass
"""


@pytest.mark.parametrize("name", few(["sleeps", "catches"], "catches"))
def test_a_function_that_does_not_return_ends_with_an_error(pendulum, tmp_path, name):
    (tmp_path / "slow.py").write_text(SLOW)
    named = f"gravity_torque={tmp_path / 'slow.py'}:{name}"
    command = [sys.executable, "-m", "crosscheck", "judge", str(pendulum), "--function", named, "--time-limit", "0.2"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 2
    assert "had not returned after 0.2 s" in done.stderr
    assert "give more time by --time-limit" in done.stderr
