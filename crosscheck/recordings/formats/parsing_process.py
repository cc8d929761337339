"""The process that parses files whose libraries can die of damage: it forks for each file, with the libraries loaded.

It runs by its path and needs NumPy and SciPy alone, and h5py for HDF5. Its standard input is a socket. A request is a
line of JSON with the limits, and two open files: the one to read, and the one for its arrays. The answer is the exit
code of the fork, minus the number of a signal.

The arrays stand one after the other as bytes; behind them their description in JSON, whose length is in the last bytes.
"""

from __future__ import annotations

import io
import json
import os
import select
import signal
import socket
import struct
import zlib
from collections.abc import Iterator, Mapping
from contextlib import suppress
from typing import Any, BinaryIO

import numpy as np

REQUEST_BYTES = 4096
"""Largest length of a request."""

LENGTH = struct.Struct("<Q")
"""Form of the length of the description."""

EXIT_CODE = struct.Struct("<i")
"""Form of the exit code."""

NO_FORK = 1000
"""An exit code from here on says that there was no fork; what is above is the number of the error of the system."""

ARRAY_ALIGNMENT = 64
"""Multiple at which an array begins [bytes]."""

HEADER_BYTES, COMPRESSED_TYPE = 128, 15
"""Layout of version 5 files: bytes before the first element; type of an element that is compressed with zlib."""


class ExpandsTooFar(Exception):
    """The content is larger than allowed once expanded. args: its size so far [bytes]"""


def main() -> None:
    """Parse files until the other end of the socket is closed."""
    import scipy.io  # noqa: F401, once for all forks

    with socket.socket(fileno=0) as asker:
        while True:
            request, files, _, _ = socket.recv_fds(asker, REQUEST_BYTES, 2)
            if not request:
                return
            asker.sendall(EXIT_CODE.pack(_forked(asker, json.loads(request), *files)))


def _forked(asker: socket.socket, limits: Mapping[str, int], source: int, sink: int) -> int:
    """The exit code of the fork, which is killed where the asker has gone."""
    end, held = os.pipe()  # it is at its end when the fork is
    try:
        process = os.fork()
    except OSError as error:
        for file in (end, held, source, sink):
            os.close(file)
        return NO_FORK + (error.errno or 0)
    if process == 0:
        try:
            _parse(limits, source, sink)
            os._exit(0)
        finally:
            os._exit(1)
    for file in (held, source, sink):
        os.close(file)
    if asker.fileno() in select.select([asker.fileno(), end], [], [])[0]:
        os.kill(process, signal.SIGKILL)
    os.close(end)
    return os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])


def _parse(limits: Mapping[str, int], source: int, sink: int) -> None:
    """Write the arrays of a file. limits: seconds of the processor; bytes of memory, and of the content expanded"""
    import resource

    signal.setitimer(signal.ITIMER_PROF, limits["seconds"])
    with suppress(ValueError, OSError):  # not every system limits it
        resource.setrlimit(resource.RLIMIT_AS, (limits["memory"], limits["memory"]))
    with open(source, "rb") as file, open(sink, "wb") as out:
        description: dict[str, Any]
        try:
            description = {"arrays": [*_written(_variables(file, limits["expanded"]), out)]}
        except ExpandsTooFar as error:
            description = {"expanded": error.args[0]}
        except ImportError as error:
            description = {"missing": error.name}
        except MemoryError:
            description = {"error": f"it needs more than {limits['memory']} bytes of memory"}
        except Exception as error:
            description = {"error": str(error)[:10_000]}
        text = json.dumps(description).encode()
        out.write(text + LENGTH.pack(len(text)))


def _written(variables: Mapping[str, Any], out: BinaryIO) -> Iterator[dict[str, Any]]:
    """Write the arrays, and describe each; of one that has no numbers the shape alone."""
    for name, value in _flat(variables):
        try:
            array = np.asarray(value)
        except ValueError:  # lists of different lengths
            array = np.empty(len(value), dtype=object)
        if array.dtype.kind not in "biufc":
            yield {"name": name, "shape": array.shape}
            continue
        out.write(bytes(-out.tell() % ARRAY_ALIGNMENT))
        yield {"name": name, "shape": array.shape, "type": array.dtype.str, "place": out.tell()}
        out.write(np.ascontiguousarray(array).reshape(-1).view(np.uint8).data)


def _flat(variables: Mapping[str, Any], prefix: str = "") -> Iterator[tuple[str, Any]]:
    """The variables by name, the fields of structures as 'structure.field'."""
    for name, value in variables.items():
        if isinstance(value, Mapping):
            yield from _flat(value, f"{prefix}{name}.")
        else:
            yield f"{prefix}{name}", value


def _variables(file: BinaryIO, limit: int) -> dict[str, Any]:
    """The variables of a MATLAB file, structures as dictionaries. limit: of its size once expanded [bytes]"""
    from scipy.io import loadmat

    content = file.read()
    if (size := _expanded_size(content, limit)) > limit:
        raise ExpandsTooFar(size)
    try:
        variables = loadmat(io.BytesIO(content), simplify_cells=True)
    except NotImplementedError:
        variables = _of_hdf5(content, limit)
    return {name: value for name, value in variables.items() if not name.startswith("__")}


def _expanded_size(content: bytes, limit: int) -> int:
    """Size of the elements of a file of version 5 after expansion [bytes]; the count stops at the limit."""
    order = {b"IM": "<", b"MI": ">"}.get(content[HEADER_BYTES - 2 : HEADER_BYTES])
    if order is None:  # version 4, which is not compressed
        return len(content)
    size, place = 0, HEADER_BYTES
    while place + 8 <= len(content) and size <= limit:
        kind, length = struct.unpack_from(f"{order}II", content, place)
        place += 8
        if kind == COMPRESSED_TYPE:
            expander, rest = zlib.decompressobj(), content[place : place + length]
            while rest and size <= limit:
                size += len(expander.decompress(rest, 1 << 24))
                rest = expander.unconsumed_tail
        else:
            size += length
        place += length
    return size


def _of_hdf5(content: bytes, limit: int) -> dict[str, Any]:
    """The variables of a version 7.3 file, which stores arrays with their axes reversed."""
    import h5py

    sizes: list[int] = []

    def read(node: Any) -> Any:
        if isinstance(node, h5py.Group):
            return {name: read(child) for name, child in node.items() if not name.startswith("#")}
        if node.dtype.kind not in "fiub":
            return "no numbers"
        sizes.append(node.size * node.dtype.itemsize)
        if sum(sizes) > limit:
            raise ExpandsTooFar(sum(sizes))
        return np.transpose(node[()])

    with h5py.File(io.BytesIO(content)) as opened:
        return dict(read(opened))


if __name__ == "__main__":
    main()
