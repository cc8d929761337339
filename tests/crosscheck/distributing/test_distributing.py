"""Tasks in processes and on the workers of a scheduler: each has its answer, whatever happens to a process."""

import json
import logging
import multiprocessing
import os
import pickle
from concurrent.futures import CancelledError
from pathlib import Path
from uuid import uuid4

import pytest
from deadly_tasks import deadly, own_number, telling
from typer.testing import CliRunner

from crosscheck.commands import app
from crosscheck.commands.program.exits import AGREED
from crosscheck.distributing import DaskWorkers, LocalProcesses, Lost, NoWorkers, dask_workers
from crosscheck.distributing.processes import Telling, Told
from crosscheck.distributing.workers import versions


class TestProcesses:
    def test_one_that_dies(self, tmp_path):
        """Its task is tried again, and known if that does not help; the others go on."""
        answers = dict(LocalProcesses(1).each(deadly, [1, -2, tmp_path / "a", 3]))
        assert answers == {0: 1, 1: Lost("its process died with code -9, tries: 2"), 2: "a", 3: 9}

    def test_nothing_to_do(self):
        assert list(LocalProcesses(2).each(deadly, [])) == []
        assert list(DaskWorkers("tcp://nowhere:1").each(deadly, [])) == []

    def test_they_end_with_the_generator(self):
        answers = LocalProcesses(2).each(deadly, [1, 2, 3])
        next(answers)
        answers.close()
        assert multiprocessing.active_children() == []

    def test_what_a_process_logs_is_logged_here(self, caplog):
        with caplog.at_level("INFO", "crosscheck"):
            assert list(LocalProcesses(1).each(telling, [7])) == [(0, 7)]
        assert caplog.messages == ["task 7 begins"]

    def test_what_soon_follows_is_logged_later(self):
        """Not left out: it may be what takes long."""
        here, there = multiprocessing.Pipe()
        handler = Telling(there)
        for message in ("a", "b", "c"):
            handler.emit(logging.makeLogRecord({"levelno": logging.INFO, "msg": message}))
        told = []
        while Told("c") not in told:
            assert here.poll(60)
            told.append(here.recv())
        assert told[0] == Told("a")

    def test_kept_between_two_works(self):
        """One that has died in the meantime is replaced; none is left at the end."""
        with LocalProcesses(1).kept() as workers:
            ((_, first),) = workers.each(own_number, [1])
            assert dict(workers.each(deadly, [2, 3])) == {0: 4, 1: 9}
            ((_, again),) = workers.each(own_number, [1])
            (process,) = multiprocessing.active_children()
            process.kill()
            process.join()
            ((_, other),) = workers.each(own_number, [1])
        assert first == again == process.pid != other
        assert multiprocessing.active_children() == []


class Future:
    """As of distributed: done at once, unless its task is to kill its worker."""

    def __init__(self, task, beside):
        self.key, self.task, self.beside = str(uuid4()), task, beside
        self.status = "canceled" if task == "gone" else "error" if task == "broken" else "finished"
        if task == "killer" or (task == "innocent" and beside):
            self.status = "error"

    def add_done_callback(self, function):
        function(self)

    def exception(self):
        from distributed import KilledWorker

        return ImportError("no module") if self.task == "broken" else KilledWorker(self.key, None, 3)

    def result(self):
        if self.task == "vanished":
            raise CancelledError
        return self.task


class FakeCluster:
    """Of one worker."""

    def __init__(self, address, libraries):
        self.address, self.given = address, 0

    def close(self):
        pass

    def n_workers(self):
        return 1

    def submit(self, function, task):
        self.given += 1
        return Future(task, beside=self.given <= 3)

    def gone(self):
        return NoWorkers("the connection is lost")


class TestScheduler:
    @pytest.fixture(autouse=True)
    def fake(self, monkeypatch):
        monkeypatch.setattr(dask_workers, "Cluster", FakeCluster)

    def test_what_waited_beside_a_deadly_task_is_not_lost(self):
        answers = dict(DaskWorkers("a").each(deadly, ["innocent", "killer", "ok"]))
        lost = Lost("its process died, the last time with no task beside it, tries: 8")
        assert answers == {0: "innocent", 1: lost, 2: "ok"}

    def test_what_a_worker_cannot_import(self):
        assert dict(DaskWorkers("a").each(deadly, ["broken"])) == {0: Lost("ImportError: no module", died=False)}

    @pytest.mark.parametrize("when", ["gone", "vanished"])
    def test_the_scheduler_ends(self, when):
        with pytest.raises(NoWorkers, match="the connection is lost"):
            list(DaskWorkers("a").each(deadly, [when]))

    def test_a_folder_of_robots(self, monkeypatch, pendulum, second_pendulum, tmp_path):
        """`graphdyn crosscheck FOLDER --scheduler`: tasks and outcomes travel as bytes."""
        done = []

        def submit(_self, function, task):
            done.append(task.robot)
            work, its = pickle.loads(pickle.dumps((function, task)))
            return Future(pickle.loads(pickle.dumps(work(its))), beside=False)

        monkeypatch.setattr(FakeCluster, "submit", submit)
        options = ["--samples", "1", "--scheduler", "tcp://a:1", "--json", str(tmp_path / "r.json")]
        assert CliRunner().invoke(app, ["crosscheck", str(tmp_path), *options]).exit_code == AGREED
        robots = json.loads((tmp_path / "r.json").read_text(encoding="utf-8"))["robots"]
        assert sorted(robot["robot"] for robot in robots) == sorted(done) == [str(pendulum), str(second_pendulum)]

    def test_its_only_worker_is_being_replaced(self, monkeypatch):
        """A task waits at the scheduler for the new one, where nothing else is under way."""
        monkeypatch.setattr(FakeCluster, "n_workers", lambda self: 0)
        assert dict(DaskWorkers("a").each(deadly, ["one", "two"])) == {0: "one", 1: "two"}

    def test_the_last_worker_ends(self, monkeypatch):
        monkeypatch.setattr(dask_workers, "ANSWER_TIMEOUT", 0.001)
        monkeypatch.setattr(FakeCluster, "n_workers", lambda self: 0 if self.given else 1)
        monkeypatch.setattr(Future, "add_done_callback", lambda *_: None)
        with pytest.raises(NoWorkers, match="the scheduler a has lost its last worker; start others"):
            list(DaskWorkers("a").each(deadly, ["ok"]))


@pytest.mark.parametrize("there", [True, False])
def test_relative_paths_mean_the_same_on_a_worker(tmp_path, there):
    folder = tmp_path if there else tmp_path / "none"
    assert dask_workers._in_folder(os.path.abspath, str(folder), "arms") == str(
        tmp_path / "arms" if there else Path("arms").absolute()
    )


class TestRefusals:
    def refused(self, message):
        return pytest.raises(NoWorkers, match=message)

    def test_no_dask(self, monkeypatch):
        monkeypatch.setitem(__import__("sys").modules, "distributed", None)
        with self.refused(r"distributed is not installed \(.*\); run: python -m pip install 'graphdyn\[distributed\]'"):
            next(DaskWorkers("tcp://127.0.0.1:1").each(deadly, [1]))

    @pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "127.0.0.1:x", "http://a b"])
    def test_no_scheduler(self, monkeypatch, address):
        monkeypatch.setattr(dask_workers, "SCHEDULER_TIMEOUT", 0.2)
        with self.refused(r"no Dask scheduler answers at .*; start one with: dask scheduler, and give the address"):
            next(DaskWorkers(address).each(deadly, [1]))

    def test_what_dask_says_of_its_end_is_not_shown(self, caplog):
        """Its traces, whatever level it sets; afterwards it may speak again."""
        client = logging.getLogger("distributed.client")
        with dask_workers.quiet_loggers():
            client.setLevel(logging.INFO)
            client.error("Traceback")
            assert caplog.messages == []
        client.error("Traceback")
        assert caplog.messages == ["Traceback"]

    def test_libraries_of_a_study_are_asked_for(self, monkeypatch):
        """Of new workers only, and one that has another version is refused."""
        asked, there = [], {"tcp://a:1": 1, "tcp://a:2": 1}

        class Client:
            def wait_for_workers(self, count, timeout):
                pass

            def nthreads(self):
                return there

            def run(self, function, libraries, workers, on_error):
                asked.append(workers)
                of = function(libraries)
                return {worker: {**of, "cvxpy": "0.1"} if worker == "tcp://a:3" else of for worker in workers}

        monkeypatch.setattr(dask_workers, "_connected", lambda address: Client())
        cluster = dask_workers.Cluster("tcp://a:0", ["cvxpy", "nowhere"])
        assert [cluster.n_workers(), cluster.n_workers()] == [2, 2]
        there["tcp://a:3"] = 1
        with self.refused(r"worker tcp://a:3 has cvxpy 0.1 in place of \d"):
            cluster.n_workers()
        assert asked == [["tcp://a:1", "tcp://a:2"], ["tcp://a:3"]]

    @pytest.mark.parametrize(
        ("threads", "found", "message"),
        [
            (1, {**versions(), "numpy": "1.0"}, r"worker W has numpy 1.0 in place of .*; install the versions of this"),
            (1, {**versions(), "python": "3.9"}, r"worker W has python 3.9 in place of"),
            (
                8,
                versions(("cvxpy", "nowhere")),
                r"worker W does 8 tasks at once in one process; start it with --nthreads 1, and with --nwo",
            ),
            (1, {**versions(), "llvmlite": "0.1"}, r"worker W has llvmlite 0.1 in place of"),
            (1, {**versions(), "cvxpy": "missing"}, r"worker W has cvxpy missing in place of \d"),
            (1, {**versions(("cvxpy",)), "nowhere": "1"}, r"worker W has nowhere 1 in place of missing"),
            (1, TypeError("versions() takes no argument"), r"W cannot say which versions it has .*install graphdyn \d"),
            (1, ModuleNotFoundError("No module named 'crosscheck'"), r"W does not have graphdyn .*install version "),
        ],
    )
    def test_workers(self, threads, found, message):
        with self.refused(message):
            dask_workers.examine("W", threads, found, ("cvxpy", "nowhere"))

    def test_one_that_is_like_this_process_or_has_gone(self):
        for found in (versions(("nowhere",)), OSError("gone"), TimeoutError()):
            dask_workers.examine("W", 1, found, ("nowhere",))
