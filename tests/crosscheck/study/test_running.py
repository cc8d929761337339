"""`graphdyn study`: configuration, tables that are the same however they come about, interruptions and failures."""

import hashlib
import json
import os
import re
import shutil
import signal
import sqlite3
import subprocess
import sys
import warnings
from contextlib import closing
from dataclasses import asdict
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pyarrow.parquet as parquet
import pytest
from failing import failing
from identified import small_study as small
from identified.small_study import ARM, InThisProcess, backwards, small_study, study_of
from long_check import few

from crosscheck.commands.program import own_process
from crosscheck.commands.program.exits import AGREED, BAD_INPUT
from crosscheck.commands.study.report import study_run_report
from crosscheck.distributing import LocalProcesses, Lost, NoWorkers
from crosscheck.report.text import as_text
from crosscheck.study import running, store
from crosscheck.study import tasks as computing
from crosscheck.study.folder import CONFIGURATION, DATABASE
from crosscheck.study.running import PROCESS_DIED, Remaining, run_study, tasks_of
from crosscheck.study.settings.configuration import SHIPPED_CONFIGURATIONS, hash_of, read_configuration
from crosscheck.study.settings.scenarios import GRID_AXES, Scenario
from crosscheck.study.settings.settings import BadConfiguration
from crosscheck.study.simulated.plants import plant_of
from crosscheck.study.simulated.runs import known_model
from crosscheck.study.so_far import read_so_far
from crosscheck.study.statistics.outcomes import ERRORS, read_outcomes
from crosscheck.study.statistics.summary import summarized
from crosscheck.study.store import opened
from crosscheck.study.tables import RESULTS, SCENARIOS, TIMES, write_results, write_scenarios
from crosscheck.study.tasks import Result, StudyOutcome
from crosscheck.study.validation import validation_metric
from graphdyn import InvalidInput
from graphdyn.identification import structure

INTERRUPTED = 130


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """With the robot of the small study."""
    path = tmp_path_factory.mktemp("study")
    (path / "small.urdf").write_text(ARM, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def complete(folder):
    """The small study, one task after the other in this process."""
    out = folder / "complete"
    run_study(small_study(folder), out, InThisProcess())
    return out


@pytest.fixture
def begun(folder, complete, tmp_path):
    """A copy of the small study."""
    return Path(shutil.copytree(complete, tmp_path / "begun"))


def tables(out):
    return {name: (out / name).read_bytes() for name in (RESULTS, SCENARIOS)}


def rows(out, name=RESULTS):
    return parquet.read_table(out / name).to_pylist()


def test_every_method_has_a_row_for_every_run(folder, complete):
    study = small_study(folder)
    found = rows(complete)
    keys = [(row["scenario"], row["run"], row["method"]) for row in found]
    assert keys == sorted(keys)
    assert len(set(keys)) == 2 * 2 * 3
    assert [(row["scenario"], row["run"], row["method"]) for row in rows(complete, TIMES)] == keys
    assert {row["scenario"] for row in rows(complete, SCENARIOS)} == {one.name for one in study.scenarios}
    assert all(row["status"] == "found" and row["measures"] == "torques" for row in found)
    sizes = {len(row[name]) for row in found for name in ("base", "sigma")}
    assert sizes == {len(row["truth"]) for row in rows(complete, SCENARIOS)}
    assert all(0 < row["parameter_error"] < 0.1 and 0 < row["torque_error"] < 0.1 for row in found)
    assert {row["simulations"] > 0 for row in found if row["method"] == "iv"} == {True}
    assert {(row["iterations"], row["simulations"]) for row in found if row["method"] != "iv"} == {(1, 0)}


def test_errors_stand_in_the_columns_of_their_names(folder, complete):
    study = small_study(folder)
    scenarios = {one.name: one for one in study.scenarios}
    for row in rows(complete)[::6]:
        draw = study.design.draw(row["run"])
        known = known_model(study, scenarios[row["scenario"]], draw)
        measure = validation_metric(study.robots[0], study.seed, known, draw.motion)
        expected = {name: getattr(measure, name)(row["base"]) for name in ERRORS}
        assert {name: row[name] for name in ERRORS} == expected


def test_tables_hold_every_field_of_every_result_beside_its_seconds(folder, tmp_path):
    """Methods in the order of the configuration, in which no table has them."""
    study, names = small_study(folder), ("wls", "ols", "iv")
    numbers = {name: k for k, name in enumerate(names, start=1)}

    def of(scenario, run):
        found = [
            Result(name, "torques", None, k, 10 * k, 20 * k, (k, run), (3.0 * k,), 0.1 * k, 0.2 * k, 0.3 * k, k == 1)
            for name, k in numbers.items()
        ]
        failed = Result("other", "wrenches", reason=scenario)
        return (scenario, run), StudyOutcome((*found, failed), (*numbers.values(), None), 9.0)

    given = [of(scenario.name, run) for scenario in study.scenarios for run in range(2)]
    write_scenarios(study, tmp_path)
    write_results(given, tmp_path)
    times = {(row["scenario"], row["run"], row["method"]): row["processor_seconds"] for row in rows(tmp_path, TIMES)}
    found = {(row.pop("scenario"), row.pop("run"), row["method"]): row for row in rows(tmp_path)}
    assert len(found) == len(times) == 4 * len(given)
    for (scenario, run), outcome in given:
        for result, seconds in zip(outcome.results, outcome.seconds, strict=True):
            status = {"status": "found" if result.reason is None else "failed"}
            row = found[scenario, run, result.method]
            assert {name: tuple(x) if isinstance(x, list) else x for name, x in row.items()} == asdict(result) | status
            assert times[scenario, run, result.method] == seconds
    for row, scenario in zip(rows(tmp_path, SCENARIOS), sorted(study.scenarios, key=lambda one: one.name), strict=True):
        assert {name: row[name] for name in GRID_AXES} == asdict(scenario)
        base = structure(known_model(study, scenario)).base
        assert row["truth"] == pytest.approx(
            base.matrix @ plant_of(study.robots[0]).truth(known_model(study, scenario))
        )
        assert len(row["base_names"]) == len(row["base_units"]) == base.rank


def killed(study, out, answers):
    """The study in another process, which kills itself after so many answers, as a power cut would."""
    with warnings.catch_warnings(action="ignore"):  # that threads do not survive a fork: none is needed
        child = os.fork()
    if not child:
        try:
            run_study(study, out, InThisProcess(ends=answers), resume=True)
        finally:
            os.kill(os.getpid(), signal.SIGKILL)
    assert os.WTERMSIG(os.waitpid(child, 0)[1]) == signal.SIGKILL


@pytest.mark.parametrize(("kills", "processes"), few([(1, 1), (3, 2), (3, 4)], (1, 1)))
def test_killed_and_resumed_by_others_it_is_the_same_to_the_last_bit(kills, processes, folder, complete, tmp_path):
    """Killed after a task, as often as asked; interrupted after another one, from behind; ended by processes."""
    out, told = tmp_path / "out", []
    study = small_study(folder, study=small.STUDY.replace("runs = 2", f"runs = {kills + 1}"))
    for _ in range(kills):
        killed(study, out, 1)
    assert not (out / RESULTS).exists()
    with pytest.raises(KeyboardInterrupt):
        run_study(study, out, InThisProcess(backwards, ends=1), resume=True)
    run_study(study, out, LocalProcesses(processes), resume=True, progress=told.append)
    assert [one.done for one in told] == list(range(kills + 1, 2 * (kills + 1) + 1))
    whole = complete
    if kills > 1:
        run_study(study, tmp_path / "whole", InThisProcess())
        whole = tmp_path / "whole"
    assert tables(out) == tables(whole)


def test_one_more_scenario_changes_no_other(folder, complete, tmp_path):
    run_study(small_study(folder, small.FURTHER), tmp_path / "out", InThisProcess())
    known = {row["scenario"] for row in rows(complete)}
    assert [row for row in rows(tmp_path / "out") if row["scenario"] in known] == rows(complete)
    assert len(rows(tmp_path / "out")) == len(rows(complete)) + 2 * 3


class TestExtending:
    """Runs, methods and scenarios are added to what is done."""

    PART = "[study]\nruns = 1\nmethods = ['wls', 'iv']\n"

    def test_a_study_that_has_grown_is_the_whole_one(self, folder, complete, tmp_path):
        """Killed in the middle, and ended by --resume: the same to the last bit, and nothing is computed twice."""
        out, done = tmp_path / "out", []
        few = study_of(folder, self.PART, small.ROBOT, small.SCENARIO, "[[grid]]\nposition_noise = 1e-6\n")
        run_study(few, out, InThisProcess())
        with pytest.raises(KeyboardInterrupt):
            run_study(small_study(folder), out, InThisProcess(ends=1), extend=True)
        with opened(out / DATABASE) as database:
            assert sorted(map(len, database.done().values())) == [3]
        with pytest.raises(InvalidInput, match=r"study\.runs was 2, is 1"):
            run_study(few, out, InThisProcess(), resume=True)
        run_study(small_study(folder), out, InThisProcess(), resume=True, progress=lambda now: done.append(now.done))
        assert done == [1, 2, 3, 4]
        assert tables(out) == tables(complete)

    @pytest.mark.parametrize(
        ("study", "further", "said"),
        [
            (
                small.STUDY.replace("runs = 2", "runs = 1"),
                "",
                "has results of run 1, which study.toml has not; --extend",
            ),
            ("[study]\nruns = 2\nmethods = ['wls', 'ols']\n", "", "has results of iv, which study.toml has not"),
            (small.STUDY, "torque_noise = 1\n", "has results of scenario [0-9a-f]+, which study.toml has not"),
            (small.STUDY + "seed = 1\n", "", r"another configuration than .*study\.seed was missing, is 1"),
            (small.STUDY + "reference = 'ols'\n", "", r"another configuration than .*study\.reference was missing"),
        ],
    )
    def test_it_only_grows(self, folder, begun, study, further, said):
        with pytest.raises(InvalidInput, match=said):
            run_study(small_study(folder, further, study=study), begun, InThisProcess(), extend=True)

    def test_nothing_to_extend(self, folder, tmp_path):
        with pytest.raises(InvalidInput, match="holds no study that could be extended; omit --extend to begin one"):
            run_study(small_study(folder), tmp_path / "out", InThisProcess(), extend=True)


class TestSoFar:
    """What a study has found is read while it goes on."""

    def test_it_is_read_while_it_is_written(self, folder, tmp_path):
        """By another process, which finds what is done, and keeps nothing from being written."""
        found = []

        def read(now):
            if now.done == 2:
                given = [sys.executable, "-c", READ, str(tmp_path / "out")]
                found.append(subprocess.run(given, capture_output=True, text=True, check=True).stdout.strip())

        with pytest.raises(KeyboardInterrupt):
            run_study(small_study(folder), tmp_path / "out", InThisProcess(ends=3), progress=read)
        assert found == ["2 records of 2 scenarios"]
        with opened(tmp_path / "out" / DATABASE) as database:
            assert len(database.done()) == 3

    def test_methods_that_are_not_everywhere_wait(self, folder, begun):
        study = small_study(folder, study=small.STUDY.replace('"iv"', '"iv", "ridge"'))
        with pytest.raises(KeyboardInterrupt):
            run_study(study, begun, InThisProcess(ends=1), extend=True)
        found = read_so_far(begun)
        assert dict(found.facts)["not yet everywhere"] == "ridge"
        assert [method.name for method in found.outcomes.methods] == ["iv", "ols", "wls"]
        assert [len(scenario.runs) for scenario in found.outcomes.scenarios] == [2, 2]

    def test_nothing_to_read(self, folder, tmp_path):
        with pytest.raises(InvalidInput, match=r"holds no study: there is no study\.sqlite; name the folder of one"):
            read_so_far(tmp_path)
        with pytest.raises(KeyboardInterrupt):
            run_study(small_study(folder), tmp_path / "out", InThisProcess(ends=0))
        with pytest.raises(InvalidInput, match="has no finished run yet; wait for one"):
            read_so_far(tmp_path / "out")

    def test_a_store_of_another_form_is_named_where_it_is(self, begun):
        with closing(sqlite3.connect(begun / DATABASE)) as database:
            database.execute("PRAGMA user_version = 2")
        with pytest.raises(InvalidInput, match=re.escape(f"{begun / DATABASE} has form 2")):
            read_so_far(begun)

    def test_a_store_that_is_written_all_the_time(self, begun, monkeypatch):
        times = iter(range(1000))
        monkeypatch.setattr(store, "_stamps", lambda file: next(times))
        monkeypatch.setattr(store, "COPY_PAUSE", 0.0)
        with pytest.raises(OSError, match=r"study\.sqlite is written all the time; try again"):
            read_so_far(begun)


READ = """
import sys
from pathlib import Path
from crosscheck.study.so_far import read_so_far
print(dict(read_so_far(Path(sys.argv[1])).facts)["so far"])
"""


def test_sources_that_are_drawn_once_more(folder, tmp_path):
    """Each varying source of each run once more, with rows of their own; the run itself is as without."""
    study = study_of(folder, small.STUDY + "repeats = 2\nvary = ['noise', 'cad']\n", small.ROBOT, small.SCENARIO)
    plain = study_of(folder, small.STUDY + "vary = ['noise', 'cad']\n", small.ROBOT, small.SCENARIO)
    for one, name in ((study, "repeated"), (plain, "plain")):
        run_study(one, tmp_path / name, InThisProcess(lambda tasks: range(2)))
    found = rows(tmp_path / "repeated")
    again = [(row["redrawn"], row["repeat"]) for row in found if (row["run"], row["method"]) == (1, "iv")]
    assert again == [(None, 0), ("cad", 1), ("noise", 1)]
    assert [row for row in found if not row["repeat"]] == rows(tmp_path / "plain")
    task = tasks_of(study)[1]
    shown = as_text(study_run_report(task, computing.compute(study, task)), 200)
    assert all(f" iv{other} " in shown for other in ("", ", other noise 1", ", other cad 1"))
    shares = summarized(read_outcomes(tmp_path / "repeated")).scenarios[0].methods[0].parameters.shares
    assert np.all(shares["cad"] < 1e-12), "no parameter of iv comes from the CAD model"
    assert np.all(shares["noise"] > 0)


def test_a_method_that_kills_its_process_fails_alone(folder, complete, tmp_path):
    told = []
    study = small_study(folder, study=small.STUDY.replace("runs = 2", "runs = 1"))
    workers = InThisProcess(lost=lambda task: "ols" in task.methods)
    run_study(study, tmp_path / "out", workers, tell=told.append)
    found = {(row["scenario"], row["run"], row["method"]): row for row in rows(tmp_path / "out")}
    assert {row["reason"] for (*_, method), row in found.items() if method == "ols"} == {PROCESS_DIED}
    same = [row for row in rows(complete) if row["method"] != "ols" and row["run"] == 0]
    assert [found[row["scenario"], row["run"], row["method"]] for row in same] == same
    assert len(told) == 2 * 2
    assert "its process died with code -9" in told[0]


def test_whatever_a_method_raises_is_its_result(folder, tmp_path):
    (folder / "own.py").write_text(OWN, encoding="utf-8")
    names = ["ols", *(f"own.py:{name}" for name in ("Raises", "Wrong", "Nothing", "Narrow", "Counts", "Blocks"))]
    study = small_study(folder, study=f"[study]\nruns = 1\nmethods = {json.dumps(names)}\n")
    run_study(study, tmp_path / "out", InThisProcess(lambda tasks: range(1), ends=1))
    reasons = {row["method"]: row["reason"] for row in rows(tmp_path / "out")}
    assert reasons["ols"] is None
    assert reasons["own:Raises"] == "ZeroDivisionError: division by zero"
    assert reasons["own:Wrong"] == "the method answers parameters of shape (3,); 26 finite numbers needed"
    assert reasons["own:Nothing"] == "AttributeError: 'NoneType' object has no attribute 'parameters'"
    assert reasons["own:Narrow"] == "ValueError: the method answers a covariance of shape (3, 3)"
    assert reasons["own:Counts"] is None, "NumPy's whole numbers are numbers"
    (blocks,) = (row for row in rows(tmp_path / "out") if row["method"] == "own:Blocks")
    assert blocks["sigma"] == [3.0] * len(blocks["base"]), "deviations that allow for correlation come first"


def test_methods_take_part_where_what_they_need_is_measured(folder):
    text = "[study]\nruns = 1\nmethods = {}\n" + small.ROBOT + "[[grid]]\nforce_noise = {}\n"
    tasks = tasks_of(study_of(folder, text.format(["wls", "graph"], ["none", 0.5])))
    assert [task.methods for task in tasks] == [("wls",), ("wls", "graph")]
    for methods, noises, where in ((["wls", "graph"], ["none"], "no"), (["graph"], ["none", 0.5], "not every")):
        with pytest.raises(BadConfiguration, match=rf"methods in \[study\] has graph for wrenches, which {where} scen"):
            study_of(folder, text.format(methods, noises))


@pytest.mark.parametrize(("start", "expected"), [("wls", "wls"), ("cad", "cad"), ("0.15", [0.85, -1.7, 3.4])])
def test_methods_are_given_what_they_have_a_use_for(start, expected):
    """An iteration starts where record and scenario say; only methods with wrenches see the recording."""
    own = None if isinstance(expected, str) else np.array(expected)
    record = SimpleNamespace(loop=None, truth=np.array([1.0, -2.0, 4.0]), recording=object(), start=own)
    scenario = Scenario(start=start)
    found = computing.ready(computing.estimator_of("didim"), record, scenario)
    assert np.array_equal(found.start, expected)
    assert not hasattr(found, "recording")
    graph = computing.ready(computing.estimator_of("graph"), record, scenario)
    assert graph.recording is record.recording
    plain = computing.estimator_of("ols")
    assert vars(computing.ready(plain, record, scenario)) == vars(plain)


def test_own_methods_of_one_name_are_refused(folder):
    for name in ("a", "b"):
        (folder / name).mkdir()
        (folder / name / "own.py").write_text(OWN, encoding="utf-8")
    with pytest.raises(BadConfiguration, match="several are called own:Wrong in tables, which name no folders; rename"):
        study_of(folder, "[study]\nmethods = ['a/own.py:Wrong', 'b/own.py:Wrong']\n", small.ROBOT)


OWN = """
from dataclasses import replace
import numpy as np
from graphdyn.identification import Estimate, OrdinaryLeastSquares

class Raises(OrdinaryLeastSquares):
    def estimate(self, problem):
        return 1 / 0

class Wrong(OrdinaryLeastSquares):
    def estimate(self, problem):
        return Estimate(np.zeros(3))

class Nothing(OrdinaryLeastSquares):
    def estimate(self, problem):
        return None

class Narrow(OrdinaryLeastSquares):
    def estimate(self, problem):
        return replace(super().estimate(problem), covariance=np.eye(3), block_covariance=None)

class Blocks(OrdinaryLeastSquares):
    def estimate(self, problem):
        return replace(super().estimate(problem), block_covariance=9 * np.eye(problem.base.rank))

class Counts(OrdinaryLeastSquares):
    def estimate(self, problem):
        return replace(super().estimate(problem), iterations=np.int64(3))
"""


def test_a_folder_of_something_else_is_refused(folder, begun, tmp_path, monkeypatch):
    monkeypatch.setattr(store, "LOCK_TIMEOUT", 0.01)
    study = small_study(folder)
    with pytest.raises(
        InvalidInput, match="holds a study already; go on with it by --resume, add to it by --extend, or"
    ):
        run_study(study, begun, InThisProcess())
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "letter.txt").write_text("")
    with pytest.raises(InvalidInput, match=r"other holds other files, such as letter\.txt; name a new folder"):
        run_study(study, tmp_path / "other", InThisProcess(), resume=True)
    with pytest.raises(InvalidInput, match=r"letter\.txt is no folder; name a new one"):
        run_study(study, tmp_path / "other" / "letter.txt", InThisProcess())
    with (
        opened(begun / DATABASE),
        pytest.raises(InvalidInput, match="is in use: a study writes there; wait for it, or name another folder"),
    ):
        run_study(study, begun, InThisProcess(), resume=True)
    (begun / DATABASE).write_bytes(b"no database" * 100)
    with pytest.raises(InvalidInput, match=r"study\.sqlite is damaged: .*; remove it, or name another folder"):
        run_study(study, begun, InThisProcess(), resume=True)


def test_what_is_damaged_is_computed_again(folder, begun, complete):
    """A row that is lost, and a store that is: the tables are the same."""
    with closing(sqlite3.connect(begun / DATABASE)) as connection:
        connection.execute("UPDATE tasks SET outcome = replace(outcome, '1', '2') WHERE rowid = 2")
        connection.commit()
    (begun / RESULTS).unlink()
    told, done = [], []
    run_study(small_study(folder), begun, InThisProcess(), resume=True, tell=told.append, progress=done.append)
    assert told == [f"{begun / DATABASE} is damaged: 3 runs can be read, all others are computed again"]
    assert [one.done for one in done] == [3, 4]
    assert tables(begun) == tables(complete)


@pytest.mark.parametrize("damage", [b"[study\xff", b"a = " + 20_000 * b"["], ids=["bytes", "nested"])
def test_a_store_that_is_lost(folder, begun, damage):
    """The copy of the configuration says which study it was; where that is lost too, the study begins again."""
    (begun / DATABASE).unlink()
    other = small_study(folder, study=small.STUDY.replace("runs = 2", "runs = 3"))
    with pytest.raises(InvalidInput, match=r"study\.runs was 2, is 3; give the one that it was begun with"):
        run_study(other, begun, InThisProcess(), resume=True)
    with pytest.raises(KeyboardInterrupt):
        run_study(small_study(folder), begun, InThisProcess(ends=0), resume=True)
    (begun / DATABASE).unlink()
    (begun / CONFIGURATION).write_bytes(damage)
    with pytest.raises(KeyboardInterrupt):
        run_study(other, begun, InThisProcess(ends=0), resume=True)
    assert (begun / CONFIGURATION).read_text() == other.text


@pytest.mark.parametrize("number", range(1, 10))
def test_a_table_that_cannot_be_written(number, folder, begun, complete):
    """Writing, flushing and naming of three tables: each is the old or the new one, and the study goes on."""
    (begun / RESULTS).write_bytes(b"old")
    with failing(number) as made, pytest.raises(OSError, match="No space"):
        run_study(small_study(folder), begun, InThisProcess(), resume=True)
    assert len(made) == number
    assert (begun / RESULTS).read_bytes() in (b"old", (complete / RESULTS).read_bytes())
    assert {path.name for path in begun.iterdir()} == {path.name for path in complete.iterdir()}
    run_study(small_study(folder), begun, InThisProcess(), resume=True)
    assert tables(begun) == tables(complete)


def test_a_full_disk(tmp_path):
    full = pytest.raises(OSError, match=r"a\.sqlite cannot be written: .* full; make room, and go on with --resume")
    with full, opened(tmp_path / "a.sqlite") as begun:
        begun._connection.execute("PRAGMA max_page_count = 1")
        begun.begin({"configuration": "x" * 100_000})


@pytest.mark.parametrize(
    ("change", "what"),
    [
        ({"study": "[study]\nruns = 3\nmethods = ['wls', 'ols', 'iv']\n"}, r"study\.runs was 2, is 3;"),
        ({"study": "[study]\nruns = 2\nmethods = ['wls', 'ols']\n"}, r'study\.methods was \["wls", "ols", "iv"\], is'),
        ({"further": small.FURTHER}, r"grid was \[\{.*\}\], is \[\{.*steps.*\}\];"),
        ({"further": "torque_noise = 1\n"}, r"grid 1\.torque_noise was missing, is 1;"),
        ({"versions": {"numpy": "1.0"}}, r"numpy was None, is 1\.0;"),
    ],
)
def test_another_configuration_is_not_resumed(folder, begun, change, what):
    study = small_study(folder, change.get("further", ""), study=change.get("study", small.STUDY))
    said = rf"holds a study with another configuration than study\.toml: .*{what}.*give the one that it was begun with"
    with pytest.raises(InvalidInput, match=said):
        run_study(study, begun, InThisProcess(), resume=True, versions=change.get("versions"))


def test_modules_that_an_own_method_imports(folder, tmp_path):
    """All files of its folder that take part are known by their content, whatever imports them."""
    shutil.copy(folder / "small.urdf", tmp_path)
    files = {
        "own.py": "import direct, numpy, pack.deep as d\nfrom pack import side\nclass M: pass\n",
        "direct.py": "def f():\n    import importlib\n    importlib.import_module('lazy')\n",
        "lazy.py": "__import__('last')\n",
        "last.py": "import graphdyn\n",
        "pack/__init__.py": "",
        "pack/deep.py": "from . import near\nfrom .. import direct\n",
        "pack/near.py": "def broken(:\n",
        "pack/side.py": "",
        "other.py": "",
        "graphdyn.py": "",
    }
    (tmp_path / "pack").mkdir()
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    study = study_of(tmp_path, "[study]\nruns = 1\nmethods = ['own.py:M']\n", small.ROBOT)
    known = {str(Path(path).relative_to(tmp_path)) for path in study.own_files}
    assert known == {*files, "small.urdf"} - {"other.py", "graphdyn.py"}
    before = study.own_files
    (tmp_path / "last.py").write_text("x = 1\n")
    assert [path for path in before if study.own_files[path] != before[path]] == [str(tmp_path / "last.py")]


LACKS = """
from graphdyn.identification import OrdinaryLeastSquares
class Lacks(OrdinaryLeastSquares):
    def estimate(self, problem):
        try:
            import package_of_nobody
        except ImportError:
            raise ValueError("nobody knows")
"""


class TestMissing:
    """What fails for want of a package or a file is no result."""

    def test_a_package_that_a_method_always_needs(self, folder, tmp_path, monkeypatch):
        monkeypatch.setattr(running, "find_spec", lambda name: None if name == "clarabel" else name)
        study = study_of(folder, "[study]\nmethods = ['ols', 'consistent']\n", small.ROBOT)
        with pytest.raises(InvalidInput, match=r"consistent in methods needs clarabel, which is not installed; .*pip"):
            run_study(study, tmp_path / "out", InThisProcess())
        assert not (tmp_path / "out").exists()

    @pytest.mark.parametrize("method", ["consistent", "lacks.py:Lacks"])
    def test_a_package_during_a_task(self, method, folder, tmp_path, monkeypatch):
        monkeypatch.setitem(sys.modules, "clarabel", None)
        monkeypatch.setattr(running, "find_spec", lambda name: name)
        (folder / "lacks.py").write_text(LACKS)
        study = small_study(folder, study=f"[study]\nruns = 1\nmethods = ['{method}']\n")
        with pytest.raises(NoWorkers, match=r"run 0: on the machine .*; nothing of it is kept: mend this, and go on"):
            run_study(study, tmp_path / "out", InThisProcess())
        with opened(tmp_path / "out" / DATABASE) as database:
            assert not database.done()
        assert not (tmp_path / "out" / RESULTS).exists()

    def test_a_method_that_can_no_longer_be_made(self, folder):
        """It could where the study began."""
        (folder / "once.py").write_text("class Once:\n    def __init__(self): raise OSError('the disk is gone')\n")
        study = small_study(folder)
        task = computing.StudyTask(study.scenarios[0], 0, (f"{folder}/once.py:Once",))
        answer = computing.computed(study, computing.Surroundings((), ()), task)
        assert answer.reason.endswith("once.py:Once cannot be made: OSError: the disk is gone")

    @pytest.mark.parametrize(
        ("files", "libraries", "said"),
        [
            ((("/none/own.py", "0"),), (), "there is no file /none/own.py"),
            (((__file__, "0"),), (), "test_running.py is another file"),
            ((), (("clarabel", "0.1"), ("nobody", "1")), r"clarabel .* in place of 0\.1, nobody None in place of 1"),
        ],
    )
    def test_a_process_unlike_the_first(self, files, libraries, said, folder):
        answer = computing.computed(small_study(folder), computing.Surroundings(files, libraries), None)
        assert re.search(said, answer.reason)

    def test_a_scheduler_that_ends(self, folder, tmp_path):
        class Ending:
            def each(self, function, tasks):
                yield 0, function(tasks[0])
                raise NoWorkers("the scheduler is lost; start it again")

        said = "the scheduler is lost; start it again; what is done is kept: go on with --resume"
        with pytest.raises(NoWorkers, match=said):
            run_study(small_study(folder), tmp_path / "out", Ending())
        with opened(tmp_path / "out" / DATABASE) as database:
            assert len(database.done()) == 1

    def test_a_worker_that_can_do_nothing(self, folder, tmp_path):
        class Broken:
            def each(self, function, tasks):
                yield 0, Lost("ImportError: no module", died=False)

        with pytest.raises(NoWorkers, match="ImportError: no module; nothing of it is kept"):
            run_study(small_study(folder), tmp_path / "out", Broken())


def test_another_robot_in_the_same_file_is_not_resumed(folder, begun, tmp_path):
    run_study(small_study(folder, "# a comment changes nothing\n"), begun, InThisProcess(), resume=True)
    (tmp_path / "small.urdf").write_text(ARM + "\n", encoding="utf-8")
    with pytest.raises(InvalidInput, match=r"small\.urdf has changed"):
        run_study(small_study(tmp_path), begun, InThisProcess(), resume=True)


BAD = {
    "[study": r"study\.toml: is no TOML: Expected ']'",
    "x = " + "[" * 5000: r"study\.toml: is no TOML: more than 50 tables or lists within each other",
    "x = " + "[" * 90 + "]" * 90 + "\n": r"study\.toml: more than 50 tables or lists within each other",
    "[" + "a." * 20_000 + "a]\n": r"study\.toml: line 1: a key of more than 50 parts",
    "x = {" + "a . " * 20_000 + "a = 1}\n": r"study\.toml: line 1: a key of more than 50 parts",
    "[study]\nseed = " + "9" * 400 + "\n": r"study\.toml: study\.seed is a number of some \d+ digits; give one below",
    "[study]\nseed = " + "9" * 5000 + "\n": r"study\.toml: is no TOML: .*digits",
    "[[grid]]\ncutoff = [0x" + "f" * 400 + "]\n": r"study\.toml: grid\.cutoff is a number of some \d+ digits",
    "[[grid]]\ncutoff = 1e999\n": r"cutoff in \[grid\] is inf; give a number above 0",
    "[study]\n[extra]\n": r"\[extra\] is no table of a study; it has: study, robot, errors, scenario, grid",
    "[study]\nrunz = 5\n": r"runz in \[study\] is no setting of this table; did you mean runs\?",
    "[study]\nruns = 1000001\n": r"runs in \[study\] is 1000001; give 1000000 or less",
    "[study]\nruns = 0\n": r"runs in \[study\] is 0; give a whole number from 1 on",
    "[study]\nvary = ['weather']\n": r"vary in \[study\] is \['weather'\]; give a list of what each run draws anew",
    "[study]\nvary = []\n": r"vary in \[study\] is \[\]; give a list of what each run draws anew, of noise",
    "[study]\nreference = 'best'\n": r"reference in \[study\] is 'best'; there is no method 'best'",
    "[study]\nmethods = ['ols', 'iv']\nreference = 'wls'\n": (
        r"reference in \[study\] is wls, which is not among the methods: ols, iv"
    ),
    "[study]\npairs = 'some'\n": r"pairs in \[study\] is 'some'; use one of reference, all",
    "[study]\nregion = 0\n": r"region in \[study\] is 0; give a number above 0",
    "[study]\nrepeats = 0\n": r"repeats in \[study\] is 0; give a whole number from 1 on",
    "[study]\nseed = 1.5\n": r"seed in \[study\] is 1\.5; give a whole number from 0 on",
    "[study]\nmethods = ['best']\n": r"methods in \[study\] is \['best'\]; there is no method 'best'; use ols, wls,",
    "[study]\nmethods = []\n": r'methods in \[study\] is \[\]; give methods, or "all"',
    "[study]\nmethods = ['none.py:M']\n": r"there is no file .*none\.py",
    "study = 3\n": r"study\.toml: study is 3; it must be a table, \[study\]",
    "[robot]\nviscous = 1\n": r"name in \[robot\] is missing; give a robot of `graphdyn robots`, or a file",
    "[robot]\nname = 'ur5'\nviscous = [1, 'x']\n": r"viscous in \[robot\] is \[1, 'x'\]; give a number from 0 on",
    "[robot]\nname = 'ur5'\nposition_gain = 9\n": r"position_gain in \[robot\] and velocity_gain belong together; give",
    "[robot]\nname = 'ur5'\nchain = ['base']\n": r"chain in \[robot\] is \['base'\]; give the names of two links",
    "[robot]\nname = 'ur5'\nmimic = 'no'\n": r"mimic in \[robot\] is 'no'; use one of coupled, independent, locked",
    "[errors]\npayload_center = [1, 2]\n": r"payload_center in \[errors\] is \[1, 2\]; give three numbers",
    "[grid]\nmotion = 'steps'\n": r"\[grid\] must be \[\[grid\]\], which can be given several times",
    "[scenario]\nmotion = 'slow'\n": r"motion in \[scenario\] is 'slow'; use one of random, excited, steps, paper",
    "[[grid]]\nposition_noise = []\n": r"position_noise in \[grid\] is \[\]; give one value, or a list of them",
    "[[grid]]\n[[grid]]\ncutoff = -1\n": r'cutoff in \[grid 2\] is -1; give a number above 0, or "none"',
    "[[grid]]\ncutoff = 600\n": r"cutoff in \[grid\] is 600 Hz with a sampling_rate of 1000 Hz; it must be below half",
    "[[grid]]\nduration = 2.0005\n": r"duration in \[grid\] is 2\.0005 s .* 1000 Hz; give a whole number of samples",
    "[[grid]]\ncontrol_rate = 300\n": r"control_rate in \[grid\] is 300 Hz .* one must be a multiple of the other",
    "[[grid]]\nstart = 'near'\n": r"start in \[grid\] is 'near'; give \"wls\", \"cad\", or a number from 0",
    "[[grid]]\ncad_error = 1\n": r"cad_error in \[grid\] is 1; give a number from 0 to below 1",
    "[[grid]]\nmotion = 'paper'\n": r'duration in \[grid\] is 10 s; the motion "paper" lasts 2 s: give no more',
    "[[grid]]\nduration = 1e-3\n": r"duration in \[grid\] is 0\.001 s; give ten samples and control periods or more",
    "[[grid]]\nmodel_error = 'friction'\n": r'coulomb in \[robot\] is zero, and the model error "friction" forgets it',
    "[[grid]]\nmodel_error = 'flexible'\n": r"rotor_inertia in \[robot\] must be above zero in all joints",
    "[robot]\nname = 'ur5'\nrotor_inertia = [1, 1, 1, 0, 1, 1]\n[[grid]]\nmodel_error = 'flexible'\n": (
        r"rotor_inertia in \[robot\] must be above zero in all joints"
    ),
    "[study]\nmethods = 'ols'\n": r"methods in \[study\] is 'ols'; give a list of methods, or \"all\"",
    "[robot]\nname = 'ur5'\nlocked = 'elbow_joint'\n": r"locked in \[robot\] is 'elbow_joint'; give a list of names of",
    "[robot]\nname = 'ur5'\nrepair = 'inertia'\n": r"repair in \[robot\] is 'inertia'; give a list of names of repairs",
    "[robot]\nname = 'ur5'\nchain = 'ab'\n": r"chain in \[robot\] is 'ab'; give a list of names of links",
}


@pytest.mark.parametrize("text", BAD)
def test_bad_configurations(text, folder):
    robot = "" if "[robot]" in text else "[robot]\nname = 'ur5'\n"
    with pytest.raises(BadConfiguration, match=BAD[text]):
        study_of(folder, text, robot)


def test_how_the_robot_is_read(folder):
    cut = "chain = ['panda_link0', 'panda_link6']"
    held = "locked = ['panda_joint7', 'panda_finger_joint1', 'panda_finger_joint2']"
    plant = plant_of(study_of(folder, f"[robot]\nname = 'panda'\n{cut}\n{held}\ngravity = [0, 0, -1.62]\n").robots[0])
    assert plant.model.joint_names == tuple(f"panda_joint{k}" for k in range(1, 7))
    assert plant.model.gravity.tolist() == [0, 0, -1.62]


def test_what_only_the_robot_shows(folder):
    for numbers, count in (("[1, 2, 3]", "3 numbers"), ("[1]", "1 number")):
        robot = small.ROBOT.replace("viscous = 0.5", f"viscous = {numbers}")
        study = study_of(folder, small.STUDY, robot, small.SCENARIO, small.GRID)
        with pytest.raises(
            BadConfiguration, match=rf"study\.toml: viscous in \[robot\] has {count}; .* has 2 joints: sh"
        ):
            run_study(study, folder / "never", InThisProcess())
    with pytest.raises(
        BadConfiguration, match=r"study\.toml: limits in \[robot\]: joint 'sh.*' may move from 1 to -1;"
    ):
        run_study(study_of(folder, small.ROBOT, "lower = 1\nupper = -1\n"), folder / "never", InThisProcess())
    errors = "[errors]\ngain_factor = [1.1, 1.2, 1.3]\n"
    with pytest.raises(BadConfiguration, match=r"gain_factor in \[errors\] has 3 numbers; .* has 2 joints: give one f"):
        run_study(study_of(folder, small.ROBOT, errors), folder / "never", InThisProcess())
    with pytest.raises(BadConfiguration, match=r"'panda' has joints that drive others, .*; lock them"):
        run_study(study_of(folder, "[robot]\nname = 'panda'\n"), folder / "never", InThisProcess())
    assert not (folder / "never").exists()


@pytest.mark.parametrize("name", SHIPPED_CONFIGURATIONS)
def test_shipped_configurations(name):
    study = read_configuration(name)
    noises, runs = {"small": (2, 12), "birdy": (5, 25), "benchmark": (3, 25)}[name]
    assert (len({(one.position_noise, one.torque_noise) for one in study.scenarios}), study.runs) == (noises, runs)
    assert {one.start for one in study.scenarios} == {"0.15"}
    assert "graph" in study.methods


def test_axes_and_columns_are_those_of_a_scenario():
    assert list(GRID_AXES) == list(Scenario.__dataclass_fields__)


def test_a_start_keeps_all_its_digits(folder):
    (scenario,) = study_of(folder, small.ROBOT, "[scenario]\nstart = 0.123456789\n").scenarios
    assert scenario.start_error == 0.123456789


def test_time_that_is_left(folder):
    """Ten times as long for the second scenario: known from its first run on, guessed before."""
    tasks, now = tasks_of(small_study(folder)), [0.0]
    left = Remaining(tasks, lambda: now[0])
    assert left.seconds() is None
    now[0] = 1.0
    left.count(tasks[0], 2.0)  # two processor seconds a second: two processes
    assert left.seconds() == pytest.approx(3.0)
    now[0] = 11.0
    left.count(tasks[1], 20.0)
    assert left.seconds() == pytest.approx(11.0)


def test_the_command(program, words, folder, tmp_path, monkeypatch):
    monkeypatch.setattr(LocalProcesses, "each", lambda _self, *given: InThisProcess().each(*given))
    config, out = folder / "study.toml", tmp_path / "out"
    config.write_text(small.STUDY + small.ROBOT + small.SCENARIO + small.GRID)
    done = program("study", "--config", config, "--out", out)
    assert (done.code, "3 methods on 4 records" in words(done.out)) == (AGREED, True)
    assert json.loads((out / "study.json").read_text())["facts"]["robot"] == str(folder / "small.urdf")
    assert f"--config {config} --only {rows(out)[0]['scenario']}:0" in (out / "study.html").read_text()
    assert len(rows(out)) == 12
    again = program("study", "--config", config, "--out", out)
    assert (again.code, "go on with it by --resume" in words(again.err)) == (BAD_INPUT, True)
    name = rows(out)[0]["scenario"]
    assert "2 runs cannot decide 2 comparisons, however clear they are: give 7 runs or more" in words(done.err)
    so_far = program("study", "--report", out)
    assert (so_far.code, "so far 4 records of 2 scenarios" in words(so_far.out)) == (AGREED, True)
    repeated = f"--config {config.resolve()} --only {name}:0"
    assert repeated in (out / "study.html").read_text(), "whose robot is beside the configuration, not beside its copy"
    written = json.loads((out / "study.json").read_text())
    assert written["facts"]["so far"] == "4 records of 2 scenarios"
    assert written["files"]["results.parquet"] == hashlib.sha256((out / "results.parquet").read_bytes()).hexdigest()
    assert written["files"][str(folder / "small.urdf")] == hash_of(folder / "small.urdf")
    assert written["files"]["study.toml"] == hash_of(config)
    assert written["software"]["numpy"] == np.__version__
    paper = tmp_path / "paper"
    assert program("study", "--report", out, "--tables", paper).code == AGREED
    names = {file.name for file in paper.iterdir()}
    assert {"comparisons.csv", "errors.csv", "comparisons-torques.tex"} < names
    assert "torque-error-against-position-noise-errors-torques.svg" in names
    for options, message in (
        (("--report", out, "--resume"), "--report only reads the folder that it names; omit the other options"),
        ((), "name a configuration by --config, or the folder of a study by --report"),
        (("--config", config, "--tables", out), "--tables writes what --report shows; name the folder of a study by"),
    ):
        found = program("study", *options)
        assert (found.code, message in words(found.err)) == (BAD_INPUT, True)
    shown = program("study", "--config", config, "--only", f"{name}:1")
    assert (shown.code, "3 of 3 methods have an answer" in words(shown.out)) == (AGREED, True)
    refused = {
        ("--only", f"{name}:7"): "has no such run; it has",
        ("--only", f"{name}:1", "--resume"): "omit the other options beside --config",
        ("--jobs", 2, "--scheduler", "tcp://x:1"): "exclude each other",
    }
    for options, message in refused.items():
        found = program("study", "--config", config, *options)
        assert (found.code, message in words(found.err)) == (BAD_INPUT, True), options
    monkeypatch.setattr(LocalProcesses, "each", lambda _self, *given: InThisProcess(ends=1).each(*given))
    ended = program("study", "--config", config, "--out", tmp_path / "second")
    assert ended.code == INTERRUPTED
    assert "interrupted: 1 of 4 runs are kept in" in words(ended.err)


def test_an_own_method_that_is_none(program, words, tmp_path, monkeypatch):
    monkeypatch.setattr(own_process, "tell", lambda what: None)  # this one is
    (tmp_path / "mine.py").write_text("class Empty: pass\n")
    (tmp_path / "study.toml").write_text("[study]\nmethods = ['mine.py:Empty']\n[robot]\nname = 'ur5'\n")
    monkeypatch.chdir(tmp_path)
    found = program("study", "--config", tmp_path / "study.toml", "--allow-code", "--out", tmp_path / "out")
    assert found.code == BAD_INPUT
    assert not (tmp_path / "out").exists()
    assert "mine.py:Empty: what it makes has no name, reference, assumptions, needs, estimate" in words(found.err)


RUNS = """
from pathlib import Path
Path(__file__).with_suffix(".ran").touch()
"""


@pytest.mark.parametrize(
    ("options", "study", "robot", "said"),
    [
        ((), "", "'ur5'", "names Python code, .*evil.py:M, which can do whatever you can; .* add --allow-code"),
        (("--only", "a:1"), "", "'ur5'", "add --allow-code"),
        (("--allow-code",), "runz = 1\n", "'ur5'", "did you mean runs"),
        (("--allow-code",), "", "'none'", "none"),
        (("--allow-code",), "", "'ur5'\nviscous = [1, 2]", "viscous in .robot. has 2"),
        (("--allow-code", "--out", "."), "", "'ur5'", "holds a study already"),
        (("--allow-code", "--only", "a:1"), "", "'ur5'\nviscous = [1, 2]", "viscous in .robot. has 2"),
        (("--allow-code", "--only", "a:1"), "", "'ur5'", "has no such run; it has"),
    ],
)
def test_code_of_a_refused_study_does_not_run(program, words, tmp_path, monkeypatch, options, study, robot, said):
    monkeypatch.setattr(own_process, "tell", lambda what: None)  # this one is
    monkeypatch.chdir(tmp_path)
    (tmp_path / "evil.py").write_text(RUNS)
    (tmp_path / "study.toml").write_text(f"[study]\nmethods = ['evil.py:M']\n{study}[robot]\nname = {robot}\n")
    found = program("study", "--config", "study.toml", *options)
    assert found.code == BAD_INPUT
    assert re.search(said, words(found.err))
    assert not (tmp_path / "evil.ran").exists()


def test_unknown_file():
    with pytest.raises(BadConfiguration, match=r"there is no file nowhere; name a configuration, or one of small"):
        read_configuration("nowhere")


def test_a_robot_that_runs_away_is_a_failure_of_all_methods(folder):
    soft = small.ROBOT + "position_gain = 0\nvelocity_gain = -5\n"
    with pytest.raises(BadConfiguration, match=r"velocity_gain in \[robot\] is -5; give a number from 0 on"):
        study_of(folder, small.STUDY, soft, small.SCENARIO, small.GRID)
    stiff = small.ROBOT + "position_gain = 1e9\nvelocity_gain = 1e7\n"
    study = study_of(folder, small.STUDY, stiff, small.SCENARIO, small.GRID)
    outcome = computing.compute(study, tasks_of(study)[0])
    assert {result.reason for result in outcome.results} == {
        "no record: the controller does not hold the robot: it runs away; give other gains, or a higher rate"
    }
