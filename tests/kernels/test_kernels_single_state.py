"""graphdyn.compile: one state after the other, in memory that is reused."""

import numpy as np
import pytest
from back_ends import BACK_ENDS, on
from random_trees import NAMED, random_state

import graphdyn
from graphdyn import InvalidInput
from graphdyn._compiled import SINGLE
from graphdyn.kernels import running

MODEL = NAMED["mixed_chain"]
"""Four joints."""


@pytest.mark.parametrize("back_end", BACK_ENDS)
def test_single_states_are_rows_of_batches(back_end):
    """Bit for bit, whether arguments are given or left in place, as arrays or as lists."""
    states = random_state(MODEL, 1, (4,))
    with on(back_end):
        compiled = graphdyn.compile(MODEL)
        for verb in SINGLE:
            count = len(SINGLE[verb].inputs)
            batch = getattr(graphdyn, verb)(MODEL, *states[:count], method="recursive")
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


def test_what_is_named_is_prepared_up_front(monkeypatch):
    prepared, original = [], running.record
    monkeypatch.setattr(running, "record", lambda *a: prepared.append(a[1].recursion) or original(*a))
    with on("numpy"):
        compiled = graphdyn.compile(MODEL, "mass_matrix", "joint_torques")
        assert prepared == ["mass_matrix", "inverse_dynamics"]
        compiled.joint_torques(*random_state(MODEL, 3))
        assert len(prepared) == 2
        compiled.bias_torque(*random_state(MODEL, 3)[:2])
        assert len(prepared) == 3


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
