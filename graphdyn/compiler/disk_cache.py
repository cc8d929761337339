"""A folder of machine code, so that what one process has compiled the next one need not compile again.

One file for each key: the digest of key and code, and the code. A file is used only if it is a plain file of this user
that nobody else may write, and if its digest is right: whatever is damaged, cut off, renamed or not its own is
compiled again, and replaced. Where the folder cannot be read or written, everything is compiled, as without it.
"""

from __future__ import annotations

import hashlib
import os
import stat
import tempfile
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from itertools import count
from pathlib import Path

CACHE_VARIABLE = "GRAPHDYN_CACHE"
"""Environment variable that names the folder in which that of the machine code is, or is "off"."""

MAX_BYTES = 256 << 20
"""Size of the folder beyond which the files that were not used for longest are removed. A verb takes 10 to 500 kB."""

WRITES_BETWEEN_SWEEPS = 50
"""The size of the folder is looked at when a process first writes to it, and after so many more files."""

SUFFIX, UNFINISHED = ".code", ".unfinished"

_writes = count()


@dataclass(frozen=True)
class CodeCache:
    """The folder and what is in it.

    folder: None where it is switched off, and where there is no home to put it
    is_writable: whether this user may write to it
    files: number of compiled programs
    bytes: their size together
    """

    folder: Path | None
    is_writable: bool
    files: int
    bytes: int


def cached_code(key: bytes, compiled: Callable[[], bytes]) -> bytes:
    """The code of a key: from the folder, or else compiled and put there."""
    folder = cache_folder()
    if folder is None:
        return compiled()
    path = folder / (hashlib.sha256(key).hexdigest() + SUFFIX)
    with suppress(OSError):
        content = _own_content(path)
        code = content[hashlib.sha256().digest_size :]
        if content == _signed(key, code):
            return code
    code = compiled()
    with suppress(OSError):
        _write(path, _signed(key, code))
    return code


def code_cache() -> CodeCache:
    """What there is at the moment."""
    folder = cache_folder()
    if folder is None:
        return CodeCache(None, False, 0, 0)
    existing = next(path for path in (folder, *folder.parents) if path.exists())
    sizes = [status.st_size for _, status in _files(folder)]
    return CodeCache(folder, os.access(existing, os.W_OK | os.X_OK), len(sizes), sum(sizes))


def clear_code_cache() -> CodeCache:
    """Remove all compiled programs; answers what there was. Raises OSError where they cannot be removed."""
    found = code_cache()
    if found.folder is not None:
        for path, _ in _files(found.folder):
            path.unlink(missing_ok=True)
    return found


def cache_folder() -> Path | None:
    """The folder, which need not exist; None where it is switched off, and where there is no home to put it."""
    chosen = os.environ.get(CACHE_VARIABLE)
    if chosen == "off":
        return None
    from platformdirs import user_cache_path

    root = Path(chosen).absolute() if chosen else user_cache_path("graphdyn", appauthor=False)
    return root / "machine_code" if root.is_absolute() else None


def _signed(key: bytes, code: bytes) -> bytes:
    return hashlib.sha256(hashlib.sha256(key).digest() + code).digest() + code


def _own_content(path: Path) -> bytes:
    """The content of a plain file of this user that nobody else may write. Raises OSError for any other."""
    flags = os.O_RDONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
    with open(os.open(path, flags), "rb") as file:
        status = os.fstat(file.fileno())
        of_others = hasattr(os, "geteuid") and (status.st_uid != os.geteuid() or status.st_mode & 0o022)
        if of_others or not stat.S_ISREG(status.st_mode) or status.st_size > MAX_BYTES:
            raise PermissionError(f"{path} is not a file that only this user writes")
        content = file.read()
    with suppress(OSError):
        os.utime(path)  # used now
    return content


def _write(path: Path, content: bytes) -> None:
    """Whole or not at all, for this user only."""
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    if next(_writes) % WRITES_BETWEEN_SWEEPS == 0:
        _sweep(path.parent)
    descriptor, unfinished = tempfile.mkstemp(suffix=UNFINISHED, dir=path.parent)
    try:
        with open(descriptor, "wb") as file:
            file.write(content)
        os.replace(unfinished, path)
    except BaseException:
        os.unlink(unfinished)
        raise


def _sweep(folder: Path) -> None:
    files = sorted(_files(folder), key=lambda file: file[1].st_mtime)
    surplus = sum(status.st_size for _, status in files) - MAX_BYTES
    for path, status in files:
        if surplus <= 0:
            break
        path.unlink(missing_ok=True)
        surplus -= status.st_size


def _files(folder: Path) -> list[tuple[Path, os.stat_result]]:
    """The files that this module writes, and nothing else that may lie there."""
    found = []
    with suppress(FileNotFoundError):
        for path in folder.iterdir():
            if path.suffix in (SUFFIX, UNFINISHED):
                with suppress(FileNotFoundError):
                    found.append((path, path.lstat()))
    return found
