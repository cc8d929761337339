"""Special states: faults that show at them alone are found, and it is said where; right functions are not accused."""

import functools
import re

import numpy as np
import pytest
from faults.textbook import TextbookArm
from long_check import few

import crosscheck
import graphdyn
import urdf
from crosscheck.judging.special_states import (
    N_SPECIAL_STATES,
    earlier_calls,
    in_a_row,
    only_where,
    special_states,
)

SAMPLES = 3


@functools.cache
def ur5():
    return urdf.load("ur5")


@functools.cache
def torques():
    return TextbookArm.of(ur5()).inverse_dynamics


def of(verb, *more):
    """One state of a function of graphdyn."""
    return lambda *x: np.asarray(getattr(graphdyn, verb)(ur5(), *x, *more, method="dense"))


def mass_matrix(q):
    return graphdyn.mass_matrix(ur5(), q)


def kept_by(*which):
    """Answers kept for ever by some of the arguments."""
    known = {}

    def f(*arguments):
        return known.setdefault(tuple(arguments[k].tobytes() for k in which), torques()(*arguments))

    return f


def last_position(f):
    """What depends on q is computed again only where q changes; here this is everything."""
    kept = [None, None]

    def g(*arguments):
        if kept[0] is None or not np.array_equal(kept[0], arguments[0]):
            kept[:] = arguments[0].copy(), f(*arguments)
        return kept[1]

    return g


def at(where, f, otherwise):
    """f, where a condition holds, of the same arguments otherwise."""
    return lambda *x: f(*x) if where(*x) else otherwise(*x)


def alone(_, v, a):
    return np.count_nonzero(v) == np.count_nonzero(a) == 1


def by_the_fastest(q, v, a):
    with np.errstate(all="ignore"):
        return torques()(q, v, a) * (v / v)


def small(limit):
    return lambda q, *_: np.abs(q).max() < limit


LIMITS = np.array([[joint.limits.lower, joint.limits.upper] for joint in ur5().joints]).T
SPEEDS = np.array([joint.limits.velocity for joint in ur5().joints])


def first_alone(q, v, a):
    return torques()(q, v, a) * (v != 0)


def full_speed(q, v, a):
    return torques()(q, np.clip(v, -0.999 * SPEEDS, 0.999 * SPEEDS), a)


def wrist_determinant(q, v, a):
    """Zero where sin q of the fifth joint is."""
    return torques()(q, v, a) * (1.0 if abs(np.sin(q[4])) > 1e-6 else 0.0)


def inside(q, v, a):
    if ((q <= LIMITS[0]) | (q >= LIMITS[1])).any():
        raise ValueError("a joint is at its limit")
    return torques()(q, v, a)


def undefined(*arguments):
    return 0 * torques()(*arguments) * np.nan


def energy(q, v):
    return graphdyn.kinetic_energy(ur5(), q, v)


REST, STILL, BOTH = "v = 0", "a = 0", "v = 0 and a = 0"
NEAR = "every position is within"
FAULTS = {
    "kept by q": (kept_by(0), "v and a are those of the first call with the same q"),
    "kept by q and v": (kept_by(0, 1), "a is that of the first call with the same q and v"),
    "kept by q and a": (kept_by(0, 2), "v is that of the first call with the same q and a"),
    "kept for the last q": (last_position(lambda *x: torques()(*x)), "v and a are those of the first call with the"),
    "nan at rest": (at(lambda q, v, a: not v.any(), undefined, torques()), f"not finite wherever {REST}"),
    "gravity alone at rest": (
        at(lambda q, v, a: not v.any(), lambda q, v, a: torques()(q, v, 0 * a), torques()),
        f"only where {REST}, at 1 of 2",
    ),
    "no velocity terms at a = 0": (
        at(lambda q, v, a: not a.any(), lambda q, v, a: torques()(q, 0 * v, a), torques()),
        f"only where {STILL}, at 1 of 2",
    ),
    "no torque where nothing moves": (
        at(lambda q, v, a: not (v.any() or a.any()), lambda q, v, a: 0 * q, torques()),
        f"wherever {BOTH}",
    ),
    "divided by every velocity": (by_the_fastest, "not finite"),
    "one joint alone": (at(alone, first_alone, torques()), "one joint moves alone"),
    "threshold of small angles": (at(small(1e-3), lambda q, v, a: torques()(0 * q, v, a), torques()), NEAR),
    "no rotation below 1e-5": (at(small(1e-5), lambda q, v, a: torques()(0 * q, v, a), torques()), f"{NEAR} 5e-06"),
    "series of small angles": (
        at(small(0.1), lambda q, v, a: torques()(q - q**3 / 6, v, a), torques()),
        f"{NEAR} 0.02",
    ),
    "clipped at the limits": (
        lambda q, v, a: torques()(np.clip(q, 0.9999 * LIMITS[0], 0.9999 * LIMITS[1]), v, a),
        "limit",
    ),
    "refused at the limits": (inside, "no answer"),
    "whole turns": (
        at(lambda q, v, a: (q[[0, 1]] == 2 * np.pi).all(), undefined, torques()),
        "every angle is a whole turn",
    ),
    "parallel axes": (wrist_determinant, "right at 13 ordinary states, wrong at 7 special states"),
    "saturated velocities": (full_speed, "the limit of its velocity"),
}
OTHERS = {
    "M kept by its first joint": ("mass_matrix", lambda q: mass_matrix(q if np.abs(q).max() > 1e-3 else 0 * q), NEAR),
    "a of no torque": (
        "forward_dynamics",
        at(lambda q, v, tau: not tau.any(), lambda q, v, tau: 0 * q, lambda *x: graphdyn.forward_dynamics(ur5(), *x).a),
        "tau = 0",
    ),
    "energy at rest": ("kinetic_energy", at(lambda q, v: not v.any(), lambda q, v: np.nan, energy), f"wherever {REST}"),
    "power at rest": (
        "power",
        at(lambda q, v, a: not v.any(), lambda q, v, a: q * np.nan, lambda q, v, a: v * torques()(q, v, a)),
        f"wherever {REST}",
    ),
    "bias at rest": (
        "bias_torque",
        at(lambda q, v: not v.any(), lambda q, v: 0 * q, lambda q, v: torques()(q, v, 0 * q)),
        f"wherever {REST}",
    ),
    "height at zero": (
        "potential_energy",
        at(small(1e-7), lambda q: 0.0, lambda q: graphdyn.potential_energy(ur5(), q)),
        NEAR,
    ),
}


def said(judgment):
    assert not judgment.agrees
    return " + ".join(f"{x.message} [{x.kind}]" for x in judgment.diagnoses)


@pytest.mark.parametrize(
    "name", few([*FAULTS], "kept by q", "no velocity terms at a = 0", "nan at rest", "whole turns")
)
def test_faults_of_inverse_dynamics_that_show_at_special_states(name):
    f, words = FAULTS[name]
    message = said(crosscheck.judge("ur5", samples=SAMPLES, inverse_dynamics=f))
    assert re.search(words, message), message


@pytest.mark.parametrize("name", few([*OTHERS], "energy at rest"))
def test_faults_of_other_functions_that_show_at_special_states(name):
    function, f, words = OTHERS[name]
    assert words in said(crosscheck.judge("ur5", samples=SAMPLES, **{function: f}))


def test_rounding_where_the_right_answer_vanishes_is_no_fault():
    """A code that takes gravity for an acceleration of the base, and subtracts it, leaves rounding at rest."""

    def frame_acceleration(q, v, a):
        return (graphdyn.frame_acceleration(ur5(), q, v, a, "tool0", reference="local") + 9.81) - 9.81

    def kinetic_energy(q, v):
        return (energy(q, v) + graphdyn.potential_energy(ur5(), q)) - graphdyn.potential_energy(ur5(), q)

    functions = {"frame_acceleration": frame_acceleration, "kinetic_energy": kinetic_energy}
    assert crosscheck.judge("ur5", samples=SAMPLES, frame="tool0", **functions).agrees


@pytest.mark.parametrize("robot", few(["ur5", "kinova", "z1", "kr500"], "ur5"))
def test_special_states_lie_within_the_limits(robot):
    model = urdf.load(robot)
    labels, q, v, a = special_states(model, 0, 5.0)
    assert len(labels) == len(q) == len(v) == len(a) == N_SPECIAL_STATES <= 20
    for k, joint in enumerate(model.joints):
        limits = joint.limits
        if joint.kind != "continuous" and limits.lower is not None:
            assert ((q[:, k] >= limits.lower) & (q[:, k] <= limits.upper)).all()
        assert limits.velocity is None or (np.abs(v[:, k]) <= limits.velocity).all()
    assert [(~x.any(axis=1)).sum() for x in (v, a)] == [2, 2]
    assert (earlier_calls(q) < np.arange(len(q))).sum() == 6


def test_what_deviating_states_have_in_common():
    where = [("x", np.array([1, 1, 1, 0], dtype=bool)), ("y", np.array([0, 1, 1, 0], dtype=bool))]
    assert only_where(np.array([0, 1, 1, 0], dtype=bool), iter(where)) == "wherever y"
    assert only_where(np.array([0, 1, 0, 0], dtype=bool), iter(where)) == "only where y, at 1 of 2 such states"
    assert only_where(np.array([0, 0, 0, 1], dtype=bool), iter(where)) is None
    first = in_a_row(np.array([[1.0], [1.0], [2.0], [1.0], [1.0]]))
    assert first.tolist() == [0, 0, 2, 3, 3]
    assert earlier_calls(np.array([[1.0], [1.0], [2.0], [1.0], [1.0]])).tolist() == [0, 0, 2, 0, 0]
