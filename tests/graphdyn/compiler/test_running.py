"""Which back end runs a program, and that nothing breaks where one is missing."""

import gc
import os
import pickle
import subprocess
import sys
import textwrap
import threading
import weakref
from collections import deque
from dataclasses import replace

import numpy as np
import pytest
from back_ends import no_programs, on
from long_check import LONG
from random_trees import NAMED, random_base_motion, random_state, random_tree, random_wrenches

import graphdyn
from graphdyn import InvalidInput
from graphdyn.arguments.choices import MANY_SAMPLES, reproducible
from graphdyn.compiler import running
from graphdyn.compiler.gram import gram
from graphdyn.compiler.gram.gram import CompiledGram, InterpretedGram, torque_gram
from graphdyn.compiler.interpreter import Interpreter
from graphdyn.compiler.native import CompiledProgram
from graphdyn.compiler.programs import Request, pivot_scales, trace
from graphdyn.compiler.rolled import rolling
from graphdyn.compiler.rolled.program import LongProgram, Pass
from graphdyn.compiler.running import (
    DERIVATIVES_WORTH_COMPILING,
    REGRESSORS_WORTH_COMPILING,
    SAMPLES_PER_CALL,
    WORTH_COMPILING,
)
from graphdyn.model.coupling import Coupling
from graphdyn.model.parts import Frame
from graphdyn.model.spatial import Placement
from graphdyn.scalars.expressions import Program

MODEL = NAMED["one_revolute"]
X = np.zeros((3, 1))

SUM = 1e-12
"""Sixty bodies in a chain: the same sums in another order, relative to their largest term; measured 1.1e-14."""


@pytest.fixture(autouse=True)
def _no_programs():
    with no_programs():
        yield


def fresh():
    """Another robot of the same content."""
    return replace(MODEL)


def back_end_of(model):
    (ready,) = running.programs_of(model).ready.values()
    return type(ready.backend)


def test_an_unknown_choice_is_refused(monkeypatch):
    monkeypatch.setenv("GRAPHDYN_BACKEND", "cuda")
    with pytest.raises(
        InvalidInput, match="the environment variable GRAPHDYN_BACKEND is 'cuda'; use one of llvm, numpy"
    ):
        graphdyn.joint_torques(MODEL, X, X, X, method="recursive")


@pytest.mark.parametrize(
    ("choice", "expected"), [("numpy", Interpreter), ("llvm", CompiledProgram), ("", CompiledProgram)]
)
def test_the_environment_chooses(monkeypatch, choice, expected):
    monkeypatch.setenv("GRAPHDYN_BACKEND", choice)
    model = fresh()
    graphdyn.joint_torques(model, X, X, X, method="recursive")
    assert back_end_of(model) is expected
    assert torque_gram(model, [0], 0)._backend.__class__ is (InterpretedGram if choice == "numpy" else CompiledGram)


def broken():
    raise ImportError("No module named 'llvmlite'\nwith a second line")


@pytest.mark.parametrize("method", ["recursive", "auto"])
def test_without_llvmlite_there_is_one_warning_and_the_same_results(method, monkeypatch):
    q, v, a = random_state(MODEL, 1, (5,))
    expected = graphdyn.joint_torques(MODEL, q, v, a, method="recursive")
    monkeypatch.setattr("graphdyn.compiler.native._binding", broken)
    monkeypatch.setattr(running, "CALLS_WORTH_COMPILING", 1)
    monkeypatch.setattr(running, "SAMPLES_PER_CALL", WORTH_COMPILING)
    model = replace(MODEL, name="another")
    running._can_compile.cache_clear()
    try:
        with pytest.warns(
            RuntimeWarning,
            match=r"no compiled dynamics \(No module named 'llvmlite'\); the NumPy back end gives the same results, "
            r".*Install llvmlite 0.45 or newer, or set GRAPHDYN_BACKEND=numpy to silence this",
        ) as caught:
            found = graphdyn.joint_torques(model, q, v, a, method=method)
        assert caught[0].filename == __file__
        graphdyn.joint_torques(model, q, v, a, method="recursive")  # a second warning would be an error here
        torque_gram(model, [0], 0)
        assert graphdyn.compile(fresh()).mass_matrix(q[0]).shape == (1, 1)
    finally:
        running._can_compile.cache_clear()
    assert back_end_of(model) is Interpreter
    assert np.allclose(found, expected, rtol=1e-14, atol=0)


def run_alone(code, **environment):
    """A program in a process of its own, warnings as errors."""
    command = [sys.executable, "-W", "error", "-c", textwrap.dedent(code)]
    done = subprocess.run(
        command, capture_output=True, text=True, timeout=300, env={**os.environ, **environment}, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_llvmlite_is_imported_when_something_is_compiled_and_not_before():
    run_alone("""
        import sys
        import numpy as np
        import graphdyn

        model = graphdyn.kr500()
        graphdyn.joint_torques(model, np.zeros(6), np.zeros(6), np.zeros(6))
        assert "llvmlite" not in sys.modules
        graphdyn.joint_torques(model, np.zeros((10_000, 6)), np.zeros(6), np.zeros(6))
        assert "llvmlite" in sys.modules
    """)


def test_numpy_needs_no_llvmlite():
    run_alone(
        """
        import sys
        import numpy as np
        sys.modules["llvmlite"] = None
        import graphdyn

        graphdyn.joint_torques(graphdyn.kr500(), np.zeros((10_000, 6)), np.zeros(6), np.zeros(6))
        """,
        GRAPHDYN_BACKEND="numpy",
    )


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork on this system")
def test_after_a_fork_the_child_computes_too():
    """Threads of the parent are gone, and a thread of the parent may have been compiling."""
    out = run_alone("""
        import os, threading, warnings
        import numpy as np
        import graphdyn
        from graphdyn.compiler import running

        warnings.simplefilter("ignore", DeprecationWarning)  # Python 3.12 and later: fork beside threads
        running.WORTH_A_THREAD = 1000
        model = graphdyn.kr500()
        x = np.random.default_rng(0).normal(size=(1000, 6))
        expected = graphdyn.joint_torques(model, x, x, x, threads=3)
        robots = [graphdyn.kr500() for _ in range(3)]
        busy = [threading.Thread(target=graphdyn.compile, args=(robot, "joint_accelerations")) for robot in robots]
        for thread in busy:
            thread.start()
        child = os.fork()
        again = graphdyn.joint_torques(model, x, x, x, threads=3)
        other = graphdyn.joint_torques(model.with_gravity(np.zeros(3)), x, x, x, threads=2)
        assert np.array_equal(again, expected)
        assert not np.array_equal(other, expected)
        if child == 0:
            os._exit(0)
        for thread in busy:
            thread.join()
        print(os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]))
    """)
    assert out.split() == ["0"]


def test_programs_go_with_the_last_robot_of_their_content(monkeypatch):
    """Where no more robots are remembered than there are."""
    monkeypatch.setattr(running, "_recent", deque(maxlen=0))
    gc.freeze()  # what other tests have left need not be looked through
    model, same = fresh(), fresh()
    graphdyn.joint_torques(model, X, X, X, method="recursive")
    single = graphdyn.compile(same).joint_torques
    (program, _) = (weakref.ref(ready.program) for ready in running.programs_of(model).ready.values())
    gone = weakref.ref(same)
    del model, same
    gc.collect()
    assert gone() is not None  # another thread may need it
    single(X[0], X[0], X[0])  # keeps its machine code
    del single
    gc.collect()
    assert gone() is None
    assert program() is None
    assert not running._of_contents


def test_a_robot_that_is_loaded_again_finds_its_programs():
    """Also after the first is gone; one whose last digit differs, or a name, is another."""
    model = NAMED["revolute_chain"]
    programs = running.programs_of(replace(model))
    gc.collect()
    assert running.programs_of(replace(model)) is programs
    assert running.programs_of(pickle.loads(pickle.dumps(model))) is programs
    third = replace(model.bodies[2], mass=np.nextafter(model.bodies[2].mass, 0))
    others = [
        replace(model, name="another"),
        replace(model, bodies=(*model.bodies[:2], third, *model.bodies[3:])),
        model.with_gravity(-model.gravity),
        replace(model, frames=(Frame("tool", 1, Placement()),)),
    ]
    assert len({id(running.programs_of(other)) for other in [model, *others]}) == 5


def test_a_program_is_prepared_once(monkeypatch):
    prepared, original = [], running.trace
    monkeypatch.setattr(running, "trace", lambda *a: prepared.append(a[1].recursion) or original(*a))
    model = fresh()
    with on("host"):
        callers = [
            threading.Thread(target=graphdyn.joint_torques, args=(model, X, X, X), kwargs={"method": "recursive"})
            for _ in range(5)
        ]
        for caller in callers:
            caller.start()
        for caller in callers:
            caller.join()
    assert prepared == ["inverse_dynamics"]


VERBS_OF_MOTION = (
    graphdyn.forward_dynamics,
    graphdyn.inverse_dynamics,
    graphdyn.joint_accelerations,
    graphdyn.joint_torques,
    graphdyn.maximal_state,
)


@pytest.fixture
def compiled(monkeypatch):
    """The programs that were compiled."""
    programs, original = [], running._backend
    monkeypatch.setattr(running, "_backend", lambda *of: programs.append(of[0]) or original(*of))
    return programs


@pytest.mark.parametrize("verb", VERBS_OF_MOTION, ids=lambda verb: verb.__name__)
def test_what_has_cost_as_much_as_compiling_is_compiled(verb, compiled):
    """Calls for one state, and one for many states, of two robots of the same content."""
    calls = WORTH_COMPILING // (1 + SAMPLES_PER_CALL)
    for _ in range(calls):
        verb(fresh(), X[0], X[0], X[0])
    assert not compiled
    verb(fresh(), X[0], X[0], X[0])
    verb(fresh(), X[0], X[0], X[0])
    assert len(compiled) == (2 if verb is graphdyn.maximal_state else 1)  # the accelerations have a program of theirs
    compiled.clear()
    other, many = MODEL.with_gravity(np.zeros(3)), np.zeros((WORTH_COMPILING // 2, 1))
    verb(other, many, many, many)
    assert not compiled
    verb(other, *(many.reshape(10, -1, 1),) * 3)
    assert compiled


def test_samples_of_derivatives_and_regressors_count_otherwise(compiled):
    """Those of derivatives take long, and regressors take long to compile."""
    model, several = fresh(), np.zeros((DERIVATIVES_WORTH_COMPILING, 1))
    graphdyn.coriolis_matrix(model, several, several)
    assert len(compiled) == 1
    many = np.zeros((REGRESSORS_WORTH_COMPILING // 2, 1))
    graphdyn.joint_torque_regressor(model, many, many, many)
    assert len(compiled) == 1
    graphdyn.joint_torque_regressor(model, many, many, many)
    assert len(compiled) == 2


def test_what_is_compiled_is_used(compiled):
    """Because a call asked for it, or has memory for the answer; to the last digit, as the call that asks for it."""
    model = NAMED["revolute_chain"]
    x = np.random.default_rng(0).normal(size=(3, 1, model.nv))
    asked = graphdyn.joint_torques(model, *x, method="recursive")
    assert np.array_equal(graphdyn.joint_torques(model, *x), asked)
    assert not np.array_equal(graphdyn.joint_torques(model, *x, method="projected"), asked)
    graphdyn.mass_matrix(model, x[0], out=np.empty((1, model.nv, model.nv)))
    graphdyn.mass_matrix(model, x[0])
    assert len(compiled) == 2


def test_reproducible_goes_by_the_number_of_samples(compiled):
    """Whatever was computed before; also where nothing is asked for, inside reproducible."""
    model = NAMED["revolute_chain"]
    x = np.random.default_rng(0).normal(size=(3, 1, model.nv))
    projected = graphdyn.joint_torques(model, *x, method="projected")
    graphdyn.joint_torques(model, *x, method="recursive")
    assert np.array_equal(graphdyn.joint_torques(model, *x, method="reproducible"), projected)
    with reproducible():
        assert np.array_equal(graphdyn.joint_torques(model, *x), projected)
        for _ in range(WORTH_COMPILING // SAMPLES_PER_CALL):
            graphdyn.mass_matrix(model, x[0])
    graphdyn.mass_matrix(model, x[0], method="reproducible")
    assert len(compiled) == 1
    many = np.zeros((2, MANY_SAMPLES // 2, model.nv))
    graphdyn.mass_matrix(model, many, method="reproducible")
    assert len(compiled) == 2


def test_few_samples_are_not_interpreted(monkeypatch):
    """Where a program takes too long to compile, it is for many samples."""
    monkeypatch.setattr(running, "MAX_COMPILED_LENGTH", 0)
    model = NAMED["revolute_chain"]
    x = np.random.default_rng(0).normal(size=(3, 1, model.nv))
    graphdyn.joint_torques(model, *x, method="recursive")
    projected = graphdyn.joint_torques(model, *x, method="projected")
    for _ in range(WORTH_COMPILING // SAMPLES_PER_CALL):
        assert np.array_equal(graphdyn.joint_torques(model, *x), projected)
    many = np.broadcast_to(x, (3, WORTH_COMPILING, model.nv))
    assert np.array_equal(
        graphdyn.joint_torques(model, *many)[0], graphdyn.joint_torques(model, *x, method="recursive")[0]
    )


def test_far_angles_of_joints_that_drive_others_are_left_to_the_projected_method():
    """Compiled code cannot reduce them by whole turns; what answered before compiling still does."""
    model = replace(NAMED["revolute_chain"], couplings=(Coupling("joint2", {"joint1": 0.5}),))
    x = np.full((1, model.nv), 1e7)
    with pytest.raises(InvalidInput, match="some joints drive others"):
        graphdyn.gravity_torque(model, x, method="recursive")
    found = graphdyn.gravity_torque(model, x)
    assert np.array_equal(found, graphdyn.gravity_torque(model, x, method="projected"))


# Many bodies

CHAIN = random_tree(1, list(range(60)), ["revolute", "prismatic", "revolute"] * 20)
STAR = random_tree(2, [0] * 60, ["revolute", "prismatic"] * 30)


def test_programs_that_would_take_long_to_compile_are_interpreted():
    """Above LONGEST; the same chain in one array may still be short enough."""
    whole = Request("forward_dynamics", ("a", "body_accelerations", "multipliers", "joint_wrenches"))
    long, short = trace(CHAIN, whole), trace(CHAIN, Request("bias_torque", ("bias_torque",)))
    assert short.length < running.MAX_COMPILED_LENGTH < long.length
    assert isinstance(running._backend(long, "llvm"), Interpreter)
    assert isinstance(running._backend(trace(MODEL, whole), "llvm"), CompiledProgram)
    twenty = random_tree(4, list(range(20)), ["revolute"] * 20)
    assert isinstance(torque_gram(MODEL, range(10), 0)._backend, CompiledGram)
    assert isinstance(torque_gram(twenty, range(200), 0)._backend, InterpretedGram)


def test_sums_are_read_after_they_are_done(monkeypatch):
    """What was the same for all bodies before others added to it: here, each counts the bodies that it carries."""

    def ones(body):
        body.sum("bodies", 1.0)

    def added(body):
        body.add("bodies", body.kept("bodies"))

    def counted(body):
        body.answer("a", body.kept("bodies"))

    passes = (Pass("outwards", ones), Pass("inwards", added), Pass("outwards", counted))
    monkeypatch.setitem(rolling.PASSES, "forward_dynamics", passes)
    monkeypatch.setattr(rolling, "most_unrolled", lambda request: 0)
    tree = random_tree(7, [0, 1, 2, 1, 0], ["revolute"] * 5)
    x = np.zeros((20, 5))
    assert np.array_equal(
        graphdyn.joint_accelerations(tree, x, x, x, method="recursive"), np.broadcast_to([4.0, 2, 1, 1, 1], x.shape)
    )


def test_far_angles_of_long_programs_are_brought_back_first(monkeypatch):
    """Each joint in its turn, as the same robot with the angle that NumPy's sine and cosine tell."""
    monkeypatch.setattr(rolling, "most_unrolled", lambda request: 0)
    tree = random_tree(9, [0, 1, 0], ["revolute"] * 3)
    q, v, a = random_state(tree, 3, (6,))
    far = q.copy()
    far[[1, 3, 5], [0, 1, 2]] = 1e17
    near = np.where(far == q, q, np.arctan2(np.sin(far), np.cos(far)))
    found, expected = (graphdyn.joint_torques(tree, x, v, a, method="recursive") for x in (far, near))
    assert np.abs(found - expected).max() < SUM * np.abs(expected).max()
    assert all(isinstance(ready.program, LongProgram) for ready in running.programs_of(tree).ready.values())


def test_long_programs_of_loaded_bodies_on_a_base_that_moves(monkeypatch):
    """Of a tree of turns and slides, against the equations that know no programs."""
    monkeypatch.setattr(rolling, "most_unrolled", lambda request: 0)
    tree = random_tree(11, [0, 1, 0, 2], ["revolute", "prismatic", "prismatic", "revolute"])
    (q, v, a), wrenches, base = random_state(tree, 1, (3,)), random_wrenches(tree, 2, (3,)), random_base_motion(3, (3,))
    for verb in (graphdyn.inverse_dynamics, graphdyn.forward_dynamics):
        expected = verb(tree, q, v, a, wrenches, base=base, method="projected")
        found = verb(tree, q, v, a, wrenches, base=base, method="recursive")
        for name, value in vars(expected).items():
            size = np.abs(value).max(initial=np.abs(expected.joint_wrenches).max())
            assert np.abs(getattr(found, name) - value).max(initial=0.0) < SUM * size, name
    assert all(isinstance(ready.program, LongProgram) for ready in running.programs_of(tree).ready.values())


@pytest.mark.parametrize("unrolled", [0, 100])
def test_pivots_are_parts_of_what_they_can_be(unrolled, monkeypatch):
    """Ratios of leading minors of the mass matrix, from the last joint on, over the inertia of the stretched arm."""
    monkeypatch.setattr(rolling, "most_unrolled", lambda request: unrolled)
    tree = random_tree(11, [0, 1, 0, 2], ["revolute", "prismatic", "prismatic", "revolute"])
    q, v, tau = random_state(tree, 1, (3,))
    pivots = np.empty((3, 4))
    request = Request("forward_dynamics", ("pivots",))
    seen = running.run(tree, request, {"q": q, "v": v, "tau": tau}, {"pivots": pivots})
    mass = graphdyn.mass_matrix(tree, q, method="projected")
    minors = [np.linalg.det(mass[:, j:, j:]) if j < 4 else np.ones(3) for j in range(5)]
    wanted = np.stack([minors[j] / minors[j + 1] for j in range(4)], axis=-1) / pivot_scales(tree)
    np.testing.assert_allclose(pivots, wanted, rtol=SUM)
    assert seen["minimum"] == pivots.min()
    assert isinstance(running.prepared(tree, request).program, Program if unrolled else LongProgram)


@pytest.mark.parametrize("model", [CHAIN, pytest.param(STAR, marks=LONG)], ids=["chain", "star"])
def test_sixty_bodies(model):
    q, v, a = random_state(model, 3, (3,))
    found = graphdyn.inverse_dynamics(model, q, v, a, method="recursive")
    expected = graphdyn.inverse_dynamics(model, q, v, a, method="projected")
    size = np.abs(expected.joint_wrenches).max()
    for name, value in vars(expected).items():
        scale = np.abs(value).max() if name == "body_accelerations" else size
        assert np.abs(getattr(found, name) - value).max(initial=0.0) < SUM * scale, name
    solved = graphdyn.forward_dynamics(model, q, v, found.tau, method="recursive")
    back = graphdyn.inverse_dynamics(model, q, v, solved.a, method="projected")
    assert np.abs(back.tau - found.tau).max() < SUM * size
    assert np.abs(back.multipliers - solved.multipliers).max() < SUM * size
    assert all(isinstance(ready.program, LongProgram) for ready in running.programs_of(model).ready.values())


def test_gram_of_interpreted_and_compiled_programs_agree(monkeypatch):
    """The same sums where a program is too long to be compiled."""
    model = NAMED["mixed_chain"]
    arrays = [*random_state(model, 8, (100,)), *random_state(model, 9, (100,))[:1], np.zeros((100, 4, 0))]
    compiled, _ = torque_gram(model, range(40), 0)(*arrays)
    monkeypatch.setattr(gram, "MAX_COMPILED_LENGTH", 10)
    interpreted, _ = torque_gram(model, range(40), 0)(*arrays)
    for x, y in zip(compiled, interpreted, strict=True):
        assert np.abs(x - y).max() < SUM * np.abs(x).max()


def test_interpreted_for_a_while(monkeypatch):
    """In this thread, whatever the environment says, and not afterwards."""
    monkeypatch.setenv("GRAPHDYN_BACKEND", "llvm")
    others = []
    with running.interpreted():
        model = fresh()
        graphdyn.joint_torques(model, X, X, X, method="recursive")
        assert back_end_of(model) is Interpreter
        other = threading.Thread(target=lambda: others.append(running.chosen_backend()))
        other.start()
        other.join()
    assert [*others, running.chosen_backend()] == ["llvm", "llvm"]


@pytest.mark.parametrize(("samples", "back_end"), [(3, Interpreter), (MANY_SAMPLES, CompiledProgram)])
def test_what_is_computed_again_and_again(samples, back_end):
    """Few samples on NumPy, many compiled, the same numbers the second time; long robots are projected."""
    model = NAMED["revolute_chain"]
    x = np.random.default_rng(0).normal(size=(3, samples, model.nv))
    found = []
    for _ in range(2):
        with running.quick_for_few(model, "joint_torque_regressor", samples) as method:
            assert method == "recursive"
            found.append(graphdyn.joint_torque_regressor(model, *x, method=method))
        assert back_end_of(model) is back_end
    projected = graphdyn.joint_torque_regressor(model, *x, method="projected")
    assert np.abs(found[0] - projected).max() < SUM * np.abs(projected).max()
    np.testing.assert_array_equal(*found)
    with running.quick_for_few(CHAIN, "joint_torque_regressor", samples) as method:
        assert method == ("projected" if samples < MANY_SAMPLES else "recursive")
