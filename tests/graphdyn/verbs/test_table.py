"""The table of verbs: what follows from a row holds for every verb."""

import functools
import inspect

import numpy as np
import pytest
from random_trees import NAMED, random_state

import graphdyn
from graphdyn import BaseMotion, InvalidInput
from graphdyn.arguments.choices import KEYWORDS, METHODS
from graphdyn.recursions import ARRAY_SPECS, RECURSIONS
from graphdyn.verbs import VERBS

MODEL = NAMED["mixed_chain"]
AGREEMENT = 1e-12
"""Between methods, relative to the largest entry: measured 4.5e-15. tests/kernels compares them on the scale of their
terms."""

SECOND_ROW = np.array([[0.0], [np.nan]])
"""Spoils it."""

AT_REST = ("coriolis_matrix", "frame_jacobian_derivative")
"""They refuse a base that moves."""

verbs = pytest.mark.parametrize("name", VERBS)
MOVING = BaseMotion(velocity=[0.1, 0.2, -0.3, 0.5, -0.4, 0.3], acceleration=[1.0, -2.0, 0.5, 0.3, 0.2, -0.7])


def function_of(name):
    """Of the verb, for one frame where it speaks of one."""
    function = getattr(graphdyn, name)
    return functools.partial(function, frame="body3", reference="world") if VERBS[name].of_frame else function


def call(name, *leading, **keywords):
    arguments = random_state(MODEL, 1, leading)[: len(VERBS[name].inputs)]
    return function_of(name)(MODEL, *arguments, **keywords)


def arrays(name, answer):
    """Those of an answer, by name."""
    outputs = VERBS[name].outputs
    if isinstance(answer, np.ndarray):
        return {outputs[0]: answer}
    parts = answer if isinstance(answer, tuple) else vars(answer).values()
    return dict(zip(outputs, parts, strict=True))


@verbs
def test_the_function_is_public_and_has_the_signature_of_its_row(name):
    assert name in graphdyn.__all__
    parameters = dict(inspect.signature(getattr(graphdyn, name)).parameters)
    assert tuple(parameters)[: 1 + len(VERBS[name].inputs)] == ("model", *VERBS[name].inputs)
    if name == "inverse_dynamics":
        assert parameters.pop("actuated").kind is inspect.Parameter.KEYWORD_ONLY
    further = tuple(parameters)[1 + len(VERBS[name].inputs) : -len(KEYWORDS)]
    of_frame = [("frame", "reference"), ("frame", "reference", "classical")]
    assert further in (of_frame if VERBS[name].of_frame else [(), ("external_wrenches",)])
    assert tuple(parameters)[-len(KEYWORDS) :] == tuple(KEYWORDS)
    assert all(parameters[keyword].kind is inspect.Parameter.KEYWORD_ONLY for keyword in KEYWORDS)


@verbs
def test_help_says_all_of_it(name):
    text = inspect.getdoc(getattr(graphdyn, name))
    for keyword, meaning in KEYWORDS.items():
        assert f"{keyword}: {meaning}" in text
    assert "graphdyn._" not in text


@verbs
@pytest.mark.parametrize("method", METHODS)
def test_shapes_are_those_of_the_table(name, method):
    for leading in ((), (3,), (2, 3)):
        for output, array in arrays(name, call(name, *leading, method=method)).items():
            assert array.shape == (*leading, *ARRAY_SPECS[output].shape_for(MODEL)), (output, leading)


@verbs
@pytest.mark.parametrize("base", [None, MOVING], ids=["fixed", "moving"])
def test_methods_agree(name, base, monkeypatch):
    if base is not None:
        if name in AT_REST:
            pytest.skip("refuses a base that moves")
        monkeypatch.setenv("GRAPHDYN_BACKEND", "numpy")  # test_recursions compares compiled ones
    expected = arrays(name, call(name, 4, base=base, method="dense"))
    for method in ("projected", "recursive"):
        for output, array in arrays(name, call(name, 4, base=base, method=method)).items():
            size = np.abs(expected[output]).max(initial=1e-300)  # no couplings, no entries
            assert np.abs(array - expected[output]).max(initial=0.0) < AGREEMENT * size


@verbs
def test_answers_go_where_out_says(name):
    expected = arrays(name, call(name, 3, method="recursive"))
    memory = {output: np.full_like(array, np.nan) for output, array in expected.items()}
    answer = type(call(name, 3))
    out = (
        memory[VERBS[name].outputs[0]]
        if answer is np.ndarray
        else tuple(memory.values())
        if answer is tuple
        else answer(**memory)
    )
    found = arrays(name, call(name, 3, out=out))
    for output, array in found.items():
        assert array is memory[output] or array.size == 0
        assert np.array_equal(array, expected[output])


@verbs
def test_refusals(name):
    count = len(VERBS[name].inputs)
    q = np.zeros((2, MODEL.n_bodies))
    function, good = function_of(name), [q] * count
    for k, argument in enumerate(VERBS[name].inputs):
        wrong = [*good]
        wrong[k] = q[:, 1:]
        with pytest.raises(InvalidInput, match=rf"{argument} has shape \(2, 3\), expected \(…, 4\)"):
            function(MODEL, *wrong)
        wrong[k] = q + SECOND_ROW
        for method in METHODS:
            with pytest.raises(InvalidInput, match=rf"{argument} contains nan at row 1, joint"):
                function(MODEL, *wrong, method=method)
    with pytest.raises(InvalidInput, match="method is 'fastest'; use one of auto, recursive, projected, dense"):
        function(MODEL, *good, method="fastest")
    with pytest.raises(InvalidInput, match="threads is 0; give a number from 1"):
        function(MODEL, *good, method="recursive", threads=0)
    with pytest.raises(InvalidInput, match=r"the dense method makes arrays of its own; omit out="):
        function(MODEL, *good, method="dense", out=np.empty(1))
    with pytest.raises(InvalidInput, match=r"out "):
        function(MODEL, *good, out=[])


@verbs
def test_the_first_and_the_last_number_of_every_argument_are_looked_at(name, monkeypatch):
    """Each alone, also where the answer hardly depends on it."""
    monkeypatch.setenv("GRAPHDYN_BACKEND", "numpy")  # test_programs has compiled ones
    function, zero = function_of(name), np.zeros(MODEL.n_bodies)
    loads = {"external_wrenches": np.zeros((MODEL.n_bodies, 6))}
    taken = dict.fromkeys(VERBS[name].inputs, zero)
    if "external_wrenches" in inspect.signature(getattr(graphdyn, name)).parameters:
        taken |= loads
    for argument, array in taken.items():
        for place in (0, -1):
            spoilt = array.copy()
            spoilt.flat[place] = np.nan
            message = rf"{argument} contains nan at joint '{MODEL.joint_names[place]}'"
            with pytest.raises(InvalidInput, match=message):
                function(MODEL, **{**taken, argument: spoilt}, method="recursive")


@verbs
def test_unchecked_arguments_spoil_their_own_sample_only(name):
    q = np.zeros((2, MODEL.n_bodies))
    function, others = function_of(name), [q] * (len(VERBS[name].inputs) - 1)
    spoilt = function(MODEL, q + SECOND_ROW, *others, method="recursive", check=False)
    sound = arrays(name, function(MODEL, q, *others, method="recursive"))
    for output, array in arrays(name, spoilt).items():
        assert np.array_equal(array[0], sound[output][0])
        assert np.isnan(array[1]).any() or array.size == 0


def test_every_recursion_answers_arrays_of_known_shape_and_unit():
    for recursion in RECURSIONS.values():
        assert recursion.inputs[0] == "q"
        for name in (*recursion.inputs, *recursion.outputs):
            assert ARRAY_SPECS[name].unit
            assert all(isinstance(size, int) for size in ARRAY_SPECS[name].shape_for(MODEL))


def test_the_row_reads_like_a_call():
    assert str(VERBS["mass_matrix"]) == "mass_matrix(q) → mass_matrix (n, n) [kg m², kg m, kg]"
    assert str(VERBS["joint_torques"]) == "joint_torques(q, v, a) → tau (n,) [N m or N]"


def test_keywords_are_left_out_of_the_help_of_functions_without_them():
    text = inspect.getdoc(graphdyn.maximal_state)
    assert f"method: {KEYWORDS['method']}" in text
    assert "out: memory" not in text
