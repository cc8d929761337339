"""Sine and cosine of the compiled code, against fifty digits."""

from unittest import mock

import mpmath
import numpy as np
import pytest
from back_ends import BACK_ENDS, COMPILED, on
from long_check import few
from random_trees import NAMED

import graphdyn
from graphdyn import Body, Joint, Placement, RobotModel
from graphdyn.compiler import native
from graphdyn.compiler.interpreter import Interpreter
from graphdyn.compiler.llvm.precision import DOUBLE, SINGLE
from graphdyn.compiler.native import CompiledProgram, host_lanes
from graphdyn.compiler.programs import pivot_scales
from graphdyn.compiler.running import turned_back
from graphdyn.scalars.expressions import Recorder

ULPS = {100.0: 1.5, DOUBLE.max_angle: 2.5}
"""Largest error in units in the last place of the value, by largest angle: the angle is rounded once or twice as it is
brought to [-π/4, π/4], where its unit may be twice that of its sine, and the value once more. Measured 1.37 and 2.26
over 200 000 angles."""

SINGLE_ULPS = 2.0
"""The same in single precision, up to its largest angle: measured 1.54 at every third number."""

TURNED = 1e-13
"""Of torques at an angle beyond max_angle, which is brought back by whole turns and rounded once more, relative to the
largest wrench: measured 8e-16."""

mpmath.mp.dps = 50


def angles(farthest=DOUBLE.max_angle):
    """Random ones, tiny ones, and the multiples of π/4 and π/2 with their neighbors."""
    rng = np.random.default_rng(0)
    most = int(farthest / (np.pi / 2))
    turns = np.concatenate([np.arange(-40, 41), rng.integers(-most, most, 400), [most, -most]]).tolist()
    corners = np.array([float(k * mpmath.pi / part) for k in turns for part in (2, 4)])
    neighbors = [corners, np.nextafter(corners, np.inf), np.nextafter(corners, -np.inf)]
    tiny = rng.uniform(-1, 1, 500) * 10.0 ** rng.uniform(-320, 0, 500)
    everything = np.concatenate([*neighbors, tiny, rng.uniform(-farthest, farthest, 2000), [0.0, farthest]])
    return everything[np.abs(everything) <= farthest]


def compiled(q, lanes):
    recorder = Recorder()
    (x,) = recorder.inputs("q", 1)
    program = recorder.program({"turned": [x.sine, x.cosine]}, {})
    result = np.empty((len(q), 2))
    CompiledProgram(program, lanes).bind({"q": q[:, None].copy()}, {"turned": result})(0, len(q))
    return result.T


def error_in_ulps(found, exact):
    """|found - exact| in units in the last place of the exact value."""
    return max(
        float(abs(mpmath.mpf(x) - y) / mpmath.mpf(float(np.spacing(abs(float(y))))))
        for x, y in zip(found.tolist(), exact, strict=True)
    )


@pytest.mark.parametrize("farthest", ULPS)
@pytest.mark.parametrize("lanes", [2, 4, 8])
def test_error_in_units_in_the_last_place(lanes, farthest):
    q = angles(farthest)
    sine, cosine = compiled(q, lanes)
    exact = [mpmath.mpf(x) for x in q.tolist()]
    assert error_in_ulps(sine, [mpmath.sin(x) for x in exact]) <= ULPS[farthest]
    assert error_in_ulps(cosine, [mpmath.cos(x) for x in exact]) <= ULPS[farthest]
    assert np.abs([sine, cosine]).max() <= 1.0


@pytest.mark.parametrize("lanes", few((4, 8, 16), 16))
def test_error_in_single_precision(lanes):
    """Against double precision, whose error is nothing beside it: random angles, those of every size, quarter turns and
    their neighbors."""
    rng, most = np.random.default_rng(0), SINGLE.max_angle
    sizes = rng.uniform(-1, 1, 20_000) * 10.0 ** rng.uniform(-44, np.log10(most), 20_000)
    corners = (np.arange(int(most / (np.pi / 4))) * (np.pi / 4)).astype(np.float32)
    neighbors = [np.nextafter(corners, np.float32(way)) for way in (-np.inf, np.inf)]
    q = np.concatenate([sizes.astype(np.float32), corners, *neighbors, [-most, most]]).astype(np.float32)
    recorder = Recorder()
    (x,) = recorder.inputs("q", 1)
    program, found = recorder.program({"turned": [x.sine, x.cosine]}, {}), np.empty((len(q), 2), np.float32)
    with mock.patch.object(native, "host_lanes", return_value=lanes // 2):
        CompiledProgram(program, precision=SINGLE).bind({"q": q[:, None]}, {"turned": found})(0, len(q))
    exact = np.stack([np.sin(q.astype(float)), np.cos(q.astype(float))], axis=1)
    assert (np.abs(found - exact) / np.spacing(np.abs(exact).astype(np.float32))).max() <= SINGLE_ULPS
    assert np.abs(found).max() <= 1.0


def test_sine_is_odd_and_cosine_even_bit_for_bit():
    q = angles()
    sine, cosine = compiled(q, host_lanes())
    mirrored = compiled(-q, host_lanes())
    assert np.array_equal(mirrored[0], -sine)
    assert np.array_equal(mirrored[1], cosine)


def test_what_is_not_finite_has_no_sine():
    q = np.array([0.5, np.nan, np.inf, -np.inf, 0.5])
    for value in compiled(q, host_lanes()):
        assert np.array_equal(np.isnan(value), [False, True, True, True, False])


@pytest.mark.parametrize("back_end", ["numpy", *COMPILED])
@pytest.mark.parametrize("angle", [1.0000001e6, -3e8, 1e17, 1e300, -1.7976931348623157e308])
def test_angles_beyond_the_reduction_are_brought_back_first(back_end, angle):
    """As good as the sine and cosine of NumPy; slides are not turned back, other samples not touched."""
    model = NAMED["mixed_chain"]
    near = np.arctan2(np.sin(angle), np.cos(angle))
    q = np.full((11, 4), 0.3)
    v, a = q + 1, q - 1
    far, back = q.copy(), q.copy()
    far[4, 0], far[6, 2] = angle, angle
    back[4, 0], back[6, 2] = near, near
    slid = q.copy()
    slid[:, 1] = 2e6  # [m]: the second joint slides
    with on(back_end):
        found = graphdyn.inverse_dynamics(model, far, v, a, method="recursive")
        here = graphdyn.inverse_dynamics(model, back, v, a, method="recursive")
        plain = graphdyn.inverse_dynamics(model, q, v, a, method="recursive")
        away = graphdyn.joint_torques(model, slid, v, a, method="recursive")
    exact = graphdyn.inverse_dynamics(model, far, v, a, method="projected")
    size = np.abs(exact.joint_wrenches).max()
    assert np.abs(found.tau - exact.tau).max() < TURNED * size
    assert np.array_equal(found.tau, here.tau)
    others = np.delete(np.arange(11), [4, 6])
    assert np.array_equal(found.joint_wrenches[others], plain.joint_wrenches[others])
    there = graphdyn.inverse_dynamics(model, slid, v, a, method="projected")
    assert np.abs(away - there.tau).max() < TURNED * np.abs(there.joint_wrenches).max()


@pytest.mark.parametrize("back_end", BACK_ENDS)
def test_a_slide_is_not_turned_back(back_end):
    """Positions beyond max_angle on a slide with a turning joint after it: nothing is periodic in meters."""
    slide = Joint("slide", "prismatic", 0, Placement(), [1, 0, 0])
    turn = Joint("turn", "revolute", 1, Placement(np.eye(3), [0, 0.5, 0]), [0, 1, 0])
    bodies = (Body("base_motion", 2.0, [0, 0, 0], np.eye(3)), Body("arm", 1.0, [0.3, 0, 0], np.eye(3)))
    model = RobotModel("crane", bodies, (slide, turn))
    far = np.array([[3e6, 0.3]])
    with on(back_end):
        state = graphdyn.maximal_state(model, far, method="recursive")
    assert state.position[0, 0].tolist() == [3e6, 0.0, 0.0]
    assert turned_back(model, np.array([[3e6, 3e6]]))[0].tolist() == [
        3e6,
        pytest.approx(np.angle(np.exp(3e6j)), abs=1e-9),
    ]


def test_scales_of_pivots():
    """The stretched arm by hand: bodies of 2 kg at 0.3 m and 1 kg at 0.4 m; joint 2 is 0.5 m off and slides 1 m."""
    tensor = np.diag([0.01, 0.02, 0.02])
    bodies = Body("one", 2.0, [0, 0, 0.3], tensor), Body("two", 1.0, [0.4, 0, 0], np.zeros((3, 3)))
    joints = (
        Joint("turn", "revolute", 0, Placement(np.eye(3), [0, 0, 9.0]), [0, 1, 0]),
        Joint("slide", "prismatic", 1, Placement(np.eye(3), [0.5, 0, 0]), [1, 0, 0]),
    )
    turning = 2.0 * 0.3**2 + 0.03 + 1.0 * (0.5 + 1.0 + 0.4) ** 2
    assert pivot_scales(RobotModel("arm", bodies, joints)) == pytest.approx([turning, 1.0])


def test_the_interpreter_has_the_sine_of_numpy():
    recorder = Recorder()
    (x,) = recorder.inputs("q", 1)
    q, result = np.linspace(-9, 9, 101)[:, None].copy(), np.empty((101, 2))
    Interpreter(recorder.program({"turned": [x.sine, x.cosine]}, {})).bind({"q": q}, {"turned": result})(0, 101)
    assert np.array_equal(result, np.hstack([np.sin(q), np.cos(q)]))
