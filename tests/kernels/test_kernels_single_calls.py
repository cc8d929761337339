"""graphdyn.compile: what a single-state call takes, and what it refuses."""

import numpy as np
import pytest

import graphdyn
from graphdyn import InvalidInput, kr500


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

    def test_another_number_of_arguments(self, call, state):
        with pytest.raises(InvalidInput, match=r"2 arguments given; give q, v, a, or none where their memory is fill"):
            call(*state[:2])

    @pytest.mark.parametrize(
        ("v", "found"), [(np.zeros(5), r"\(5,\)"), (np.zeros((6, 2)), r"\(6, 2\)"), (np.float64(1.0), r"\(\)")]
    )
    def test_another_shape(self, call, state, v, found):
        with pytest.raises(InvalidInput, match=rf"v has shape {found}, expected \(6,\)"):
            call(state[0], v, state[2])

    def test_words(self, call, state):
        with pytest.raises(ValueError, match="could not convert string to float"):
            call(state[0], ["a", "b", "c", "d", "e", "f"], state[2])
