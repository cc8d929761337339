"""What faults of the catalog do to the torques, against graphdyn with the same change made by hand."""

import dataclasses
import itertools
from types import SimpleNamespace

import numpy as np
import pytest
from planting import mixed_tree, with_body, with_joint

from crosscheck.judging.faults.arguments import orders, units
from crosscheck.judging.faults.inertials import inertials
from crosscheck.judging.faults.recursion import DynamicsCode, torques_of
from crosscheck.judging.faults.signs import signs
from crosscheck.judging.verdicts.diagnosis import noise
from graphdyn import inverse_dynamics

ALIKE = 1e-12
"""Two recursions: some hundred roundings each."""

URDF_TENSOR = ("xx", "xy", "xz", "yy", "yz", "zz")
PER_METER = {"millimeters": 1000, "centimeters": 100, "inches": 39.37007874015748}


@pytest.fixture(scope="module")
def model():
    return mixed_tree()


@pytest.fixture(scope="module")
def state(model):
    q, v = model.random_state(np.random.default_rng(5), 4)
    return q, v, np.random.default_rng(6).uniform(-5, 5, q.shape)


def said(fault):
    (description,) = fault.say(fault.right)
    return description


def torques(model, faults, state):
    """Torques (R, n) of a code with each fault, by what it says."""
    faults = list(faults(model))
    codes = [fault.change(DynamicsCode.of(model), fault.right) for fault in faults]
    return {said(fault).message: tau for fault, tau in zip(faults, torques_of(codes, state), strict=True)}


def check(found, expected):
    assert np.abs(found - expected).max() <= ALIKE * np.abs(expected).max()


def test_orders(model, state):
    """Every quantity is looked up by the name of its joint."""
    found, names = torques(model, orders, state), model.joint_names
    others = [order for order in itertools.permutations(names) if order != names]
    assert len(found) == 3 * len(others)
    for order in others:
        listed = ", ".join(order)
        ours, theirs = [order.index(name) for name in names], [names.index(name) for name in order]
        tau, reordered = (
            inverse_dynamics(model, *(x[:, which] for x in state)).tau for which in (range(len(names)), ours)
        )
        check(found[f"joint quantities are in the order {listed}"], reordered[:, theirs])
        check(found[f"joint motions, but not torques, are in the order {listed}"], reordered)
        check(found[f"torques, but not joint motions, are in the order {listed}"], tau[:, theirs])


def test_units(model, state):
    found = torques(model, units, state)
    for k, joint in enumerate(model.joints):
        for unit, per_meter in PER_METER.items():
            place = dataclasses.replace(joint.placement, translation=per_meter * joint.placement.translation)
            tau = inverse_dynamics(with_joint(model, k + 1, placement=place), *state).tau
            check(found[f"the placement of joint '{joint.name}' is in {unit}, the rest in meters"], tau)
        per_unit = PER_METER if joint.is_prismatic else {"degrees": 180 / np.pi}
        for unit, size in per_unit.items():
            scale = np.where(np.arange(model.n_bodies) == k, 1 / size, 1.0)
            q, v, a = state
            of = f"of joint '{joint.name}' are taken as {unit}"
            check(found[f"positions {of}"], inverse_dynamics(model, scale * q, v, a).tau)
            whole = inverse_dynamics(model, scale * q, scale * v, scale * a).tau
            check(found[f"positions, velocities and accelerations {of}"], whole)
    one = np.array([joint.is_prismatic for joint in model.joints]).argmin()
    slower = np.where(np.arange(model.n_bodies) == one, np.pi / 30, 1.0)
    name = model.joint_names[one]
    check(
        found[f"velocities of joint '{name}' are taken as rev/min"],
        inverse_dynamics(model, state[0], slower * state[1], state[2]).tau,
    )


ORDERS = ("xx yy zz xy xz yz", "xx yy zz xy yz xz", "xx yy zz yz xz xy", "xx xy yy xz yz zz")
"""MuJoCo's, SDF's and Voigt's, Pinocchio's."""


@pytest.mark.parametrize("order", ORDERS)
def test_tensors_in_other_orders(model, state, order):
    """Six numbers that one side writes in one order, and the other side reads in another."""
    found, names = torques(model, inertials, state), order.split()
    listed = ", ".join(f"I_{name}" for name in names)
    tensor = model.bodies[1].inertia
    number = {name: tensor["xyz".index(name[0]), "xyz".index(name[1])] for name in URDF_TENSOR}
    for words, written, read in (("is read", URDF_TENSOR, names), ("is written", names, URDF_TENSOR)):
        got = dict(zip(read, (number[name] for name in written), strict=True))
        xx, xy, xz, yy, yz, zz = (got[name] for name in URDF_TENSOR)
        wrong = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        expected = inverse_dynamics(with_body(model, 2, inertia=wrong), *state).tau
        of = f"the tensor of body '{model.body_names[1]}'"
        read, other = (f"{of} is {way} in the order {listed}" for way in ("read", "written"))
        check(found[read if words == "is read" or other not in found else other], expected)


def test_remedies_of_signs(model):
    remedies = {description.message: description.remedy for description in map(said, signs(model))}
    name = model.joint_names[0]
    assert remedies[f"the torque of joint '{name}' has the opposite sign"] == "negate it"
    assert remedies[f"the axis of joint '{name}' points the other way"].startswith("reverse the axis, or negate")


class Noisy:
    """Inverse dynamics with white noise, its standard deviation a part of the largest torque."""

    name = "inverse_dynamics"
    known = SimpleNamespace(arguments_at=lambda states: states.state)

    def __init__(self, model, size):
        self.model, self.size, self.rng = model, size, np.random.default_rng(7)

    def __call__(self, *state):
        tau = inverse_dynamics(self.model, *state).tau
        return tau + self.size * np.abs(tau).max() * self.rng.normal(size=tau.shape)


@pytest.mark.parametrize("size", [1e-9, 1e-5])
def test_noise(model, state, size):
    """Of the noisiest of three torques, relative to the largest on a line."""
    found = noise(Noisy(model, size), SimpleNamespace(q=state[0], model=model, state=state))
    assert 0.5 * size < found < 5 * size
