"""Judging by files: graphdyn questions, graphdyn judge --answers, and a second round where the diagnosis needs one."""

import csv
import json
import re
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
from long_check import few

import graphdyn
import urdf
from crosscheck.commands.program.exits import AGREED, BAD_INPUT, DISAGREED, PENDING
from crosscheck.judging.exchange import questions as question_ids
from crosscheck.judging.exchange.answer_files import BadAnswers, GivenAnswer, read_answers
from crosscheck.judging.exchange.questions import SameId, once, question
from crosscheck.judging.exchange.rounds import AnswersPending, Replay, answered_functions, first_round, judge_answers
from crosscheck.judging.observing.function_under_test import FunctionFailure
from crosscheck.judging.setting import Setting
from crosscheck.quantities import FUNCTIONS
from crosscheck.quantities.tested_function import Refusal
from crosscheck.recordings.formats import format
from graphdyn import InvalidInput, UnknownFrame

NAMES = "inverse_dynamics,mass_matrix,bias_torque"


@pytest.fixture
def arm(small_arm, monkeypatch):
    """The working folder has a robot; its model."""
    monkeypatch.chdir(small_arm.parent)
    return urdf.load(small_arm)


def computed(model, function, arguments):
    """What a code that reads files answers."""
    given = [np.asarray(x) for x in arguments]
    if function == "inverse_dynamics":
        return graphdyn.joint_torques(model, *given)
    return getattr(graphdyn, function)(model, *given)


def rows_of(path, n=3):
    """id, function and arguments of every question, read as a stranger would."""
    path = Path(path)
    if path.suffix == ".json":
        return [
            (x["id"], x["function"], list(x["arguments"].values())) for x in json.loads(path.read_text())["questions"]
        ]
    if path.suffix == ".npz":
        with np.load(path) as arrays:
            functions = [name.removesuffix(".id") for name in arrays.files if name.endswith(".id")]
            return [
                (number, function, [arrays[f"{function}.{name}"][row] for name in FUNCTIONS[function].arguments])
                for function in functions
                for row, number in enumerate(arrays[f"{function}.id"])
            ]
    if path.suffix == ".parquet":
        table = pyarrow.parquet.read_table(path).to_pylist()
        return [(x["id"], x["function"], [v for k, v in x.items() if k not in ("id", "function") and v]) for x in table]
    with path.open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return [
        (
            int(row["id"]),
            row["function"],
            [[float(row[f"{name}{k}"]) for k in range(1, n + 1)] for name in "qva" if row.get(f"{name}1")],
        )
        for row in rows
    ]


def answer(questions, answers, model):
    """Write the answers of a code that has this model."""
    rows = [(number, function, computed(model, function, given)) for number, function, given in rows_of(questions)]
    path = Path(answers)
    if path.suffix == ".json":
        path.write_text(json.dumps([{"id": int(number), "answer": x.tolist()} for number, _, x in rows]))
    elif path.suffix == ".npz":
        arrays = {}
        for function in {function for _, function, _ in rows}:
            arrays[f"{function}.id"] = [number for number, own, _ in rows if own == function]
            arrays[f"{function}.answer"] = np.array([x for _, own, x in rows if own == function])
        np.savez(path, **arrays)
    elif path.suffix == ".parquet":
        columns = {"id": [number for number, _, _ in rows], "answer": [x.ravel() for _, _, x in rows]}
        pyarrow.parquet.write_table(pa.table(columns), path)
    else:
        lines = [",".join([str(number), *(f"{y:.17g}" for y in x.ravel())]) for number, _, x in rows]
        path.write_text("\n".join(lines), encoding="utf-8")


class TestRounds:
    @pytest.mark.parametrize("ending", ["csv", "json", "npz", "parquet"])
    def test_agreement(self, program, arm, ending):
        done = program("questions", "small.urdf", "--for", NAMES, "--samples", 3, "--out", f"q.{ending}")
        assert done.code == AGREED
        assert " ".join(done.out.split()) == (
            f"86 questions in q.{ending}, joints in the order {', '.join(arm.joint_names)}"
        )
        answer(f"q.{ending}", f"a.{ending}", arm)
        done = program("judge", "small.urdf", "--answers", f"a.{ending}", "--samples", 3)
        assert done.code == AGREED
        for name in NAMES.split(","):
            assert f"│ {name} " in done.out

    @pytest.mark.parametrize("ending", few(["csv", "json", "npz", "parquet"], "csv"))
    def test_a_second_round(self, program, arm, ending):
        wrong = arm.with_gravity(-arm.gravity)
        program("questions", "small.urdf", "--for", NAMES, "--samples", 2, "--out", f"q.{ending}")
        answer(f"q.{ending}", f"a.{ending}", wrong)
        first = ("judge", "small.urdf", "--samples", 2, "--answers", f"a.{ending}")
        done = program(*first)
        assert done.code == PENDING == 4
        assert " ".join(done.out.split()) == (
            "inverse_dynamics, bias_torque: disagreement with the reference implementations. To find out what is "
            f"wrong, answer the 128 questions in further_questions.{ending} as well, and judge with --answers "
            f"a.{ending} --answers FILE."
        )
        again = program(*first)  # the same file
        assert (again.code, again.out) == (PENDING, done.out)
        answer(f"further_questions.{ending}", f"b.{ending}", wrong)
        done = program(*first, "--answers", f"b.{ending}")
        assert done.code == DISAGREED
        assert "inverse_dynamics, bias_torque: gravity has the opposite sign [gravity]" in done.out

    def test_where_further_questions_go(self, program, arm, words):
        program("questions", "small.urdf", "--for", "inverse_dynamics", "--samples", 2, "--out", "q.csv")
        answer("q.csv", "a.csv", arm.with_gravity(-arm.gravity))
        first = ("judge", "small.urdf", "--samples", 2, "--answers", "a.csv")
        assert program(*first, "--further", "more.json").code == PENDING
        record = json.loads(Path("more.json").read_text())
        assert record["format"] == "graphdyn questions 2"
        assert record["joint_names"] == list(arm.joint_names)
        Path("further_questions.csv").write_text("precious", encoding="utf-8")
        done = program(*first)
        assert done.code == BAD_INPUT
        assert "--further further_questions.csv: there is another file of this name; name another" in words(done.err)
        assert Path("further_questions.csv").read_text(encoding="utf-8") == "precious"

    def test_other_functions_beside(self, program, arm, words):
        program("questions", "small.urdf", "--for", "mass_matrix", "--samples", 2, "--out", "q.csv")
        answer("q.csv", "a.csv", arm)
        command = ("judge", "small.urdf", "--samples", 2, "--answers", "a.csv", "--command")
        done = program(*command, "gravity_torque=sed -u 's/.*/error/'")
        assert "error: gravity_torque has no answer: error; at q = [" in done.err
        done = program(*command, "mass_matrix=cat")
        assert done.code == BAD_INPUT
        assert "there are answers of mass_matrix, which an option names as well; leave one of them out" in words(
            done.err
        )

    def test_joint_order(self, program, arm):
        """The questions are in the order that is asked for, and belong to it."""
        names = ",".join(reversed(arm.joint_names))
        for k, options in enumerate([(), ("--joint-names", names)]):
            program(
                "questions", "small.urdf", "--for", "inverse_dynamics", *options, "--samples", 2, "--out", f"{k}.csv"
            )
        ours, theirs = rows_of("0.csv"), rows_of("1.csv")
        np.testing.assert_array_equal([x[2] for x in ours], np.array([x[2] for x in theirs])[..., ::-1])
        assert not {x[0] for x in ours} & {x[0] for x in theirs}

    def test_unused_answers(self, program, arm):
        for name in ("mass_matrix", "gravity_torque"):
            program("questions", "small.urdf", "--for", name, "--samples", 2, "--out", f"{name}.csv")
        answer("mass_matrix.csv", "a.csv", arm)
        with Path("a.csv").open("a", encoding="utf-8") as file:
            file.write("\n12,1,2,3\n13,1,2,3\n")
        done = program("judge", "small.urdf", "--samples", 2, "--answers", "a.csv")
        assert done.code == AGREED
        assert done.err == "warning: 2 answers belong to no question that was asked: ids 12, 13\n"

    def test_no_number(self, program, arm):
        """The function is judged at the other states, and the one is listed by its id."""
        program("questions", "small.urdf", "--for", "gravity_torque", "--samples", 2, "--out", "q.csv")
        answer("q.csv", "a.csv", arm)
        head, line, *others = Path("a.csv").read_text(encoding="utf-8").splitlines()
        number, _, *rest = line.split(",")
        Path("a.csv").write_text("\n".join([head, ",".join([number, "nan", *rest]), *others]), encoding="utf-8")
        done = program("judge", "small.urdf", "--samples", 2, "--answers", "a.csv", "--json", "r.json")
        assert done.code == DISAGREED
        (failure,) = json.loads(Path("r.json").read_text())["functions"]["gravity_torque"]["failures"]
        assert (
            f"gravity_torque has no answer: a.csv, line 2, id {number}: number 1 is nan; at q = [" in failure["message"]
        )

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            (("--for", "mass_matrix", "--out", "q.txt"), "--out q.txt: end the name in .json, .csv, .npz or .parquet"),
            (
                ("--for", "mas_matrix", "--out", "q.csv"),
                "did you mean 'mass_matrix'?",
            ),
            (("--for", "frame_jacobian", "--out", "q.csv"), "frame_jacobian belong to one frame of the robot"),
        ],
    )
    def test_refused(self, program, arm, words, options, message):
        done = program("questions", "small.urdf", *options)
        assert done.code == BAD_INPUT
        assert message in words(done.err)
        assert not list(Path().glob("q.*"))

    def test_standard_output(self, program, arm):
        done = program("questions", "small.urdf", "--for", "mass_matrix", "--samples", 1, "--out", "-")
        assert done.out.startswith("id,function,q1,q2,q3\n")
        assert len(done.out.splitlines()) == 24


class TestEveryFunction:
    """Right answers to the first round are a judgment, whatever the function."""

    SETTING = Setting(robot="ur5", samples=2, frame="tool0", external_wrenches=True)

    def test_every_function_is_asked(self):
        asked = first_round(self.SETTING, list(FUNCTIONS)).questions
        assert {one.function for one in asked} == set(FUNCTIONS)
        assert len({one.id for one in asked}) == len(asked)
        for one in asked:
            assert tuple(one.arguments) == FUNCTIONS[one.function].called_with(loaded=True)

    def test_a_function_does_not_depend_on_the_others(self):
        """The questions of one are among those of all."""
        every = {one.id for one in first_round(self.SETTING, list(FUNCTIONS)).questions}
        for name in ("inverse_dynamics", "forward_dynamics", "joint_wrenches"):
            assert {one.id for one in first_round(self.SETTING, [name]).questions} <= every

    @pytest.mark.parametrize("external_wrenches", [False, True])
    def test_they_are_those_of_the_judge(self, external_wrenches):
        reading = urdf.Reading(gravity=(0, 1, -9))
        chosen = {"seed": 3, "beyond_limits": True, "reading": reading, "external_wrenches": external_wrenches}
        setting = Setting(robot="ur5", samples=2, frame="tool0", **chosen)
        model = urdf.load("ur5", gravity=(0, 1, -9))

        def placement(q):
            rotation, position = graphdyn.frame_placement(model, q, "tool0")
            return np.block([[rotation, position[:, None]], [0, 0, 0, 1]])

        codes = {
            "forward_dynamics": lambda *x: graphdyn.joint_accelerations(model, *x),
            "static_torque": lambda *x: graphdyn.static_torque(model, *x),
            "mass_matrix": lambda *x: graphdyn.mass_matrix(model, *x),
            "frame_placement": placement,
        }
        given = {
            one.id: GivenAnswer(codes[one.function](*one.arguments.values()).ravel(), "here")
            for one in first_round(setting, list(codes)).questions
        }
        assert set(answered_functions(setting, given)) == set(codes)
        judgment, unused = judge_answers(setting, given, {})
        assert judgment.agrees
        assert unused == []

    def test_unknown_frame(self):
        with pytest.raises(UnknownFrame):
            first_round(Setting(robot="ur5", frame="no"), ["frame_jacobian"])


class TestIds:
    def test_they_depend_on_the_question_alone(self):
        q = np.array([0.1, -2.0])
        one = question("mass_matrix", {"q": q})
        assert one.id == question("mass_matrix", {"q": q * (1 + 1e-15)}).id
        assert one.id != question("gravity_torque", {"q": q}).id
        assert one.id != question("mass_matrix", {"q": q * (1 + 1e-8)}).id
        assert question("mass_matrix", {"q": np.array([0.0])}).id == question("mass_matrix", {"q": np.array([-0.0])}).id
        assert len(str(one.id)) == 12

    def test_they_do_not_change_between_versions(self):
        """Answers that somebody keeps stay valid."""
        x = np.array([0.5, -1.0])
        assert question("mass_matrix", {"q": x}).id == 148220634166
        assert question("joint_torque_regressor", {"q": x, "v": x, "a": x}).id == 363705886018  # was "regressor"

    def test_by_chance(self, monkeypatch):
        monkeypatch.setattr(question_ids, "N_IDS", 1)
        asked = [question("mass_matrix", {"q": np.array([x])}) for x in (1.0, 1.0, 2.0)]
        with pytest.raises(SameId) as caught:
            once(asked)
        assert str(caught.value) == "two questions have the id 100000000000 by chance; give another --seed"
        assert len(once(asked[:2])) == 1


def given(asked, value=1.0):
    return {one.id: GivenAnswer(np.full(2, value), f"a.csv, line {k}") for k, one in enumerate(asked, start=1)}


class TestReplay:
    STATES = tuple({"q": np.array([k, 0.5])} for k in range(4))
    ASKED = tuple(question("gravity_torque", state) for state in STATES)

    def ask(self, replay, *rows):
        return replay.answers("gravity_torque", [self.STATES[row] for row in rows], (2,))

    def test_missing(self):
        with pytest.raises(BadAnswers) as caught:
            self.ask(Replay(given(self.ASKED[:1]), set()), 0, 1, 2)
        ids = f"{self.ASKED[1].id}, {self.ASKED[2].id}"
        assert str(caught.value) == f"gravity_torque: no answers to 2 questions, ids {ids}"

    def test_a_stage_too_many(self):
        replay = Replay(given(self.ASKED[:3]), used := set())
        self.ask(replay, 0)
        assert self.ask(replay, 0, 0)[1].tolist() == [1, 1]  # asked again
        assert self.ask(replay, 0, 1)[1].tolist() == [1, 1]
        self.ask(replay, 2)
        with pytest.raises(
            FunctionFailure, match=r"^gravity_torque would have to answer questions in a further round$"
        ):
            self.ask(replay, 3)
        assert used == {one.id for one in self.ASKED[:3]}

    def test_pending(self):
        replay = Replay(given(self.ASKED[:1]), set())
        self.ask(replay, 0)
        with pytest.raises(AnswersPending) as caught:
            self.ask(replay, 0, 1, 1, 2)
        assert [one.id for one in caught.value.questions] == [one.id for one in self.ASKED[1:3]]

    def test_a_part_of_the_second_round(self):
        replay = Replay(given(self.ASKED[:2]), set())
        self.ask(replay, 0)
        with pytest.raises(BadAnswers, match=rf"no answers to 1 question, id {self.ASKED[2].id}$"):
            self.ask(replay, 1, 2)

    def test_many_missing(self):
        states = [{"q": np.array([k])} for k in range(9)]
        with pytest.raises(BadAnswers, match=r"no answers to 9 questions, ids .* and 4 more$"):
            Replay({}, set()).answers("gravity_torque", states, (1,))

    def test_size(self):
        with pytest.raises(BadAnswers) as caught:
            Replay(given(self.ASKED), set()).answers("gravity_torque", self.STATES[:1], (3,))
        assert str(caught.value) == f"a.csv, line 1, id {self.ASKED[0].id}, gravity_torque: 2 numbers, expected 3"

    def test_not_finite(self):
        found = self.ask(Replay(given(self.ASKED, np.inf), set()), 0)
        assert found == [Refusal(f"a.csv, line 1, id {self.ASKED[0].id}: number 1 is inf")]

    def test_other_robot(self):
        with pytest.raises(BadAnswers) as caught:
            answered_functions(Setting(robot="ur5", samples=2), given(self.ASKED[:1]))
        assert str(caught.value) == (
            f"a.csv, line 1: no question has id {self.ASKED[0].id}; give the same robot and "
            "options (--samples, --seed, --joint-names, --lock and so on) as to `graphdyn questions`, and leave the "
            "ids as they are"
        )


class TestReading:
    def read(self, tmp_path, name, content):
        path = tmp_path / name
        if isinstance(content, dict):
            np.savez(path, **content)
        else:
            path.write_bytes(content.encode() if isinstance(content, str) else content)
        return {number: x.numbers.tolist() for number, x in read_answers([path]).items()}

    def test_lists_that_are_nested_32_times_are_read(self, tmp_path):
        nested = f"{'[' * 32}1.5, 2{']' * 32}"
        assert self.read(tmp_path, "a.json", f'[{{"id": 7, "answer": {nested}}}]') == {7: [1.5, 2.0]}

    @pytest.mark.parametrize(
        ("name", "content"),
        [
            ("a.csv", "123456789012,1,2\n7,3,4\n"),
            ("a.csv", "id,tau1,tau2\r\n123456789012.0; 1;\t2\r\n\r\n7 3 4"),
            ("a.csv", "\ufeffid 1 2\n  123456789012  1.0  2e0\n7,3,4"),
            ("a.json", '[{"id": 123456789012, "answer": [[1], [2]]}, {"id": 7.0, "answer": [3, 4]}]'),
            ("a.npz", {"id": np.array([123456789012, 7]), "answer": np.array([[1, 2], [3, 4]])}),
            ("A.NPZ", {"f.id": [123456789012.0], "f.answer": [[1.0, 2.0]], "g.id": [7], "g.answer": [[[3], [4]]]}),
        ],
    )
    def test_forms(self, tmp_path, name, content):
        if name == "A.NPZ":
            np.savez(tmp_path / "a.npz", **content)
            content = (tmp_path / "a.npz").read_bytes()
        assert self.read(tmp_path, name, content) == {123456789012: [1, 2], 7: [3, 4]}

    def test_parquet(self, tmp_path):
        pyarrow.parquet.write_table(pa.table({"id": [7], "answer": [[1.0, None]]}), tmp_path / "a.parquet")
        (found,) = read_answers([tmp_path / "a.parquet"]).values()
        np.testing.assert_array_equal(found.numbers, [1, np.nan])
        assert found.where == f"{tmp_path / 'a.parquet'}, row 1"

    @pytest.mark.parametrize(
        ("name", "content", "message"),
        [
            ("a.txt", "", ": no file of answers ends in '.txt'; give .csv, .json, .npz, .parquet"),
            ("a.csv", "id,1\n", ": no answers; give a row with the id and the numbers for each question"),
            ("a.csv", "7,1\n8,x\n", ", line 2: 'x' is no number; write the id and the numbers of the answer"),
            ("a.csv", "7.5,1\n", ", line 1: 7.5 is no id; begin with that of the question, and write all its digits"),
            ("a.json", "[", ": is no JSON: Expecting value: line 1 column 2 (char 1)"),
            ("a.json", "{}", ': holds no list; the form is [{"id": …, "answer": […]}, …]'),
            ("a.json", '[{"id": 7}]', ', entry 1: has no id and answer; the form is [{"id": …, "answer": […]}, …]'),
            ("a.json", '[{"id": "7", "answer": [1]}]', ", entry 1: the id is '7'; give that of a question, a number"),
            (
                "a.json",
                '[{"id": 7, "answer": ["x"]}]',
                ", entry 1, id 7: 'x' is no decimal number, such as",
            ),
            ("a.npz", "PK", ": not a readable .npz file (File is not a zip file); save it with numpy.savez"),
            ("a.npz", {"x": [1]}, ": has no array 'id'; name two id and answer, or FUNCTION.id and FUNCTION.answer"),
            ("a.npz", {"f.id": [1], "g": [1]}, ": 'f.answer' needs 1 row, one for each entry of 'f.id'"),
            ("a.npz", {"id": [7], "answer": [[1j]]}, ", answer[0]: is of type complex128; give real numbers"),
            ("a.parquet", "x", ": not a readable Parquet file ("),
        ],
    )
    def test_refused(self, tmp_path, name, content, message):
        with pytest.raises(BadAnswers) as caught:
            self.read(tmp_path, name, content)
        assert str(caught.value).startswith(f"{tmp_path / name}{message}")

    @pytest.mark.parametrize(
        ("name", "content", "message"),
        [
            ("a.csv", "1;0,5;0.7\n", ", line 1: '0,5' is one number or two; write decimal points; write the id"),
            ("a.csv", "id q\n1 0,5 0,7\n", ", line 2: '0,5' is one number or two; write decimal points"),
            ("a.csv", "7,1,,2\n", ", line 1: '' is no number"),
            ("a.csv", "1;,5;,7\n", ", line 1: '' is no number"),
            ("a.csv", "7,1_0\n", ", line 1: '1_0' is no number"),
            ("a.csv", "7,0x10\n", ", line 1: '0x10' is no number"),
            ("a.csv", "7,1e400\n", ", line 1: '1e400' is no number"),
            ("a.csv", "7,١٢\n", ", line 1: '١٢' is no number"),
            ("a.csv", "7,1\x0b8,2\n", ", line 1: '1\\x0b8' is no number"),
            ("a.csv", f"7,{'1' * 5000}\n", f", line 1: '{'1' * 37}...{'1' * 38}' is no number"),
            ("a.csv", "9007199254740993,1\n", ", line 1: 9007199254740992 is no id"),
            ("a.csv", "nan,1\n", ", line 1: nan is no id"),
            ("a.json", '[{"id": 9007199254740993, "answer": [1]}]', ", entry 1: 9007199254740993 is no id"),
            ("a.json", f'[{{"id": 1{"0" * 5000}, "answer": [1]}}]', f", entry 1: 1{'0' * 36}...{'0' * 38} is no id"),
            ("a.json", '[{"id": 1e400, "answer": [1]}]', ", entry 1: 1e400 is no id"),
            ("a.json", '[{"id": NaN, "answer": [1]}]', ", entry 1: nan is no id"),
            ("a.json", '[{"id": true, "answer": [1]}]', ", entry 1: the id is 'True'; give that of a question"),
            (
                "a.json",
                '[{"id": 7, "answer": [9007199254740993]}]',
                ", entry 1, id 7: no double holds '9007199254740993'",
            ),
            ("a.json", '[{"id": 7, "answer": [1e400]}]', ", entry 1, id 7: no double holds '1e400'; give real numbers"),
            ("a.json", '[{"id": 7, "answer": {"x": 1}}]', ", entry 1, id 7: the answer is no array of numbers"),
            (
                "a.json",
                '[{"id": 7, "id": 8, "answer": [1]}]',
                ": is no JSON: an object has 'id' twice",
            ),
            ("a.json", "[" * 100_000, ": is nested too deeply"),
            (
                "a.json",
                f'[{{"id": 7, "answer": {"[" * 900}1{"]" * 900}}}]',
                ", entry 1, id 7: the answer is nested more than 32 times",
            ),
            ("a.json", b"\xff\xfe[", ": is no JSON: "),
            (
                "a.npz",
                {"id": np.array(7), "answer": [[1.0]]},
                ": 'id' is no row of ids (N,), but of shape () and type int64",
            ),
            ("a.npz", {"id": ["7"], "answer": [[1.0]]}, ": 'id' is no row of ids (N,), but of shape (1,) and type <U1"),
            ("a.npz", {"id": [[7]], "answer": [[1.0]]}, ": 'id' is no row of ids (N,), but of shape (1, 1)"),
            ("a.npz", {"id": np.zeros((10**9, 0)), "answer": np.zeros((10**9, 0))}, ": 'id' is no row of ids"),
            (
                "a.npz",
                {"id": [7], "answer": np.array(1.0)},
                ": 'answer' needs 1 row, one for each entry of 'id'",
            ),
            ("a.npz", {"id": [2**53 + 1], "answer": [1.0]}, ", answer[0]: 9007199254740993 is no id"),
            ("a.npz", {"id": [7], "answer": [2**53 + 1]}, ", answer[0], id 7: no double holds '9007199254740993'"),
            ("a.npz", {"id": np.array([7], dtype=object), "answer": [1.0]}, ": 'id' is not an array of numbers"),
        ],
    )
    def test_hostile(self, tmp_path, name, content, message):
        with pytest.raises(BadAnswers) as caught:
            self.read(tmp_path, name, content)
        assert str(caught.value).startswith(f"{tmp_path / name}{message}")
        assert "\n" not in str(caught.value)

    def test_hostile_archives(self, tmp_path, monkeypatch):
        """Of another kind, encrypted, with a shape beyond its bytes, and larger than allowed once expanded."""
        path = tmp_path / "a.npz"

        def refused(match):
            with pytest.raises(BadAnswers, match=match):
                read_answers([path])

        with path.open("wb") as file:
            np.save(file, np.zeros(3))
        refused(r"a.npz: not a readable .npz file \(File is not a zip file\)")
        np.savez(path, id=[7], answer=[[1.0]])
        whole = path.read_bytes()
        for signature, flags in ((b"PK\3\4", 6), (b"PK\1\2", 8)):  # bit 0: encrypted
            content = bytearray(whole)
            places = [found.start() for found in re.finditer(re.escape(signature), whole)]
            for place in places:
                content[place + flags] |= 1
        path.write_bytes(content)
        refused(r"a.npz: not a readable .npz file \(.*encrypted.*\)")
        path.write_bytes(whole.replace(b"'shape': (1,)", b"'shape': (9,)"))
        refused(r"a.npz: 'id.npy' announces 72 bytes of numbers|not a readable .npz file")
        np.savez_compressed(path, id=[7], answer=np.zeros((1, 1000)))
        monkeypatch.setattr(format, "MAX_EXPANDED_BYTES", 4096)
        refused(r"a.npz: its content is larger than 4096 bytes when expanded; divide the file")

    def test_answers_that_are_no_numbers_are_kept(self, tmp_path):
        """The judge says which of them is nan or inf."""
        for name, content in (
            ("a.csv", "7,nan,-inf,Infinity\n"),
            ("a.json", '[{"id": 7, "answer": [NaN, -Infinity, Infinity]}]'),
        ):
            np.testing.assert_array_equal(self.read(tmp_path, name, content)[7], [np.nan, -np.inf, np.inf])

    def test_columns_of_parquet(self, tmp_path):
        pyarrow.parquet.write_table(pa.table({"id": [7], "x": [1.0]}), tmp_path / "a.parquet")
        with pytest.raises(BadAnswers, match=r"a\.parquet: has the columns id, x; name them id and answer"):
            read_answers([tmp_path / "a.parquet"])

    @pytest.mark.parametrize("name", ["a.csv", "a.json", "a.npz", "a.parquet"])
    def test_no_file(self, tmp_path, name):
        with pytest.raises(FileNotFoundError):
            read_answers([tmp_path / name])

    def test_doubled(self, tmp_path):
        for name, content in (("a.csv", "7,1\n8,2\n"), ("b.csv", "9,2\n8,2\n")):
            (tmp_path / name).write_text(content, encoding="utf-8")
        with pytest.raises(BadAnswers) as caught:
            read_answers([tmp_path / "a.csv", tmp_path / "b.csv"])
        where = [f"{tmp_path / name}, line 2" for name in ("a.csv", "b.csv")]
        assert str(caught.value) == f"id 8 is answered twice: in {where[0]} and in {where[1]}"

    def test_known_names(self):
        with pytest.raises(InvalidInput, match="there is no function 'rnea' to judge; known are inverse_dynamics, "):
            first_round(Setting(robot="ur5"), ["rnea"])
