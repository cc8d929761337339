"""Functions of one's own: values, derivatives against complex steps, refusals."""

import copy
import gc
import pickle
import sys

import numpy as np
import pytest

from graphdyn import InvalidInput, RecordedFunction

ROUNDING = 1e-14
"""Of some ten operations on numbers near one: measured 3e-16."""


def spring(q, stiffness):
    """Of a weight on a crank: a torque for each joint, and the energy."""
    stretch = 1.5 - np.cos(q)
    return [*(stiffness * stretch * np.sin(q)), stiffness @ stretch**2 / 2]


def softened(x):
    return np.exp(x)


def complex_step(function, arguments, k):
    columns = []
    for j in range(len(arguments[k])):
        stepped = [x.astype(complex) for x in arguments]
        stepped[k][j] += 1e-100j
        columns.append(np.imag(function(*stepped)) / 1e-100)
    return np.stack(columns, axis=-1)


@pytest.mark.parametrize("backend", ["llvm", "numpy"])
@pytest.mark.parametrize("leading", [(), (3,), (2, 9)])
def test_value_and_derivatives(backend, leading, monkeypatch):
    monkeypatch.setenv("GRAPHDYN_BACKEND", backend)
    rng = np.random.default_rng(1)
    q, stiffness = rng.normal(size=(*leading, 2)), rng.uniform(1, 2, 2)  # one stiffness for all samples
    recorded = RecordedFunction(spring, 2, 2)
    value, (by_q, by_stiffness) = recorded(q, stiffness), recorded.jacobian(q, stiffness)
    assert value.shape == (*leading, 3)
    assert by_q.shape == by_stiffness.shape == (*leading, 3, 2)
    for index in np.ndindex(leading):
        arguments = q[index], stiffness
        assert value[index] == pytest.approx(np.array(spring(*arguments)), rel=ROUNDING)
        for k, found in enumerate((by_q, by_stiffness)):
            assert found[index] == pytest.approx(complex_step(spring, arguments, k), rel=ROUNDING, abs=ROUNDING)


def test_one_scalar_and_no_samples():
    recorded = RecordedFunction(lambda x: x @ x, 3)
    assert recorded([1.0, 2.0, 3.0]) == [14.0]
    assert recorded.jacobian([1.0, 2.0, 3.0])[0].tolist() == [[2.0, 4.0, 6.0]]
    assert recorded(np.zeros((0, 3))).shape == (0, 1)


def test_nan_stays_in_its_sample():
    found = RecordedFunction(lambda x: x * 2.0, 1)([[1.0], [np.nan], [3.0]])
    assert np.array_equal(found, [[2.0], [np.nan], [6.0]], equal_nan=True)


@pytest.mark.parametrize("copied", [lambda f: pickle.loads(pickle.dumps(f)), copy.deepcopy, copy.copy])
@pytest.mark.parametrize("backend", ["llvm", "numpy"])
def test_copies_and_pickles(monkeypatch, copied, backend):
    """Of a function that cannot be pickled itself; nothing is left behind that llvmlite stumbles over."""
    ignored = []
    monkeypatch.setattr(sys, "unraisablehook", lambda problem: ignored.append(problem.exc_value))
    recorded = RecordedFunction(lambda x: x @ x, 3)
    monkeypatch.setenv("GRAPHDYN_BACKEND", backend)
    gc.freeze()  # what other tests have left need not be looked through
    again = copied(recorded)
    gc.collect()
    assert again([1.0, 2.0, 3.0]) == recorded([1.0, 2.0, 3.0]) == [14.0]
    assert again.jacobian([1.0, 2.0, 3.0])[0].tolist() == [[2.0, 4.0, 6.0]]
    assert ignored == []


def test_refusals():
    with pytest.raises(InvalidInput, match=r"softened cannot be recorded: .*exp.*; it may use \+, -, \*, /, \*\*, sin"):
        RecordedFunction(softened, 1)
    with pytest.raises(InvalidInput, match=r"<lambda> cannot be recorded: .*'>' not supported"):
        RecordedFunction(lambda x: x[0] if x[0] > 0.0 else 0.0, 1)
    with pytest.raises(InvalidInput, match="<lambda> answers str; it should answer scalars"):
        RecordedFunction(lambda x: "x", 1)
    recorded = RecordedFunction(spring, 2, 2)
    with pytest.raises(InvalidInput, match="1 arrays given; this function takes 2"):
        recorded([1.0, 2.0])
    with pytest.raises(InvalidInput, match=r"argument 2 has shape \(3,\), expected \(…, 2\)"):
        recorded.jacobian(np.zeros(2), np.zeros(3))
    with pytest.raises(InvalidInput, match=r"leading dimensions do not broadcast: \(3, 2\), \(4, 2\)"):
        recorded(np.zeros((3, 2)), np.zeros((4, 2)))
