"""How long the progress of each command stands still: python tests/tools standing_bars [COMMAND ...] [--over SECONDS]

Runs every command on UR5 in a terminal of its own, the first time on this machine: no compiled programs on disk. Prints
for each the longest time in which the line of progress did not change, apart from its clock and the color of its bar,
with that line, and the longest time without any line. Exit code 1 if a line stood longer than 2 s, or --over SECONDS.
Times are those of a clock, or where it is less, as on a busy machine, the processor time of the command (Linux).
"""

from __future__ import annotations

import argparse
import fcntl
import os
import pty
import re
import select
import shlex
import struct
import sys
import tempfile
import termios
import time
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from graphdyn.compiler import CACHE_VARIABLE

PREPARED = {
    "log.csv": "simulate ur5 --duration 6 --torque hold --velocity 0.5,0.3,0.4,1,1,1 --rate 200 --out log.csv",
    "motion.csv": "excite --robot ur5 --seeds 1 --random 1 --out motion.csv",
}
"""What writes the files that other commands read."""

RUNS = (
    "crosscheck ur5",
    "crosscheck ur5 --exact",
    "judge ur5 --inverse-dynamics code.py:rnea",
    "judge ur5 --inverse-dynamics code.py:wrong --html judged.html",
    "judge ur5 --function mass_matrix=code.py:mass --exact",
    "questions ur5 --for inverse_dynamics --out questions.csv",
    "show ur5 --html shown.html",
    "view ur5 --html view.html",
    "view ur5 --play log.csv --html play.html",
    "export ur5 --c ur5_c",
    "vectors ur5 --out vectors",
    "inspect ur5",
    "inspect ur5 --meshes detail",
    "repair ur5 --list",
    "recording log.csv --robot ur5",
    "identify log.csv --robot ur5 --cutoff 8 --urdf better.urdf",
    "identify --robot ur5",
    "identify --rehearse motion.csv --robot ur5 --torque-noise 0.03",
    "payload log.csv log.csv --robot ur5 --gains 11 --gains-error 0.03",
    "simulate ur5 --duration 3 --html fall.html",
    "excite --robot ur5 --out planned.csv",
    "excite --robot ur5 --motion motion.csv --against log.csv --noise 0.5",
    "study --config small --out small",
    "paper --samples 20",
    "bench --quick --robot ur5 --samples 10000",
    "robots",
    "errata --samples 20",
    "cache",
)
CODE = """\
import numpy as np
import graphdyn, urdf

model = urdf.load("ur5")
rnea = lambda q, v, a: graphdyn.joint_torques(model, q, v, a)
wrong = lambda q, v, a: graphdyn.joint_torques(model, q, -v, a) + 0.1 * v
mass = lambda q: graphdyn.mass_matrix(model, q)
"""

COLUMNS = 200
"""Width of the terminal: no line of progress is broken."""

SEQUENCE = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")
CLOCK = re.compile(r"\b\d+:\d\d:\d\d\b")
BAR = re.compile(r"[━╸╺ ]{3,}")
PAINTED = re.compile(r"[\r\n]")
ERASED = "\x1b[2K"


@dataclass(frozen=True)
class Instant:
    """A time of the clock, and the processor time of a command until then [s]."""

    clock: float
    processor: float

    @classmethod
    def of(cls, session: int) -> Instant:
        """Now, for the processes of a session."""
        return cls(time.monotonic(), sum(map(_processor, _members(session))))

    def since(self, earlier: Instant) -> float:
        elapsed, worked = self.clock - earlier.clock, self.processor - earlier.processor
        return elapsed if not Path("/proc/self").exists() else min(elapsed, max(worked, 0.0))


def _members(session: int) -> Iterator[list[str]]:
    """What Linux tells of each process of a session, from its state on."""
    for path in Path("/proc").glob("[0-9]*/stat"):
        with suppress(OSError):
            told = path.read_text().rpartition(")")[2].split()
            if int(told[3]) == session:
                yield told


def _processor(told: list[str]) -> float:
    """Processor time of a process and of its children that have ended [s]."""
    return sum(map(int, told[11:15])) / os.sysconf("SC_CLK_TCK")


@dataclass
class Standing:
    """The longest times without a change [s], and the line that stood."""

    line: str = ""
    stood: float = 0.0
    silent: float = 0.0
    code: int = 0


def main() -> int:
    parser = argparse.ArgumentParser(prog="python tests/tools standing_bars")
    parser.add_argument("commands", nargs="*", metavar="COMMAND", help="such as crosscheck; all if none is named")
    parser.add_argument("--over", type=float, default=2.0, metavar="SECONDS")
    options = parser.parse_args()
    failed = 0
    with tempfile.TemporaryDirectory() as folder:
        os.environ[CACHE_VARIABLE] = f"{folder}/cache"
        (Path(folder) / "code.py").write_text(CODE)
        for line in RUNS:
            if options.commands and line.split()[0] not in options.commands:
                continue
            for name, command in PREPARED.items():
                if name in line.split() and not (Path(folder) / name).exists():
                    watched(command, folder)
            os.environ[CACHE_VARIABLE] = tempfile.mkdtemp(dir=folder)
            found = watched(line, folder)
            failed += found.stood > options.over
            told = f"{found.stood:5.1f} s  {found.line}" if found.line else "no bar"
            print(f"{line}\n  {told}\n  {found.silent:5.1f} s without a line; exit code {found.code}", flush=True)
    return failed > 0


def watched(line: str, folder: str) -> Standing:
    """Run a command in a terminal, to its end."""
    child, terminal = pty.fork()
    if not child:
        os.chdir(folder)
        os.environ["TERM"] = "xterm-256color"
        os.execv(sys.executable, [sys.executable, "-m", "crosscheck", *shlex.split(line)])
    fcntl.ioctl(terminal, termios.TIOCSWINSZ, struct.pack("HHHH", 50, COLUMNS, 0, 0))
    found, since, shown = Standing(), Instant.of(child), ""
    for text in _pieces(terminal):
        painted = text.rpartition(ERASED)[2]
        new = _bar(painted) or ("" if ERASED in text else shown)
        if new != shown:
            now = Instant.of(child)
            _count(found, shown, now.since(since))
            shown, since = new, now
        last = Instant.of(child)
    _count(found, shown, last.since(since))
    found.code = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return found


def _count(found: Standing, shown: str, seconds: float) -> None:
    if not shown:
        found.silent = max(found.silent, seconds)
    elif seconds > found.stood:
        found.line, found.stood = shown, seconds


def _pieces(terminal: int) -> Iterator[str]:
    """What is written to the terminal, as it comes."""
    while True:
        select.select([terminal], [], [])
        try:
            written = os.read(terminal, 1 << 20)
        except OSError:  # the command has ended
            return
        if not written:
            return
        yield written.decode("utf-8", "replace")


def _bar(painted: str) -> str:
    """The last line of progress in what is written, without clock and colors; "" if there is none."""
    lines = [SEQUENCE.sub("", line) for line in PAINTED.split(painted)]
    bars = [BAR.sub("  ", CLOCK.sub("", line)).strip() for line in lines if CLOCK.search(line)]
    return bars[-1] if bars else ""
