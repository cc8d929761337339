"""graphdyn judge --command: programs in any language, and all that they may do wrong."""

import shlex
import signal
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from long_check import few
from own_processes import HANGS, alive

from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED
from crosscheck.judging.exchange import line_process
from crosscheck.judging.exchange.line_process import LineProcess, ProgramFailed, end_in_words
from crosscheck.judging.exchange.printed_numbers import UnreadableAnswer
from crosscheck.judging.exchange.program import ProgramFunction
from crosscheck.judging.exchange.protocols import PROTOCOLS_BY_NAME, number_text
from crosscheck.quantities.tested_function import Refusal

SOON = 0.3
"""Time limit where an answer never comes [s]."""

STATES = [{"q": np.array([k, 0.5])} for k in range(3)]

AT_THE_END = "globals().setdefault('held', []).append('1 2')\nprint(*held, sep='\\n')"

LISTENS = "import sys\nfor line in sys.stdin:\n    x = line.split()\n    "


def echo(code, *, protocol="plain", time_limit=HANGS, restart_after=None):
    """A Python program as a function under test: this, after reading a line as the words x."""
    command = [sys.executable, "-c", LISTENS + code]
    return ProgramFunction(command, "echo", PROTOCOLS_BY_NAME[protocol], time_limit, restart_after)


def answers(function, shape=(2,)):
    with function:
        return function.answers("gravity", STATES, shape)


class TestLines:
    """What is written and read."""

    @pytest.mark.parametrize("restart_after", [None, 1, 2, 3, 10])
    def test_one_per_question(self, restart_after):
        found = answers(echo("print(*x, flush=True)", restart_after=restart_after))
        assert [answer.tolist() for answer in found] == [[0, 0.5], [1, 0.5], [2, 0.5]]

    def test_17_digits(self):
        numbers = np.random.default_rng(0).normal(size=100) * 10.0 ** np.arange(-50, 50)
        assert [float(number_text(x)) for x in numbers] == numbers.tolist()

    def test_matrices_row_by_row(self):
        found = answers(echo("print(1, 2, 3, 4, flush=True)"), (2, 2))
        assert found[0].tolist() == [[1, 2], [3, 4]]

    def test_any_number_of_columns(self):
        assert answers(echo("print(1, 2, 3, 4, 5, 6, flush=True)"), (2, None))[0].shape == (2, 3)

    def test_no_whole_number_of_columns(self):
        with pytest.raises(ProgramFailed, match="answer 1 is '1 2 3': 3 numbers, expected a multiple of 2; "):
            answers(echo("print(1, 2, 3, flush=True)"), (2, None))

    def test_blank_lines_and_commas(self):
        found = answers(echo("print(); print('1,  2e-3\\r', flush=True)"))
        assert found[0].tolist() == [1, 0.002]

    def test_what_is_not_finite(self):
        assert np.isnan(answers(echo("print('nan -Inf', flush=True)"))[0][0])

    def test_json(self):
        code = """
    import json; asked = json.loads(line)
    assert (asked["function"], asked["shape"]) == ("gravity", [2, 1])
    print(json.dumps({"id": asked["id"], "answer": [[asked["arguments"]["q"][0]], [None]]}), flush=True)"""
        found = answers(echo(code, protocol="json"), (2, 1))
        assert [answer[0, 0] for answer in found] == [0, 1, 2]
        assert np.isnan(found[0][1, 0])

    @pytest.mark.parametrize(
        ("protocol", "line", "reason"),
        [
            ("plain", "error: out of reach", "out of reach"),
            ("plain", "error", "error"),
            ("json", '{"id": 1, "error": "out of reach"}', "out of reach"),
        ],
    )
    def test_no_answer(self, protocol, line, reason):
        assert PROTOCOLS_BY_NAME[protocol].answer(line, 1, (2,)) == Refusal(reason)

    def test_full_pipes(self):
        """It answers with more than a pipe holds before it has read all that a pipe holds."""
        many = [{"q": np.full(2, k / 7)} for k in range(4000)]
        with echo("print(*x * 20, flush=True)") as function:
            found = function.answers("gravity", many, (40,))
        assert [answer[0] for answer in found] == [k / 7 for k in range(4000)]

    def test_started_once(self):
        code = "import os; print(os.getpid(), len(x), flush=True)"
        with echo(code) as function:
            first, second = (function.answers("gravity", STATES, (2,)) for _ in range(2))
        assert len({answer[0] for answer in first + second}) == 1
        assert len({answer[0] for answer in answers(echo(code, restart_after=2))}) == 2


class TestUnreadable:
    @pytest.mark.parametrize(
        ("protocol", "line", "message"),
        [
            ("plain", "ready", "'ready', which is no line of numbers"),
            ("plain", "1 2 3", "'1 2 3': 3 numbers, expected 2"),
            ("json", "[1, 2", """'[1, 2', which is no JSON; an answer is {"id": …, "answer": […]}"""),
            ("json", "[1, 2]", """'[1, 2]'; an answer is {"id": …, "answer": […]}"""),
            ("json", '{"id": 1}', """'{"id": 1}'; an answer is {"id": …, "answer": […]}"""),
            (
                "json",
                '{"id": 2, "answer": [1, 2]}',
                """'{"id": 2, "answer": [1, 2]}', whose id is not 1; answer the questions in their order""",
            ),
            (
                "json",
                '{"id": 1, "answer": [1, true]}',
                """'{"id": 1, "answer": [1, true]}': the answer is no array of numbers""",
            ),
            ("json", '{"id": 1, "answer": [1]}', """'{"id": 1, "answer": [1]}': 1 number, expected 2"""),
            ("plain", "x" * 100, f"'{'x' * 79}…', which is no line of numbers"),
        ],
    )
    def test_lines(self, protocol, line, message):
        with pytest.raises(UnreadableAnswer) as caught:
            PROTOCOLS_BY_NAME[protocol].answer(line, 1, (2,))
        assert str(caught.value) == message

    def test_which_answer(self):
        with pytest.raises(ProgramFailed) as caught:
            answers(echo("print('ready' if x[0] == '1' else '1 2', flush=True)"))
        assert str(caught.value) == (
            "echo: answer 2 is 'ready', which is no line of numbers; write answers alone to standard output, and "
            "everything else to standard error"
        )

    def test_too_many_lines(self):
        with pytest.raises(ProgramFailed) as caught:
            answers(echo("print('1 2\\n7 8', flush=True)"))
        assert str(caught.value) == (
            "echo wrote more than the 3 lines that answer its questions, such as '7 8': write one line per question, a "
            "matrix row by row in one line, and everything else to standard error"
        )

    def test_a_prompt(self):
        with pytest.raises(ProgramFailed, match=r"^echo wrote more than the 3 lines .*, such as '> ':"):
            answers(echo("import os; os.write(1, b'1 2\\n' + b'> ' * (x[0] == '2'))"))

    def test_no_line_breaks(self, monkeypatch):
        monkeypatch.setattr(line_process, "MAX_LINE_BYTES", 1000)
        with pytest.raises(ProgramFailed, match=r"echo wrote \d+ bytes without the end of a line; end each answer"):
            answers(echo("print('1 ' * 1000, end='', flush=True)"))


class TestFailure:
    def test_what_holds_its_output_back(self, monkeypatch):
        """As a C program does that does not call fflush."""
        monkeypatch.setattr(line_process, "CLOSING_TIMEOUT", HANGS)
        with pytest.raises(ProgramFailed) as caught:
            answers(echo(AT_THE_END, time_limit=SOON))
        assert str(caught.value) == (
            "echo did not write answer 1 of 3 within 0.3 s, but wrote 3 more once its input was closed: it holds "
            "answers back; flush the output after each answer (C: fflush(stdout); C++: std::endl; Fortran: flush(6)), "
            "or give --restart-after if it waits for more input, as Octave's fgetl does"
        )

    def test_what_answers_at_the_end_of_its_input(self):
        assert len(answers(echo(AT_THE_END, restart_after=3))) == 3

    def test_no_answer_in_time(self, monkeypatch):
        """The second time: only then is it sure to have been started."""
        code = "import time; print('thinking', file=sys.stderr); print(1, 2, flush=True)\n    "
        with echo(f"{code}if x[0] == '2': time.sleep(600)") as function:
            function.answers("gravity", STATES, (2,))
            monkeypatch.setattr(function._process, "_time_limit", SOON)
            monkeypatch.setattr(line_process, "CLOSING_TIMEOUT", SOON)
            with pytest.raises(ProgramFailed) as caught:
                function.answers("gravity", STATES, (2,))
        assert str(caught.value) == (
            "echo did not write answer 1 of 3 within 0.3 s; if it does answer, flush the output after each answer (C: "
            "fflush(stdout); C++: std::endl; Fortran: flush(6)), or give more time by --time-limit; the question was "
            "'0 0.5'; on standard error: thinking\nthinking\nthinking"
        )

    def test_its_end(self):
        with pytest.raises(ProgramFailed) as caught:
            answers(echo("sys.exit('singular') if x[0] == '1' else print(1, 2, flush=True)"))
        assert str(caught.value) == (
            "echo ended itself with exit code 1 after 1 of 3 answers; the first question without one was '1 0.5'; on "
            "standard error: singular"
        )

    def test_its_end_by_a_signal(self):
        with pytest.raises(ProgramFailed) as caught:
            answers(echo("import os; os.abort()"))
        assert str(caught.value) == (
            f"echo was ended by signal 6 ({signal.strsignal(6)}) after 0 of 3 answers; the first question without one "
            "was '0 0.5'; it wrote nothing to standard error"
        )

    def test_a_closed_output(self, monkeypatch):
        monkeypatch.setattr(line_process, "CLOSING_TIMEOUT", SOON)
        with pytest.raises(ProgramFailed, match=r"^echo closed its output after 0 of 3 answers; "):
            answers(echo("import os, time; os.close(1); time.sleep(99)"))

    def test_a_closed_input(self):
        """The questions that it does not read are no error of ours."""
        many = [{"q": np.zeros(20)} for _ in range(10000)]
        with (
            echo("sys.stdin.close(); print(1, 2, flush=True); break") as function,
            pytest.raises(ProgramFailed, match=r"^echo ended itself with exit code 0 after 1 of 10000 answers; "),
        ):
            function.answers("gravity", many, (2,))

    def test_only_the_end_of_what_it_said(self, monkeypatch):
        monkeypatch.setattr(line_process, "MAX_REPEATED_ERROR", 10)
        with pytest.raises(ProgramFailed, match=r"on standard error: xxxx last$"):
            answers(echo("sys.exit('x' * 100 + ' last')"))

    @pytest.mark.parametrize(
        ("name", "mode", "content", "message"),
        [
            ("absent", None, "", "there is no program absent"),
            ("here", 0o755, "#!/bin/sh\n", "there is no program here; the file here is ./here"),
            (
                "./no_interpreter",
                0o755,
                "#!/no/such/shell\n",
                "what the first line of ./no_interpreter names does not exist",
            ),
            ("./script", 0o644, "", "./script is no executable program; compile it, or chmod +x a script"),
            (
                "./data",
                0o755,
                "1 2 3",
                "./data is no program; begin with the one that runs it, such as 'octave-cli ./data'",
            ),
        ],
    )
    def test_what_cannot_be_started(self, tmp_path, monkeypatch, name, mode, content, message):
        monkeypatch.chdir(tmp_path)
        if mode is not None:
            Path(name).write_text(content, encoding="utf-8")
            Path(name).chmod(mode)
        with pytest.raises(ProgramFailed) as caught:
            LineProcess([name], "--command f", HANGS)
        assert str(caught.value) == f"--command f cannot be started: {message}"

    def test_end_in_words(self):
        assert end_in_words(3) == "ended itself with exit code 3"
        assert end_in_words(-9) == "was ended by signal 9 (Killed)"


@pytest.fixture
def plain_rnea(tmp_path, monkeypatch):
    """A folder, the working one, with a program that answers for kr500; with an argument, gravity is upside down."""
    code = f"""
import sys
import numpy as np
sys.path[:0] = {sys.path!r}
import graphdyn
model = graphdyn.kr500()
if len(sys.argv) > 1:
    model = model.with_gravity(-model.gravity)
for line in sys.stdin:
    q, v, a = np.array(line.split(), float).reshape(3, -1)
    print(*map(repr, graphdyn.joint_torques(model, q, v, a).tolist()), flush=True)
"""
    (tmp_path / "my rnea.py").write_text(code, encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return f"{shlex.quote(sys.executable)} 'my rnea.py'"


class TestCommand:
    """The option."""

    def test_right(self, program, plain_rnea):
        done = program("judge", "kr500", "--command", f"inverse_dynamics={plain_rnea}", "--samples", 1)
        assert done.code == AGREED
        assert done.out.startswith("Your functions on kr500: agrees\n")

    def test_wrong(self, program, plain_rnea):
        done = program("judge", "kr500", "--command", f"inverse_dynamics={plain_rnea} x", "--samples", 1)
        assert done.code == DISAGREED
        assert "inverse_dynamics: gravity has the opposite sign [gravity]" in done.out

    def test_two_functions(self, program, plain_rnea):
        options = ("--command", f"inverse_dynamics={plain_rnea}", "--command", "mass_matrix=sed -u 's/.*/1 2/'")
        done = program("judge", "kr500", *options, "--samples", 1)
        assert done.code == BAD_INPUT
        assert done.err.startswith(
            "error: --command mass_matrix=sed -u 's/.*/1 2/': answer 1 is '1 2': 2 numbers, expected 36; "
        )

    def test_a_refusal(self, program):
        done = program("judge", "ur5", "--command", "mass_matrix=sed -u 's/.*/error: no idea/'", "--samples", 1)
        assert done.code == BAD_INPUT
        assert done.err.startswith("error: mass_matrix has no answer: no idea; at q = [")

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            (("--command", "./rnea"), "--command ./rnea: give NAME='PROGRAM …'"),
            (("--command", "torque=./rnea"), "there is no function 'torque' to judge; "),
            (("--command", "mass_matrix='x"), "--command mass_matrix='x: No closing quotation; close the quotation"),
            (
                ("--command", "mass_matrix=x", "--command", "mass_matrix=y"),
                "--command mass_matrix=y: mass_matrix is given twice",
            ),
            (
                ("--command", "mass_matrix=x", "--library", "mass_matrix=pyproject.toml:y"),
                "mass_matrix is named by --command and by --library; name it once",
            ),
            (
                ("--command", "mass_matrix=x", "--mass-matrix", "my.py:f"),
                "mass_matrix is named by --mass-matrix and by --command or --library; name it once",
            ),
        ],
    )
    def test_wrong_options(self, program, words, options, message):
        done = program("judge", "ur5", *options)
        assert done.code == BAD_INPUT
        assert message in words(done.err)

    def test_the_program_is_no_output(self, program, words, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        Path("rnea").write_text("", encoding="utf-8")
        done = program("judge", "ur5", "--command", "mass_matrix=./rnea --fast", "--json", "rnea")
        assert done.code == BAD_INPUT
        assert "--json rnea: --command reads this file; name another" in words(done.err)


@pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="processes are found in /proc")
@pytest.mark.parametrize("number", few([signal.SIGINT, signal.SIGTERM, signal.SIGKILL], signal.SIGKILL))
def test_it_ends_with_us(started, tmp_path, number):
    """Though it neither reads nor writes, and even if the program that started it is killed."""
    sleeper = "import os, time; open('pid', 'w').write(str(os.getpid())); time.sleep(600)"
    command = f"{sys.executable} -c {shlex.quote(sleeper)}"
    program = started("judge", "ur5", "--command", f"mass_matrix={command}", "--samples", 1)
    while not (pid := tmp_path / "pid").exists() or not pid.read_text():
        assert program.poll() is None
        time.sleep(0.01)
    program.send_signal(number)
    program.communicate()
    deadline = time.monotonic() + HANGS
    while alive(int(pid.read_text())):
        assert time.monotonic() < deadline
        time.sleep(0.02)
