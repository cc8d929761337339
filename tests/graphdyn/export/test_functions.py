"""Verbs as programs of arrays that users know: what they compute, and what is refused."""

import dataclasses

import numpy as np
import pytest
from random_trees import random_tree

import graphdyn
from graphdyn import Coupling, Frame, InvalidInput, Placement
from graphdyn.compiler.interpreter import Interpreter
from graphdyn.export import ExportChoices, exportable
from graphdyn.export.functions import exported_functions
from graphdyn.export.vectors import VECTOR_STATES, vectors

ROUNDING = 1e-12
"""Share of the largest entry: a few hundred operations, and the condition of the mass matrix."""

EVERYTHING = ExportChoices(external_wrenches=True, moving_base=True, frame="tool", reference="local")


@pytest.fixture(scope="module")
def tree():
    """A branching robot with a slide on a turned base."""
    robot = random_tree(7, [0, 1, 1], ["revolute", "prismatic", "continuous"])
    turned = robot.with_base(Placement(np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]), np.array([0.1, 0.2, 0.3])))
    return dataclasses.replace(turned, frames=(Frame("tool", 2, Placement(np.eye(3), np.ones(3) / 3)),))


@pytest.mark.parametrize(
    ("choices", "coupled"), [(ExportChoices(frame="tool", reference="world"), False), (EVERYTHING, True)]
)
def test_programs_compute_what_the_equations_say(tree, choices, coupled):
    """Alone, and with external wrenches, a moving base and a joint that another drives."""
    first, second, _ = tree.joint_names
    model = dataclasses.replace(tree, couplings=(Coupling(second, {first: 0.5}, 0.1),)) if coupled else tree
    names = exportable(model, choices)
    assert {"solve_kkt", "frame_jacobian", "energy_regressor"} <= set(names)
    for function in exported_functions(model, names, choices):
        x, expected = vectors(function, np.random.default_rng(0))
        assert list(x) == list(function.inputs) == list(function.program.inputs)
        given = {name: array.reshape(VECTOR_STATES, -1) for name, array in x.items()}
        found = {name: np.empty((VECTOR_STATES, function.size(name))) for name in function.outputs}
        Interpreter(function.program).bind(given, found)(0, VECTOR_STATES)
        for name, array in expected.items():
            error = np.abs(found[name] - array.reshape(VECTOR_STATES, -1)).max()
            assert error <= ROUNDING * max(np.abs(array).max(), 1.0), (function.name, name)


def test_arrays_are_those_that_matter(tree):
    names = ["joint_torques", "gravity_torque", "mass_matrix", "static_torque", "potential_energy", "forward_dynamics"]
    arrays = {function.name: list(function.inputs) for function in exported_functions(tree, names, EVERYTHING)}
    base = ["base_rotation", "base_translation", "base_velocity", "base_acceleration"]
    assert arrays == {
        "joint_torques": ["q", "v", "a", "external_wrenches", base[0], *base[2:]],
        "gravity_torque": ["q", base[0]],
        "mass_matrix": ["q"],
        "static_torque": ["q", "external_wrenches", base[0]],
        "potential_energy": ["q", *base[:2]],
        "forward_dynamics": ["q", "v", "tau", "external_wrenches", base[0], *base[2:]],
    }
    (function,) = exported_functions(tree, ["forward_dynamics"], EVERYTHING)
    assert list(function.outputs) == ["a", "body_accelerations", "multipliers", "joint_wrenches"]  # no couplings


@pytest.mark.parametrize(
    ("names", "message"),
    [
        ([], "no function to export; name at least one"),
        (["joint_torque"], "there is no function 'joint_torque' to export; use 'joint_torques'"),
        (["mass_matrix", "mass_matrix"], "function 'mass_matrix' is given twice; name it once"),
        (["frame_jacobian"], "frame_jacobian speaks of a frame; say which, with its reference, or leave it out"),
    ],
)
def test_refused(tree, names, message):
    with pytest.raises(InvalidInput) as error:
        exported_functions(tree, names, ExportChoices())
    assert str(error.value) == message


def test_unknown_frame(tree):
    with pytest.raises(graphdyn.UnknownFrame, match="nowhere"):
        exported_functions(tree, ["frame_jacobian"], ExportChoices(frame="nowhere", reference="local"))
