"""What commands write: never onto what they read, never two results into one file; - is standard output."""

import json
import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest
import typer
from long_check import few

from crosscheck.commands import app
from crosscheck.commands.program import console, output_files
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, Command
from crosscheck.commands.program.output_files import OutputFile, refuse_harm
from crosscheck.distributing import LocalProcesses

READS = {
    "crosscheck": ("{robot}",),
    "judge": (
        *("{robot}", "--mass-matrix", "{code}:M"),
        *("--command", "inverse_dynamics=python {program} --fast", "--library", "forward_dynamics={library}:aba"),
        *("--answers", "{log}"),
    ),
    "questions": ("{robot}", "--for", "mass_matrix"),
    "show": ("{robot}", "--state", "{log}"),
    "view": ("{robot}", "--play", "{log}", "--mapping", "{mapping}"),
    "export": ("{robot}",),
    "vectors": ("{robot}", "--out", "vectors"),
    "inspect": ("{robot}",),
    "diff": ("{robot}", "{robot}"),
    "repair": ("{robot}", "--take", "axis"),
    "recording": ("{log}", "--robot", "{robot}"),
    "identify": (
        *("{log}", "--robot", "{robot}", "--mapping", "{mapping}", "--validate", "{other}", "--term", "{code}:T"),
        *("--known-torque", "{code}:K", "--methods", "wls,{method}:E"),
    ),
    "payload": ("{log}", "{other}", "--robot", "{robot}", "--calibration", "{mapping}"),
    "excite": (*("--robot", "{robot}", "--motion", "{log}", "--against", "{other}", "--mapping", "{mapping}"),),
    "simulate": ("{robot}", "--torque", "{code}:T"),
    "study": ("--config", "{log}"),
    "paper": (),
    "bench": ("--robot", "{robot}"),
    "robots": (),
    "cache": (),
    "errata": (),
}
"""Arguments with which each command reads files, all it can read."""

COMMANDS = typer.main.get_command(app).commands
OUTPUTS = [
    (name, parameter.opts[0])
    for name, command in COMMANDS.items()
    for parameter in command.params
    if getattr(parameter, "help", None) and parameter.help.startswith("Write")
]
"""Every option that writes a file, by its help."""


@pytest.fixture
def refuses(program, no_work, tmp_path, monkeypatch):
    """refuses(…) asserts that arguments are refused before the work, and that no file changes; gives the message."""
    monkeypatch.chdir(tmp_path)

    def check(*arguments):
        before = {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()}
        done = program(*arguments)
        assert done.code == BAD_INPUT
        assert done.out == ""
        assert {path: path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()} == before
        return " ".join(done.err.split())

    return check


@pytest.fixture
def files(tmp_path, small_arm):
    """A file for each name in READS, with endings that do not give them away."""
    named = {"robot": small_arm}
    for name in ("log", "other", "mapping", "program", "library"):
        named[name] = tmp_path / f"{name}.json"
        named[name].write_text(name, encoding="utf-8")
    for name in ("code", "method"):
        named[name] = tmp_path / f"{name}.py"
        named[name].write_text("raise AssertionError('imported')", encoding="utf-8")
    return named


class TestCommands:
    def test_all_are_here(self):
        assert set(READS) == set(COMMANDS)
        assert all(isinstance(command, Command) for command in COMMANDS.values())

    def test_every_option_that_writes_is_known(self):
        """A new one has to be an OutputFile, which alone is checked."""
        assert {option for _, option in OUTPUTS} == {
            "--json",
            "--html",
            "--sarif",
            "--junit",
            "--urdf",
            "--to",
            "--out",
            "--further",
            "--write-mapping",
            "--write-gains",
        }
        for name, option in OUTPUTS:
            (parameter,) = (p for p in COMMANDS[name].params if option in p.opts)
            context = COMMANDS[name].make_context(name, [*READS[name], option, "x"])
            assert isinstance(context.params[parameter.name], OutputFile)

    @pytest.mark.parametrize("name", ["new.urdf", "new.xml", "NEW.URDF"])
    def test_a_robot_may_replace_a_robot(self, tmp_path, name):
        """What is not read; another kind of file may not."""
        (tmp_path / name).touch()
        command, reads = COMMANDS["identify"], READS["identify"]
        refuse_harm(command.make_context("identify", [*reads, "--urdf", str(tmp_path / name)]))
        context = command.make_context("identify", [*reads, "--json", str(tmp_path / name)])
        with pytest.raises(typer.BadParameter, match="file of this name, which would be lost; name another"):
            refuse_harm(context)

    @pytest.mark.parametrize(("command", "option"), [case for case in OUTPUTS if READS[case[0]]])
    def test_what_is_read_is_not_written(self, refuses, files, command, option):
        arguments = [text.format(**files) for text in READS[command]]
        read = {name for name in files if any(f"{{{name}}}" in text for text in READS[command])}
        for name in read:
            message = refuses(command, *arguments, option, files[name])
            assert f"{option} {files[name]}: " in message
            assert "this file; name another" in message

    @pytest.mark.parametrize(("command", "option"), OUTPUTS)
    @pytest.mark.parametrize("target", ["folder", "no/such/folder/x", "mesh.stl", "macros.xacro"])
    def test_what_cannot_be_written_or_would_be_lost(self, refuses, files, tmp_path, command, option, target):
        (tmp_path / "folder").mkdir()
        for name in ("mesh.stl", "macros.xacro"):
            (tmp_path / name).write_text("precious", encoding="utf-8")
        message = refuses(command, *(text.format(**files) for text in READS[command]), option, target)
        assert f"{option} {target}: " in message

    @pytest.mark.parametrize("command", [name for name, option in OUTPUTS if option == "--html" and name != "view"])
    @pytest.mark.parametrize("second", ["x", "./x", "folder/../x", "link", "hard", "-"])
    def test_two_into_one(self, refuses, files, tmp_path, command, second):
        (tmp_path / "folder").mkdir()
        (tmp_path / "x").write_text("old", encoding="utf-8")
        (tmp_path / "link").symlink_to("x")
        os.link(tmp_path / "x", tmp_path / "hard")
        first = "-" if second == "-" else "x"
        arguments = (text.format(**files) for text in READS[command])
        message = refuses(command, *arguments, "--json", first, "--html", second)
        assert f"--json and --html name the same file, {second}; name two" in message


class TestSpellings:
    """Of the robot that `show` reads."""

    @pytest.mark.parametrize("spelling", ["small.urdf", "./small.urdf", "folder/../small.urdf", "link", "hard"])
    def test_of_the_output(self, refuses, small_arm, tmp_path, spelling):
        (tmp_path / "folder").mkdir()
        (tmp_path / "link").symlink_to(small_arm)
        os.link(small_arm, tmp_path / "hard")
        assert "the command reads this file; name another" in refuses("show", small_arm, "--json", spelling)

    def test_of_the_input(self, refuses, small_arm, tmp_path):
        (tmp_path / "robot").symlink_to(small_arm)
        (tmp_path / "r.json").symlink_to(small_arm)
        assert "reads this file" in refuses("show", tmp_path / "robot", "--json", "r.json")

    def test_a_robot_by_name(self, refuses, tmp_path, small_arm, monkeypatch):
        """Its file lies with the installed packages."""
        installed = tmp_path / "installed"
        installed.write_text(small_arm.read_text(encoding="utf-8"), encoding="utf-8")
        entry = type("Entry", (), {"name": "arm", "path": installed})
        monkeypatch.setattr("urdf.robots", lambda: (entry,))
        assert "reads this file" in refuses("show", "arm", "--json", installed)

    def test_a_module_by_name(self, refuses, tmp_path):
        (tmp_path / "package").mkdir()
        for name in ("code.py", "__init__.py"):
            (tmp_path / "package" / name).write_text("raise AssertionError('imported')", encoding="utf-8")
            module = f"package.{name[:-3]}" if name == "code.py" else "package"
            message = refuses("judge", "ur5", "--mass-matrix", f"{module}:M", "--json", f"package/{name}")
            assert "--mass-matrix reads this file" in message

    def test_in_a_folder_that_is_read(self, refuses, pendulum):
        message = refuses("crosscheck", pendulum.parent, "--json", pendulum)
        assert "there is a .urdf file of this name, which would be lost; name another" in message

    @pytest.mark.parametrize("number", [1, 2])
    def test_where_the_shell_sends_the_output(self, refuses, tmp_path, number, monkeypatch):
        (tmp_path / "r.json").write_text("", encoding="utf-8")
        opened = (tmp_path / "r.json").open()
        fstat = os.fstat
        monkeypatch.setattr(output_files.os, "fstat", lambda fd: fstat(opened.fileno() if fd == number else 0))
        stream = {1: "standard output", 2: "standard error"}[number]
        with opened:
            assert f"{stream} goes to this file; name another, or - alone" in refuses("robots", "--json", "r.json")


class TestAllowed:
    def test_results_are_replaced(self, program, small_arm, tmp_path):
        files = ("--json", tmp_path / "r.json", "--html", tmp_path / "r.html")
        for _ in range(2):
            assert program("show", small_arm, *files).code == AGREED

    def test_into_the_folder_that_is_read(self, program, small_arm):
        for _ in range(2):
            assert program("inspect", small_arm.parent, "--json", small_arm.parent / "r.json").code == AGREED

    def test_a_device_takes_both(self, program, small_arm):
        assert program("show", small_arm, "--json", os.devnull, "--html", os.devnull).code == AGREED

    def test_names_that_no_file_can_have(self, program, tmp_path):
        """Texts of options are looked up as files."""
        (tmp_path / "r.json").write_text("{}", encoding="utf-8")
        done = program("show", "a\0b" + 5000 * "x", "--json", tmp_path / "r.json")
        assert done.code == BAD_INPUT
        assert "is neither a file nor a robot" in done.err


class TestStandardOutput:
    def test_json_alone(self, program, small_arm):
        done = program("show", small_arm, "--json", "-")
        assert done.code == AGREED
        assert json.loads(done.out)["format"].startswith("graphdyn show")
        assert not console.out.quiet  # what is printed next, in the same process, is seen

    def test_html_alone(self, program, small_arm, tmp_path):
        done = program("show", small_arm, "--html", "-", "--json", tmp_path / "r.json")
        assert done.out.startswith("<!DOCTYPE html>")
        assert done.out.endswith("</html>\n") or done.out.endswith("</html>")
        assert json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))["format"] == "graphdyn show 1"

    def test_the_report_comes_back(self, program, small_arm):
        program("show", small_arm, "--json", "-")
        assert program("show", small_arm).out.startswith("robot ")

    def test_no_file_of_this_name(self, program, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        assert json.loads(program("robots", "--json", "-").out)["robots"]
        assert list(tmp_path.iterdir()) == []

    def test_errors_go_elsewhere(self, program, pendulum):
        done = program("crosscheck", "ur55", pendulum, "--samples", 1, "--json", "-")
        assert done.code == BAD_INPUT
        assert json.loads(done.out)["failures"]
        assert "'ur55' is neither" in done.err

    @pytest.mark.parametrize("target", few(["-", "/dev/stdout", "pipe"], "pipe"))
    def test_a_sweep_writes_once(self, program, pendulum, tmp_path, target, monkeypatch):
        """A file is written after each robot, which in a pipe would be one JSON after another."""
        monkeypatch.setattr(LocalProcesses, "each", lambda _self, function, items: enumerate(map(function, items)))
        if os.name != "posix" and target != "-":
            pytest.skip("POSIX names")
        folder = tmp_path / "robots"
        folder.mkdir()
        for k in range(2):
            (folder / f"{k}.urdf").write_text(pendulum.read_text(encoding="utf-8"), encoding="utf-8")
        if target != "pipe":
            said = program("crosscheck", folder, "--samples", 1, "--jobs", 1, "--json", target).out
        else:
            os.mkfifo(tmp_path / "pipe")
            read = []
            reader = threading.Thread(target=lambda: read.append((tmp_path / "pipe").read_text(encoding="utf-8")))
            reader.start()
            program("crosscheck", folder, "--samples", 1, "--jobs", 1, "--json", tmp_path / "pipe")
            reader.join()
            (said,) = read
        assert len(json.loads(said)["robots"]) == 2

    def test_nothing_to_resume_from(self, program, pendulum):
        done = program("crosscheck", pendulum.parent, "--json", "-", "--resume")
        assert done.code == BAD_INPUT
        assert "--resume needs --json FILE" in done.err

    def test_a_robot_needs_a_file(self, program):
        done = program("identify", "--urdf", "-")
        assert done.code == BAD_INPUT
        assert "only --json and --html can go to standard output" in " ".join(done.err.split())

    @pytest.mark.parametrize("name", few(["/dev/stdout", "/dev/../dev/stdout"], "/dev/../dev/stdout"))
    def test_a_pipe_without_a_name(self, script, name):
        """/dev/fd/N of a shell's >(…) and /dev/stdout lead to pipe:[…], beside which no file can be made."""
        if not Path("/dev/stdout").exists():
            pytest.skip("no /dev/stdout")
        done = script("robots", "--json", name)
        assert done.code == AGREED
        assert '"format": "graphdyn robots 1"' in done.out

    @pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
    def test_a_full_disk_behind_the_output(self, tmp_path):
        with open("/dev/full", "w") as full:
            done = subprocess.run(
                [sys.executable, "-m", "crosscheck", "robots", "--json", "-"],
                cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True, check=False,
            )  # fmt: skip
        assert done.returncode == BAD_INPUT
        assert "No space left on device" in done.stderr
        assert "Traceback" not in done.stderr
