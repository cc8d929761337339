"""Files that end or hold up the process that parses them: an error that names the file, and the next one is read."""

import errno
import os
import socket
import struct
import subprocess

import numpy as np
import pytest
from scipy.io import savemat

from crosscheck.recordings import BadRecordingFile, load_recording
from crosscheck.recordings.formats import parsed_apart, parsing_process

T = np.arange(20) / 10
NUMBERS, NO_TYPE = struct.pack("<II", 9, T.nbytes), struct.pack("<II", 0, T.nbytes)
"""Head of an element of doubles, and of one of no type, which ends SciPy."""


def test_damage_that_ends_scipy(tmp_path):
    path = tmp_path / "r.mat"
    savemat(path, {"t": T, "q_1": T})
    whole = path.read_bytes()
    path.write_bytes(whole.replace(NUMBERS, NO_TYPE, 1))
    with pytest.raises(BadRecordingFile, match=r"r.mat: not a readable .mat file \(.+\); save it with save\('-v7'\)"):
        load_recording(path)
    path.write_bytes(whole)
    assert np.array_equal(load_recording(path).q[:, 0], T)


class TestNoFurtherProcess:
    """Where none can be started, the file is not to blame."""

    def test_the_parser(self, monkeypatch, tmp_path):
        def refused(*_command, **_options):
            raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))

        savemat(tmp_path / "r.mat", {"t": T, "q_1": T})
        monkeypatch.setattr(parsed_apart, "PARSERS", {})
        monkeypatch.setattr(subprocess, "Popen", refused)
        with pytest.raises(BlockingIOError):
            load_recording(tmp_path / "r.mat")

    def test_its_fork(self, monkeypatch):
        def refused():
            raise BlockingIOError(errno.EAGAIN, os.strerror(errno.EAGAIN))

        monkeypatch.setattr(os, "fork", refused)
        ours, theirs = socket.socketpair()
        files = [os.open(os.devnull, os.O_RDONLY) for _ in range(2)]
        with ours, theirs:
            code = parsing_process._forked(theirs, {}, *files)
            for file in files:
                with pytest.raises(OSError, match="Bad file"):
                    os.fstat(file)
            theirs.sendall(parsing_process.EXIT_CODE.pack(code))
            parser = parsed_apart.FileParser()
            parser._socket = ours
            with pytest.raises(BlockingIOError):
                parser.exit_code({}, [0, 0])


def test_arrays_of_every_kind_arrive_as_they_are(tmp_path):
    kinds = {
        "a": np.int8([[1, -2]]),
        "b": np.uint64([[1, 2**64 - 1]]),
        "c": np.float32([[0.1, 2]]),
        "d": np.array([[1j, 2]]),
    }
    savemat(tmp_path / "r.mat", {**kinds, "e": np.zeros((0, 3)), "s": "text", "f": {"g": [[1.5]]}, "h": [T, "x"]})
    found, size = parsed_apart.arrays_apart(tmp_path / "r.mat", 10**6)
    assert size == 0
    for name, array in kinds.items():
        assert found[name].dtype == array.dtype
        assert np.array_equal(found[name].ravel(), array.ravel())
    assert found["e"].size == 0
    assert found["f.g"].tolist() == 1.5
    assert (found["s"].dtype, found["h"].dtype) == (object, object)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """The file of a library that stands in place of h5py, in a process of its own that finds it first."""
    folder = tmp_path_factory.mktemp("libraries")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", f"{folder}{os.pathsep}{os.environ.get('PYTHONPATH', '')}")
        patch.setenv("PYTHONDONTWRITEBYTECODE", "1")
        parser = parsed_apart.FileParser()
        patch.setitem(parsed_apart.PARSERS, os.getpid(), parser)
        yield folder / "h5py.py"
        parser.close()


@pytest.mark.parametrize(
    ("does", "message"),
    [
        (
            "raise ModuleNotFoundError(name='h5py')",
            r"r.mat: of MATLAB version 7.3; save it .*, or run: .*\[mat73\]'",
        ),
        ("import os; os.abort()", r"r.mat: .* \(it ended the process that parses it, signal 6, Aborted\); save it"),
        ("import os; os._exit(3)", r"r.mat: .* \(it ended the process that parses it, exit code 3\); save it"),
        ("while True: pass", r"r.mat: .* \(parsing it takes more than 0.05 s of the processor\); save it"),
        ("bytearray(1 << 40)", r"r.mat: .* \(it needs more than 6442450944 bytes of memory\); save it"),
        ("raise ValueError('a\\nb\\x1b[31m' + 999 * 'c')", r"r.mat: .* \(a b\\x1b\[31mc+ … c{100}\); save it"),
        ("import os; os.kill(os.getppid(), 9)", r"r.mat: .* \(the process that parses it has ended\); save it"),
    ],
)
def test_a_library_that_does_not_come_back(tmp_path, monkeypatch, library, does, message):
    monkeypatch.setattr(parsed_apart, "MAX_CPU_SECONDS", 0.05)
    library.write_text(does)
    path = tmp_path / "r.mat"
    path.write_bytes(b"MATLAB 7.3 MAT-file".ljust(116) + bytes(8) + b"\x00\x02IM" + bytes(384))
    with pytest.raises(BadRecordingFile, match=message) as caught:
        load_recording(path)
    assert str(caught.value).isprintable()
    savemat(path, {"t": T, "q_1": T})
    if "getppid" not in does:
        assert np.array_equal(load_recording(path).q[:, 0], T)
