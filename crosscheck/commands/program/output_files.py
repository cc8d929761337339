"""The files that a command writes, and which of them are refused before the work begins.

A folder that a command writes as a whole, and only where nothing else is lost.
"""

from __future__ import annotations

import json
import os
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from importlib.machinery import SOURCE_SUFFIXES
from pathlib import Path

import typer

from crosscheck.commands.program import console
from urdf.document import write_whole

STANDARD_OUTPUT = ("-", "/dev/stdout", "/dev/fd/1", "/proc/self/fd/1")

ROBOT_SUFFIXES = (".urdf", ".xacro", ".xml", ".sdf")
MESH_SUFFIXES = (".stl", ".dae", ".obj", ".mtl", ".ply", ".glb")
OTHER_SUFFIXES = (".yaml", ".yml", ".toml", ".py", ".pyi", ".so", ".pyd")
OUTPUT_SUFFIXES = (".json", ".html", ".txt", ".dat", ".log")
"""Endings of reports, and those of recordings that any other text may have too."""


def is_of_source(suffix: str) -> bool:
    """Whether commands read files with this ending, some without being told: meshes, included files, modules, bags."""
    if suffix in OUTPUT_SUFFIXES:
        return False
    if suffix in (*ROBOT_SUFFIXES, *MESH_SUFFIXES, *OTHER_SUFFIXES, ".npy"):
        return True
    from crosscheck.recordings.formats.format import formats  # half a second, which reports need not wait for

    return suffix in {"." + known.rpartition(".")[2] for known in formats()}


@dataclass(frozen=True)
class OutputFile:
    """A file to be written, as named on the command line. own: endings of sources that it may have."""

    name: str
    own: tuple[str, ...] = ()

    @classmethod
    def robot(cls, name: str) -> OutputFile:
        return cls(name, (".urdf", ".xml"))

    @classmethod
    def mapping(cls, name: str) -> OutputFile:
        return cls(name, (".toml",))

    @classmethod
    def tests(cls, name: str) -> OutputFile:
        return cls(name, (".xml",))

    @property
    def path(self) -> Path:
        return Path(self.name)

    @property
    def is_standard_output(self) -> bool:
        return self.name in STANDARD_OUTPUT

    @property
    def is_regular(self) -> bool:
        """Whether it is replaced as a whole by each writing; a pipe or a device gets all that is written."""
        return not self.is_standard_output and (self.path.is_file() or not self.path.exists())

    def write(self, content: bytes) -> None:
        """Write it as a whole or not at all. Raises OSError."""
        if not self.is_standard_output:
            write_whole(self.path, content)
            return
        console.out.file.flush()
        console.out.file.buffer.write(content)  # type: ignore[attr-defined]
        console.out.file.flush()


def refuse_harm(context: typer.Context) -> None:
    """Refuse outputs that cannot be written, and those that would destroy what is read or written besides.

    Of every parameter of the command that is no OutputFile, all files are regarded that its text may name.

    Raises typer.BadParameter.
    """
    options = {parameter.name: parameter.opts[0] for parameter in context.command.params}
    outputs = {options[name]: file for name, file in context.params.items() if isinstance(file, OutputFile)}
    inputs = {options[name]: value for name, value in context.params.items() if not isinstance(value, OutputFile)}
    named: dict[str, OutputFile] = {}
    for option, file in outputs.items():
        if not file.is_standard_output:
            _refuse_unwritable(option, file.path)
            _refuse_sources(option, file, inputs)
        for other, earlier in named.items():
            if _are_one(file, earlier):
                raise typer.BadParameter(f"{other} and {option} name the same file, {file.name}; name two")
        named[option] = file


def _refuse_unwritable(option: str, path: Path) -> None:
    if path.is_dir():
        raise typer.BadParameter(f"{option} {path}: is a folder")
    if not path.resolve().parent.is_dir():
        raise typer.BadParameter(f"{option} {path}: folder {path.resolve().parent} does not exist")
    if not os.access(path if path.exists() else path.resolve().parent, os.W_OK):
        raise typer.BadParameter(f"{option} {path}: no permission to write there")


def _refuse_sources(option: str, file: OutputFile, inputs: Mapping[str, object]) -> None:
    """Refuse an existing file that is read, that may be read, or that the program's own output goes to."""
    path = file.path
    if not path.is_file():
        return
    for source, value in inputs.items():
        if any(_same(path, Path(candidate)) for text in _texts(value) for candidate in _candidates(text)):
            read = f"{source} reads" if source.startswith("-") else "the command reads"
            raise typer.BadParameter(f"{option} {path}: {read} this file; name another")
    if path.suffix.lower() not in file.own and is_of_source(path.suffix.lower()):
        raise typer.BadParameter(
            f"{option} {path}: there is a {path.suffix} file of this name, which would be lost; name another"
        )
    for number, stream in ((1, "standard output"), (2, "standard error")):
        if _is_stream(path, number):
            raise typer.BadParameter(f"{option} {path}: {stream} goes to this file; name another, or - alone")


def _are_one(file: OutputFile, other: OutputFile) -> bool:
    if file.is_standard_output or other.is_standard_output:
        return file.is_standard_output and other.is_standard_output
    if not file.is_regular or not other.is_regular:
        return False  # /dev/null takes both
    return file.path.resolve() == other.path.resolve() or _same(file.path, other.path)


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, str | Path):
        yield str(value)
    elif isinstance(value, list | tuple):
        for item in value:
            yield from _texts(item)


def _candidates(text: str) -> Iterator[str]:
    """The files that a parameter may mean.

    A path, a robot's name, FILE.py:NAME, MODULE:NAME, several with commas, NAME=PROGRAM ARGUMENT ….
    """
    from urdf import robots

    yield text
    yield from (str(entry.path) for entry in robots() if entry.name == text)
    yield from (word.rpartition(":")[0] or word for word in text.partition("=")[2].split())
    for part in text.split(","):
        yield part.strip()
        head = part.strip().rpartition(":")[0]
        if head:
            module = head.replace(".", os.sep)
            yield head
            yield from (f"{module}{place}{suffix}" for place in ("", f"{os.sep}__init__") for suffix in SOURCE_SUFFIXES)


def _same(path: Path, other: Path) -> bool:
    try:
        return path.samefile(other)
    except (OSError, ValueError):  # there is no such file, or no file can have this name
        return False


def _is_stream(path: Path, number: int) -> bool:
    try:
        return os.path.samestat(path.stat(), os.fstat(number))
    except OSError:
        return False


def refuse_folder(option: str, folder: Path, table: str) -> None:
    """Refuse a folder that holds anything but what the command has written there before.

    table: the file in it that lists what was written, under "files"

    Raises typer.BadParameter.
    """
    if not folder.resolve().parent.is_dir():
        raise typer.BadParameter(f"{option} {folder}: folder {folder.resolve().parent} does not exist")
    if not folder.exists():
        return
    if not folder.is_dir():
        raise typer.BadParameter(f"{option} {folder}: is no folder")
    others = {path.name for path in folder.iterdir()} - _written_before(folder / table)
    if others:
        raise typer.BadParameter(
            f"{option} {folder}: holds other files, such as {min(others)}, which would be lost; name another folder"
        )


def _written_before(table: Path) -> set[str]:
    try:
        return {table.name, *json.loads(table.read_bytes())["files"]}
    except (OSError, ValueError, LookupError, TypeError, RecursionError):
        return set()


def write_folder(folder: Path, files: Mapping[str, bytes]) -> None:
    """Write all files or none: into a new folder beside, which then takes the place of the old one. Raises OSError."""
    target = folder.resolve()
    try:
        new = Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=target.parent))
        try:
            new.chmod(0o777 & ~_umask())
            for name, content in files.items():
                write_whole(new / name, content)
            _take_place(new, target)
        finally:
            shutil.rmtree(new, ignore_errors=True)
    except OSError as error:
        raise OSError(error.errno, error.strerror or "cannot be written", str(folder)) from error


def _take_place(new: Path, target: Path) -> None:
    """A folder that holds files cannot be renamed over: it is put aside, and comes back where the new one fails."""
    if not target.exists():
        os.replace(new, target)
        return
    old = Path(tempfile.mkdtemp(prefix=f".{target.name}.", dir=target.parent))
    try:
        os.replace(target, old)
    except OSError:
        old.rmdir()
        raise
    try:
        os.replace(new, target)
    except OSError as error:
        try:
            os.replace(old, target)
        except OSError:
            raise OSError(error.errno, f"{error.strerror}; what was there is in {old}") from error
        raise
    shutil.rmtree(old)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
