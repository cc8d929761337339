"""Passes that leave a robot fewer constants: the same answers for its joints."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from examples import examples
from hypothesis import given
from random_trees import NAMED, SEEDS, random_base_motion, random_state, random_wrenches, robots
from witnesses import relative_error

import graphdyn
from graphdyn import Placement
from graphdyn.compiler import programs
from graphdyn.compiler.batch import ground_columns
from graphdyn.compiler.interpreter import Interpreter
from graphdyn.compiler.programs import REDUCTIONS, Request, trace
from graphdyn.model.spatial import rotation_about

SUM = 1e-13
"""The same torques from other constants, relative to the largest wrench: measured 2.3e-15."""

AXES = np.array([0.0, 0.0, 1.0])
TORQUES = Request("inverse_dynamics", ("tau",))
ACCELERATIONS = Request("forward_dynamics", ("a",))


def answer(model, request, inputs):
    program = trace(model, request)
    (columns,) = program.outputs.values()
    out = np.empty((len(inputs["q"]), len(columns)))
    Interpreter(program).bind(inputs, {request.outputs[0]: out})(0, len(out))
    return out


def operations(model, request):
    return sum(kind in "+-*/" for kind, *_ in trace(model, request).operations)


@pytest.mark.parametrize("count", range(1, len(REDUCTIONS) + 1))
@examples(10)
@given(robots(), SEEDS)
def test_every_pass_keeps_torques_and_mass_matrix(count, model, seed):
    """Of any tree, with wrenches on its bodies and on a moving base."""
    (q, v, a), wrenches = random_state(model, seed, (2,)), random_wrenches(model, seed + 1, (2,))
    base = random_base_motion(seed + 2, (2,))
    inputs = {"q": q, "v": v, "a": a, "external_wrenches": wrenches.reshape(2, -1)}
    inputs["ground"] = ground_columns(model, base, (2,))
    torques, matrix = replace(TORQUES, external=True, moving_base=True), Request("mass_matrix", ("mass_matrix",))
    size = np.abs(graphdyn.inverse_dynamics(model, q, v, a, wrenches, base=base).joint_wrenches).max()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(programs, "REDUCTIONS", ())
        plain = answer(model, torques, inputs), answer(model, matrix, inputs)
        patch.setattr(programs, "REDUCTIONS", REDUCTIONS[:count])
        reduced = answer(model, torques, inputs), answer(model, matrix, inputs)
    assert np.abs(reduced[0] - plain[0]).max() < SUM * max(size, np.abs(wrenches).max())
    assert relative_error(reduced[1], plain[1]) < SUM


def test_what_the_passes_save(monkeypatch):
    """Operations of a six-axis arm, less with every pass, for torques and for accelerations."""
    counts = []
    for count in range(len(REDUCTIONS) + 1):
        monkeypatch.setattr(programs, "REDUCTIONS", REDUCTIONS[:count])
        counts.append((operations(NAMED["kr500"], TORQUES), operations(NAMED["kr500"], ACCELERATIONS)))
    assert counts[-1] == (239, 490)
    assert all(after <= before for pair in zip(*counts, strict=True) for before, after in pairwise(pair))


def test_a_rounded_right_angle_about_an_axis_costs_six_operations():
    """1.5707963 for π/2 in the placement of every joint: cosine and sine are turned by the rest."""
    arm = NAMED["kr500"]
    spoilt = []
    for joint in arm.joints:
        turn = rotation_about(joint.axis, 1.5707963 - np.pi / 2)
        place = Placement(joint.placement.rotation @ turn, joint.placement.translation)
        spoilt.append(replace(joint, placement=place))
    model = replace(arm, joints=tuple(spoilt))
    assert operations(model, TORQUES) <= operations(arm, TORQUES) + 6 * arm.n_bodies
    assert operations(model, ACCELERATIONS) <= operations(arm, ACCELERATIONS) + 6 * arm.n_bodies


@pytest.mark.parametrize("angle", [*(quarters * np.pi / 2 for quarters in range(4)), -2.0, -0.4, 0.4, 2.0])
def test_what_turns_the_place_of_a_joint_is_part_of_its_angle(angle):
    """Torques and mass matrix are those of the arm whose joints stand further by as much, by other equations."""
    arm = NAMED["kr500"]
    turned = []
    for joint in arm.joints:
        turn = rotation_about(joint.axis, angle)
        exact = np.round(turn) if np.abs(turn - np.round(turn)).max() < 1e-15 else turn
        place = Placement(joint.placement.rotation @ exact, joint.placement.translation)
        turned.append(replace(joint, placement=place))
    model = replace(arm, joints=tuple(turned))
    (q, v, a), matrix = random_state(arm, 9, (3,)), Request("mass_matrix", ("mass_matrix",))
    wanted = graphdyn.inverse_dynamics(arm, q + angle, v, a, method="projected")
    torques = answer(model, TORQUES, {"q": q, "v": v, "a": a})
    assert np.abs(torques - wanted.tau).max() < SUM * np.abs(wanted.joint_wrenches).max()
    mass = graphdyn.mass_matrix(arm, q + angle, method="projected")
    assert relative_error(answer(model, matrix, {"q": q}).reshape(mass.shape), mass) < SUM


@pytest.mark.parametrize("angle", [1e-3, 1e-7, 1e-12, 1e-15])
def test_nearly_parallel_axes_lose_no_digits(angle, monkeypatch):
    """Their common normal is far away, or anywhere."""
    first, second, third, *rest = NAMED["revolute_chain"].joints
    turn = rotation_about(np.array([0.6, 0.8, 0.0]), angle)
    beside = Placement(turn, np.array([0.3, 0.2, 0.1]))
    second, third = (replace(joint, placement=beside, axis=AXES) for joint in (second, third))
    model = replace(NAMED["revolute_chain"], joints=(replace(first, axis=AXES), second, third, *rest))
    q, v, a = random_state(model, 4, (20,))
    inputs = {"q": q, "v": v, "a": a}
    reduced = answer(model, TORQUES, inputs)
    monkeypatch.setattr(programs, "REDUCTIONS", ())
    plain = answer(model, TORQUES, inputs)
    assert np.abs(reduced - plain).max() < SUM * np.abs(graphdyn.inverse_dynamics(model, q, v, a).joint_wrenches).max()
