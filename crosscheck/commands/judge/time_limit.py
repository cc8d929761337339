"""The time that a function in Python has for each call."""

from __future__ import annotations

import faulthandler
import signal
import sys
from collections.abc import Callable
from types import FrameType
from typing import Any

from crosscheck.commands.program.own_process import UserCodeEnded

REPEATED_AFTER = 1.0
"""Time after which a function that has caught the interruption is interrupted again [s]."""

KILLED_AFTER = 5.0
"""Time after the limit at which compiled code that cannot be interrupted ends with its process [s]."""


class TooSlow(BaseException):
    """A call took longer than its limit; no Exception, so that functions do not catch it as one."""


def limited(function: Callable[..., object], what: str, seconds: float) -> Callable[..., object]:
    """The function, whose calls raise UserCodeEnded after a time [s]. what: its name in messages

    Compiled code that does not return is ended with its process. Systems without SIGALRM have no limit.
    """
    if not hasattr(signal, "setitimer"):
        return function

    def call(*arguments: Any) -> object:
        def interrupt(_number: int, frame: FrameType | None) -> None:
            raise TooSlow(f" ({frame.f_code.co_filename}, line {frame.f_lineno})" if frame else "")

        before = signal.signal(signal.SIGALRM, interrupt)
        faulthandler.dump_traceback_later(seconds + KILLED_AFTER, exit=True, file=sys.__stderr__ or 2)
        signal.setitimer(signal.ITIMER_REAL, seconds, REPEATED_AFTER)
        try:
            return function(*arguments)
        finally:
            signal.setitimer(signal.ITIMER_REAL, 0)
            faulthandler.cancel_dump_traceback_later()
            signal.signal(signal.SIGALRM, before)

    def timed(*arguments: Any) -> object:
        try:
            return call(*arguments)
        except TooSlow as late:
            raise NoAnswerInTime(
                f"{what} had not returned after {seconds:g} s{late}; if it does return, give more time by --time-limit"
            ) from None

    return timed


class NoAnswerInTime(BaseException):
    """A call took longer than its limit: the command ends."""

    def ended(self) -> UserCodeEnded:
        return UserCodeEnded(str(self))
