"""Tasks in processes and on the workers of a scheduler: each has its answer, whatever happens to a process."""

import multiprocessing
import os
import signal

import pytest

from crosscheck.distributing import DaskWorkers, LocalProcesses, Lost, NoWorkers, cluster
from crosscheck.distributing.versions import versions


def deadly(number):
    if number < 0:
        os.kill(os.getpid(), signal.SIGKILL)
    return number**2


def deadly_once(path):
    if not path.exists():
        path.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return path.name


class TestProcesses:
    def test_the_task_that_kills_is_known_and_the_others_go_on(self):
        lost = Lost("its process died with code -9, tries: 1")
        answers = dict(LocalProcesses(1, tries=1).each(deadly, [1, -2, 3, -4]))
        assert answers == {0: 1, 1: lost, 2: 9, 3: lost}

    def test_tried_again(self, tmp_path):
        assert dict(LocalProcesses(2).each(deadly_once, [tmp_path / "a"])) == {0: "a"}
        assert dict(LocalProcesses(2).each(deadly, [-1])) == {0: Lost("its process died with code -9, tries: 2")}

    def test_nothing_to_do(self):
        assert list(LocalProcesses(2).each(deadly, [])) == []
        assert list(DaskWorkers("tcp://nowhere:1").each(deadly, [])) == []

    def test_they_end_with_the_generator(self):
        answers = LocalProcesses(2).each(deadly, [1, 2, 3])
        next(answers)
        answers.close()
        assert multiprocessing.active_children() == []


class TestRefusals:
    def refused(self, message):
        return pytest.raises(NoWorkers, match=message)

    def test_no_dask(self, monkeypatch):
        monkeypatch.setitem(__import__("sys").modules, "distributed", None)
        with self.refused(r"Dask is not installed \(.*\); pip install 'graphdyn\[distributed\]'"):
            next(DaskWorkers("tcp://127.0.0.1:1").each(deadly, [1]))

    @pytest.mark.parametrize("address", ["tcp://127.0.0.1:1", "127.0.0.1:x", "http://a b"])
    def test_no_scheduler(self, monkeypatch, address):
        monkeypatch.setattr(cluster, "PATIENCE", 0.2)
        with self.refused(r"no Dask scheduler answers at .*; start one with: dask scheduler, and give the address"):
            next(DaskWorkers(address).each(deadly, [1]))

    @pytest.mark.parametrize(
        ("threads", "found", "message"),
        [
            (1, {**versions(), "numpy": "1.0"}, r"worker W has numpy 1.0 in place of .*; install the versions of this"),
            (1, {**versions(), "python": "3.9"}, r"worker W has python 3.9 in place of"),
            (
                8,
                versions(),
                r"worker W does 8 tasks at once in one process; start it with --nthreads 1, and with --nwo",
            ),
            (1, ModuleNotFoundError("No module named 'crosscheck'"), r"W does not have graphdyn .*install version "),
        ],
    )
    def test_workers(self, threads, found, message):
        with self.refused(message):
            cluster.examine("W", threads, found)
