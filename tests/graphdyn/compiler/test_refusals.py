"""What the recursive method refuses, what it fills, and what it leaves to the projection."""

import dataclasses

import numpy as np
import pytest
from back_ends import BACK_ENDS, LONG_ROBOTS, on
from numpy.testing import assert_allclose
from random_trees import NAMED, random_base_motion, random_state, random_wrenches

import graphdyn
from graphdyn import (
    Body,
    ForwardDynamics,
    InvalidInput,
    InverseDynamics,
    Joint,
    Placement,
    RobotModel,
    SingularMassMatrix,
)

ROBOT = NAMED["mixed_chain"]
"""Four joints, the second prismatic."""

N = 9
back_ends = pytest.mark.parametrize("back_end", BACK_ENDS)
with_long_robots = pytest.mark.parametrize("back_end", [*BACK_ENDS, LONG_ROBOTS])


@pytest.fixture(autouse=True)
def _interpreted(request):
    """On NumPy unless a test chooses: refusals happen before and after the programs run."""
    with on(request.node.callspec.params.get("back_end", "numpy") if hasattr(request.node, "callspec") else "numpy"):
        yield


def arguments(count=N, seed=1):
    q, v, x = random_state(ROBOT, seed, (count,))
    return q, v, x, random_wrenches(ROBOT, seed + 1, (count,))


def memory(answer, count=N):
    """An answer to write to, full of NaN."""
    widths = {"a": (4,), "tau": (4,), "multipliers": (4, 5), "coupling_multipliers": (0,), "chord_multipliers": (0,)}
    names = [field.name for field in dataclasses.fields(answer)]
    return answer(**{name: np.full((count, *widths.get(name, (4, 6))), np.nan) for name in names})


# Memory for the answer


@back_ends
def test_answers_are_written_where_they_are_wanted(back_end):
    q, v, x, wrenches = arguments()
    for verb, answer in ((graphdyn.forward_dynamics, ForwardDynamics), (graphdyn.inverse_dynamics, InverseDynamics)):
        out = memory(answer)
        there = verb(ROBOT, q, v, x, wrenches, out=out)
        fresh = verb(ROBOT, q, v, x, wrenches, method="recursive")
        for name, value in vars(fresh).items():
            assert getattr(there, name) is getattr(out, name) or value.size == 0
            assert np.array_equal(getattr(out, name), value)
    pair = np.full((N, 4, 6), np.nan), np.full((N, 4, 5), np.nan)
    there = graphdyn.solve_kkt(ROBOT, q, v, x, wrenches, out=pair)
    fresh_pair = graphdyn.solve_kkt(ROBOT, q, v, x, wrenches, method="recursive")
    for here, memory_, value in zip(there, pair, fresh_pair, strict=True):
        assert here is memory_
        assert np.array_equal(here, value)
    single = {
        "joint_accelerations": ((q, v, x), (4,)),
        "joint_torques": ((q, v, x), (4,)),
        "mass_matrix": ((q,), (4, 4)),
        "bias_torque": ((q, v), (4,)),
        "joint_torque_regressor": ((q, v, x), (4, 40)),
        "body_regressor": ((q, v, x), (4, 6, 10)),
    }
    for name, (given, shape) in single.items():
        verb, out = getattr(graphdyn, name), np.full((N, *shape), np.nan)
        assert verb(ROBOT, *given, out=out) is out
        assert np.array_equal(out, verb(ROBOT, *given, method="recursive"))


@pytest.mark.parametrize("out", [np.zeros((N, 4, 6)), (np.zeros((N, 4, 6)),)])
def test_memory_for_the_unknowns_is_a_pair(out):
    with pytest.raises(InvalidInput, match="give a pair of arrays, for body_accelerations and multipliers"):
        graphdyn.solve_kkt(ROBOT, *arguments()[:3], out=out)


@pytest.mark.parametrize("method", ["dense", "projected"])
def test_unknowns_are_those_of_forward_dynamics(method):
    q, v, x, wrenches = arguments()
    accelerations, multipliers = graphdyn.solve_kkt(ROBOT, q, v, x, wrenches, method=method)
    everything = graphdyn.forward_dynamics(ROBOT, q, v, x, wrenches, method=method)
    assert np.array_equal(accelerations, everything.body_accelerations)
    assert np.array_equal(multipliers, everything.multipliers)


def read_only(shape):
    array = np.zeros(shape)
    array.flags.writeable = False
    return array


def unaligned(shape):
    return np.zeros(8 * int(np.prod(shape)) + 1, dtype=np.uint8)[1:].view(float).reshape(shape)


@pytest.mark.parametrize(
    ("out", "message"),
    [
        (np.zeros((8, 4)), r"out for tau is float64 \(8, 4\); give a float64 array of shape \(9, 4\)"),
        (np.zeros((9, 4, 1)), r"out for tau is float64 \(9, 4, 1\); give"),
        (np.zeros((9, 4), dtype=np.float32), r"out for tau is float32 \(9, 4\); give a float64 array"),
        (np.zeros((9, 4), dtype=">f8"), r"out for tau is >f8 \(9, 4\); give a float64 array"),
        ([[0.0] * 4] * 9, r"out for tau is list; give a float64 array of shape \(9, 4\)"),
        (np.zeros((9, 4), order="F"), r"out for tau is not C-contiguous; give a writable, aligned, C-contiguous array"),
        (np.zeros((9, 8))[:, ::2], r"out for tau is not C-contiguous; give"),
        (read_only((9, 4)), r"out for tau is read-only; give a writable"),
        (unaligned((9, 4)), r"out for tau is not aligned; give a writable, aligned"),
    ],
)
def test_memory_that_cannot_take_the_answer_is_refused(out, message):
    q, v, a, _ = arguments()
    with pytest.raises(InvalidInput, match=message):
        graphdyn.joint_torques(ROBOT, q, v, a, out=out)


def test_memory_of_several_arrays_is_refused_by_name():
    q, v, a, _ = arguments()
    out = dataclasses.replace(memory(InverseDynamics), multipliers=np.zeros((N, 4, 6)))
    with pytest.raises(InvalidInput, match=r"out for multipliers is float64 \(9, 4, 6\); .* shape \(9, 4, 5\)"):
        graphdyn.inverse_dynamics(ROBOT, q, v, a, out=out)
    for wrong, name in ((np.zeros((N, 4)), "ndarray"), (memory(InverseDynamics), "InverseDynamics")):
        with pytest.raises(InvalidInput, match=rf"out is {name}; give ForwardDynamics with an array for each"):
            graphdyn.forward_dynamics(ROBOT, q, v, a, out=wrong)
    with pytest.raises(InvalidInput, match="out is ForwardDynamics; give InverseDynamics with an array for each"):
        graphdyn.inverse_dynamics(ROBOT, q, v, a, out=memory(ForwardDynamics))


def test_memory_that_overlaps_is_refused_by_name():
    q, v, a, wrenches = arguments()
    with pytest.raises(InvalidInput, match="out for tau overlaps with v; give memory of its own"):
        graphdyn.joint_torques(ROBOT, q, v, a, out=v)
    block = np.zeros((2 * N, 4))
    with pytest.raises(InvalidInput, match="out for tau overlaps with q"):
        graphdyn.joint_torques(ROBOT, block[:N], v, a, out=block[N - 1 : -1])
    with pytest.raises(InvalidInput, match="out for tau overlaps with q"):  # a view that is copied before the program
        graphdyn.joint_torques(ROBOT, block[::2], v, a, out=block[:N])
    with pytest.raises(InvalidInput, match="out for tau overlaps with external_wrenches"):
        graphdyn.joint_torques(ROBOT, q, v, a, wrenches, out=wrenches.reshape(-1)[: 4 * N].reshape(N, 4))
    out = memory(InverseDynamics)
    out = dataclasses.replace(out, joint_wrenches=out.body_accelerations)
    with pytest.raises(InvalidInput, match="out for joint_wrenches overlaps with out for body_accelerations"):
        graphdyn.inverse_dynamics(ROBOT, q, v, a, out=out)
    beside = graphdyn.joint_torques(ROBOT, block[:N], v, a, out=block[N:])
    assert np.array_equal(beside, graphdyn.joint_torques(ROBOT, np.zeros((N, 4)), v, a, method="recursive"))


@pytest.mark.parametrize("method", ["projected", "dense"])
def test_the_other_methods_write_where_they_please(method):
    q, v, a, _ = arguments()
    calls = [
        lambda: graphdyn.forward_dynamics(ROBOT, q, v, a, method=method, out=memory(ForwardDynamics)),
        lambda: graphdyn.inverse_dynamics(ROBOT, q, v, a, method=method, out=memory(InverseDynamics)),
        lambda: graphdyn.joint_torques(ROBOT, q, v, a, method=method, out=np.zeros((N, 4))),
        lambda: graphdyn.mass_matrix(ROBOT, q, method=method, out=np.zeros((N, 4, 4))),
        lambda: graphdyn.joint_torque_regressor(ROBOT, q, v, a, method=method, out=np.zeros((N, 4, 40))),
        lambda: graphdyn.body_regressor(ROBOT, q, v, a, method=method, out=np.zeros((N, 4, 6, 10))),
    ]
    for call in calls:
        with pytest.raises(InvalidInput, match=rf"the {method} method makes arrays of its own; omit out=, or use"):
            call()


# Arguments


@pytest.mark.parametrize("threads", [0, -1, 1.5, "two"])
def test_numbers_of_threads(threads):
    q, v, a, _ = arguments()
    with pytest.raises(InvalidInput, match=rf"threads is {threads!r}; give a number from 1, or None for all cores"):
        graphdyn.joint_torques(ROBOT, q, v, a, method="recursive", threads=threads)


def test_wrong_shapes_are_refused_as_elsewhere():
    q, v, a, wrenches = arguments()
    with pytest.raises(InvalidInput, match=r"v has shape \(9, 3\), expected \(…, 4\) for the 4 joints"):
        graphdyn.joint_torques(ROBOT, q, v[:, 1:], a, method="recursive")
    with pytest.raises(InvalidInput, match=r"external_wrenches has shape \(9, 4, 5\), expected \(…, 4, 6\)"):
        graphdyn.joint_torques(ROBOT, q, v, a, wrenches[..., 1:], method="recursive")
    with pytest.raises(InvalidInput, match=r"leading dimensions do not broadcast: q \(9, 4\), v \(8, 4\)"):
        graphdyn.joint_torques(ROBOT, q, v[1:], a, method="recursive")


@back_ends
def test_no_samples_no_work(back_end):
    nothing, none = np.zeros((0, 4)), np.zeros((3, 0, 4))
    f = graphdyn.forward_dynamics(ROBOT, nothing, nothing, nothing, method="recursive")
    assert [x.shape for x in vars(f).values()] == [(0, 4), (0, 4, 6), (0, 4, 5), (0, 4, 6), (0, 0), (0, 0)]
    assert graphdyn.mass_matrix(ROBOT, none, method="recursive").shape == (3, 0, 4, 4)
    out = np.empty((0, 4))
    assert graphdyn.joint_torques(ROBOT, nothing, nothing, nothing, out=out) is out
    state = graphdyn.maximal_state(ROBOT, nothing, nothing, nothing, method="recursive")
    assert state.rotation.shape == (0, 4, 3, 3)


@back_ends
def test_one_state_without_leading_dimensions(back_end):
    q, v, a, wrenches = arguments(1)
    one = graphdyn.inverse_dynamics(ROBOT, q[0], v[0], a[0], wrenches[0], method="recursive")
    batch = graphdyn.inverse_dynamics(ROBOT, q, v, a, wrenches, method="recursive")
    for name, value in vars(one).items():
        assert np.array_equal(value, getattr(batch, name)[0])


VERBS = {
    "forward_dynamics": lambda q, v, x, w, **k: vars(graphdyn.forward_dynamics(ROBOT, q, v, x, w, **k)),
    "inverse_dynamics": lambda q, v, x, w, **k: vars(graphdyn.inverse_dynamics(ROBOT, q, v, x, w, **k)),
    "joint_accelerations": lambda q, v, x, w, **k: {"a": graphdyn.joint_accelerations(ROBOT, q, v, x, w, **k)},
    "joint_torques": lambda q, v, x, w, **k: {"tau": graphdyn.joint_torques(ROBOT, q, v, x, w, **k)},
    "mass_matrix": lambda q, v, x, w, **k: {"M": graphdyn.mass_matrix(ROBOT, q, **k)},
    "bias_torque": lambda q, v, x, w, **k: {"h": graphdyn.bias_torque(ROBOT, q, v, **k)},
    "joint_torque_regressor": lambda q, v, x, w, **k: {"W": graphdyn.joint_torque_regressor(ROBOT, q, v, x, **k)},
    "body_regressor": lambda q, v, x, w, **k: {"Y": graphdyn.body_regressor(ROBOT, q, v, x, **k)},
}


@back_ends
def test_what_is_not_finite_is_refused_with_its_row_or_stays_in_it(back_end):
    clean = arguments()
    others = np.delete(np.arange(N), [5, 7])
    for name, verb in VERBS.items():
        expected = verb(*clean, method="recursive")
        for bad in (np.nan, np.inf, -np.inf):
            q = clean[0].copy()
            q[5, 3] = q[7, 2] = bad
            with pytest.raises(InvalidInput, match=rf"q contains {bad} at row 5, joint 'joint4' \(2 of 9 rows are not"):
                verb(q, *clean[1:], method="recursive")
            found = verb(q, *clean[1:], method="recursive", check=False)
            for array, value in found.items():
                assert np.array_equal(value[others], expected[array][others]), name
                assert value.size == 0 or all(np.isnan(value[row]).any() for row in (5, 7)), name
            v = np.where(np.arange(N)[:, None] == 2, bad, clean[1])
            with pytest.raises(InvalidInput, match=rf"v contains {bad} at row 2"):
                graphdyn.maximal_state(ROBOT, clean[0], v, method="recursive")


@with_long_robots
def test_rows_that_are_not_finite_are_named_before_broadcasting(back_end):
    q, v, tau, wrenches = arguments(6)
    q, tau = q.reshape(2, 3, 4), tau[0]
    tau = np.where(np.arange(4) == 1, np.nan, tau)
    with pytest.raises(InvalidInput, match=r"tau contains nan at joint 'joint2' \(1 of 1 rows are not finite\)"):
        graphdyn.joint_accelerations(ROBOT, q, v[:3], tau, method="recursive")
    bad = q.copy()
    bad[1, 2, 0] = np.nan
    with pytest.raises(InvalidInput, match=r"q contains nan at row \(1, 2\), joint 'joint1' \(1 of 6 rows"):
        graphdyn.joint_accelerations(ROBOT, bad, v[:3], v[0], method="recursive")
    spoiled = wrenches[:3].copy()
    spoiled[1, 2, 5] = np.inf
    with pytest.raises(InvalidInput, match=r"external_wrenches contains inf at row 1, joint 'joint3' \(1 of 3 rows"):
        graphdyn.joint_accelerations(ROBOT, q, v[:3], v[0], spoiled, method="recursive")
    loose = graphdyn.joint_accelerations(
        ROBOT, bad, v[:3], v[0], base=random_base_motion(1, (2, 1)), method="recursive", check=False
    )
    assert np.array_equal(np.isnan(loose).all(axis=-1), [[False] * 3, [False, False, True]])


# Singular mass matrices

SOLID = Body("solid", 2.0, np.zeros(3), np.eye(3))


def pair(tip, axis=(0.0, 0.0, 1.0)):
    """A solid arm about z, and this body on a second joint."""
    joints = (
        Joint("arm", "revolute", 0, Placement(), [0.0, 0.0, 1.0]),
        Joint("tip", "revolute", 1, Placement(translation=[0.3, 0.0, 0.0]), axis),
    )
    return RobotModel("pair", (SOLID, tip), joints)


@with_long_robots
def test_a_body_without_inertia_is_refused(back_end):
    nothing = pair(Body("ghost", 0.0, np.zeros(3), np.zeros((3, 3))))
    x = np.zeros((2, 3, 2))
    message = (
        r"mass matrix of robot 'pair' is singular in row \(0, 0\): joint 'tip' moves without inertia, "
        r".*\(bodies without mass or inertia: ghost\)"
    )
    for check in (True, False):
        with pytest.raises(SingularMassMatrix, match=message):
            graphdyn.forward_dynamics(nothing, x, x, x, method="recursive", check=check)
    assert np.isfinite(graphdyn.joint_torques(nothing, x, x, x, method="recursive")).all()


def gimbal():
    """Point mass on its last axis when the middle joint stands at zero: M is singular there alone."""
    nothing = np.zeros((3, 3))
    joints = [Joint("a", "revolute", 0, Placement(), [0, 0, 1.0]), Joint("b", "revolute", 1, Placement(), [0, 1.0, 0])]
    bodies = (Body("one", 0.0, np.zeros(3), nothing), Body("two", 1.0, np.array([0, 0, 0.5]), nothing))
    return RobotModel("gimbal", bodies, tuple(joints))


@with_long_robots
def test_the_row_with_a_singular_mass_matrix_is_named(back_end):
    """The row before it has a small pivot but is regular, and is solved by projection."""
    q = np.full((2, 4, 2), 0.7)
    q[1, 1] = [0.3, 1e-6]
    zero = np.zeros_like(q)
    tau = np.ones_like(q)
    expected = graphdyn.forward_dynamics(gimbal(), q, zero, tau, method="projected")
    found = graphdyn.forward_dynamics(gimbal(), q, zero, tau, method="recursive")
    for name, value in vars(expected).items():
        assert np.array_equal(getattr(found, name)[1, 1], value[1, 1]), name
    assert expected.a[1, 1, 0] > 1e11  # 1 / (m r² sin²): there is next to no inertia
    q[1, 2] = [0.3, 0.0]
    with pytest.raises(SingularMassMatrix, match=r"robot 'gimbal' is singular in row \(1, 2\): joint 'a' moves"):
        graphdyn.forward_dynamics(gimbal(), q, zero, tau, method="recursive")


SUMMED_OTHERWISE = 1e-14
"""Largest difference of two calls on the same rows, on the scale of the answer: NumPy before 2.3 orders sums by the
place in memory."""


def assert_same(found, expected, name):
    scale = np.abs(expected).max(initial=0.0)
    assert_allclose(found, expected, rtol=0, atol=SUMMED_OTHERWISE * scale, err_msg=name)


@back_ends
def test_negative_inertia_is_solved_by_projection(back_end):
    """Identification without constraints produces such bodies; M is regular but not definite."""
    odd = pair(Body("odd", 1.0, np.array([0.2, 0.0, 0.0]), -0.5 * np.eye(3)))
    q, v, tau = (np.full((5, 2), x) for x in (0.4, 1.0, 2.0))
    found = graphdyn.forward_dynamics(odd, q, v, tau, method="recursive")
    expected = graphdyn.forward_dynamics(odd, q, v, tau, method="projected")
    for name, value in vars(expected).items():
        assert_same(getattr(found, name), value, name)
    base = random_base_motion(6)
    one = graphdyn.forward_dynamics(odd, q[0], v[0], tau[0], base=base, method="recursive")
    expected = graphdyn.forward_dynamics(odd, q[:1], v[:1], tau[:1], base=base, method="projected")
    for name, value in vars(expected).items():
        assert_same(getattr(one, name), value[0], name)


@back_ends
def test_small_pivots_next_to_samples_that_are_not_finite(back_end):
    q = np.full((3, 2), 0.7)
    q[0], q[1] = [0.3, 1e-6], np.nan
    zero, tau = np.zeros_like(q), np.ones_like(q)
    found = graphdyn.joint_accelerations(gimbal(), q, zero, tau, method="recursive", check=False)
    assert np.array_equal(np.isfinite(found).all(axis=-1), [True, False, True])
