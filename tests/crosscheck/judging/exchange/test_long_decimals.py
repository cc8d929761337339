"""Answers with more digits than doubles hold: read without loss, and compared with exact values."""

import json
import re
import sys

import mpmath
import numpy as np
import pytest

import crosscheck
from crosscheck.commands.program.exits import AGREED, BAD_INPUT
from crosscheck.judging.exchange.answer_files import BadAnswers, read_answers
from crosscheck.judging.exchange.printed_numbers import printed_number, printed_numbers
from crosscheck.judging.exchange.program import ProgramFunction
from crosscheck.judging.exchange.protocols import PROTOCOLS_BY_NAME
from crosscheck.quantities.tested_function import LongDecimal
from crosscheck.recordings.errors import quoted
from graphdyn import InvalidInput

pytest.importorskip("flint", reason="the extra graphdyn[exact] is not installed")

THIRD = "0.333333333333333333333333333333333333333333"
"""Forty-two digits."""

PENDULUM = """<robot name="pendulum"><link name="ground"/>
<link name="bob"><inertial><origin xyz="0.3 0 0"/><mass value="0.7"/>
  <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.03"/></inertial></link>
<joint name="turn" type="continuous"><parent link="ground"/><child link="bob"/>
  <origin xyz="0 0 1" rpy="1.5708 0 0"/><axis xyz="0 0 1"/></joint></robot>"""
"""A weight that turns about a nearly horizontal axis. All numbers but 1 are no doubles."""

PROGRAM = """
import sys
from mpmath import mp, mpf, cos, sin, nstr
mp.dps = 60
for line in sys.stdin:
    torque = mpf("0.7") * mpf("0.3") * mpf(9.81) * sin(mpf("1.5708")) * cos(mpf(float(line)))
    print(nstr(torque * (1 + mpf(sys.argv[1])), 40), flush=True)
"""
"""m l g sin(1.5708) cos q, with forty digits. The argument: a relative error."""


@pytest.fixture
def pendulum(tmp_path):
    path = tmp_path / "pendulum.urdf"
    path.write_text(PENDULUM)
    (tmp_path / "program.py").write_text(PROGRAM)
    return path


def judged(pendulum, error, **options):
    command = [sys.executable, str(pendulum.with_name("program.py")), error]
    with ProgramFunction(command, "pendulum", PROTOCOLS_BY_NAME["plain"], time_limit=60) as function:
        judgment = crosscheck.judge(pendulum, gravity_torque=function, samples=3, **options)
    return judgment, judgment.functions["gravity_torque"].exact


class TestVerdict:
    @pytest.mark.parametrize(("error", "digits"), [("0", range(39, 42)), ("1e-20", (19, 20))])
    def test_right_to_so_many_digits(self, pendulum, error, digits):
        """More than a double has, and no reason to be called wrong."""
        judgment, exact = judged(pendulum, error, exact=True)
        assert judgment.agrees
        assert exact.truth == "file"
        assert exact.given_digits == 40
        assert exact.digits in digits

    def test_without_being_asked(self, pendulum):
        """At the states that decide; an error that doubles would show is proven."""
        judgment, exact = judged(pendulum, "1e-13")
        assert judgment.agrees
        assert exact.wrong
        assert exact.digits == 13

    def test_shown(self, pendulum, program):
        command = f"gravity_torque={sys.executable} {pendulum.with_name('program.py')} 1e-25"
        done = program("judge", pendulum, "--command", command, "--samples", 2, "--exact")
        assert done.code == AGREED
        assert re.search(r"Right to 2[45] of 40\s+digits", done.out)


class TestReading:
    def test_lines(self):
        short, long = printed_numbers(f"0.5 {THIRD}")
        assert not isinstance(short, LongDecimal)
        assert (long, long.text, long.digits) == (1 / 3, THIRD, 42)

    @pytest.mark.parametrize("text", ["12345678901234567.5", "-1.00000000000000000e-5", ".12345678901234567891e+2"])
    def test_eighteen_digits_are_long(self, text):
        assert printed_number(text).text == text

    @pytest.mark.parametrize("text", ["0.00000000000000000001", "1.2345678901234567", "1e-300", "nan"])
    def test_seventeen_are_not(self, text):
        assert type(printed_number(text)) is float

    @pytest.mark.parametrize(
        ("name", "content"),
        [("x.csv", f"123456789012, 1, {THIRD}\n"), ("x.json", f'[{{"id": 123456789012, "answer": [1, {THIRD}]}}]'),
         ("x.json", f'[{{"id": 123456789012, "answer": ["1", "{THIRD}"]}}]')],
    )  # fmt: skip
    def test_files(self, tmp_path, name, content):
        path = tmp_path / name
        path.write_text(content)
        one, third = read_answers([path])[123456789012].numbers
        assert (one, third.text) == (1, THIRD)

    def test_json_lines(self):
        line = json.dumps({"id": 1, "answer": [THIRD, "-2"]})
        third, two = PROTOCOLS_BY_NAME["json"].answer(line, 1, (2,))
        assert (third.text, two) == (THIRD, -2)

    def test_any_length(self):
        long = "0." + "3" * 100_000
        exact = crosscheck.exact_values("kr500", "gravity_torque", np.zeros(6))["gravity_torque"]
        texts = np.array([long] * 6, dtype=object)
        assert exact.errors(texts)[1] == pytest.approx(exact.errors(np.full(6, 1 / 3))[1])

    @pytest.mark.parametrize("bad", ["1.2.3", "1,5", "0x10", "1_000", "", "1/3", "pi"])
    def test_what_is_no_decimal(self, tmp_path, bad):
        path = tmp_path / "x.json"
        path.write_text(json.dumps([{"id": 123456789012, "answer": [bad]}]))
        said = rf"x.json, entry 1, id 123456789012: {re.escape(quoted(bad))} is no decimal number, such as"
        with pytest.raises(BadAnswers, match=said):
            read_answers([path])

    def test_what_is_no_decimal_in_a_line(self, pendulum, program):
        command = f"gravity_torque={sys.executable} -c \"print('0.' + '3' * 30 + 'x')\""
        done = program("judge", pendulum, "--command", command, "--samples", 1, "--restart-after", 1)
        assert done.code == BAD_INPUT
        assert "which is no line of numbers; write answers alone to standard output" in " ".join(done.err.split())

    def test_errors_of_texts(self):
        """Against mpmath, of the weight of a robot at rest."""
        exact = crosscheck.exact_values("kr500", "potential_energy", np.zeros(6), digits=50)["potential_energy"]
        with mpmath.workdps(60):
            value = mpmath.mpf(str(exact.decimals(50)))
            text = mpmath.nstr(value * (1 + mpmath.mpf("1e-30")), 50)
            least, most = exact.errors(np.array(text, dtype=object))
            assert float(least) == pytest.approx(float(value) * 1e-30, rel=1e-6)
            assert float(most) == pytest.approx(float(value) * 1e-30, rel=1e-6)
        with pytest.raises(InvalidInput, match=r"'1\.2\.3' is no number"):
            exact.errors(np.array("1.2.3", dtype=object))
