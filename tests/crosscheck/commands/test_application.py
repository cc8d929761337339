"""The program: exit codes, files, messages. In process through its entry point, and as the installed script."""

import errno
import functools
import json
import os
import re
import runpy
import shlex
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import typer
from back_ends import no_programs
from long_check import LONG, few
from planting import mixed_tree
from random_trees import NAMED
from shown.pages import first_cells

import crosscheck
import graphdyn
import urdf
from crosscheck.bench.benchmark import Effort
from crosscheck.commands import app, application
from crosscheck.commands.crosscheck.command import DEFAULT_ROBOTS
from crosscheck.commands.program import console, exits
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, BROKEN_PIPE, DISAGREED, INTERNAL_ERROR
from crosscheck.comparing import compare as comparing
from crosscheck.paper import errata
from crosscheck.paper.errata import ERRATA, N_EFFECTS, measure
from crosscheck.quantities import COMPARED
from crosscheck.report.records.record import versions
from graphdyn import __version__
from graphdyn.compiler import CACHE_VARIABLE

COMMANDS = (
    *("inspect", "crosscheck", "diff", "repair", "show", "view", "simulate", "robots"),
    *("judge", "questions", "vectors", "export"),
    *("recording", "identify", "excite", "payload", "study"),
    *("bench", "paper", "errata", "cache"),
)

WRITES = {
    "export": "--to FILE",
    "view": "--html FILE",
    "questions": "--out FILE",
    "vectors": "--out FOLDER",
    "study": "--out DIR",
}
"""The option that writes what a program reads, where it is not --json."""


@pytest.mark.usefixtures("random_states_alone")
class TestExitCodes:
    def test_agreement(self, program, small_arm):
        done = program("crosscheck", small_arm, "--samples", 2)
        assert done.code == AGREED == 0
        assert done.err == ""
        assert "DISAGREES" not in done.out
        assert set(COMPARED) <= set(first_cells(done.out))

    def test_disagreement(self, program, pendulum, wrong_torque):
        done = program("crosscheck", pendulum, "--samples", 2)
        assert done.code == DISAGREED == 1
        assert first_cells(done.out, "DISAGREES") == ["inverse_dynamics", "inverse_dynamics_recursive"]

    def test_one_of_several_disagrees(self, program, pendulum, second_pendulum, wrong_torque):
        """The plant strikes the first robot only; the verdict is of all."""
        done = program("crosscheck", pendulum, second_pendulum, "--samples", 2)
        assert done.code == DISAGREED
        assert re.search(r"│ verdict +│ +│ +DISAGREES │ +agrees │", done.out)
        for name, row in zip(
            ("inverse_dynamics", "inverse_dynamics_recursive"),
            (line for line in done.out.splitlines() if "✗" in line),
            strict=True,
        ):
            assert re.fullmatch(rf"│ {name} +│ +[\d.e-]+ │ +[\d.e-]+ ✗ │ +[\d.e-]+ │", row)

    def test_bad_file_is_one_line_and_the_others_go_on(self, program, pendulum, tmp_path):
        broken = tmp_path / "broken.urdf"
        broken.write_text("<robot name='x'>\n", encoding="utf-8")
        done = program("crosscheck", broken, pendulum, "--samples", 2)
        assert done.code == BAD_INPUT == 2
        assert done.err.startswith(f"error: {broken}:")
        assert done.err.count("\n") == 1
        assert "Traceback" not in done.err + done.out
        assert f"\n{pendulum.name}: agrees" in done.out

    def test_problems_of_one_file_are_one_line_each(self, program, tmp_path):
        """Not one line with line breaks as \\n in it, as in names of others."""
        columns = ["time", *(f"{name}[{k}]" for name in ("q", "qd", "tau") for k in range(6))]
        rows = [[f"{0.01 * k:.2f}", *(["0.5"] * 18)] for k in range(20)]
        rows[7][3] = "0.5x"
        rows[12][0] = rows[11][0]
        log = tmp_path / "log.csv"
        log.write_text("\n".join(",".join(row) for row in [columns, *rows]), encoding="utf-8")
        done = program("identify", log, "--robot", "ur5")
        assert done.code == BAD_INPUT
        first, second = done.err.splitlines()
        assert re.fullmatch(r"error: .*log\.csv, .*0\.5x.*; .* \[.*\]", first)
        assert re.fullmatch(r"error: .*log\.csv, .*stamp.*; .* \[.*\]", second)

    def test_one_unreadable_robot_leaves_the_others_their_result(self, program, pendulum, monkeypatch):
        original = comparing.compare

        def compare(robot, *arguments, **options):
            if robot == "gone.urdf":
                raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), robot)
            return original(robot, *arguments, **options)

        monkeypatch.setattr(comparing, "compare", compare)
        done = program("crosscheck", "gone.urdf", pendulum, "--samples", 1)
        assert done.code == BAD_INPUT
        assert re.fullmatch("error: gone\\.urdf: permission denied; check who may read and write it\n", done.err)
        assert f"\n{pendulum.name}: agrees" in done.out

    def test_bad_file_outweighs_disagreement(self, program, pendulum, wrong_torque):
        assert program("crosscheck", pendulum, "no_such_robot", "--samples", 2).code == BAD_INPUT

    def test_unknown_name(self, program):
        done = program("crosscheck", "ur55")
        assert done.code == BAD_INPUT
        assert re.fullmatch(r"error: 'ur55' is neither a file nor a robot .*ur5.*\n", done.err)

    @pytest.mark.parametrize(
        ("arguments", "message"),
        [
            (["crosscheck", "kr500", "--samples", "0"], "'--samples'"),
            (["crosscheck", "kr500", "--samples", "many"], "'--samples'"),
            (["crosscheck", "kr500", "--lock", "O1=soft"], "'soft' is not a number"),
            (["crosscheck", "kr500", "ur5", "--lock", "O1"], "--lock and --chain need exactly one robot"),
            (["crosscheck", "--lock", "O1"], "--lock and --chain need exactly one robot"),
            (["crosscheck", "kr500", "--speed", "1"], "--speed"),
            (["errata", "--samples", "9"], "'--samples'"),
            (["simulate", "kr500", "--duration", "inf"], "'--duration': inf is not a finite number"),
            (["simulate", "kr500", "--gravity", "0", "nan", "1"], "'--gravity': nan is not a finite number"),
            (["simulate", "kr500", "--duration", "1_0"], "'--duration': 1_0 is not a finite number such as 10"),
            (["simulate", "kr500", "--duration", "0,5"], "'--duration'"),
            (["simulate", "kr500", "--rate", "٣"], "'--rate'"),
            (["show", "kr500", "--gravity", "0", "0", "1_0"], "'--gravity': 1_0 is not a finite number"),
            (["crosscheck", "kr500", "--samples", "1_0"], "'--samples': 1_0 is not a finite number"),
            (["nonsense"], "nonsense"),
        ],
    )
    def test_bad_options(self, program, no_work, arguments, message):
        done = program(*arguments)
        assert done.code == BAD_INPUT
        assert message in done.err
        assert "Traceback" not in done.err

    def test_warnings_are_one_line_each(self, program, pendulum):
        pendulum.write_text(pendulum.read_text().replace('xyz="0 1 0"', 'xyz="0 2 0"'))
        done = program("crosscheck", pendulum, "--samples", 1)
        assert done.code == AGREED
        assert re.fullmatch(r"warning: .*axis not of unit length.*'swing' \(2\)\n", done.err)


class TestDebug:
    """Errors are one line; --debug adds the traceback and changes nothing else."""

    @pytest.mark.parametrize("command", [("crosscheck", "ur55"), ("show", "ur55")], ids=" ".join)
    def test_errors_of_the_user(self, program, command):
        plain, traced = program(*command), program("--debug", *command)
        assert plain.code == traced.code == BAD_INPUT
        assert re.fullmatch(r"error: 'ur55' is neither .*\n", plain.err)
        assert traced.err.startswith("Traceback (most recent call last)")
        assert traced.err.endswith(plain.err)
        assert "RobotNotFound" in traced.err

    @pytest.mark.parametrize("command", [("crosscheck", "kr500"), ("errata",)], ids=" ".join)
    def test_errors_of_the_program(self, program, monkeypatch, command):
        def broken(*_arguments, **_options):
            raise ZeroDivisionError("two\nlines")

        monkeypatch.setattr(comparing, "compare", broken)
        monkeypatch.setattr(errata, "kr500", broken)
        plain, traced = program(*command), program("--debug", *command)
        assert plain.code == traced.code == INTERNAL_ERROR == 3
        assert plain.err == "internal error: ZeroDivisionError: two lines; run with --debug and report it\n"
        assert plain.out == ""
        assert traced.err.startswith("Traceback (most recent call last)")
        assert traced.err.endswith(plain.err)

    def test_usage_errors_have_no_traceback(self, program):
        done = program("--debug", "crosscheck", "kr500", "--samples", "0")
        assert done.code == BAD_INPUT
        assert "Traceback" not in done.err

    def test_interrupted(self, program, monkeypatch):
        def interrupted(*_arguments, **_options):
            raise KeyboardInterrupt

        monkeypatch.setattr(comparing, "compare", interrupted)
        done = program("crosscheck", "kr500")
        assert (done.code, done.out, done.err) == (130, "", "")

    def test_a_reader_who_left(self, script):
        """As in `graphdyn robots | head -1`, if head is quick: no traceback, and not the code of a disagreement."""
        reader, writer = os.pipe()
        os.close(reader)
        try:
            done = script("robots", stdout=writer)
        finally:
            os.close(writer)
        assert (done.code, done.err) == (BROKEN_PIPE, "")

    @pytest.mark.skipif(os.name != "posix", reason="the shell of POSIX closes streams by >&-")
    def test_a_closed_output(self):
        """Not the code of a disagreement, nor a result that nobody sees."""
        code = "from crosscheck.commands import main; main()"
        line = f'exec "{sys.executable}" -c "{code}" robots >&-'
        done = subprocess.run(["/bin/sh", "-c", line], stderr=subprocess.PIPE, text=True, check=False)
        assert done.returncode == BAD_INPUT
        assert done.stderr == (
            "error: standard output is closed; leave it open, or send it to a file or to /dev/null\n"
        )

    def test_other_closed_streams_lead_to_nothing(self, monkeypatch):
        """A file that is opened later would take the number of standard error, and what libraries write."""
        opened, closed = iter([0, 2, 3]), []
        monkeypatch.setattr(exits.os, "open", lambda *_: next(opened))
        monkeypatch.setattr(exits.os, "close", closed.append)
        exits.refuse_closed_output()
        assert closed == [3]


class TestCompletion:
    @pytest.fixture
    def complete(self, program, monkeypatch):
        """Candidates that bash is offered for the last word of a line."""

        def run(line):
            monkeypatch.setenv("_GRAPHDYN_COMPLETE", "complete_bash")
            monkeypatch.setenv("COMP_WORDS", line)
            monkeypatch.setenv("COMP_CWORD", str(len(line.split(" ")) - 1))
            return program().out.splitlines()

        return run

    @pytest.mark.parametrize("command", few(["crosscheck", "crosscheck kr500", "show"], "crosscheck kr500", "show"))
    def test_robot_names(self, complete, command):
        assert {"ur3", "ur5", "ur10"} <= set(complete(f"graphdyn {command} ur"))
        assert complete(f"graphdyn {command} kr5") == ["kr500"]

    def test_commands(self, complete):
        assert complete("graphdyn sh") == ["show"]

    def test_names_need_no_pinocchio(self):
        """Nor do --help and the pytest fixture."""
        code = """
import sys
import crosscheck.pytest_plugin
from crosscheck.commands import app, application
from crosscheck.commands.program.options import robot_names
assert "ur5" in robot_names("ur")
print(*{"pinocchio", "yourdfpy", "scipy", "matplotlib"} & set(sys.modules))
"""
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert done.stdout == "\n"

    @LONG
    def test_the_installed_program_writes_a_script(self, script):
        assert "_GRAPHDYN_COMPLETE=complete_" in script(env={"_GRAPHDYN_COMPLETE": "source_bash"}).out

    @pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
    def test_every_shell_gets_its_script(self, program, monkeypatch, shell):
        monkeypatch.setenv("_GRAPHDYN_COMPLETE", f"source_{shell}")
        assert "_GRAPHDYN_COMPLETE=complete_" in program().out


commands_of_the_program = functools.cache(lambda: typer.main.get_command(app))


class TestExamples:
    """What the help shows can be typed."""

    EXAMPLES = tuple(
        (info.name, shlex.split(line)[2:])
        for info in app.registered_commands
        for line in info.epilog.splitlines()
        if line.startswith("  graphdyn ")
    )

    @pytest.mark.parametrize(("command", "arguments"), EXAMPLES, ids=lambda value: str(value))
    def test_parsed(self, command, arguments):
        context = commands_of_the_program().commands[command].make_context(command, list(arguments))
        assert not context.args

    @pytest.fixture
    def hurry(self, monkeypatch):
        """The benchmark measures little; a page that is served is left at once, as by Ctrl-C."""

        def interrupted(server):
            raise KeyboardInterrupt

        monkeypatch.setattr("socketserver.BaseServer.serve_forever", interrupted)
        monkeypatch.setattr("webbrowser.open", lambda address: True)
        monkeypatch.setattr("crosscheck.bench.benchmark.QUICK_EFFORT", Effort(1e-3, 2, 1, 300, (2, 3)))
        monkeypatch.setattr("crosscheck.bench.contender.MIN_STEADY_TIME", 1e-3)

    FAST = tuple(name for name in COMMANDS if name not in ("study", "recording", "payload"))
    """A study takes minutes, and logs are the user's: their tests run small ones."""

    SLOW = frozenset({"crosscheck", "identify", "bench", "excite", "simulate", "view", "vectors"})

    @pytest.mark.parametrize("command", few(FAST, *(set(FAST) - SLOW)))
    def test_the_first_one_runs(self, program, command, my_code, hurry):
        first = next(arguments for name, arguments in self.EXAMPLES if name == command)
        assert program(command, *first).code == AGREED


class TestProgress:
    """On a terminal, with the total."""

    @pytest.fixture(autouse=True)
    def terminal(self, monkeypatch):
        for name, value in {"FORCE_COLOR": "1", "TERM": "xterm", "COLUMNS": "140"}.items():
            monkeypatch.setenv(name, value)
        for name in ("JPY_PARENT_PID", "MPLBACKEND"):  # of notebooks
            monkeypatch.delenv(name, raising=False)
        monkeypatch.setattr(console.err, "is_interactive", True)
        monkeypatch.setattr(type(console.err), "is_terminal", True)  # rich 13.0 asks FORCE_COLOR when it is imported

    def test_one_robot(self, program, pendulum, monkeypatch):
        monkeypatch.chdir(pendulum.parent)  # a path of any length would leave no room for the count
        done = program("crosscheck", pendulum.name, "--samples", 2)
        states = 2 + 1 + 4 * 2 + 1 + 1  # random, at rest, four awkward kinds, gimbal lock, horizontal axis
        assert re.search(rf"{pendulum.name}.* {states}/{states} ", done.err)
        assert "(1 of" not in done.err

    @pytest.mark.usefixtures("random_states_alone")
    def test_several(self, program, pendulum, second_pendulum):
        done = program("crosscheck", second_pendulum, pendulum, "ur55", "--samples", 1)
        assert done.code == BAD_INPUT
        assert "second.urdf (1 of 3)" in done.err
        assert "(2 of 3)" in done.err
        assert "'ur55' is neither" in done.err

    @pytest.mark.usefixtures("random_states_alone")
    def test_warnings_once(self, program, pendulum):
        pendulum.write_text(pendulum.read_text().replace('xyz="0 1 0"', 'xyz="0 2 0"'))
        done = program("crosscheck", pendulum, "--samples", 1)
        assert done.err.count("warning: ") == 1

    def test_errata(self, program):
        done = program("errata", "--samples", 10)
        assert re.search(rf"errata.* {N_EFFECTS}/{N_EFFECTS} .*A6 on ur5", done.err)

    def test_the_callback_of_measure(self):
        seen = []
        assert measure(10, progress=seen.append) == seen
        assert len(seen) == N_EFFECTS


@pytest.mark.usefixtures("random_states_alone")
class TestLockOption:
    def test_value(self, program, small_arm, tmp_path):
        record = tmp_path / "r.json"
        done = program(
            "crosscheck", small_arm, "--lock", "y_elbow=0.3", "--lock", "a_slide", "--samples", 1, "--json", record
        )
        assert done.code == AGREED
        (robot,) = json.loads(record.read_text(encoding="utf-8"))["robots"]
        assert robot["locked"] == {"y_elbow": 0.3, "a_slide": 0.0}
        assert robot["n_bodies"] == 1

    def test_unknown_joint(self, program, small_arm):
        done = program("crosscheck", small_arm, "--lock", "elbow")
        assert done.code == BAD_INPUT
        assert re.fullmatch(r"error: .*cannot lock 'elbow'.*\n", done.err)


@pytest.mark.usefixtures("random_states_alone")
class TestDefaults:
    def test_without_arguments_the_six_arms(self, program, monkeypatch):
        seen, comparison = [], crosscheck.compare(mixed_tree(), 1)

        def compare(robot, samples, seed, *, reading, progress=None):
            seen.append((robot, reading.locked))
            return comparison

        monkeypatch.setattr(comparing, "compare", compare)
        assert program("crosscheck").code == AGREED
        assert seen == [(name, dict(lock)) for name, lock in DEFAULT_ROBOTS]

    def test_seed_and_samples_arrive(self, program, pendulum, tmp_path):
        record = tmp_path / "r.json"
        program("crosscheck", pendulum, "--samples", 3, "--seed", 11, "--json", record)
        (robot,) = json.loads(record.read_text(encoding="utf-8"))["robots"]
        assert (robot["samples"], robot["seed"]) == (3, 11)


class TestOtherCommands:
    def test_robots(self, program, tmp_path):
        path = tmp_path / "robots.json"
        done = program("robots", "--json", path)
        assert done.code == AGREED
        listed = json.loads(path.read_text(encoding="utf-8"))["robots"]
        assert [entry["name"] for entry in listed] == [entry.name for entry in urdf.robots()]
        for name in ("kr500", "ur5", "z1"):
            assert re.search(rf"│ {name} +│", done.out)

    def test_cache(self, program, tmp_path, monkeypatch):
        monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "kept"))
        q = np.zeros((1000, 1))
        robot = NAMED["one_revolute"]
        with no_programs():
            graphdyn.joint_torques(robot, q, q, q, method="recursive")
        sizes = [path.stat().st_size for path in (tmp_path / "kept" / "machine_code").iterdir()]
        path = tmp_path / "cache.json"
        for arguments, files, said in (
            ((), len(sizes), f"compiled programs  {len(sizes)}, "),
            (("--clear",), len(sizes), f"removed  {len(sizes)}, "),
            ((), 0, "compiled programs  0, 0.0 MB"),
        ):
            done = program("cache", *arguments, "--json", path)
            assert done.code == AGREED
            assert said in done.out
            record = json.loads(path.read_text(encoding="utf-8"))
            assert record == {
                "format": "graphdyn cache 1",
                "cleared": bool(arguments),
                "folder": str(tmp_path / "kept" / "machine_code"),
                "is_writable": True,
                "files": files,
                "bytes": sum(sizes) if files else 0,
            }
        monkeypatch.setenv(CACHE_VARIABLE, "off")
        assert "none: GRAPHDYN_CACHE is off" in program("cache").out

    def test_errata(self, program, tmp_path):
        path = tmp_path / "errata.json"
        done = program("errata", "--samples", 20, "--json", path)
        assert done.code == AGREED
        effects = json.loads(path.read_text(encoding="utf-8"))["effects"]
        assert {effect["erratum"] for effect in effects} == set(ERRATA)
        assert {effect["robot"] for effect in effects} == {"kr500", "ur5"}
        said = " ".join(done.out.split())
        for name, sentence in ERRATA.items():
            assert f"{name} {sentence}" in said

    def test_version(self, program):
        done = program("--version")
        assert done.code == AGREED
        numbers = dict(line.split() for line in done.out.splitlines())
        assert numbers == versions()
        assert numbers["graphdyn"] == __version__

    @pytest.mark.parametrize("command", [(), *((name,) for name in COMMANDS)])
    def test_help(self, program, command):
        done = program(*command, "--help")
        assert done.code == AGREED
        assert re.search(r"Usage: .*graphdyn", done.out)
        if command:
            assert WRITES.get(command[0], "--json") in done.out
            examples = done.out.partition("Examples:\n")[2].partition("\n\n")[0].splitlines()
            assert examples
            assert all(line.startswith(f"    graphdyn {command[0]}") for line in examples)
        else:
            headings = "|".join(dict.fromkeys(heading for *_, heading in application.COMMANDS))
            listed = re.findall(rf"^(?:{headings}):\n((?:  .*\n)+)", done.out, re.MULTILINE)
            summaries = re.findall(r"^  (\w+)  +(.*)$", "".join(listed), re.MULTILINE)
            assert [name for name, _ in summaries] == list(COMMANDS)
            assert all(summary.endswith(".") and not summary.endswith("...") for _, summary in summaries)
            assert done.out.index("inspect") < done.out.index("--version")

    def test_first_steps(self, program):
        """graphdyn alone tells them, shortly: each is a command with options that it has."""
        done = program()
        assert done.code == BAD_INPUT
        assert len(done.out.splitlines()) < 20
        steps = re.findall(r"^  graphdyn (\w+)(.*?)(?:   .*)?$", done.out, re.MULTILINE)
        assert [name for name, _ in steps] == ["inspect", "crosscheck", "judge", "recording", "identify"]
        for name, arguments in steps:
            commands_of_the_program().commands[name].make_context(name, shlex.split(arguments))

    @pytest.mark.parametrize("package", [graphdyn, crosscheck], ids=lambda package: package.__name__)
    def test_as_a_module(self, package, monkeypatch):
        started = []
        monkeypatch.setattr("crosscheck.commands.main", lambda: started.append(package))
        runpy.run_path(str(Path(package.__file__).with_name("__main__.py")), run_name="__main__")
        assert started == [package]

    def test_every_command_is_tested(self):
        assert tuple(info.name for info in app.registered_commands) == COMMANDS


@pytest.mark.usefixtures("random_states_alone")
class TestOutput:
    def test_no_progress_where_nobody_watches(self, program, pendulum):
        """A bar in a log file is noise: standard error stays empty, standard output has no control characters."""
        done = program("crosscheck", pendulum, "--samples", 2)
        assert done.err == ""
        assert "\x1b" not in done.out

    def test_names_are_not_markup(self, program, pendulum, tmp_path):
        """Brackets in a path are brackets, not rich's markup."""
        folder = tmp_path / "[bold]x["
        (folder / "y]").mkdir(parents=True)
        path = folder / "y]" / "[red]arm.urdf"
        shutil.copy(pendulum, path)
        done = program("crosscheck", path, "--samples", 1)
        assert done.code == AGREED
        assert str(path) in done.out.replace("\n", "")
        several = program("crosscheck", path, pendulum, "--samples", 1)
        assert several.code == AGREED
        assert str(path) in several.out.replace("\n", "")

    def test_disagreement_of_such_a_name(self, small_arm, tmp_path, wrong_torque):
        path = tmp_path / "[red]arm.urdf"
        shutil.copy(small_arm, path)
        with pytest.raises(crosscheck.Disagreement) as caught:
            crosscheck.assert_agrees(path, 1)
        table = str(caught.value).split("\n", 1)[1]
        assert "[red]arm.urdf: DISAGREES" in table


class TestInstalledScript:
    def test_agreement(self, script, pendulum, tmp_path):
        record = tmp_path / "r.json"
        done = script("inspect", pendulum, "--json", record)
        assert (done.code, done.err) == (AGREED, "")
        assert json.loads(record.read_text(encoding="utf-8"))["command"][:2] == ["graphdyn", "inspect"]

    @LONG
    def test_bad_file(self, script, tmp_path):
        broken = tmp_path / "broken.urdf"
        broken.write_bytes(b"\xff\xfe<robot")
        done = script("crosscheck", broken)
        assert done.code == BAD_INPUT
        assert done.err.startswith(f"error: {broken}:")
        assert done.err.count("\n") == 1

    @LONG
    def test_version(self, script):
        done = script("--version")
        assert done.code == AGREED
        assert f"graphdyn {__version__}" in done.out.splitlines()
