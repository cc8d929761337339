"""Calls that write, of which one fails. The program tests/tools/program/failing_calls.py does so below Python."""

import errno
import os
from contextlib import contextmanager
from pathlib import Path
from unittest.mock import patch

CALLS = ((Path, "write_bytes"), (os, "fsync"), (os, "replace"))


@contextmanager
def failing(number, lasting=False):
    """The call of this number, from 1 on, fails after half of its work. Answers the list of those that were made.

    lasting: all after it fail too
    """
    made = []

    def counted(place, name):
        original = getattr(place, name)

        def call(first, *others):
            made.append(name)
            if len(made) != number and not (lasting and len(made) > number):
                return original(first, *others)
            if name == "write_bytes":
                original(first, others[0][: len(others[0]) // 2])
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(first))

        return patch.object(place, name, call)

    with counted(*CALLS[0]), counted(*CALLS[1]), counted(*CALLS[2]):
        yield made
