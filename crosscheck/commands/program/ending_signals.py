"""SIGTERM and SIGHUP unwind the program as Ctrl-C does: the processes it started end, and files stay whole."""

from __future__ import annotations

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager

SIGNALS = tuple(getattr(signal, name) for name in ("SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Windows has no SIGHUP."""


class Ended(BaseException):
    """Raised wherever the program is when it receives one of the signals. exit_code: as shells report it."""

    def __init__(self, number: int) -> None:
        self.exit_code = 128 + number


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """End the program with the exit code of the signal. One that is ignored, as with nohup, stays ignored."""
    here = threading.current_thread() is threading.main_thread()
    ours = [number for number in SIGNALS if here and signal.getsignal(number) is signal.SIG_DFL]

    def unwind(number: int, _: object) -> None:
        for one in ours:
            signal.signal(one, signal.SIG_IGN)  # the first one is enough
        raise Ended(number)

    for number in ours:
        signal.signal(number, unwind)
    try:
        yield
    except Ended as ended:
        sys.exit(ended.exit_code)
    finally:
        for number in ours:
            signal.signal(number, signal.SIG_DFL)
