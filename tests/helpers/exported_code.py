"""What graphdyn exports to CasADi and JAX, called like any other code: arrays of one state in, arrays out."""

import functools
from dataclasses import replace

import numpy as np
import pytest

import graphdyn.export.casadi
import graphdyn.export.jax
from graphdyn.export.functions import AS_THEY_ARE
from graphdyn.export.recorded import recorded_function

LIBRARIES = ("casadi", "jax")


def library(name):
    """The package, in double precision. The test is skipped where it is not installed."""
    package = pytest.importorskip(name, reason=f"{name} is not installed: pip install 'graphdyn[{name}]'")
    if name == "jax":
        package.config.update("jax_enable_x64", True)
    return package


def code(name, model, verb, choices=AS_THEY_ARE):
    """The verb as a function of arrays, which answers a dictionary of arrays."""
    recorded = recorded_function(model, verb, choices)
    exported = getattr(graphdyn.export, name).function(model, verb, choices)

    def answers(*arrays):
        found = exported(*arrays)
        several = found if isinstance(found, tuple) else (found,)
        named = zip(recorded.outputs, several, strict=True)
        return {array: np.array(x).reshape(recorded.shape(array)) for array, x in named}

    return answers


JUDGED = {
    "inverse_dynamics": ("joint_torques", "tau"),
    "forward_dynamics": ("joint_accelerations", "a"),
    "joint_wrenches": ("inverse_dynamics", "joint_wrenches"),
    "multipliers": ("inverse_dynamics", "multipliers"),
    "momentum": ("momentum", "about_center_of_mass"),
    "kinetic_energy_regressor": ("energy_regressor", "kinetic"),
    "potential_energy_regressor": ("energy_regressor", "potential"),
    **{name: ("inverse_dynamics_derivatives", name) for name in ("dtau_dq", "dtau_dv")},
    **{name: ("forward_dynamics_derivatives", name) for name in ("da_dq", "da_dv")},
    **{f"d{of}_d{by}": ("reaction_derivatives", f"d{of}_d{by}") for of in ("multipliers", "wrenches") for by in "qva"},
}
"""The verb and the array of functions that crosscheck.judge knows by other names."""


def judged(name, model, functions, choices):
    """These functions, by the names of crosscheck.judge."""

    @functools.cache
    def made(verb):
        return code(name, model, verb, replace(choices, external_wrenches=True) if verb == "static_torque" else choices)

    def function(judged_name):
        verb, array = JUDGED.get(judged_name, (judged_name, judged_name))
        if judged_name == "potential_energy_regressor":
            return lambda q: made(verb)(q, 0 * q)[array]
        return lambda *arrays: made(verb)(*arrays)[array]

    return {judged_name: function(judged_name) for judged_name in functions}
