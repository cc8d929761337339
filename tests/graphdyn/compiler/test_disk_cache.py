"""Machine code of earlier processes: the same numbers; nothing is used but what this user wrote whole."""

import os
import stat
from functools import partial

import numpy as np
import pytest
from back_ends import no_programs
from random_trees import NAMED

import graphdyn
from graphdyn.compiler import CACHE_VARIABLE, MachineCode, clear_code_cache, code_cache, disk_cache, native
from graphdyn.compiler.disk_cache import cached_code

MODEL = NAMED["mixed_chain"]

POSIX = pytest.mark.skipif(os.name != "posix", reason="owners and modes of files are those of POSIX")


class Compiler:
    """Answers code for a key, and counts how often it is asked."""

    def __init__(self):
        self.calls = 0

    def __call__(self, key=b"key", code=b"code" * 100):
        def compiled():
            self.calls += 1
            return code

        assert cached_code(key, compiled) == code
        return self.calls


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path))
    return tmp_path / "machine_code"


@pytest.fixture
def path(folder):
    """The file of the one key."""
    Compiler()()
    (path,) = folder.iterdir()
    return path


class TestOnce:
    def test_per_key(self, folder):
        ask = Compiler()
        assert [ask(), ask(), ask(b"another"), ask(b"another"), ask()] == [1, 1, 2, 2, 2]
        assert code_cache() == (disk_cache.CodeCache(folder, True, 2, 2 * (32 + 400)))

    @POSIX
    def test_for_this_user_only(self, path):
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700

    def test_switched_off(self, tmp_path, monkeypatch):
        monkeypatch.setenv(CACHE_VARIABLE, "off")
        monkeypatch.chdir(tmp_path)
        ask = Compiler()
        assert [ask(), ask()] == [1, 2]
        assert code_cache() == clear_code_cache() == disk_cache.CodeCache(None, False, 0, 0)
        assert not list(tmp_path.iterdir())

    def test_without_a_home(self, tmp_path, monkeypatch):
        """Where no home is known, platformdirs answers a path below ~, literally."""
        monkeypatch.delenv(CACHE_VARIABLE)
        monkeypatch.setattr("platformdirs.user_cache_path", lambda *_, **__: disk_cache.Path("~/.cache/graphdyn"))
        monkeypatch.chdir(tmp_path)
        ask = Compiler()
        assert [ask(), ask()] == [1, 2]
        assert not list(tmp_path.iterdir())

    def test_in_the_home(self, monkeypatch):
        import platformdirs

        monkeypatch.delenv(CACHE_VARIABLE)
        assert disk_cache.cache_folder() == disk_cache.Path(platformdirs.user_cache_dir("graphdyn"), "machine_code")


def flipped(path, place):
    content = bytearray(path.read_bytes())
    content[place] ^= 1
    path.write_bytes(content)


def replaced(path, make):
    path.unlink()
    make(path)


class TestNotUsed:
    """Compiled again, and where a file can be put there, it is whole afterwards."""

    @pytest.mark.parametrize(
        "harm",
        [
            *(partial(flipped, place=place) for place in (0, 31, 32, -1)),
            lambda path: path.write_bytes(b""),
            lambda path: path.write_bytes(path.read_bytes()[:-1]),
            lambda path: path.write_bytes(path.read_bytes() + b"0"),
            pytest.param(lambda path: path.chmod(0o622), marks=POSIX),
            pytest.param(lambda path: replaced(path, lambda p: p.symlink_to(os.devnull)), marks=POSIX),
            pytest.param(lambda path: replaced(path, os.mkfifo), marks=POSIX),
        ],
        ids=["digest", "end of digest", "code", "end", "empty", "cut", "longer", "mode", "link", "pipe"],
    )
    def test_harmed(self, path, harm):
        harm(path)
        ask = Compiler()
        assert [ask(), ask()] == [1, 1]

    def test_the_file_of_another_key(self, path, folder):
        Compiler()(b"another", b"other code")
        (other,) = set(folder.iterdir()) - {path}
        path.write_bytes(other.read_bytes())
        ask = Compiler()
        assert [ask(), ask()] == [1, 1]

    @POSIX
    def test_a_link_to_a_sound_file(self, path):
        """A name may lead out of the folder, to what somebody else can replace."""
        moved = path.with_name("moved")
        path.rename(moved)
        path.symlink_to(moved)
        assert Compiler()() == 1

    @POSIX
    def test_the_file_of_another_user(self, path, monkeypatch):
        user = os.geteuid()
        monkeypatch.setattr(os, "geteuid", lambda: user + 1)
        assert Compiler()() == 1

    def test_a_folder_in_its_place(self, path):
        replaced(path, os.mkdir)
        ask = Compiler()
        assert [ask(), ask()] == [1, 2]
        assert list(path.parent.iterdir()) == [path]  # nothing unfinished is left

    def test_a_file_in_place_of_the_folder(self, folder):
        folder.write_bytes(b"")
        ask = Compiler()
        assert [ask(), ask()] == [1, 2]

    @pytest.mark.skipif(os.name != "posix" or os.geteuid() == 0, reason="the superuser may write everywhere")
    def test_a_folder_that_is_read_only(self, path):
        path.parent.chmod(0o500)
        ask = Compiler()
        assert [ask(), ask(b"another"), ask(b"another")] == [0, 1, 2]
        assert not code_cache().is_writable

    def test_a_full_disk(self, folder, monkeypatch):
        def full(*_):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(os, "replace", full)
        ask = Compiler()
        assert [ask(), ask()] == [1, 2]
        assert not list(folder.iterdir())


@POSIX
def test_many_processes_at_once(folder):
    """Each asks for the same keys, while another removes everything again and again."""

    def work(k):
        for _ in range(30):
            if k == 0:
                clear_code_cache()
            for key in (b"1", b"2", b"3"):
                Compiler()(key, key * 100_000)

    children = []
    for k in range(8):
        if not (child := os.fork()):
            try:
                work(k)
                os._exit(0)
            except BaseException:
                os._exit(1)
        children.append(child)
    assert [os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children] == [0] * 8
    assert {path.suffix for path in folder.iterdir()} <= {disk_cache.SUFFIX}


class TestSize:
    def test_what_was_not_used_for_longest_is_removed(self, folder, monkeypatch):
        monkeypatch.setattr(disk_cache, "MAX_BYTES", 3 * 432)
        monkeypatch.setattr(disk_cache, "WRITES_BETWEEN_SWEEPS", 1)
        names = [bytes([65 + k]) for k in range(5)]
        for age, name in enumerate(names[:4]):
            before = set(folder.glob("*"))
            Compiler()(name)
            (new,) = set(folder.iterdir()) - before
            os.utime(new, (1000 + age, 1000 + age))
        assert Compiler()(names[0]) == 0  # used again, so that the second is the oldest
        Compiler()(names[4])
        assert [Compiler()(name) for name in (names[0], names[2], names[3], names[4], names[1])] == [0, 0, 0, 0, 1]

    def test_what_processes_left_that_were_killed(self, folder, monkeypatch):
        folder.mkdir()
        (folder / f"tmp{disk_cache.UNFINISHED}").write_bytes(b"0" * 500)
        assert code_cache().bytes == 500
        monkeypatch.setattr(disk_cache, "MAX_BYTES", 499)
        monkeypatch.setattr(disk_cache, "WRITES_BETWEEN_SWEEPS", 1)
        Compiler()()
        assert code_cache().files == 1
        assert code_cache().bytes == 432

    def test_clear_removes_nothing_else(self, path):
        other = path.with_name("notes.txt")
        other.write_text("mine")
        assert clear_code_cache().files == 1
        assert list(path.parent.iterdir()) == [other]


def test_the_next_process_gets_the_same_numbers(folder, monkeypatch):
    """A robot that is the same in content: its programs are those of the first, to the last bit."""
    q, v, a = np.random.default_rng(0).uniform(-3, 3, (3, 2000, MODEL.nv))

    def torques():
        with no_programs():
            return graphdyn.joint_torques(MODEL, q, v, a, method="recursive")

    first = torques()
    assert code_cache().files > 0
    monkeypatch.setattr(native, "_compiled", lambda *_: pytest.fail("compiled again"))
    assert (torques() == first).all()
    monkeypatch.undo()
    assert graphdyn.joint_torques(MODEL, q, v, a, method="projected") == pytest.approx(first, rel=1e-9, abs=1e-9)


def test_a_key_holds_what_the_code_depends_on(monkeypatch):
    """Another compiler or processor makes other code, of which this one may not know all instructions."""
    import llvmlite.binding as llvm

    keys = []
    monkeypatch.setattr(native, "cached_code", lambda key, compiled: keys.append(key) or compiled())
    text = "define void @nothing(ptr %unused) { ret void }"

    def key():
        MachineCode(text)
        return keys[-1]

    sound = key()
    assert sound == key()
    assert sound.endswith(text.encode())
    for name, other in (("get_host_cpu_name", "x86-64"), ("llvm_version_info", (1, 2, 3))):
        with monkeypatch.context() as changed:
            changed.setattr(llvm, name, (lambda o=other: o) if callable(getattr(llvm, name)) else other)
            assert key() != sound
    features = llvm.get_host_cpu_features()
    features["avx512f"] = not features.get("avx512f")
    monkeypatch.setattr(llvm, "get_host_cpu_features", lambda: features)
    assert key() != sound
