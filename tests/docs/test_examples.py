"""Functions that people call first have an example, which runs; every public function says in a line what it does."""

import doctest
import inspect

import public_names
import pytest

import graphdyn

FIRST_FUNCTIONS = (
    "crosscheck.compare",
    "crosscheck.identify",
    "crosscheck.judge",
    "graphdyn.aligning.align",
    "graphdyn.aligning.differences",
    "graphdyn.aligning.same_names",
    "graphdyn.excitation.optimized",
    "urdf.dh_table",
    "urdf.inspect",
    "urdf.load",
    *(f"graphdyn.{name}" for name in graphdyn.__all__ if inspect.isfunction(getattr(graphdyn, name))),
)
"""The verbs of the dynamics, and what begins the work with robots, codes and recordings."""


def examples_of(thing):
    return [test for test in doctest.DocTestFinder(recurse=False).find(thing, globs={}) if test.examples]


@pytest.mark.parametrize("name", FIRST_FUNCTIONS)
def test_the_example_of_a_function_runs_and_prints_what_it_says(name):
    function = inspect.unwrap(public_names.everything()[name])
    (found,) = examples_of(function)
    assert f"{function.__name__}(" in "".join(example.source for example in found.examples)
    said = []
    doctest.DocTestRunner(verbose=False).run(found, out=said.append)
    assert said == []


def test_every_verb_is_among_them():
    verbs = [name for name in graphdyn.__all__ if name in graphdyn.verbs.VERBS]
    assert len(verbs) >= 29
    assert {f"graphdyn.{name}" for name in verbs} <= set(FIRST_FUNCTIONS)


def test_all_examples_are_executed():
    """Other public names may have one: it is then to be listed above."""
    with_examples = {
        name
        for name, value in public_names.everything().items()
        if inspect.isroutine(value) or inspect.isclass(value)
        if examples_of(value)
    }
    homes = {public_names.home(*name.rsplit(".", 1)) for name in with_examples}
    assert homes == {public_names.home(*name.rsplit(".", 1)) for name in FIRST_FUNCTIONS}


def test_every_public_function_says_in_a_line_what_it_does():
    silent = []
    for name, value in public_names.everything().items():
        if inspect.isfunction(value):
            first, *rest = (inspect.getdoc(value) or "").splitlines() or [""]
            if not first.rstrip().endswith((".", ":", "]", ")")) or (rest and rest[0].strip()):
                silent.append(f"{name}: {first!r}")
    assert silent == []
