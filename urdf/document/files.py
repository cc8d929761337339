"""Files appear complete or not at all."""

import os
import shutil
import uuid
from pathlib import Path


def write_whole(path: Path, content: bytes) -> None:
    """Write next to the target, then rename: no reader ever sees half a file.

    A link is followed, an existing file keeps its permissions, and a target that is not a regular file (a pipe,
    /dev/stdout) is written to directly. Raises OSError with the path that was given.
    """
    target = path.resolve()
    part = target.with_name(f".{target.name}.{uuid.uuid4().hex}")
    try:
        if path.exists() and not path.is_file():  # asked of the path: /dev/stdout may lead to a pipe without a name
            path.write_bytes(content)
            return
        try:
            part.write_bytes(content)
            _to_disk(part)
            if target.exists():
                shutil.copymode(target, part)
            os.replace(part, target)
        finally:
            part.unlink(missing_ok=True)
    except OSError as error:
        raise OSError(error.errno, error.strerror or "cannot be written", str(path)) from error


def _to_disk(path: Path) -> None:
    """After a power cut, a name that was given to the file must not lead to one without content."""
    with path.open("r+b") as file:
        os.fsync(file.fileno())
