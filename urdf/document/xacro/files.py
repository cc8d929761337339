"""Expand .xacro files, without ROS, in a separate process that can read only the folders that the user named.

xacro evaluates Python expressions; see process.py for what these may do.
"""

from __future__ import annotations

import importlib.util
import json
import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path

from graphdyn.errors import install_line
from urdf.errors import MAX_QUOTED_NAMES, InvalidXacro, XacroNotInstalled, shortened

MAX_CPU_SECONDS = 5
"""Processor time allowed for expanding [s]; the files of one arm take some 0.3 s, on a busy machine twice as much."""

MAX_MEGABYTES = 300
"""Memory allowed for expanding [MB]."""

MAX_WALL_SECONDS = 60
"""Elapsed time allowed for expanding [s]: on a busy machine, far more than the processor time."""

SCRIPT = Path(__file__).with_name("process.py")


@dataclass(frozen=True)
class Expansion:
    """The XML that a .xacro file expands to.

    text: in UTF-8; complaints: warnings of the expander
    places: per element, in the order of the text, the file and the line where it is written; None where unknown
    """

    text: bytes
    complaints: tuple[str, ...]
    places: tuple[tuple[Path, int] | None, ...]


def expand(
    path: Path, content: bytes, arguments: Mapping[str, object], packages: Mapping[str, str | PathLike[str]]
) -> Expansion:
    """The expansion of a .xacro file.

    path: of the file; what it includes must lie in its folder or below, or in a package
    arguments: values of <xacro:arg> by name; packages: folder by the name that $(find NAME) gives

    Raises XacroNotInstalled; InvalidXacro for faults, forbidden files and expansions that do not end.
    """
    _check_packages(path, packages)
    if importlib.util.find_spec("xacro") is None:
        problem = "a .xacro file needs the package xacro, which is not installed"
        remedy = f"run: {install_line('xacro')}, or expand the file yourself and give the URDF"
        raise XacroNotInstalled(problem, remedy, path=path)
    task = {
        "path": str(path.resolve()),
        "content": content.decode("latin-1"),  # bytes as text, one character each
        "arguments": {name: str(value) for name, value in arguments.items()},
        "packages": {name: str(Path(folder).resolve()) for name, folder in packages.items()},
        "cpu_seconds": MAX_CPU_SECONDS,
        "megabytes": MAX_MEGABYTES,
    }
    command = [sys.executable, "-I", "-X", "utf8", str(SCRIPT)]
    try:
        done = subprocess.run(
            command, input=json.dumps(task).encode(), capture_output=True, env={}, timeout=MAX_WALL_SECONDS
        )
    except subprocess.TimeoutExpired:
        raise _endless(path) from None
    if done.returncode < 0:
        raise _endless(path)
    try:
        answer = json.loads(done.stdout)
    except ValueError:
        said = done.stderr.decode(errors="replace").strip().splitlines() or ["nothing"]
        raise InvalidXacro(
            f"the expander failed: {shortened(said[-1])}", "report it, with the file", path=path
        ) from None
    if "problem" in answer:
        raise InvalidXacro(" ".join(answer["problem"].split()), answer["remedy"], path=path)
    files = [_as_given(Path(file), path) for file in answer["files"]]
    places = tuple(place and (files[place[0]], place[1]) for place in answer["places"])
    return Expansion(str(answer["text"]).encode(), tuple(_complaints(done.stderr)), places)


def _as_given(file: Path, path: Path) -> Path:
    """A file below the folder of the document, as the path of the document was given; others as they are."""
    whole = path.resolve()
    if file == whole:
        return path
    return path.parent / file.relative_to(whole.parent) if file.is_relative_to(whole.parent) else file


def _check_packages(path: Path, packages: Mapping[str, str | PathLike[str]]) -> None:
    for name, folder in packages.items():
        if not Path(folder).is_dir():
            raise InvalidXacro(f"package '{name}': '{folder}' is not a folder", "give the package's folder", path=path)


def _complaints(written: bytes) -> list[str]:
    """The lines that begin with "warning:"; the others give the place."""
    lines = (re.sub(r"\x1b\[[\d;]*m", "", line).strip() for line in written.decode(errors="replace").splitlines())
    return [shortened(line.removeprefix("warning: ")) for line in lines if line.startswith("warning: ")][
        :MAX_QUOTED_NAMES
    ]


def _endless(path: Path) -> InvalidXacro:
    problem = f"expanding takes more than {MAX_CPU_SECONDS} s of processor time"
    remedy = "expand the file yourself, if you trust it, and give the URDF"
    return InvalidXacro(problem, remedy, path=path)
