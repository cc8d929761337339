"""Pinocchio in C++ as a contender: its numbers, what is refused, and, in the long check, its code."""

import ctypes
import os
import shutil
import sys
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
from long_check import LONG
from typer.testing import CliRunner

import urdf
from crosscheck.bench import benchmark
from crosscheck.bench.forms import native_pinocchio
from crosscheck.bench.forms.native_pinocchio import (
    NATIVE_NAME,
    NEEDED_HEADERS,
    NativePinocchio,
    NativeRefuses,
    header_folders,
)
from crosscheck.bench.forms.peers import Peers
from crosscheck.bench.states import random_states
from crosscheck.commands import app
from graphdyn import Placement, kr500

KINDS = (pin.JointModelRX, pin.JointModelRY, pin.JointModelRZ, pin.JointModelRevoluteUnaligned)
KINDS += (pin.JointModelPX, pin.JointModelPY, pin.JointModelPZ, pin.JointModelPrismaticUnaligned)


def doubles(address, *shape):
    return np.ctypeslib.as_array(ctypes.cast(address, ctypes.POINTER(ctypes.c_double)), shape)


class Twin:
    """What native_pinocchio.cpp does, by Pinocchio's bindings."""

    def __init__(self, scale=1.0):
        self.native, self.scale = pin.Model(), scale

        def libraries():
            return b"headers of Pinocchio"

        def make_robot(bodies, rows, gravity):
            self.native.gravity.linear = doubles(gravity, 3).copy()
            for k, row in enumerate(doubles(rows, bodies, 30), 1):
                parent, kind, axis, turn, place, mass, center, tensor = np.split(row, [1, 2, 5, 14, 17, 18, 21])
                kind, along = int(kind[0]), (axis,) if kind[0] % 4 == 3 else ()
                placement = pin.SE3(turn.reshape(3, 3), place)
                self.native.addJoint(int(parent[0]), KINDS[kind](*along), placement, f"joint{k}")
                inertia = pin.Inertia(mass[0], center, tensor.reshape(3, 3))
                self.native.appendBodyToJoint(k, inertia, pin.SE3.Identity())

        def loop(function):
            def run(_, count, *addresses):
                q, v, x, out = (doubles(address, count, self.native.nv) for address in addresses)
                data = self.native.createData()
                for k in range(count):
                    out[k] = self.scale * function(self.native, data, q[k], v[k], x[k])

            return run

        self.libraries, self.make_robot = libraries, make_robot
        self.rnea_loop, self.aba_loop = loop(pin.rnea), loop(pin.aba)


@pytest.fixture
def compiled(monkeypatch, tmp_path):
    """NativePinocchio of a robot on a twin of its library."""

    def of(model, twin):
        monkeypatch.setenv("CXX", sys.executable)
        monkeypatch.setattr(native_pinocchio, "header_folders", lambda searched: [])
        monkeypatch.setattr(native_pinocchio, "_library", lambda compiler, folders, path: twin)
        return Peers(random_states(model, 5, 1), tmp_path, native=True)

    return of


def slides_along(axis):
    """The sixth joint of a robot that slides, with a base that leans."""
    model = kr500()
    last = replace(model.joints[5], kind="prismatic", axis=np.array(axis))
    turned = Placement(np.array([[0.6, 0.8, 0.0], [-0.8, 0.6, 0.0], [0.0, 0.0, 1.0]]), np.array([0.1, 0.2, 0.3]))
    return replace(model, joints=(*model.joints[:5], last), base=turned)


@pytest.mark.parametrize("axis", [(1.0, 0.0, 0.0), (0.0, 0.6, -0.8)])
def test_numbers_of_the_robot(compiled, axis):
    """The twin that reads them agrees with Pinocchio on our model, to rounding."""
    peers = compiled(slides_along(axis), Twin())
    assert peers.native.description == "headers of Pinocchio, -O3 -march=native -DNDEBUG"
    for work in ("inverse_dynamics", "forward_dynamics"):
        (form,) = (form for form in peers.contenders(work, (1, 2)) if form.name == NATIVE_NAME)
        assert (form.threads, form.ours) == (1, False)
        assert form.errors(form.run(5)).max() < 1e-15
    assert NATIVE_NAME not in {form.name for form in peers.contenders("solve_kkt", (1,))}


def test_versions_and_flags_are_reported():
    peers = SimpleNamespace(native=SimpleNamespace(description="headers of Pinocchio, gcc, -O3"))
    assert benchmark._peers([], peers)[NATIVE_NAME] == "headers of Pinocchio, gcc, -O3"
    assert NATIVE_NAME not in benchmark._peers([], SimpleNamespace(native=None))


class TestRefusals:
    @pytest.mark.parametrize(("work", "name"), [("inverse_dynamics", "rnea"), ("forward_dynamics", "aba")])
    def test_other_answers(self, compiled, work, name):
        peers = compiled(kr500(), Twin(1 + 1e-6))
        with pytest.raises(NativeRefuses, match=rf"{name} of Pinocchio compiled here differs from its bindings by"):
            peers.contenders(work, (1,))

    def test_no_compiler(self, monkeypatch):
        monkeypatch.setenv("CXX", "no-such-compiler")
        done = CliRunner().invoke(app, ["bench", "--native", "--quick", "--samples", "2"])
        assert done.exit_code == 2
        assert "--native compiles Pinocchio, and there is no C++ compiler (c++, or the one in CXX)" in done.output

    @pytest.mark.parametrize("missing", range(3))
    def test_no_headers(self, tmp_path, missing):
        for number, (_, header, _) in enumerate(NEEDED_HEADERS):
            if number != missing:
                (tmp_path / header).parent.mkdir(parents=True)
                (tmp_path / header).touch()
        library, header, remedy = NEEDED_HEADERS[missing]
        with pytest.raises(NativeRefuses, match=f"there is no {header} of {library}: {remedy}"):
            header_folders((tmp_path / "none", tmp_path))

    def test_folders_of_headers(self, tmp_path, monkeypatch):
        """The first of each library, once; those of the compiler it finds by itself, after its own."""
        first, second, third = (tmp_path / name for name in ("first", "second", "third"))
        for folder, numbers in ((first, (0,)), (second, (0, 1)), (third, (1, 2))):
            for number in numbers:
                (folder / NEEDED_HEADERS[number][1]).parent.mkdir(parents=True, exist_ok=True)
                (folder / NEEDED_HEADERS[number][1]).touch()
        assert header_folders((first, second, third)) == [first, second, third]
        assert header_folders((second, third)) == [second, third]
        monkeypatch.setattr(native_pinocchio, "FOLDERS_OF_THE_COMPILER", (third,))
        assert header_folders((second, third)) == [second]

    def test_the_compiler_fails(self, tmp_path):
        failing = tmp_path / "c++"
        text = "#!/bin/sh\necho In x >&2\necho 'x:1: error: no vectors' >&2\nexit 1\n"
        failing.write_text(text, encoding="utf-8")
        failing.chmod(0o755)
        with pytest.raises(NativeRefuses, match=r"C\+\+ compiler fails on Pinocchio's headers: x:1: error: no vectors"):
            native_pinocchio._library(str(failing), [], tmp_path / "library.so")

    def test_the_compiler_is_killed(self, tmp_path):
        with pytest.raises(NativeRefuses, match=r"fails on Pinocchio's headers: killed"):
            native_pinocchio._library(shutil.which("false"), [], tmp_path / "library.so")


def test_where_headers_are_searched(monkeypatch):
    """In wheels first, then in the environment, then in the system."""
    monkeypatch.setattr(sys, "path", ["", "/wheels"])
    monkeypatch.setattr(sys, "prefix", "/environment")
    found = [str(folder) for folder in native_pinocchio._searched()]
    assert found[:3] == ["/wheels/cmeel.prefix/include", "/wheels/cmeel.prefix/include/eigen3", "/environment/include"]
    assert found[-3:] == ["/usr/include", "/usr/include/eigen3", "/wheels/casadi/include/eigen3"]


@pytest.mark.parametrize("native", [False, True])
def test_option(monkeypatch, native):
    taken = []

    def refuse(robot, model, samples, seed, threads, quick, native, advance):
        taken.append(native)
        raise NativeRefuses("stop here")

    monkeypatch.setattr(benchmark, "benchmark", refuse)
    CliRunner().invoke(app, ["bench", "--quick", *(["--native"] if native else [])])
    assert taken == [native]


@pytest.mark.skipif(shutil.which(os.environ.get("CXX", "c++")) is None, reason="there is no C++ compiler (c++)")
@LONG
@pytest.mark.filterwarnings("ignore::urdf.MimicJointWarning")
def test_compiled_code(tmp_path):
    """Half a minute of processor time: revolute and prismatic joints, about and along z and other axes."""
    try:
        native = NativePinocchio(
            random_states(urdf.load("panda", reading=urdf.Reading(mimic="independent")), 200, 1), tmp_path
        )
    except NativeRefuses as refusal:
        pytest.skip(str(refusal))
    assert "headers of Pinocchio 4" in native.description
    for forward in (False, True):
        form = native.contender(forward)
        assert form.errors(form.run(200)).max() < native_pinocchio.LARGEST_DIFFERENCE
