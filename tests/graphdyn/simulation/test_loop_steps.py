"""Compiled steps of robots with loops: against the same in Python, against laws of mechanics, and what Python takes."""

from dataclasses import replace

import numpy as np
import pytest
from long_check import few
from random_trees import random_wrenches
from robots.loop_motions import G, held_palletizer
from robots.mechanisms import andrews, at, bricard, four_bar, hinge, n_four_bar, rod
from scipy.integrate import solve_ivp
from shared_data import DATA, existing

import graphdyn
import urdf
from graphdyn import (
    Chord,
    Coupling,
    Event,
    Friction,
    InvalidInput,
    Joint,
    JointLimits,
    JointStops,
    MeasurementNoise,
    PDControl,
    RobotModel,
    rollout,
    simulate,
)
from graphdyn.motion_laws import ConstantAcceleration, FourierSeries, Rail, Turntable
from graphdyn.simulation import many_robots
from graphdyn.simulation.equations import LoopEquations
from graphdyn.simulation.integration import compiled, fixed, loop_adaptive
from graphdyn.simulation.loop_rows import LoopRows, loop_rows
from graphdyn.simulation.plant import make_plant

ROUNDING = 1e-12
"""Of compiled steps against Python, relative to the largest number of a column; measured 3e-14 (loop_size5)."""

CRANK = four_bar()
CRANK_START = graphdyn.assemble(CRANK, [0.7, 0.0, 1.0], [1.0, 0, 0], hold=["a"])
SLIDE = Joint("slide", "prismatic", 2, at(2.0), np.array([1.0, 0.0, 0.0]))


def with_chord(chord: Chord, *more: Joint) -> RobotModel:
    """The open four-bar with another chord, and further rods."""
    rods = tuple(rod(f"rod {joint.name}", 0.3) for joint in more)
    return replace(CRANK, bodies=CRANK.bodies + rods, joints=CRANK.joints + more, chords=(chord,))


MECHANISMS = {
    "hinge": CRANK,
    "ball": with_chord(Chord("closing", "ball", 2, at(2.0), 3, at(1.5))),
    "distance": with_chord(Chord("closing", "distance", 2, at(2.0), 0, at(2.0, 1.0), length=0.8)),
    "weld": with_chord(Chord("closing", "weld", 4, at(0.2), 3, at(1.5)), hinge("d", 2, (2, 0, 0))),
    "slide": with_chord(Chord("closing", "slide", 4, at(0.1), 3, at(0.4), axis=(1.0, 0, 0)), hinge("d", 2, (2, 0, 0))),
    "prismatic joint": with_chord(Chord("closing", "hinge", 4, at(0.2), 3, at(1.5)), SLIDE),
    "couplings": replace(
        with_chord(CRANK.chords[0], hinge("d", 1, (1, 0, 0)), hinge("e", 4, (0.3, 0, 0))),
        couplings=(Coupling("d", {"b": 0.5, "a": -1.0}, 0.2), Coupling("e", {"d": 2.0})),
    ),
    "redundant rows": bricard(),
    "two loops": n_four_bar(2),
}


def in_python(monkeypatch, function, *arguments, **keywords):
    """What a simulation gives without compiled steps."""
    with monkeypatch.context() as without:
        for module in (fixed, many_robots):
            without.setattr(module, "can_compile", lambda plant: False)
        return function(*arguments, **keywords)


def agree(here, there, rounding=ROUNDING):
    for name in ("q", "v", "a", "tau", "passive"):
        one, other = getattr(here, name), getattr(there, name)
        assert one.shape == other.shape, name
        assert np.abs(one - other).max() <= rounding * max(np.abs(other).max(), 1e-300), name


@pytest.fixture
def lost(monkeypatch):
    """The times of the steps that compiled code has left undone."""
    times, taken = [], compiled.LostSteps.taken

    def counted(self, run, t, *more):
        times.append(t)
        return taken(self, run, t, *more)

    monkeypatch.setattr(compiled.LostSteps, "taken", counted)
    return times


def moving(model, seed=0):
    """A closed state near a regular pose."""
    rate = np.random.default_rng(seed).normal(size=model.nv)
    return LoopEquations(make_plant(model)).started(model.regular_pose, rate)


@pytest.mark.parametrize("name", MECHANISMS)
def test_compiled_steps_agree_with_python(name, monkeypatch, lost):
    model = MECHANISMS[name]
    settings = {"torque": np.linspace(-1, 1, model.nv), "method": "rk4", "step": 5e-3, "friction": Friction(0.1)}
    here = simulate(model, *moving(model), 0.06, **settings)
    assert not lost
    agree(here, in_python(monkeypatch, simulate, model, *moving(model), 0.06, **settings))
    assert here.closure_error().max() < 1e-14


@pytest.mark.parametrize(
    "chord",
    [Chord("closing", "hinge", 2, at(2.0), 0, at(2.2)), Chord("closing", "hinge", 1, at(0.0), 0, at(0.0))],
    ids=["all", "nothing"],
)
def test_a_chord_that_holds_all_or_nothing(chord, monkeypatch, lost):
    """A triangle stands still, and a second hinge beside the first changes nothing."""
    model = replace(CRANK, bodies=CRANK.bodies[:2], joints=CRANK.joints[:2], chords=(chord,))
    start = (model.closed_pose, np.zeros(2))
    motion = simulate(model, *start, 0.05, method="rk4", step=1e-2)
    agree(motion, in_python(monkeypatch, simulate, model, *start, 0.05, method="rk4", step=1e-2))
    assert not lost
    free = simulate(model.opened, *start, 0.05, method="rk4", step=1e-2)
    expected = start[0] if chord.body_i == 2 else free.q[-1]
    assert np.abs(motion.q[-1] - expected).max() < 1e-14


@pytest.mark.parametrize("name", MECHANISMS)
def test_compiled_rows_are_those_of_the_loops(name):
    """But for rows that nothing moves; gaps where they are small, with their signs."""
    model, plain = MECHANISMS[name], LoopRows(MECHANISMS[name].loops)
    q, v = moving(model)
    there, here = plain.at(q, v), loop_rows(model).at(q, v)
    moves = np.abs(there.jacobian).max(axis=1) > 1e-9
    assert here.jacobian == pytest.approx(there.jacobian[moves], abs=1e-14)
    assert here.bias == pytest.approx(there.bias[moves], abs=1e-13)
    opened = q + 1e-4 * np.cos(np.arange(model.nv))
    there, here = plain.at(opened, v), loop_rows(model).at(opened, v)
    assert np.abs(there.gaps).max() > 2e-5
    assert here.gaps == pytest.approx(there.gaps[moves], abs=1e-7)  # of a distance, to second order


def test_a_flipped_end_is_open():
    model, turn = MECHANISMS["weld"], np.array([0, 0, 0, np.pi])
    assert np.isinf(loop_rows(model).at(model.regular_pose + turn, np.zeros(4)).gaps).all()


PUBLISHED = ["four_bar", "six_bar", "planar_leg_linkage", "loop_size5", "5bar", "delta", "andrews"]


@pytest.mark.parametrize("name", few(PUBLISHED, "5bar"))
def test_published_mechanisms_agree_with_python(name, monkeypatch, lost):
    folder = existing(DATA / "loops")
    file = {"5bar": "epr/5bar_linkage/robot.urdf", "delta": "epr/robot_delta/robot.urdf"}.get(name)
    model = andrews(DATA)[0] if name == "andrews" else urdf.load(folder / (file or f"urdfplus/{name}.urdf"))
    # light parts: as long as gravity moves them, and no longer
    rate, step = (0.0, 1e-5) if name in ("5bar", "delta", "andrews") else (1.0, 2e-3)
    q, v = moving(model)
    settings = {"torque": np.full(model.nv, 1e-3), "method": "rk4", "step": step}
    here = simulate(model, q, rate * v, 8 * step, **settings)
    assert not lost
    # masses that differ by a factor of a million
    rounding = 1e-9 if name in ("5bar", "delta") else ROUNDING
    agree(here, in_python(monkeypatch, simulate, model, q, rate * v, 8 * step, **settings), rounding)


def test_the_palletizer_holds_its_closed_form(lost):
    """Four thousand steps under control: all joints follow from four, and the energy is that of the motors."""
    existing(DATA / "loops")
    motion, apart = held_palletizer(4.0, method="rk4", step=1e-3)
    assert not lost
    assert apart < 1e-14
    assert motion.closure_error().max() < 1e-14
    assert motion.energy.drift < 1e-10  # measured 3e-12


def test_a_crank_turns_without_end(lost):
    """Through eighteen turns the energy stays, and gravity alone brings the crank back to the same speed."""
    model = four_bar(1.0, 3.0, 2.5, 3.0)
    start = graphdyn.assemble(model, [0.0, 0.8, 1.9], [12.0, 0, 0], hold=["a"])
    motion = simulate(model, *start, 10.0, method="rk8", step=2e-3)
    assert not lost
    assert motion.q[-1, 0] > 18 * 2 * np.pi
    assert motion.energy.drift < 1e-11
    turns = np.arange(1, 18) * 2 * np.pi
    speeds = np.interp(turns, motion.q[:, 0] - motion.q[0, 0], motion.v[:, 0])
    assert speeds == pytest.approx(motion.v[0, 0], rel=1e-3)  # between rows, as straight lines


STOPPED = replace(CRANK, joints=(replace(CRANK.joints[0], limits=JointLimits(0.6, 0.72)), *CRANK.joints[1:]))
HOLDING = PDControl([50.0, 0, 0], [[10.0, 0, 0], [20.0, 0, 0], [5.0, 0, 0]], CRANK_START[0], period=0.01)
RNG = np.random.default_rng(5)
OPTIONS = {
    "torques": {"controls": RNG.normal(size=(3, 4, 3)), "period": 0.01},
    "control": {"controls": HOLDING, "noise": MeasurementNoise(1e-3, 1e-2), "seed": 3, "torque_limits": 3.0},
    "drives": {"friction": Friction([[1.0], [2.0], [3.0]]), "rotor_inertia": 0.3},
    "stops": {"model": STOPPED, "limits": JointStops(1e3, [[1.0], [2.0], [3.0]])},
    "wrenches": {"external_wrenches": random_wrenches(CRANK, 1, (3,))},
    "parameters": {"parameters": CRANK.inertial_parameters * RNG.uniform(0.9, 1.1, size=(3, 30))},
    "base": {"base": [Rail((1, 0, 0), ConstantAcceleration(2.0)), Turntable((0, 0, 1), FourierSeries(1, [1], [1]))]},
}


@pytest.mark.parametrize("case", OPTIONS)
def test_rollouts_agree_with_python(case, monkeypatch, lost):
    q, v = CRANK_START
    settings = {"model": CRANK, "q": q, "v": np.outer([1, 2, -1], v), "step": 5e-3, **OPTIONS[case]}
    if "period" not in settings:
        settings["duration"] = 0.04
    many = rollout(**settings)
    assert not lost
    assert many.q.shape == (3, 9, 3)
    agree(many, in_python(monkeypatch, rollout, **settings))


def test_a_rollout_of_loops_is_a_simulation():
    q, v = CRANK_START
    runs = rollout(CRANK, [q, q + np.array([0, 1e-9, 0])], [v, 2 * v], step=5e-3, duration=0.1, every=2)
    for run, rate in enumerate((1, 2)):
        one = simulate(CRANK, q, rate * v, 0.1, method="rk4", step=5e-3)
        for name in ("q", "v", "a", "tau", "passive"):
            assert np.abs(getattr(runs, name)[run] - getattr(one, name)[::2]).max() < 1e-7
    assert np.abs(CRANK.loops.gaps(runs.q)).max() < 1e-14  # the start that was open by less than counts, too


def test_singular_poses_are_left_to_python(lost):
    """One of three runs passes a singular pose, as the pendulum that it is, and the others do not notice."""
    model, signs = MECHANISMS["two loops"], np.array([1.0, 1, 1, -1, -1])
    angles, rates = np.array([0.6, 0.8, 1.3]), np.array([-12.0, 0, 1])
    settings = {"method": "rk8", "step": 1e-2}
    runs = rollout(model, np.outer(angles, signs), np.outer(rates, signs), duration=0.1, **settings)
    assert 0 < len(lost) < 8
    for run in range(3):
        pendulum = solve_ivp(
            lambda t, y: (y[1], -3.5 * G * np.cos(y[0]) / 3),
            (0, 0.1),
            (angles[run], rates[run]),
            rtol=1e-12,
            atol=1e-12,
        )
        assert np.abs(runs.q[run, -1] - pendulum.y[0, -1] * signs).max() < 1e-8
    motion = simulate(model, angles[0] * signs, rates[0] * signs, 0.1, **settings)
    assert np.array_equal(runs.q[0], motion.q)
    for run in (1, 2):
        alone = rollout(model, angles[run] * signs, rates[run] * signs, duration=0.1, **settings)
        assert np.array_equal(runs.q[run], alone.q[0])


@pytest.mark.parametrize("compiled_steps", [True, False], ids=["compiled", "Python"])
def test_runs_whose_loops_come_apart_are_nan(compiled_steps, monkeypatch, lost):
    q, v = CRANK_START
    torques = np.zeros((3, 4, 3))
    torques[1] = [1e7, 0, 0]
    simulated = rollout if compiled_steps else lambda *a, **k: in_python(monkeypatch, rollout, *a, **k)
    runs = simulated(CRANK, q, v, torques, step=5e-3)
    clean = simulated(CRANK, q, v, torques[0], step=5e-3)
    assert np.isfinite(runs.q[1, 0]).all()
    assert np.isnan(runs.q[1, -1]).all()
    assert np.array_equal(runs.q[[0, 2]], np.broadcast_to(clean.q, (2, *clean.q.shape[1:])))
    assert len(lost) == compiled_steps  # what is lost is not tried again


def test_rollouts_refuse_open_and_singular_starts():
    with pytest.raises(graphdyn.InconsistentState, match=r"the loop of chord 'closing' is open by .* in row 1"):
        rollout(CRANK, [CRANK_START[0], [0.0, 0.5, 0.0]], np.zeros(3), step=0.1, duration=1.0)
    with pytest.raises(InvalidInput, match=r"'n-four-bar' starts in a singular pose of its loops"):
        rollout(MECHANISMS["two loops"], np.zeros(5), np.zeros(5), step=0.1, duration=1.0)


def test_limits_and_events_within_compiled_steps(lost):
    """Both are found where the motion, simulated to that very time, has them."""
    limit, middle = 0.72, 0.715
    passing = Event(lambda t, q, v: q[0] - middle, "middle", stop=False)
    motion = simulate(STOPPED, *CRANK_START, 1.0, limits="stop", events=passing, method="rk4", step=1e-2)
    assert not lost
    assert motion.ended == "upper limit of joint 'a'"
    assert motion.q[-1, 0] == pytest.approx(limit, abs=1e-13)
    assert motion.occurrences[0].q[0] == pytest.approx(middle, abs=1e-13)
    again = simulate(CRANK, *CRANK_START, float(motion.time[-1]), rtol=1e-12, atol=1e-12)
    assert np.abs(again.q[-1] - motion.q[-1]).max() < 1e-8


SWAYING = [Rail((1, 0, 0), FourierSeries(1, [0.1], [0.2]))]


@pytest.mark.parametrize(
    "more",
    [{"torque": PDControl([50.0, 0, 0], [10.0, 0, 0], CRANK_START[0], period=0.01)}, {"base": SWAYING}],
    ids=["control", "constant torque, base"],
)
def test_steps_that_adapt_agree_with_python(more, monkeypatch):
    """Compiled from the third on, with the same rows and events."""
    passing = Event(lambda t, q, v: q[0] - 0.715, "passing", stop=False)
    settings = {"friction": Friction(0.1), "events": passing, "at": np.linspace(0, 0.1, 9), **more}
    numbers, compiled_steps = [], loop_adaptive.single_steps

    def counted(*arguments):
        steps = compiled_steps(*arguments)
        return lambda *state: numbers.append(1) or steps(*state)

    monkeypatch.setattr(loop_adaptive, "single_steps", counted)
    there = simulate(CRANK, *CRANK_START, 0.1, **settings)
    assert not numbers  # too few steps to be worth compiling
    monkeypatch.setattr(loop_adaptive, "PYTHON_STEPS", 3)
    here = simulate(CRANK, *CRANK_START, 0.1, **settings)
    assert numbers
    agree(here, there)
    assert here.occurrences[0].time == pytest.approx(there.occurrences[0].time, rel=1e-12)
