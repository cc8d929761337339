"""Rolled code of every verb that has it, and where straight-line code gives way to it."""

import inspect
from dataclasses import replace

import numpy as np
import pytest
from back_ends import LONG_ROBOTS, on
from long_check import LONG
from random_trees import random_base_motion, random_state, random_tree, random_wrenches

from graphdyn import Frame, Placement
from graphdyn.arguments.choices import FrameChoice
from graphdyn.compiler import running
from graphdyn.compiler.programs import Request
from graphdyn.compiler.rolled import rolling
from graphdyn.compiler.rolled.program import LongProgram
from graphdyn.recursions import RECURSIONS
from graphdyn.verbs.verb import VERBS

TREE = random_tree(11, [0, 1, 1, 3], ["revolute", "prismatic", "revolute", "prismatic"])
TOOL = Placement(TREE.base.rotation, np.array([0.3, -0.2, 0.5]))
TREE = replace(TREE, frames=(Frame("tool", 3, TOOL), Frame("stand", 0, TOOL)))
"""Turns and slides on two branches; a frame on a body that is not the last one, and one on the ground."""

LARGE = random_tree(12, [0, 1, 0, 2, 2, 5], ["prismatic", "revolute", "prismatic", "revolute", "revolute", "revolute"])
LARGE = replace(LARGE, frames=(Frame("tool", 5, TOOL),))

SUM = 1e-12
"""The same sums in another order, relative to the largest entry; measured 1.2e-14."""

NO_BASE = ("coriolis_matrix", "frame_jacobian_derivative")
"""Verbs that take a base at rest."""


def arguments(verb, model, count=3):
    """Those of a verb, with external wrenches and a moving base where it takes them."""
    q, v, a = random_state(model, 1, (count,))
    given = [{"q": q, "v": v, "a": a, "tau": a}[name] for name in verb.inputs]
    if verb.of_frame:
        given.append("tool")
    if "external_wrenches" in inspect.signature(verb.function).parameters:
        given.append(random_wrenches(model, 2, (count,)))
    return given, {} if verb.name in NO_BASE else {"base": random_base_motion(3, (count,))}


def arrays(verb, answer):
    parts = [getattr(answer, name) for name in verb.outputs] if verb.answer else answer
    return [np.asarray(part) for part in (parts if isinstance(parts, list | tuple) else [parts])]


ROLLED = [name for name, verb in VERBS.items() if verb.recursion in rolling.PASSES]


@pytest.mark.parametrize("name", ROLLED)
@pytest.mark.parametrize("model", [TREE, pytest.param(LARGE, marks=LONG)], ids=["small", "large"])
def test_rolled_code_agrees_with_the_equations_and_with_straight_line_code(name, model):
    verb = VERBS[name]
    given, keywords = arguments(verb, model)
    for reference in ("local", "world")[: 2 if model is LARGE else 1] if verb.of_frame else (None,):
        choice = {} if reference is None else {"reference": reference}
        expected = arrays(verb, verb.function(model, *given, method="projected", **keywords, **choice))
        with on("numpy"):
            straight = arrays(verb, verb.function(model, *given, method="recursive", **keywords, **choice))
        with on(LONG_ROBOTS):
            rolled = arrays(verb, verb.function(model, *given, method="recursive", **keywords, **choice))
            programs = running.programs_of(model).ready.values()
            assert all(isinstance(ready.program, LongProgram) for ready in programs)
        for output, x, plain, line in zip(verb.outputs, rolled, expected, straight, strict=True):
            scale = np.abs(plain).max(initial=0.0)
            assert np.abs(x - plain).max(initial=0.0) <= SUM * scale, output
            assert np.abs(x - line).max(initial=0.0) <= SUM * scale, output


def test_every_recursion_but_these_has_rolled_code():
    """Second derivatives are n³ numbers."""
    assert set(RECURSIONS) - set(rolling.PASSES) == {"inverse_dynamics_second_derivatives"}


def test_what_is_not_a_tree_of_free_joints_has_straight_line_code():
    with on(LONG_ROBOTS):
        assert rolling.is_long(TREE, Request("mass_matrix", ("mass_matrix",)))
        for name, long in (("tool", True), ("stand", False)):
            request = Request("frame_velocity", ("frame_velocity",), frame=FrameChoice(name, "world"))
            assert rolling.is_long(TREE, request) is long
        second = Request("inverse_dynamics_second_derivatives", ("d2tau_dqdq",))
        assert not rolling.is_long(TREE, second)


SNAKE = random_tree(13, [0, 1, 2, 3, 4, 5], ["revolute", "revolute", "revolute", "revolute", "prismatic", "revolute"])
SNAKE = replace(
    SNAKE,
    bodies=tuple(replace(SNAKE.bodies[0], name=body.name, center_of_mass=[0, 0, 0.2]) for body in SNAKE.bodies),
    joints=tuple(
        replace(joint, axis=np.eye(3)[k % 2], placement=Placement(np.eye(3), [0, 0, 0.4 + 0.1 * k]))
        for k, joint in enumerate(SNAKE.joints)
    ),
)
"""Of one module, turned by turns about x and y, on a first one that stands elsewhere, with a slide."""


def test_bodies_whose_constants_vanish_alike_have_code_of_their_own():
    """What differs at one body alone does not cost the others their zeros."""
    request = Request("mass_matrix", ("mass_matrix",))
    snake, tree = rolling.record_long(SNAKE, request), rolling.record_long(TREE, request)
    assert len({*snake.kinds[:4]}) > 1  # that turn
    assert snake.kinds[4] not in (*snake.kinds[:4], snake.kinds[5])
    assert set(tree.kinds) == {0, 1}
    placing = next(each for each in snake.passes if each.order == "outwards")
    assert len({placing.steps[kind].program.arithmetic for kind in snake.kinds[:4]}) > 1


@pytest.mark.parametrize(
    "name", ["static_torque", "joint_accelerations", "momentum", "center_of_mass_velocity", "mass_matrix_inverse"]
)
def test_kinds_agree_with_the_equations(name):
    """On a base at rest too, where more is known to be zero."""
    verb = VERBS[name]
    given, moving = arguments(verb, SNAKE)
    for keywords in ({}, moving):
        expected = arrays(verb, verb.function(SNAKE, *given, method="projected", **keywords))
        with on(LONG_ROBOTS):
            rolled = arrays(verb, verb.function(SNAKE, *given, method="recursive", **keywords))
        for x, plain in zip(rolled, expected, strict=True):
            assert np.abs(x - plain).max(initial=0.0) <= SUM * np.abs(plain).max(initial=0.0)


def test_what_rests_at_the_ground_and_is_not_moved_rests_everywhere():
    """A static torque knows no angular velocity on a base at rest, and needs one on a base that turns."""
    of_rest = rolling.record_long(TREE, Request("static_torque", ("static_torque",)))
    of_motion = rolling.record_long(TREE, Request("static_torque", ("static_torque",), moving_base=True))
    for program, columns in ((of_rest, 3), (of_motion, 9)):  # gravity; ω, ω̇ and the acceleration
        outwards = next(each for each in program.passes if each.order == "outwards")
        inputs = [given for kind, *given in outwards.steps[0].program.operations if kind == "input"]
        assert sum(place.of == ("inside",) for place, _ in inputs) == columns


def test_what_nobody_reads_is_not_kept():
    """A mass matrix needs arms, axes and composite bodies, and no velocities."""
    program = rolling.record_long(TREE, Request("mass_matrix", ("mass_matrix",)))
    reads = {
        given[0].array
        for each in program.passes
        for one in getattr(each, "passes", (each,))
        for step in one.steps.values()
        for kind, *given in step.program.operations
        if kind == "input"
    }
    assert reads == {"memory", "carried", "constants", "q"}
    assert set(program.arrays) == {"memory", "carried", "q", "mass_matrix"}
