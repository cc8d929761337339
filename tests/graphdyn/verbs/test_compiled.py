"""graphdyn.compile: one state after the other, in memory that is reused."""

import copy
import inspect
import pickle
import threading
import weakref
from concurrent.futures import ThreadPoolExecutor
from types import SimpleNamespace
from typing import get_args, get_origin, get_overloads, get_type_hints

import numpy as np
import pytest
from back_ends import BACK_ENDS, on
from random_trees import NAMED, random_state, random_tree

import graphdyn
from graphdyn import InvalidInput
from graphdyn.compiler import running
from graphdyn.compiler.python_calls import can_call
from graphdyn.verbs import VERBS, SingleState
from graphdyn.verbs import compiled as compiled_module
from graphdyn.verbs.compiled import ARRAY_VERBS, CompiledModel

MODEL = NAMED["mixed_chain"]
"""Four joints."""

SMALL = NAMED["prismatic_inside_and_out"]
"""Three, for which every verb is compiled twice."""


@pytest.mark.parametrize("back_end", BACK_ENDS)
def test_single_states_are_rows_of_batches(back_end):
    """Bit for bit, whether arguments are given or left in place, as arrays or as lists."""
    states = random_state(SMALL, 1, (4,))
    with on(back_end):
        compiled = graphdyn.compile(SMALL)
        for verb in ARRAY_VERBS:
            count = len(ARRAY_VERBS[verb].inputs)
            batch = getattr(graphdyn, verb)(SMALL, *states[:count], method="recursive")
            single = getattr(compiled, verb)
            assert getattr(compiled, verb) is single
            for row in range(4):
                result = single(*(x[row] for x in states[:count]))
                assert result is single.result
                assert np.array_equal(result, batch[row]), verb
            for row in (2, 0):
                for name, x in zip(single.arguments, states, strict=False):
                    single.arguments[name][:] = x[row]
                assert np.array_equal(single(), batch[row])
            assert np.array_equal(single(*(x[3].tolist() for x in states[:count])), batch[3])


def test_results_do_not_mix():
    """Two objects of one robot have memory of their own."""
    q, v, a = random_state(MODEL, 2)
    one, two = graphdyn.compile(MODEL), graphdyn.compile(MODEL)
    first = one.joint_torques(q, v, a)
    kept = first.copy()
    two.joint_torques(2 * q, v, a)
    one.joint_accelerations(q, v, a)
    assert np.array_equal(first, kept)


class TestThreads:
    """One object, shared: what other threads do changes neither arguments nor results."""

    @pytest.mark.parametrize("back_end", BACK_ENDS)
    def test_every_thread_has_its_own_results(self, back_end):
        """All threads have called before any looks at what it got."""
        states = random_state(MODEL, 5, (8,))
        with on(back_end):
            expected = graphdyn.joint_torques(MODEL, *states, method="recursive")
            call, together = graphdyn.compile(MODEL).joint_torques, threading.Barrier(8)

            def use(row):
                with on(back_end):
                    result = call(*(x[row] for x in states))
                    together.wait()
                    kept = result.copy()
                    together.wait()
                    return kept, call().copy()

            with ThreadPoolExecutor(8) as pool:
                for row, (kept, again) in enumerate(pool.map(use, range(8))):
                    assert np.array_equal(kept, expected[row])
                    assert np.array_equal(again, expected[row])

    def test_first_use_at_once(self):
        """All threads make a call of so many joints, which none has made before; all but one come too late."""
        together = threading.Barrier(8)
        for n in (9, 10, 11):
            model = random_tree(n, list(range(n)), ["revolute"] * n)
            states = random_state(model, 10)
            expected = graphdyn.joint_torques(model, *states, method="recursive")
            compiled = graphdyn.compile(model)

            def use(_, compiled=compiled, states=states):
                together.wait()
                return [compiled.joint_torques(*states).copy() for _ in range(100)]

            with ThreadPoolExecutor(8) as pool:
                assert np.array_equal([*pool.map(use, range(8))], np.broadcast_to(expected, (8, 100, n)))

    def test_one_call_for_all(self, monkeypatch):
        """Another thread asks for it first, while this one makes its own."""
        compiled, first = graphdyn.compile(MODEL), []

        def make(*of):
            monkeypatch.undo()
            first.append(compiled.gravity_torque)
            return compiled_module.SingleState(*of)

        monkeypatch.setattr(compiled_module, "SingleState", make)
        assert compiled.gravity_torque is first[0]

    def test_taking_turns(self):
        """Two threads, call after call: each goes on with what it has filled in."""
        states = random_state(MODEL, 9, (3,))
        expected = graphdyn.joint_torques(MODEL, *states, method="recursive")
        call = graphdyn.compile(MODEL).joint_torques
        call(*(x[0] for x in states))
        with ThreadPoolExecutor(1) as pool:
            for row in (1, 2):
                there = pool.submit(lambda row=row: call(*(x[row] for x in states)).copy())
                assert np.array_equal(there.result(), expected[row])
                assert np.array_equal(call(), expected[0])
                assert np.array_equal(pool.submit(lambda: call().copy()).result(), expected[row])
                assert np.array_equal(call(*(x[0] for x in states)), expected[0])

    def test_memory_lives_while_it_is_served(self):
        """What a thread leaves behind may call once more, after the thread has lost its memory."""
        states = random_state(MODEL, 11)
        call, local, last = graphdyn.compile(MODEL).joint_torques, threading.local(), []
        here = call(*states).copy()

        class Leftover:
            def __del__(self):
                last.append((memory(), call(*states).copy()))

        def use():
            nonlocal memory
            call(*states)
            memory, local.leftover = weakref.ref(call.result), Leftover()

        memory = None
        thread = threading.Thread(target=use)
        thread.start()
        thread.join()
        ((served, result),) = last
        assert (served is not None) == can_call()  # otherwise the thread gets new memory
        assert np.array_equal(result, here)
        del served
        last.clear()
        call(*states)
        assert memory() is None

    def test_the_back_end_is_that_of_the_first(self):
        """Wherever a thread that joins later would compute."""
        states = random_state(MODEL, 12)

        def on_numpy(use):
            with running.interpreted():
                return use(MODEL).joint_torques(*states).copy()

        compiled, interpreted = graphdyn.compile(MODEL), []
        expected = compiled.joint_torques(*states).copy()
        with ThreadPoolExecutor(1) as pool:
            assert np.array_equal(pool.submit(on_numpy, lambda _: compiled).result(), expected)
            found = on_numpy(lambda model: interpreted.append(graphdyn.compile(model)) or interpreted[0])
            assert np.array_equal(pool.submit(interpreted[0].joint_torques, *states).result(), found)
            assert np.array_equal(interpreted[0].joint_torques(*states), found)

    def test_what_another_thread_filled_in_is_not_there(self):
        """Nor are zeros: NaN, which nobody takes for a torque."""
        call = graphdyn.compile(MODEL).joint_torques
        here = call(*random_state(MODEL, 6)).copy()
        with ThreadPoolExecutor(1) as pool:
            assert np.isnan(pool.submit(call).result()).all()
            assert np.isnan(pool.submit(lambda: call.arguments["q"]).result()).all()
        assert np.array_equal(call(), here)

    def test_a_call_without_arguments_before_any(self):
        assert np.isnan(graphdyn.compile(MODEL).mass_matrix.result).all()
        assert np.isnan(graphdyn.compile(MODEL).joint_torques()).all()


@pytest.mark.parametrize("copied", [copy.copy, copy.deepcopy, lambda x: pickle.loads(pickle.dumps(x))])
class TestCopies:
    """Of the object and of one call, before and after the first use; with memory of their own."""

    @pytest.mark.parametrize("used", [False, True])
    def test_of_the_object(self, copied, used):
        original, (q, v, a) = graphdyn.compile(MODEL), random_state(MODEL, 7)
        kept = original.joint_torques(q, v, a) if used else None
        other = copied(original)
        assert np.array_equal(
            other.joint_torques(2 * q, v, a), graphdyn.joint_torques(MODEL, 2 * q, v, a, method="recursive")
        )
        assert np.array_equal(other.model.inertial_parameters, MODEL.inertial_parameters)
        if used:
            assert np.array_equal(kept, graphdyn.joint_torques(MODEL, q, v, a, method="recursive"))

    @pytest.mark.parametrize("used", [False, True])
    def test_of_a_call(self, copied, used):
        call, q = graphdyn.compile(MODEL).gravity_torque, random_state(MODEL, 8)[0]
        if used:
            call(q)
        other = copied(call)
        assert np.isnan(other.arguments["q"]).all()
        expected = graphdyn.gravity_torque(MODEL, q, method="recursive")
        assert np.array_equal(other(q), expected)
        assert np.array_equal(call(q), expected)


def test_what_is_named_is_prepared_up_front(monkeypatch):
    prepared, original = [], running.trace
    monkeypatch.setattr(running, "trace", lambda *a: prepared.append(a[1].recursion) or original(*a))
    with on("numpy"):
        compiled = graphdyn.compile(MODEL, "mass_matrix", "joint_torques")
        assert prepared == ["mass_matrix", "inverse_dynamics"]
        compiled.joint_torques(*random_state(MODEL, 3))
        assert len(prepared) == 2
        compiled.bias_torque(*random_state(MODEL, 3)[:2])
        assert len(prepared) == 3


def test_every_verb_of_one_array_is_declared_with_its_arguments():
    """Beside its public function, for editors and type checkers."""
    declared = {name: hint for name, hint in get_type_hints(CompiledModel).items() if name != "model"}
    assert declared.keys() == {name for name, verb in VERBS.items() if len(verb.outputs) == 1 and not verb.of_frame}
    for name, hint in declared.items():
        assert get_origin(hint) is SingleState
        (form,) = get_args(hint)
        where = SimpleNamespace(__module__=form.__module__, __qualname__=f"{form.__qualname__}.__call__")
        nothing, all_of_them = get_overloads(where)
        assert tuple(inspect.signature(nothing).parameters) == ("self",)
        assert tuple(inspect.signature(all_of_them).parameters) == ("self", *VERBS[name].inputs), name


def test_calls_have_a_signature_and_a_help():
    call = graphdyn.compile(MODEL).joint_torques
    assert str(inspect.signature(call)) == "(q: 'ArrayLike', v: 'ArrayLike', a: 'ArrayLike', /) -> 'Array'"
    assert inspect.getdoc(call).startswith("joint_torques(q, v, a) → tau (n,) [N m or N]\n\nA verb for one state at a")
    assert set(ARRAY_VERBS) <= set(dir(graphdyn.compile(MODEL)))


def test_a_misspelt_call_is_answered_with_the_closest():
    with pytest.raises(AttributeError, match=r"no single-state call 'joint_torqes'; use 'joint_torques'$"):
        _ = graphdyn.compile(MODEL).joint_torqes
    with pytest.raises(InvalidInput, match=r"no single-state call 'mas_matrix'; use 'mass_matrix'$"):
        graphdyn.compile(MODEL, "mas_matrix")


@pytest.mark.long
def test_a_misspelt_call_is_an_error_of_the_type_checker(tmp_path):
    mypy = pytest.importorskip("mypy.api")
    program = tmp_path / "program.py"
    program.write_text(
        "import graphdyn\n"
        "compiled = graphdyn.compile(graphdyn.kr500())\n"
        "compiled.joint_torques([0.0], [0.0], [0.0]).sum()\n"
        "compiled.joint_torques()\n"
        "compiled.joint_torqes\n"
        "compiled.joint_torques([0.0])\n"
    )
    report, *_ = mypy.run(["--strict", "--follow-imports=silent", f"--cache-dir={tmp_path}", str(program)])
    assert [line.split(": ")[0].rpartition(":")[2] for line in report.splitlines() if " error: " in line] == ["5", "6"]


def test_unknown_verbs_are_refused():
    with pytest.raises(
        InvalidInput, match="no single-state call 'inverse_dynamics'; use some of joint_torques, joint_acc"
    ):
        graphdyn.compile(MODEL, "inverse_dynamics")


def test_wrong_arguments_are_refused():
    q = np.zeros(4)
    with on("numpy"):
        torques = graphdyn.compile(MODEL).joint_torques
    with pytest.raises(InvalidInput, match=r"v has shape \(3,\), expected \(4,\)"):
        torques(q, q[1:], q)
    with pytest.raises(InvalidInput, match=r"a has shape \(1, 4\), expected \(4,\)"):
        torques(q, q, q[None])
    with pytest.raises(InvalidInput, match=r"q has shape \(\), expected \(4,\)"):
        torques(1.0, q, q)
    for given in ((q, q), (q, q, q, q)):
        with pytest.raises(InvalidInput, match=rf"{len(given)} arguments given; give q, v, a, or none where"):
            torques(*given)


def test_what_is_not_looked_for_comes_out_as_nan():
    """Neither NaN nor a mass matrix without an inverse stops a control loop."""
    q = np.zeros(4)
    with on("host"):
        compiled = graphdyn.compile(MODEL)
        assert np.isnan(compiled.joint_torques(q, q + np.nan, q)).all()
        assert np.isfinite(compiled.joint_torques(q, q, q)).all()
        massless = MODEL.with_inertial_parameters(np.zeros(40))
        assert not np.isfinite(graphdyn.compile(massless).joint_accelerations(q, q, q)).any()
