"""Arrays of files whose libraries can die of damage, parsed in another process: its death is an error of the file."""

from __future__ import annotations

import atexit
import json
import mmap
import os
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from contextlib import ExitStack
from pathlib import Path
from threading import Lock
from typing import Any, BinaryIO

import numpy as np
from numpy.typing import NDArray

from crosscheck.recordings.formats import parsing_process
from crosscheck.recordings.formats.parsing_process import EXIT_CODE, LENGTH, NO_FORK

MAX_MEMORY = 6 << 30
"""Largest memory of the process that parses a file [bytes]; the content may be there several times."""

MAX_CPU_SECONDS, MAX_WALL_SECONDS = 120, 1200
"""Longest time of the processor, and by the clock, for a file [s]."""


class ParserFailed(Exception):
    """A file cannot be parsed, or its parser has died. Its text says of what."""


class FileParser:
    """The process, started with the first file, and again after its death. One file is parsed at a time."""

    def __init__(self) -> None:
        self._lock = Lock()
        self._process: subprocess.Popen[bytes] | None = None
        self._socket: socket.socket | None = None

    def exit_code(self, limits: Mapping[str, int], files: list[int]) -> int:
        """How the parser of an open file ended, whose arrays it wrote to the other one.

        Raises ParserFailed; OSError where no process can be started.
        """
        with self._lock:
            asked = self._socket or self._started()
            try:
                socket.send_fds(asked, [json.dumps(limits).encode()], files)
                answer = asked.recv(EXIT_CODE.size)
            except TimeoutError:
                self.close()
                raise ParserFailed(f"parsing it takes more than {MAX_WALL_SECONDS} s") from None
            except BaseException:  # such as Ctrl-C: the answer would be taken for that of the next file
                self.close()
                raise
            if not answer:
                self.close()
                raise ParserFailed("the process that parses it has ended")
            code = int(EXIT_CODE.unpack(answer)[0])
            if code >= NO_FORK:
                raise OSError(code - NO_FORK, os.strerror(code - NO_FORK))
            return code

    def close(self) -> None:
        """End the process."""
        if self._process is not None and self._socket is not None:
            self._socket.close()
            self._process.kill()
            self._process.wait()
        self._process = self._socket = None

    def _started(self) -> socket.socket:
        ours, theirs = socket.socketpair()
        ours.settimeout(MAX_WALL_SECONDS)
        with theirs, ExitStack() as undone:
            undone.enter_context(ours)
            self._process = subprocess.Popen(
                [sys.executable, "-P", parsing_process.__file__],
                stdin=theirs.fileno(),
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                env={**os.environ, "OPENBLAS_NUM_THREADS": "1"},  # a fork has no other threads
                start_new_session=True,
            )
            undone.pop_all()
        self._socket = ours
        return ours


PARSERS: dict[int, FileParser] = {}
"""Parsers by the number of our process: a fork of it has its own."""


@atexit.register
def _end() -> None:
    if parser := PARSERS.pop(os.getpid(), None):
        parser.close()


def arrays_apart(path: Path, max_expanded: int) -> tuple[dict[str, NDArray[Any]], int]:
    """The arrays of a file by name, and the size of its content if that is above the limit, otherwise zero [bytes].

    An array that holds no numbers is one of None. Raises ParserFailed; ModuleNotFoundError, OSError.
    """
    limits = {"expanded": max_expanded, "memory": MAX_MEMORY, "seconds": MAX_CPU_SECONDS}
    with path.open("rb") as source, _shared_file() as sink:
        code = PARSERS.setdefault(os.getpid(), FileParser()).exit_code(limits, [source.fileno(), sink.fileno()])
        if code:
            raise ParserFailed(_end_in_words(code))
        content = mmap.mmap(sink.fileno(), 0, access=mmap.ACCESS_COPY)
    (length,) = LENGTH.unpack(content[-LENGTH.size :])
    description = json.loads(content[-LENGTH.size - length : -LENGTH.size])
    if "error" in description:
        raise ParserFailed(description["error"])
    if "missing" in description:
        raise ModuleNotFoundError(name=description["missing"])
    found = {one["name"]: _array(one, content) for one in description.get("arrays", ())}
    return found, description.get("expanded", 0)


def _shared_file() -> BinaryIO:
    """A file in memory."""
    return os.fdopen(os.memfd_create("arrays"), "r+b") if sys.platform == "linux" else tempfile.TemporaryFile()


def _end_in_words(code: int) -> str:
    if code == -signal.SIGPROF:
        return f"parsing it takes more than {MAX_CPU_SECONDS} s of the processor"
    how = f"signal {-code}, {signal.strsignal(-code)}" if code < 0 else f"exit code {code}"
    return f"it ended the process that parses it, {how}"


def _array(description: Mapping[str, Any], content: mmap.mmap) -> NDArray[Any]:
    if "type" not in description:
        return np.broadcast_to(np.array(None, dtype=object), description["shape"])
    return np.ndarray(description["shape"], description["type"], content, description["place"])
