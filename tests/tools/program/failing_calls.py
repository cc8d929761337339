"""What is left of the files of a command if one write, flush, rename, resize or fork of it fails, each in turn.

The long run: `python tests/tools failing_calls`; exit code 1 if something half written was left, an old file was lost,
the exit code was another, or a study could not go on. `python tests/tools failing_calls simulate --every 5 --lasting`
repeats a part: every fifth call of one command, and all later calls of its kind fail too, as on a full disk.

Linux with a C compiler: failing_calls.c is preloaded into the program, and into all processes that it starts.
"""

from __future__ import annotations

import argparse
import ctypes
import errno
import json
import mmap
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, nullcontext, suppress
from dataclasses import dataclass, field
from pathlib import Path
from unittest.mock import patch

KINDS = {"w": "write", "s": "flush", "r": "rename", "t": "resize", "c": "create", "f": "fork"}
SHIM = Path(__file__).with_suffix(".c")
GAVE_UP = 120.0
"""Time after which a run counts as hanging [s]."""

BAD_INPUT = 2

STORE = re.compile(r"\.sqlite(-wal|-shm)?$")
"""The store of a study, which is written to as it is."""


class Calls(ctypes.Structure):
    """The struct state of failing_calls.c, which all processes share."""

    _fields_ = (
        *((name, ctypes.c_int) for name in ("enabled", "target", "lasting", "full", "write_error", "count")),
        ("kinds_raw", ctypes.c_ubyte * 65536),
    )


@dataclass(frozen=True)
class Run:
    """A command in a folder of its own.

    inputs: its files; old: files of its outputs that are there before; resumed: arguments with which it goes on
    before: arguments that write a folder that is there before; workers: around the command
    growing: a JSON file that is written, whole, whenever a part is done, and of which a later run takes over all parts
    """

    name: str
    arguments: tuple[str, ...]
    inputs: dict[str, bytes] = field(default_factory=dict)
    old: dict[str, bytes] = field(default_factory=dict)
    resumed: tuple[str, ...] = ()
    growing: str = ""
    before: tuple[str, ...] = ()
    workers: Callable[[], AbstractContextManager[object]] = nullcontext
    code: int = 0


PAGES = {"page.html": b"old page", "numbers.json": b"old numbers"}
REPORT = ("--html", "page.html", "--json", "numbers.json")


def runs() -> list[Run]:
    from identified import small_study as small

    robot = {"small.urdf": small.ARM.encode()}
    study = (small.STUDY.replace('"wls", "ols", "iv"', '"wls", "ols"') + small.ROBOT + small.SCENARIO).encode()
    own = b"from graphdyn.identification import OrdinaryLeastSquares\nclass Own(OrdinaryLeastSquares): pass\n"
    answers = b"import numpy as np\ndef rnea(q, v, a):\n    return np.zeros(len(q))\n"
    found = ("--methods", "consistent", "--choose", "consistent", "--seconds", "10", "--urdf", "new.urdf")
    planned = ("excite", "--robot", "small.urdf", "--velocity", "2", "--torque", "100", "--duration", "4")
    fast = ("--seeds", "1", "--harmonics", "2", "--random", "3", "--lower", "-1", "--upper", "1")
    moved = ("--position", "0.3,0.2", "--velocity", "1,0.8", "--duration", "0.3")
    return [
        Run("simulate", ("simulate", "small.urdf", *moved, "--out", "m.csv", *REPORT), robot, PAGES),
        Run("simulate-parquet", ("simulate", "small.urdf", *moved, "--out", "m.parquet"), robot),
        Run("simulate-mcap", ("simulate", "small.urdf", *moved, "--out", "m.mcap"), robot),
        Run("excite", (*planned, *fast, "--jobs", "1", "--out", "m.csv", *REPORT), robot, PAGES),
        Run("excite-processes", (*planned, *fast, "--jobs", "2", "--seeds", "2", "--out", "m.yaml"), robot),
        Run(
            "identify",
            ("identify", "--robot", "small.urdf", *found, *REPORT),
            robot,
            {**PAGES, "new.urdf": b"<robot name='old'/>"},
        ),
        Run(
            "study",
            ("study", "--config", "study.toml", "--out", "out", "--jobs", "1"),
            {**robot, "study.toml": study},
            resumed=("--resume",),
            workers=_in_this_process,
        ),
        Run(
            "study-processes",
            ("study", "--config", "study.toml", "--out", "out", "--jobs", "2", "--allow-code"),
            {**robot, "own.py": own, "study.toml": study.replace(b'"ols"', b'"own.py:Own"')},
            resumed=("--resume",),
        ),
        Run(
            "judge",
            ("judge", "small.urdf", "--inverse-dynamics", "own.py:rnea", *REPORT),
            {**robot, "own.py": answers},
            PAGES,
            code=1,
        ),
        Run(
            "judge-program",
            ("judge", "small.urdf", "--command", f"inverse_dynamics={sys.executable} -I zeros.py", *REPORT),
            {**robot, "zeros.py": b"import sys\nfor line in sys.stdin:\n    print('0 0', flush=True)\n"},
            PAGES,
            code=1,
        ),
        Run(
            "judge-library",
            ("judge", "small.urdf", "--library", "inverse_dynamics=./own.so:rnea", *REPORT),
            {**robot, "own.so": _library(b"int rnea(int n) { return 0 * n; }")},
            PAGES,
            code=1,
        ),
        Run(
            "crosscheck-folder",
            ("crosscheck", "arms", "--samples", "3", "--jobs", "2", *REPORT),
            {f"arms/{name}.urdf": robot["small.urdf"] for name in ("one", "two", "three")},
            PAGES,
            resumed=("--resume",),
            growing="numbers.json",
        ),
        Run(
            "inspect-folder",
            ("inspect", "arms", *REPORT),
            {f"arms/{name}.urdf": robot["small.urdf"] for name in "ab"},
            PAGES,
        ),
        Run("crosscheck", ("crosscheck", "small.urdf", "--samples", "3", *REPORT), robot, PAGES),
        Run("inspect", ("inspect", "small.urdf", *REPORT), robot, PAGES),
        Run("show", ("show", "small.urdf", *REPORT), robot, PAGES),
        Run("view", ("view", "small.urdf", "--html", "page.html"), robot, {"page.html": b"old page"}),
        Run("questions", ("questions", "small.urdf", "--for", "inverse_dynamics", "--out", "q.csv"), robot),
        Run(
            "vectors",
            ("vectors", "small.urdf", "--for", "inverse_dynamics", "--out", "v"),
            robot,
            before=("vectors", "small.urdf", "--for", "inverse_dynamics", "--out", "v", "--seed", "1"),
        ),
        Run("export", ("export", "small.urdf", "--to", "small.c"), robot),
        Run("export-json", ("export", "small.urdf", "--to", "small.json"), robot),
    ]


def _library(source: bytes) -> bytes:
    """A shared library of a program in C."""
    with tempfile.TemporaryDirectory() as folder:
        built = Path(folder, "own.so")
        subprocess.run(["cc", "-shared", "-fPIC", "-x", "c", "-o", built, "-"], input=source, check=True)
        return built.read_bytes()


def _in_this_process() -> AbstractContextManager[object]:
    """Tasks of a study that are done by the process that writes."""
    from identified.small_study import InThisProcess

    from crosscheck.distributing import LocalProcesses

    return patch.object(LocalProcesses, "each", lambda _self, *given: InThisProcess().each(*given))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="of runs; all without one")
    parser.add_argument("--every", type=int, default=1, help="only every so many-th call")
    parser.add_argument("--first", type=int, default=1, help="number of the first call")
    parser.add_argument("--lasting", action="store_true", help="later calls of this kind fail too")
    parser.add_argument("--error", choices=["ENOSPC", "EIO", "EDQUOT"], default="ENOSPC", help="of writes")
    given = parser.parse_args()
    if "FAILING_STATE" not in os.environ:
        return _preloaded()
    from crosscheck.commands import main as _  # noqa: F401 - once for all runs

    calls = _calls(Path(os.environ["FAILING_STATE"]))
    calls.write_error, calls.lasting = getattr(errno, given.error), given.lasting
    wrong = 0
    for run in runs():
        if not given.names or run.name in given.names:
            wrong += _Trial(run, calls, Path(os.environ["FAILING_ROOT"])).each(given.first, given.every)
    print(f"{wrong} wrong")
    return int(wrong > 0)


def _preloaded() -> int:
    """This program again, with the library, in a folder that is removed afterwards."""
    with tempfile.TemporaryDirectory() as folder:
        shim, state = Path(folder, "failing_calls.so"), Path(folder, "state")
        subprocess.run(["cc", "-O1", "-shared", "-fPIC", "-o", shim, SHIM, "-ldl"], check=True)
        state.write_bytes(bytes(ctypes.sizeof(Calls)))
        more = {"LD_PRELOAD": str(shim), "FAILING_STATE": str(state), "FAILING_ROOT": f"{folder}/root/"}
        quiet = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "TMPDIR": f"{folder}/root/tmp"}
        return subprocess.run(
            [sys.executable, *sys.orig_argv[1:]], env={**os.environ, **more, **quiet}, check=False
        ).returncode


def _calls(file: Path) -> Calls:
    with file.open("r+b") as opened:
        return Calls.from_buffer(mmap.mmap(opened.fileno(), ctypes.sizeof(Calls)))


class _Trial:
    def __init__(self, run: Run, calls: Calls, root: Path) -> None:
        self.run, self.calls, self.root = run, calls, root
        self.work = root / "work"
        self.errors = root.parent / "errors"

    def each(self, first: int, every: int) -> int:
        """Fail each call in turn; answer how many went wrong."""
        begin = time.monotonic()
        self.old = dict(self.run.old)
        self.warm()
        if self.run.before:
            self.fresh()
            assert self.ended(self.run.before) == 0
            self.old |= {name.removeprefix("work/"): content for name, content in self.files().items()}
            del self.old["stdout"]
        self.fresh()
        code = self.ended(self.run.arguments)
        count, kinds = self.calls.count, bytes(self.calls.kinds_raw[1 : self.calls.count + 1]).decode()
        assert code == self.run.code, (self.run.name, code, self.errors.read_text())
        print(f"{self.run.name}: {count} calls", flush=True)
        self.whole = self.files()
        self.fresh()
        self.ended(self.run.arguments)
        self.volatile = {name for name, content in self.files().items() if content != self.whole.get(name)}
        found, wrong = Counter[str](), 0
        for target in range(first, count + 1, every):
            self.fresh()
            code = self.ended(self.run.arguments, target)
            problems = self.problems(code)
            found[f"{KINDS[kinds[target - 1]]}: {'; '.join(problems) or f'exit code {code}'}"] += 1
            if problems:
                wrong += 1
                print(f"{self.run.name}, call {target} ({KINDS[kinds[target - 1]]}): {'; '.join(problems)}")
                print(self.errors.read_text()[-3000:], flush=True)
        seconds = time.monotonic() - begin
        print(f"{self.run.name}: {found.total()} of {count} calls failed, {wrong} wrong, {seconds:.0f} s", flush=True)
        print(*(f"    {number:4} {what}" for what, number in sorted(found.items())), sep="\n", flush=True)
        return wrong

    def fresh(self) -> None:
        shutil.rmtree(self.root, ignore_errors=True)
        self.work.mkdir(parents=True)
        (self.root / "tmp").mkdir()
        for name, content in {**self.run.inputs, **self.old}.items():
            (self.work / name).parent.mkdir(exist_ok=True)
            (self.work / name).write_bytes(content)

    def files(self) -> dict[str, bytes]:
        return {
            str(path.relative_to(self.root)): path.read_bytes()
            for path in sorted(self.root.rglob("*"))
            if path.is_file()
        }

    def ended(self, arguments: tuple[str, ...], target: int = 0) -> int:
        """Exit code of the command; 0 for target: no call fails."""
        calls = self.calls
        calls.count, calls.full, calls.target = 0, 0, target
        sys.stdout.flush()
        child = os.fork()
        if not child:
            self.become(arguments)
        begin = time.monotonic()
        while not (found := os.waitpid(child, os.WNOHANG))[0]:
            time.sleep(0.005)
            if time.monotonic() - begin > GAVE_UP:
                os.killpg(child, signal.SIGKILL)
        calls.enabled = 0
        return os.waitstatus_to_exitcode(found[1])

    def warm(self) -> None:
        """Run the command once in this process, so that its children have imported and compiled everything."""
        self.fresh()
        sys.stdout.flush()
        kept = [os.dup(number) for number in (1, 2)]
        with suppress(SystemExit):
            self.go(self.run.arguments)
        sys.stdout.flush()
        for number, stream in enumerate(kept, start=1):
            os.dup2(stream, number)

    def become(self, arguments: tuple[str, ...]) -> None:
        """Run the command in this process, to its end."""
        os.setsid()
        subprocess._USE_VFORK = False  # type: ignore[attr-defined]
        self.go(arguments, 1)
        sys.exit(0)

    def go(self, arguments: tuple[str, ...], counted: int = 0) -> None:
        from crosscheck.commands import main as program

        os.chdir(self.work)
        for number, path in ((1, self.root / "stdout"), (2, self.errors)):
            os.dup2(os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC), number)
        sys.argv = ["graphdyn", *arguments]
        with self.run.workers():
            self.calls.enabled = counted
            program()

    def problems(self, code: int) -> list[str]:
        """What is not as it should be, in words."""
        found = self.files()
        if code == self.run.code:
            return [f"exit code {code}, and {name} is another" for name in self.whole if not self.same(name, found)]
        problems = [*self.of_the_end(code), *self.of_files(found)]
        return [*problems, *self.of_going_on()] if self.run.resumed else problems

    def of_the_end(self, code: int) -> Iterator[str]:
        said = self.errors.read_text()
        if code != BAD_INPUT:
            yield f"exit code {code}"
        if not re.search(r"^error: ", said, re.MULTILINE):
            yield "no error is told"
        if "Traceback" in said or "internal error" in said:
            yield f"told: {said.strip().splitlines()[-1][:150]}"

    def of_files(self, found: dict[str, bytes]) -> Iterator[str]:
        if "what was there is in" in self.errors.read_text():
            return  # nothing can be renamed any more, not even back
        known = {f"work/{name}": content for name, content in {**self.run.inputs, **self.old}.items()}
        for name, content in found.items():
            if name == "stdout" or STORE.search(name):
                continue
            if self.run.growing and name == f"work/{self.run.growing}":
                if content != known.get(name) and not isinstance(json.loads(content), dict):
                    yield f"{name} is not whole"
            elif name not in self.whole and name not in known:
                yield f"{name} is left"
            elif content != known.get(name) and not self.same(name, found):
                yield f"{name} is neither the old nor the new"
        yield from (f"{name} is lost" for name in known if name not in found)
        if len({content == self.old[name] for name, content in self.within(found) if name in self.old}) > 1:
            yield "the folder is half old"

    def of_going_on(self) -> Iterator[str]:
        code = self.ended((*self.run.arguments, *self.run.resumed))
        found = self.files()
        if code != self.run.code:
            yield f"going on: exit code {code}, {self.errors.read_text().strip()[-200:]}"
        for name in self.whole:
            if name != "stdout" and not STORE.search(name) and not self.went_on(name, found):
                yield f"going on: {name} is another"

    def went_on(self, name: str, found: dict[str, bytes]) -> bool:
        """Whether a file is as without a failure, but for the command and for what is told of parts taken over."""
        content = found.get(name, b"")
        if not self.run.growing or name in (f"work/{input}" for input in self.run.inputs):
            return self.same(name, found)
        if name != f"work/{self.run.growing}":
            return content.rstrip().endswith(b"</html>")
        now, whole = json.loads(content), json.loads(self.whole[name])
        return {**now, "command": None} == {**whole, "command": None}

    def within(self, found: dict[str, bytes]) -> list[tuple[str, bytes]]:
        """Files of a folder that is written as a whole, which are other ones in every run."""
        names = {name: name.removeprefix("work/") for name in found if name.count("/") == 2}
        return [(names[name], found[name]) for name in names if self.old.get(names[name]) != self.whole.get(name)]

    def same(self, name: str, found: dict[str, bytes]) -> bool:
        """Whether a file is as without a failure; of one that no two runs write alike, whether it is whole."""
        content = found.get(name)
        if content is None or content == self.whole.get(name) or STORE.search(name):
            return content is not None
        if name not in self.volatile:
            return False
        if name == "stdout":
            return True
        if name.endswith(".json"):
            return isinstance(json.loads(content), dict)
        if name.endswith(".html"):
            return content.rstrip().endswith(b"</html>")
        if name.endswith(".parquet"):
            import pyarrow.parquet as parquet

            return bool(parquet.read_table(self.root / name).num_rows)
        return len(content) == len(self.whole[name])
