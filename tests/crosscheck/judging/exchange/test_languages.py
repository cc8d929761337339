"""The examples of docs/languages in other languages, and C functions that misbehave."""

import os
import re
import shutil
import signal
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest
from long_check import LONG
from shared_data import REPOSITORY
from typer.testing import CliRunner

from crosscheck.commands import app
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED, PENDING
from crosscheck.judging.exchange.line_process import ProgramFailed
from crosscheck.judging.exchange.program import library_function
from crosscheck.quantities.tested_function import Refusal

EXAMPLES = REPOSITORY / "docs/languages"
COMPILER = shutil.which("cc") or shutil.which("gcc")
OCTAVE = shutil.which("octave-cli")
OPTIONS = ("-std=c99", "-pedantic", "-Wall", "-Wextra", "-Werror", "-O1")
WRONG_SIGN = "the terms ω × q̇ p in the angular accelerations have the opposite sign [coriolis]"
WITH_FLINT = find_spec("flint") is not None
HANGS = 60
"""Time limit where an answer comes at once [s]."""

MISBEHAVING = """
#include <stdio.h>
#include <stdlib.h>
#include <math.h>
int right(int n, const double *q, double *out) { for (int k = 0; k < n; k++) out[k] = 2 * q[k]; return 0; }
int talks(int n, const double *q, double *out) { printf("hello\\n"); fflush(stdout); return right(n, q, out); }
int crashes(int n, const double *q, double *out) { return q[0] > 0 ? *(int *)NULL : right(n, q, out); }
int refuses(int n, const double *q, double *out) { return q[0] > 0 ? -3 : right(n, q, out); }
int overruns(int n, const double *q, double *out) { out[n] = 0; return right(n, q, out); }
int alters(int n, const double *q, double *out) { ((double *)q)[1] = 0; return right(n, q, out); }
int forgets(int n, const double *q, double *out) { out[0] = n + q[0]; return 0; }
int many(int n, const double *q, double *out) { for (int k = 0; k < n * n; k++) out[k] = k + q[0]; return 0; }
int second(int n, const double *q, const double *w, double *out) { out[0] = w[6]; out[1] = w[6 * n - 1]; return 0; }
"""

pytestmark = pytest.mark.skipif(COMPILER is None, reason="there is no C compiler (cc or gcc) on this machine")


def compiled(target, *sources, options=()):
    shared = ("-shared", "-fPIC") if target.suffix == ".so" else ()
    subprocess.run(
        [COMPILER, *OPTIONS, *options, *shared, "-o", target, *sources, "-lm"], check=True, cwd=target.parent
    )
    return target


@pytest.fixture(scope="session")
def examples(tmp_path_factory):
    """A folder with the examples, the exported model, and what is compiled from them."""
    folder = tmp_path_factory.mktemp("languages")
    for source in EXAMPLES.iterdir():
        shutil.copy(source, folder)
    assert CliRunner().invoke(app, ["export", "ur5", "--to", str(folder / "model.h")]).exit_code == AGREED
    for name, options in (("", ()), ("_wrong", ("-DSIGN=-1",))):
        compiled(folder / f"librnea{name}.so", "rnea.c", options=options)
        compiled(folder / f"rnea_lines{name}", "rnea_lines.c", "rnea.c", options=options)
    return folder


@pytest.fixture
def judged(examples, program, monkeypatch):
    monkeypatch.chdir(examples)
    return lambda *options: program("judge", "ur5", *options, "--samples", 2)


@pytest.fixture(scope="session")
def misbehaving(tmp_path_factory):
    folder = tmp_path_factory.mktemp("library")
    (folder / "odd.c").write_text(MISBEHAVING, encoding="utf-8")
    return compiled(folder / "libodd.so", "odd.c", options=("-Wno-error",))


def answers(file, symbol, *states, shape=(2,)):
    with library_function(file, symbol, HANGS) as function:
        return function.answers("gravity_torque", [{"q": np.array(q)} for q in states], shape)


class TestC:
    """The worked example, right and with one wrong sign."""

    @pytest.mark.parametrize(
        "option", ["--library=inverse_dynamics=librnea.so:rnea", "--command=inverse_dynamics=./rnea_lines"]
    )
    def test_right(self, judged, option):
        done = judged(option)
        assert done.code == AGREED
        assert done.out.startswith("Your functions on ur5: agrees\n")

    @pytest.mark.parametrize(
        "option", ["--library=inverse_dynamics=librnea_wrong.so:rnea", "--command=inverse_dynamics=./rnea_lines_wrong"]
    )
    def test_wrong(self, judged, option):
        done = judged(option)
        assert done.code == DISAGREED
        assert f"inverse_dynamics: {WRONG_SIGN}" in done.out


@pytest.mark.skipif(OCTAVE is None, reason="there is no octave-cli on this machine")
def test_octave_by_lines(judged, examples, program):
    assert program("export", "ur5", "--to", examples / "model.m").code == AGREED
    command = f"--command=inverse_dynamics={OCTAVE} rnea_lines.m"
    assert judged(command, "--restart-after", 1000).code == AGREED


class TestFiles:
    """Questions and answers as files; two rounds where a sign is wrong."""

    @pytest.fixture
    def folder(self, examples, tmp_path, monkeypatch):
        shutil.copytree(examples, tmp_path, dirs_exist_ok=True)
        monkeypatch.chdir(tmp_path)
        return tmp_path

    def verdict(self, program, run, wrong):
        """run: reads questions.csv and writes answers.csv"""
        asked = ("questions", "ur5", "--for", "inverse_dynamics", "--samples", 2, "--out", "questions.csv")
        assert program(*asked).code == AGREED
        run()
        judged = ("judge", "ur5", "--samples", 2, "--answers", "answers.csv")
        done = program(*judged)
        if not wrong:
            assert done.code == AGREED
            return
        assert done.code == PENDING
        Path("answers.csv").rename("first.csv")
        Path("further_questions.csv").rename("questions.csv")
        run()
        done = program(*judged, "--answers", "first.csv")
        assert done.code == DISAGREED
        assert f"inverse_dynamics: {WRONG_SIGN}" in done.out

    @pytest.mark.parametrize("wrong", [False, True])
    def test_c(self, program, folder, wrong):
        built = compiled(folder / "rnea_file", "rnea_file.c", "rnea.c", options=("-DSIGN=-1",) if wrong else ())
        self.verdict(
            program, lambda: subprocess.run(f"{built} < questions.csv > answers.csv", shell=True, check=True), wrong
        )

    @pytest.mark.skipif(OCTAVE is None, reason="there is no octave-cli on this machine")
    @pytest.mark.parametrize("wrong", [False, True])
    def test_octave(self, program, folder, wrong):
        assert program("export", "ur5", "--to", "model.m").code == AGREED
        script = Path("rnea_file.m").read_text(encoding="utf-8")
        Path("run.m").write_text(script.replace("3 * n));", "3 * n), 1);") if wrong else script, encoding="utf-8")
        self.verdict(program, lambda: subprocess.run([OCTAVE, "run.m"], check=True), wrong)


@pytest.fixture(scope="session")
def vectors(examples):
    """The folder of the examples, with test vectors in it."""
    arguments = ["vectors", "ur5", "--for", "inverse_dynamics", "--samples", "2", "--out", str(examples / "vectors")]
    arguments += ["--digits", "30"] if WITH_FLINT else []
    assert CliRunner().invoke(app, arguments).exit_code == AGREED
    return examples


class TestVectors:
    """The readers of test vectors: right, and with the library that has one wrong sign."""

    def failing(self, folder, command):
        """How many rows fail, of the program's own count and exit code."""
        environment = {**os.environ, "LD_LIBRARY_PATH": str(folder)}
        done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, encoding="utf-8", check=False)
        (rows,) = re.fullmatch(r"inverse_dynamics: (\d+) rows fail\n", done.stdout).groups()
        assert done.returncode == bool(int(rows)), done.stderr
        return int(rows)

    def check(self, folder, command):
        assert self.failing(folder, command) == 0
        (folder / "librnea_wrong.so").replace(folder / "librnea.so")
        assert self.failing(folder, command) == 27  # the others do not move, or one joint alone

    @pytest.fixture
    def folder(self, vectors, tmp_path):
        shutil.copytree(vectors, tmp_path, dirs_exist_ok=True)
        return tmp_path

    def test_c(self, folder):
        program = compiled(folder / "vectors_c", "vectors.c", "librnea.so")
        if WITH_FLINT:
            assert self.failing(folder, [program, "vectors/inverse_dynamics_exact.csv"]) == 0
        self.check(folder, program)

    @pytest.mark.skipif(not WITH_FLINT, reason="the extra graphdyn[exact] is not installed")
    def test_python(self, folder):
        """A library in double precision is wrong by its rounding, which the decimals show."""
        for rows, least, most in ((0, 1e-17, 1e-13), (27, 1e-3, 1e6)):
            command = [sys.executable, "vectors.py"]
            done = subprocess.run(command, cwd=folder, capture_output=True, encoding="utf-8", check=False)
            said = re.fullmatch(r"inverse_dynamics: (\d+) rows fail, errors up to (\S+) N m\n", done.stdout)
            assert int(said[1]) == rows, done.stderr
            assert least < float(said[2]) < most
            assert done.returncode == bool(rows)
            shutil.copyfile(folder / "librnea_wrong.so", folder / "librnea.so")

    @pytest.mark.skipif(shutil.which("c++") is None, reason="there is no C++ compiler (c++) on this machine")
    def test_cpp(self, folder):
        command = ["c++", "-Wall", "-Wextra", "-Werror", "-o", "vectors_cpp", "vectors.cpp", "librnea.so"]
        subprocess.run(command, check=True, cwd=folder)
        self.check(folder, folder / "vectors_cpp")

    @LONG
    @pytest.mark.skipif(shutil.which("rustc") is None, reason="there is no Rust compiler (rustc) on this machine")
    def test_rust(self, folder):
        subprocess.run(["rustc", "-D", "warnings", "-o", "vectors_rs", "vectors.rs", "-L", "."], check=True, cwd=folder)
        self.check(folder, folder / "vectors_rs")

    @pytest.mark.skipif(shutil.which("julia") is None, reason="there is no julia on this machine")
    def test_julia(self, folder):
        self.check(folder, ["julia", "vectors.jl"])

    @pytest.mark.skipif(OCTAVE is None, reason="there is no octave-cli on this machine")
    def test_octave(self, program, folder):
        assert program("export", "ur5", "--to", folder / "model.m").code == AGREED
        assert self.failing(folder, [OCTAVE, "vectors.m"]) == 0
        code = (folder / "rnea.m").read_text(encoding="utf-8").replace("1 - 2 * (nargin > 4)", "-1")
        (folder / "rnea.m").write_text(code, encoding="utf-8")
        assert self.failing(folder, [OCTAVE, "vectors.m"]) == 27


class TestLibrary:
    def test_answers(self, misbehaving):
        found = answers(misbehaving, "right", [1.0, 1 / 3], [-2.0, 1e-300])
        assert [x.tolist() for x in found] == [[2.0, 2 / 3], [-4.0, 2e-300]]

    def test_row_by_row(self, misbehaving):
        assert answers(misbehaving, "many", [0.0, 0.0], shape=(2, 2))[0].tolist() == [[0, 1], [2, 3]]

    def test_what_it_prints_is_no_answer(self, misbehaving):
        assert answers(misbehaving, "talks", [1.0, 2.0])[0].tolist() == [2.0, 4.0]

    def test_what_it_leaves_alone_is_no_number(self, misbehaving):
        np.testing.assert_array_equal(answers(misbehaving, "forgets", [1.0, 2.0])[0], [3.0, np.nan])

    @pytest.mark.parametrize(
        ("symbol", "reason"),
        [
            ("refuses", "it returned -3; 0 means that the answer is valid"),
            ("overruns", "it wrote beyond the 2 numbers of its answer"),
            ("alters", "it changed its argument q, which is const"),
        ],
    )
    def test_refusals(self, misbehaving, symbol, reason):
        assert answers(misbehaving, symbol, [1.0, 2.0]) == [Refusal(reason)]

    def test_one_number_is_told_in_the_singular(self, misbehaving):
        found = answers(misbehaving, "overruns", [1.0, 2.0], shape=(1,))
        assert found == [Refusal("it wrote beyond the 1 number of its answer")]

    def test_a_crash(self, misbehaving):
        with pytest.raises(ProgramFailed) as caught:
            answers(misbehaving, "crashes", [0.0, 2.0], [1.0, 2.0])
        question = '{"id": 2, "function": "gravity_torque", "shape": [2], "arguments": {"q": [1.0, 2.0]}}'
        assert str(caught.value) == (
            f"the process that calls {misbehaving}:crashes was ended by signal 11 ({signal.strsignal(11)}) after 1 of "
            f"2 answers; the first question without one was '{question}'; it wrote nothing to standard error"
        )

    def test_arguments_with_rows(self, misbehaving):
        """External wrenches: row by row."""
        with library_function(misbehaving, "second", HANGS) as function:
            state = {"q": np.zeros(2), "external_wrenches": np.arange(12.0).reshape(2, 6)}
            assert function.answers("inverse_dynamics", [state], (2,))[0].tolist() == [6.0, 11.0]

    def test_no_symbol(self, misbehaving):
        with pytest.raises(ProgramFailed) as caught:
            answers(misbehaving, "rihgt", [0.0, 2.0])
        assert str(caught.value).endswith(
            f"{misbehaving} has no symbol rihgt; `nm -D {misbehaving}` lists what it has; functions in C++ need "
            'extern "C"'
        )

    def test_no_library(self, examples):
        with pytest.raises(ProgramFailed, match=r"on standard error: .*rnea\.c: .*header"):
            answers(examples / "rnea.c", "rnea", [0.0, 2.0])

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("inverse_dynamics=librnea.so", "--library inverse_dynamics=librnea.so: give FILE:SYMBOL"),
            ("inverse_dynamics=no.so:rnea", "--library inverse_dynamics=no.so:rnea: there is no file no.so"),
            ("base_regressor=librnea.so:W", "librnea.so:W: nobody knows the size of its answer; use --command"),
        ],
    )
    def test_wrong_options(self, judged, words, text, message):
        done = judged("--library", text)
        assert done.code == BAD_INPUT
        assert message in words(done.err)
