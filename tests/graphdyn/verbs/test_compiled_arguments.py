"""graphdyn.compile: what a single-state call takes, and what it refuses."""

import gc
import sys
import weakref

import numpy as np
import pytest

import graphdyn
from graphdyn import InvalidInput, kr500
from graphdyn.compiler.llvm import memory as array_layout
from graphdyn.verbs.single_state import SingleState


@pytest.fixture(scope="module")
def call():
    return graphdyn.compile(kr500()).joint_torques


@pytest.fixture
def state():
    rng = np.random.default_rng(7)
    return rng.normal(size=(3, 6))


class TestArguments:
    def test_given_and_in_place_are_the_same(self, call, state):
        given = call(*state).copy()
        for place, argument in zip(call.arguments.values(), state, strict=True):
            place[:] = argument
        assert np.array_equal(call(), given)
        assert np.array_equal(given, graphdyn.joint_torques(kr500(), *state, method="recursive"))

    def test_lists_are_taken(self, call, state):
        given = call(*state).copy()
        assert np.array_equal(call(*state.tolist()), given)

    @pytest.mark.parametrize(
        "form",
        [
            lambda x: np.repeat(x, 2)[::2],
            lambda x: x[::-1].copy()[::-1],
            lambda x: x.astype(">f8"),
            lambda x: x.view(np.recarray),
            lambda x: np.frombuffer(b"." + x.tobytes(), dtype=np.uint8)[1:].view(float),
            tuple,
        ],
        ids=["strided", "reversed", "swapped", "subclass", "unaligned", "tuple"],
    )
    def test_whatever_numpy_takes(self, call, state, form):
        """Vectors that machine code copies itself, and all others."""
        given = call(*state).copy()
        call(*np.zeros((3, 6)))
        assert np.array_equal(call(state[0], form(state[1]), state[2]), given)
        single = state.astype(np.float32)
        assert np.array_equal(call(*single), call(*single.astype(float)))

    @pytest.mark.parametrize("form", [np.asarray, lambda x: x.view(np.recarray)], ids=["plain", "subclass"])
    def test_an_argument_in_the_place_of_another(self, call, state, form):
        given, (q, v, a) = call(state[1], state[0], state[2]).copy(), call.arguments.values()
        call(*state)
        assert np.array_equal(call(form(v), form(q), a), given)

    def test_an_argument_that_calls(self, call, state):
        """It becomes an array by a call of the same object."""

        class Other:
            def __array__(self, *_, **__):
                return call(*np.ones((3, 6))) * 0 + state[1]

        given = call(*state).copy()
        assert np.array_equal(call(state[0], Other(), state[2]), given)

    def test_without_an_interpreter_lock(self, state, monkeypatch):
        """Machine code must not read what another thread may be changing."""
        given = graphdyn.compile(kr500()).joint_torques(*state)
        monkeypatch.setattr("sysconfig.get_config_var", {"Py_GIL_DISABLED": 1}.get)
        call = graphdyn.compile(kr500()).joint_torques
        assert type(call).__call__ is SingleState.__call__
        assert np.array_equal(call(*state), given)

    def test_arrays_of_another_layout(self, state, monkeypatch):
        """Where the fields of an array are elsewhere, the calls go through Python."""
        given = graphdyn.compile(kr500()).joint_torques(*state)
        monkeypatch.setattr(array_layout, "STRIDES", array_layout.STRIDES + 8)
        array_layout.is_known.cache_clear()
        try:
            assert not array_layout.is_known()
            assert np.array_equal(graphdyn.compile(kr500()).joint_torques(*state), given)
            assert array_layout.address(state) == state.ctypes.data
        finally:
            monkeypatch.undo()
            array_layout.is_known.cache_clear()
        assert array_layout.is_known()
        assert array_layout.address(state[1:]) == state[1:].ctypes.data

    def test_calls_hold_nothing(self, call, state):
        """References to arguments and results are given back, and errors leave nothing behind."""

        def references():
            return [sys.getrefcount(x) for x in (call.result, state[0], *call.arguments.values())]

        arguments = [*state]
        before = references()
        for _ in range(50):
            call(*arguments)
            call()
            with pytest.raises(InvalidInput):
                call(*arguments[:2])
        assert references() == before

    def test_the_function_alone(self, state):
        """Without the object that it was taken from, which lives as long, and no longer."""
        gc.freeze()  # what other tests have left need not be looked through
        call = graphdyn.compile(kr500()).joint_torques
        given, gone = call(*state).copy(), weakref.ref(call)
        function = call.__call__
        del call
        gc.collect()
        assert np.array_equal(function(*state), given)
        del function
        gc.collect()
        assert gone() is None

    def test_replaced_attributes_change_nothing(self, state):
        call = graphdyn.compile(kr500()).joint_torques
        given = call(*state).copy()
        call.result, call.arguments = None, {}
        assert np.array_equal(call(*state), given)
        assert np.array_equal(call(), given)

    def test_another_number_of_arguments(self, call, state):
        with pytest.raises(InvalidInput, match=r"2 arguments given; give q, v, a, or none where their memory is fill"):
            call(*state[:2])

    @pytest.mark.parametrize(
        ("v", "found"),
        [
            (np.zeros(5), r"\(5,\)"),
            (np.zeros((6, 1)), r"\(6, 1\)"),  # whose numbers lie in memory as those of a vector
            (np.zeros((6, 2)), r"\(6, 2\)"),
            (np.zeros((6, 3), order="F"), r"\(6, 3\)"),
            (np.float64(1.0), r"\(\)"),
        ],
    )
    def test_another_shape(self, call, state, v, found):
        with pytest.raises(InvalidInput, match=rf"v has shape {found}, expected \(6,\)"):
            call(state[0], v, state[2])

    @pytest.mark.parametrize(
        ("v", "found"),
        [
            (list("abcdef"), "not an array of real numbers but of <U1"),
            ("1.0000", "not an array of real numbers but of <U6"),  # as long as a vector
            (np.zeros(6, dtype=complex), "not an array of real numbers but of complex128"),
            (np.zeros(6, dtype=object), "not an array of real numbers but of object"),
            (np.ma.array(np.zeros(6), mask=[1, 0, 0, 0, 0, 0]), "masked"),
        ],
    )
    def test_no_real_numbers(self, call, state, v, found):
        """As the verbs refuse them; arguments that are in place stay."""
        given = call(*state).copy()
        with pytest.raises(InvalidInput, match=rf"v (is|has) {found}"):
            call(state[2], v, state[2])
        assert np.array_equal(call(), given)
