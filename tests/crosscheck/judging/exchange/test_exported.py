"""Functions for CasADi and JAX, judged like the code of others."""

import pytest
from exported_code import judged, library
from long_check import few

import crosscheck
import urdf
from crosscheck.quantities import FUNCTIONS
from graphdyn.export import ExportChoices

ARMS = ("kr500", "ur3", "ur5", "ur10", "kinova", "z1")

NO_VERBS = {"frame_placement", "base_regressor"}
"""What is judged and is no verb."""

SLOW = {f"d{of}_d{by}" for of in ("multipliers", "wrenches") for by in "qva"}
"""All are outputs of one function, which takes a second to record."""

LOADED = ("inverse_dynamics", "forward_dynamics", "joint_wrenches", "multipliers", "power", "static_torque")
"""Those that take external wrenches."""

ROUNDED = 1e-13
"""On the scales of the functions: measured 7e-15."""

COMPILED_BY_XLA = ("inverse_dynamics", "mass_matrix")
"""Two of them: all take a minute."""


def assert_agrees(name, arm, functions):
    library(name)
    model = urdf.load(arm)
    frame = model.bodies[-1].name
    chosen = judged(name, model, functions, ExportChoices(frame=frame, reference="local"))
    judgment = crosscheck.judge(arm, **chosen, frame=frame, samples=3)
    assert judgment.agrees, judgment.diagnoses
    assert all(function.errors["graphdyn"].max() <= ROUNDED for function in judgment.functions.values())


@pytest.mark.parametrize(("arm", "left_out"), few([("ur5", SLOW), *((arm, set()) for arm in ARMS)], ("ur5", SLOW)))
def test_casadi(arm, left_out):
    assert_agrees("casadi", arm, [name for name in FUNCTIONS if name not in NO_VERBS | left_out])


def test_casadi_with_loads():
    library("casadi")
    functions = judged("casadi", urdf.load("ur5"), LOADED, ExportChoices(external_wrenches=True))
    assert crosscheck.judge("ur5", **functions, external_wrenches=True, samples=3).agrees


@pytest.mark.parametrize("arm", few(ARMS, "ur5"))
def test_jax(arm):
    assert_agrees("jax", arm, COMPILED_BY_XLA)
