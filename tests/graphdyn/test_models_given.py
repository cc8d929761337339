"""What is no RobotModel is refused by every public function that takes one, with the same sentence."""

import inspect

import numpy as np
import pytest

import graphdyn
import urdf
from graphdyn import InvalidInput, identification
from graphdyn.identification import terms

ANYTHING = np.zeros(6)
"""For the other arguments: the model is looked at first."""


def parameters_of(function):
    try:
        return inspect.signature(function).parameters
    except ValueError:  # exceptions
        return {}


TAKE_A_MODEL = {
    f"{module.__name__}.{name}": getattr(module, name)
    for module in (graphdyn, identification, terms, urdf)
    for name in module.__all__
    if callable(getattr(module, name)) and "model" in parameters_of(getattr(module, name))
}


def test_they_are_found():
    assert {"graphdyn.joint_torques", "graphdyn.record", "graphdyn.identification.TorqueModel", "urdf.save"} < set(
        TAKE_A_MODEL
    )


@pytest.mark.parametrize(("given", "said"), [("ur5", "'ur5', of type str"), (None, "None, of type NoneType")])
@pytest.mark.parametrize("name", TAKE_A_MODEL)
def test_refused(name, given, said):
    needed = [p for p in parameters_of(TAKE_A_MODEL[name]).values() if p.default is p.empty]
    arguments = {p.name: given if p.name == "model" else ANYTHING for p in needed}
    by_name = {p.name: arguments.pop(p.name) for p in needed if p.kind == p.KEYWORD_ONLY}
    with pytest.raises(InvalidInput, match=f"the model is {said}; give a RobotModel, into which"):
        TAKE_A_MODEL[name](*arguments.values(), **by_name)
