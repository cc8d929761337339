"""Tasks for processes, in a file that a new process imports quickly."""

import logging
import os
import signal
from pathlib import Path

from mutants.outcomes import Result, Trial


def deadly(task):
    """Kills its process for a negative number, and once for a path."""
    if task.exists() if isinstance(task, Path) else task > 0:
        return task.name if isinstance(task, Path) else task**2
    if isinstance(task, Path):
        task.touch()
    return os.kill(os.getpid(), signal.SIGKILL)


def telling(task):
    """Logs what begins, and answers."""
    logging.getLogger("graphdyn").info("task %d begins", task)
    return task


def own_number(_task):
    return os.getpid()


def ends_at_two(_seed, cases, connection):
    """The work on mutants that agree, but the one with the number 2, which ends its process."""
    for format, number in cases:
        if number == 2:
            os._exit(1)
        connection.send(Result(format, number, (), Trial("agrees")))
