"""graphdyn vectors: states, answers and tolerances, confirmed by two implementations, whole or not at all."""

import errno
import json
import os
import re
import sys
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pytest
from failing import failing
from faults.textbook import TextbookArm
from jsonschema import Draft202012Validator
from shared_data import REPOSITORY

import crosscheck
import urdf
from crosscheck.commands.program.console import in_words
from crosscheck.commands.program.exits import AGREED, BAD_INPUT
from crosscheck.commands.program.output_files import write_folder
from crosscheck.judging.exchange.rounds import states_for
from crosscheck.judging.exchange.vectors import confirmed_functions, tolerances, vector_tables
from crosscheck.judging.observing.references import relative_errors
from crosscheck.judging.setting import Setting
from crosscheck.quantities import FUNCTIONS
from graphdyn import InvalidInput

BOUND = 1e-9
SAMPLES = 3


@pytest.fixture
def folder(program, small_arm, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    done = program("vectors", "small.urdf", "--samples", SAMPLES, "--frame", "tool", "--out", "vectors")
    assert done.code == AGREED
    return tmp_path / "vectors"


def numbers(path):
    return np.loadtxt(path, delimiter=",", skiprows=1)


class TestFolder:
    def test_what_is_listed_is_there(self, folder):
        listed = json.loads((folder / "vectors.json").read_text(encoding="utf-8"))
        Draft202012Validator(
            json.loads((REPOSITORY / "docs/schemas/vectors-2.schema.json").read_text("utf-8"))
        ).validate(listed)
        assert {path.name for path in folder.iterdir()} == {"vectors.json", *listed["files"]}
        assert [table["function"] for table in listed["tables"]] == confirmed_functions("tool")
        hashes = [sha256((folder / listed["model"]).read_bytes()).hexdigest()]
        for table in listed["tables"]:
            rows = numbers(folder / table["file"])
            assert rows.shape == (listed["states"], table["argument_count"] + 2 * table["answer_count"])
            assert table["answer_count"] == np.prod(table["shape"], dtype=int)
            assert {"graphdyn", "pinocchio"} <= set(table["references"])
            assert table["sha256"] == sha256((folder / table["file"]).read_bytes()).hexdigest()
            hashes.append(table["sha256"])
        assert listed["sha256"] == sha256("".join(hashes).encode()).hexdigest()

    def test_another_code_is_right(self, folder, small_arm):
        """The textbook recursion, which shares no line with graphdyn, passes; with one wrong sign it fails."""
        arm = TextbookArm.of(urdf.load(small_arm))
        rows = numbers(folder / "inverse_dynamics.csv")
        q, v, a, expected, tolerance = np.split(rows, 5, axis=1)

        def within(arm):
            tau = [arm.inverse_dynamics(*row) for row in zip(q, v, a, strict=True)]
            return (np.abs(tau - expected) <= tolerance).all(axis=1)

        assert within(arm).all()
        moving = np.count_nonzero(v, axis=1) > 1  # one joint alone has no such term
        assert not within(arm.but(cross=-1.0))[moving].any()
        mass = np.split(numbers(folder / "mass_matrix.csv")[:, 3:], 2, axis=1)
        found = np.array([arm.mass_matrix(row).ravel() for row in q])
        assert (np.abs(found - mass[0]) <= mass[1]).all()

    def test_again(self, program, folder):
        """The same folder; files of functions that are no longer asked for go."""
        before = (folder / "gravity_torque.csv").read_bytes()
        done = program("vectors", "small.urdf", "--samples", SAMPLES, "--for", "gravity_torque", "--out", folder)
        assert done.code == AGREED
        assert {path.name for path in folder.iterdir()} == {"vectors.json", "model.json", "gravity_torque.csv"}
        assert (folder / "gravity_torque.csv").read_bytes() == before
        assert [path.name for path in folder.parent.iterdir() if path.name.startswith(".")] == []

    def test_conventions_and_precision(self, program, folder):
        options = ("--frame", "tool", "--convention", "reference=local", "--precision", "single", "--samples", SAMPLES)
        program("vectors", "small.urdf", "--for", "frame_jacobian", *options, "--out", "other")
        listed = json.loads(Path("other/vectors.json").read_text(encoding="utf-8"))
        assert listed["tables"][0]["conventions"]["reference"] == "local"
        assert listed["bound"] == 1e-5


class TestProvenDigits:
    @pytest.fixture(autouse=True)
    def flint(self):
        pytest.importorskip("flint", reason="the extra graphdyn[exact] is not installed")

    @pytest.fixture
    def exact_folder(self, program, small_arm, tmp_path, monkeypatch):
        """Of functions with an exact form, and one in a convention that has none."""
        monkeypatch.chdir(tmp_path)
        declared = ("--convention", "reference=local", "--convention", "axes=world")
        options = ("--frame", "tool", *declared, "--samples", 1, "--digits", 40)
        assert program("vectors", "small.urdf", *options, "--out", "vectors").code == AGREED
        return tmp_path / "vectors"

    def test_beside_the_doubles(self, exact_folder):
        """Arguments and tolerances are the same; every answer differs by rounding, and has more digits."""
        listed = json.loads((exact_folder / "vectors.json").read_text(encoding="utf-8"))
        schema = json.loads((REPOSITORY / "docs/schemas/vectors-2.schema.json").read_text("utf-8"))
        Draft202012Validator(schema).validate(listed)
        assert {path.name for path in exact_folder.iterdir()} == {"vectors.json", *listed["files"]}
        assert listed["exact"] == {"count": 40, "truth": "file", "python_flint": version("python-flint")}
        without = [table["function"] for table in listed["tables"] if table["exact_file"] is None]
        assert without == ["joint_wrenches"]
        for table in listed["tables"]:
            if table["exact_file"] is None:
                continue
            content = (exact_folder / table["exact_file"]).read_bytes()
            assert table["exact_sha256"] == sha256(content).hexdigest()
            doubles, exact = numbers(exact_folder / table["file"]), numbers(exact_folder / table["exact_file"])
            answer = slice(table["argument_count"], table["argument_count"] + table["answer_count"])
            largest = np.abs(doubles[:, answer]).max()
            np.testing.assert_allclose(exact[:, answer], doubles[:, answer], rtol=0, atol=1e-12 * max(1, largest))
            exact[:, answer] = doubles[:, answer]
            np.testing.assert_array_equal(exact, doubles)
            texts = content.decode().splitlines()[1].split(",")[answer]
            digits = [len(x.lstrip("-0.").replace(".", "")) for x in texts]
            assert max(digits) >= 40

    def test_decimals(self, program, small_arm, tmp_path):
        """Those of crosscheck.exact_values, of either truth."""
        for truth in ("file", "model"):
            folder = tmp_path / truth
            options = ("--for", "gravity_torque", "--samples", 1, "--digits", 30, "--truth", truth, "--out", folder)
            assert program("vectors", small_arm, *options).code == AGREED
            head, row, *_ = (folder / "gravity_torque_exact.csv").read_text(encoding="utf-8").splitlines()
            q, answer, _ = np.split(np.array(row.split(",")), 3)
            assert head.split(",")[3] == "answer1"
            expected = crosscheck.exact_values(small_arm, "gravity_torque", q.astype(float), truth=truth)
            assert list(answer) == list(expected["gravity_torque"].decimals(30))

    def test_without_python_flint(self, program, small_arm, tmp_path, monkeypatch):
        monkeypatch.setitem(sys.modules, "flint", None)
        done = program("vectors", small_arm, "--digits", 30, "--out", tmp_path / "v")
        assert done.code == BAD_INPUT
        assert done.err.startswith("error: exact values: the package python-flint is not installed")
        assert not (tmp_path / "v").exists()


class TestTolerances:
    @pytest.mark.parametrize("name", confirmed_functions("tool0"))
    def test_a_number_may_be_wrong_by_its_tolerance(self, name):
        """By a little more, and the judge disagrees."""
        known = FUNCTIONS[name]
        states = states_for(Setting(robot="ur5", samples=1, frame="tool0"), [known])
        chosen = next(known.readings({}))
        answer = known.of_graphdyn(states, chosen)
        tolerance = tolerances(known, answer, states, chosen, BOUND)
        rng = np.random.default_rng(0)
        for k in rng.choice(answer[0].size, min(6, answer[0].size), replace=False):
            one = np.zeros(answer[0].size)
            one[k] = 1.0
            part = one.reshape(answer.shape[1:]) * np.where(np.isfinite(tolerance), tolerance, 0.0)
            for factor in (0.9, 1.1):
                wrong = relative_errors(known, answer + factor * part, answer, states, chosen)
                worst = factor * BOUND * (part != 0).reshape(len(part), -1).any(axis=1)
                np.testing.assert_allclose(wrong, worst, rtol=0.05, atol=0)


class TestRefused:
    def test_a_reference_that_disagrees(self, program, small_arm, tmp_path, plant):
        plant.pinocchio_value("mass_matrix", lambda x: x * (1 + 1e-8))
        done = program("vectors", small_arm, "--samples", 1, "--out", tmp_path / "v")
        assert done.code == BAD_INPUT
        assert (
            done.err == "error: mass_matrix: pinocchio and graphdyn disagree on this robot; see `graphdyn crosscheck`\n"
        )
        assert not (tmp_path / "v").exists()

    def test_any_number_of_columns(self):
        with pytest.raises(InvalidInput, match="base_regressor has no test vectors: answers of any number of columns"):
            next(vector_tables(Setting(robot="ur5"), ["base_regressor"]))

    @pytest.mark.parametrize("table", ['{"files": ["a.csv"]}', 20_000 * "["], ids=["listed", "nested"])
    def test_other_files(self, program, small_arm, tmp_path, words, table):
        (tmp_path / "v").mkdir()
        (tmp_path / "v" / "vectors.json").write_text(table, encoding="utf-8")
        for name in ("a.csv", "arm.urdf"):
            (tmp_path / "v" / name).write_text("precious", encoding="utf-8")
        done = program("vectors", small_arm, "--out", tmp_path / "v")
        assert done.code == BAD_INPUT
        assert re.search(r"other files, such as (arm\.urdf|a\.csv), which would be lost; name another", words(done.err))
        assert (tmp_path / "v" / "a.csv").read_text(encoding="utf-8") == "precious"

    @pytest.mark.parametrize("table", ["", "[]", '{"files": 3}', '{"files": [[]]}'])
    def test_a_table_of_others(self, program, small_arm, tmp_path, table):
        (tmp_path / "v").mkdir()
        (tmp_path / "v" / "vectors.json").write_text(table, encoding="utf-8")
        assert program("vectors", small_arm, "--out", tmp_path / "v").code == BAD_INPUT

    @pytest.mark.parametrize(("name", "message"), [("small.urdf", "is no folder"), ("no/such", "does not exist")])
    def test_no_folder(self, program, small_arm, tmp_path, words, name, message):
        done = program("vectors", small_arm, "--out", tmp_path / name)
        assert done.code == BAD_INPUT
        assert message in words(done.err)


class TestWholeFolder:
    def test_a_full_disk(self, tmp_path, full_disk):
        with pytest.raises(OSError, match=os.strerror(errno.ENOSPC)):
            write_folder(tmp_path / "v", {"a": b"12", "b": b"34"})
        assert list(tmp_path.iterdir()) == []

    def test_the_old_one_stays(self, tmp_path, full_disk, monkeypatch):
        (tmp_path / "v").mkdir()
        (tmp_path / "v" / "a").write_text("old", encoding="utf-8")
        with pytest.raises(OSError, match=os.strerror(errno.ENOSPC)):
            write_folder(tmp_path / "v", {"a": b"new"})
        assert (tmp_path / "v" / "a").read_text(encoding="utf-8") == "old"
        assert [path.name for path in tmp_path.iterdir()] == ["v"]

    @pytest.mark.parametrize("number", range(1, 9))
    def test_the_old_one_stays_whatever_fails(self, number, tmp_path):
        """Writing, flushing and naming of two files, then the folder before, which is put aside, and the new one."""
        write_folder(tmp_path / "v", {"a": b"old", "b": b"old"})
        with failing(number) as made, pytest.raises(OSError, match=os.strerror(errno.ENOSPC)) as error:
            write_folder(tmp_path / "v", {"a": b"new", "b": b"new"})
        assert error.value.filename == str(tmp_path / "v")
        assert len(made) == number + (number == 8)
        assert {path.name: path.read_bytes() for path in tmp_path.rglob("?") if path.is_file()} == {
            "a": b"old",
            "b": b"old",
        }
        assert [path.name for path in tmp_path.iterdir()] == ["v"]

    def test_an_old_one_that_cannot_come_back_is_named(self, tmp_path):
        write_folder(tmp_path / "v", {"a": b"old"})
        with failing(5, lasting=True), pytest.raises(OSError, match=r"; what was there is in .*\.v\.") as error:
            write_folder(tmp_path / "v", {"a": b"new"})
        aside = Path(error.value.strerror.rpartition(" ")[2])
        assert (aside / "a").read_bytes() == b"old"
        assert str(aside) in in_words(error.value)

    def test_permissions(self, tmp_path):
        write_folder(tmp_path / "v", {"a": b""})
        (tmp_path / "usual").mkdir()
        assert (tmp_path / "v").stat().st_mode == (tmp_path / "usual").stat().st_mode
