"""Processes that a test started: whether they have ended, and what could travel to them."""

import pickle
from pathlib import Path

HANGS = 60
"""Time after which a process that should have ended counts as left alive [s]; it ends in a second."""


def alive(process):
    """Whether it runs; one that has ended, and whose parent has not asked for its exit code, does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def travelled(anything):
    """The copy of it that another process gets."""
    return pickle.loads(pickle.dumps(anything))
