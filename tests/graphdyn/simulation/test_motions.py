"""Motions that are known: closed forms, a reference of eighty bits, laws of mechanics."""

import numpy as np
import pytest
from random_trees import NAMED, random_state
from robots.moving_robots import G, pendulum, slider, swing
from scipy.special import ellipj, ellipk

import graphdyn
from graphdyn import ComputedTorqueControl, kr500, simulate
from graphdyn.motion_laws import FourierSeries, Rail, Turntable

ADAPTIVE = 1e-10
"""Of q and v of the KR500 after 2 s of free swing, DOP853 at its tightest; measured 2e-11. Its motion is chaotic."""

EIGHTH = 3e-11
"""The same with steps of 1 ms of order 8; measured 1.5e-11."""

ELLIPTIC = 1e-11
"""Of a pendulum after two periods; measured 6e-13 with DOP853 at 1e-13, 1e-14 with order 8."""

FOLLOWED = 1e-8
"""Of a prescribed motion from its own torques, at the tolerance of 1e-10; measured 6e-10."""


def test_free_swing_adaptive():
    q, v, after = swing()
    motion = simulate(kr500(), q, v, 2.0, at=[1.0, 2.0], rtol=2.3e-14, atol=1e-14)
    for row, seconds in enumerate((1, 2)):
        found = np.concatenate([motion.q[row], motion.v[row]])
        assert np.abs(found - after[seconds]).max() < ADAPTIVE


def test_free_swing_order_eight():
    q, v, after = swing()
    motion = simulate(kr500(), q, v, 2.0, at=[1.0, 2.0], method="rk8", step=1e-3)
    for row, seconds in enumerate((1, 2)):
        found = np.concatenate([motion.q[row], motion.v[row]])
        assert np.abs(found - after[seconds]).max() < EIGHTH


def elliptic(model, amplitude, times):
    """Angle of the pendulum released from rest (Whittaker, Analytical Dynamics, section 44), [rad]."""
    length = -model.bodies[0].center_of_mass[2]
    omega, k = np.sqrt(G / length), np.sin(amplitude / 2)
    sn, *_ = ellipj(ellipk(k**2) - omega * times, k**2)
    return 2 * np.arcsin(k * sn)


@pytest.mark.parametrize(
    "settings", [{"rtol": 1e-13, "atol": 1e-13}, {"method": "rk8", "step": 0.005}], ids=["dop853", "rk8"]
)
def test_pendulum_in_closed_form(settings):
    model, amplitude, times = pendulum(), 2.5, np.linspace(0.0, 4.0, 41)
    motion = simulate(model, [amplitude], [0.0], 4.0, at=times, **settings)
    assert np.abs(motion.q[:, 0] - elliptic(model, amplitude, times)).max() < ELLIPTIC


@pytest.mark.parametrize(("method", "order", "step"), [("euler", 1, 1e-3), ("rk4", 4, 0.02), ("rk8", 8, 0.1)])
def test_orders(method, order, step):
    """Half the step divides the error by 2 to the order."""
    model, times = pendulum(), np.linspace(0.0, 2.0, 21)
    exact = elliptic(model, 1.5, times)
    errors = [
        np.abs(simulate(model, [1.5], [0.0], 2.0, at=times, method=method, step=width).q[:, 0] - exact).max()
        for width in (step, step / 2)
    ]
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.3)  # measured 1.00, 4.0, 8.2


@pytest.mark.parametrize("name", NAMED)
def test_energy_is_kept(name):
    """Without friction, on trees with revolute and prismatic joints."""
    model = NAMED[name]
    q, v, _ = random_state(model, 3)
    motion = simulate(model, q, v, 0.2, rtol=1e-12, atol=1e-12)
    assert motion.energy.drift < 1e-10  # measured 6e-12


def test_energy_over_many_steps():
    motion = simulate(kr500(), [0.2, 0.5, -0.3, 0.4, 0.6, -0.2], np.zeros(6), 20.0, method="rk8", step=1e-3)
    assert motion.energy.drift < 1e-11  # measured 4e-14; 10⁶ steps: docs/simulation.md


def test_prescribed_motion_from_its_torques():
    """The torques that graphdyn.simulate_recording finds on rails and a turntable give the motion back."""
    model = NAMED["branched"]
    laws = [FourierSeries(0.5, [0.4, 0.1], [0.2, -0.1], 0.1 * j) for j in range(model.n_bodies)]
    base = [
        Rail((1.0, 2.0, 0.0), FourierSeries(0.4, [0.3], [0.1])),
        Turntable((0.0, 0.0, 1.0), FourierSeries(0.6, [0.2], [0.3])),
    ]

    def torque(t, q, v):
        recorded = graphdyn.simulate_recording(model, [t], laws, base=base)
        return recorded.tau[0]

    times = np.linspace(0.0, 0.3, 4)
    wanted = graphdyn.simulate_recording(model, times, laws, base=base)
    motion = simulate(model, wanted.q[0], wanted.v[0], 0.3, torque=torque, base=base, at=times)
    assert np.abs(motion.q - wanted.q).max() < FOLLOWED
    assert np.abs(motion.v - wanted.v).max() < FOLLOWED
    fixed = simulate(model, wanted.q[0], wanted.v[0], 0.3, torque=torque, base=base, at=times, method="rk8", step=0.05)
    assert np.abs(fixed.q - wanted.q).max() < FOLLOWED
    shown, recorded = motion.recording(), wanted
    for channel in ("acceleration", "joint_forces", "angular_velocity"):
        size = np.abs(getattr(recorded, channel)).max()
        assert np.abs(getattr(shown, channel) - getattr(recorded, channel)).max() < 1e-6 * size  # measured 1e-8


def test_computed_torque_is_an_oscillator():
    """Every joint decays as (1 + ω t) e^{-ω t}, whatever the robot."""
    model, omega, offset = kr500(), 6.0, 0.3
    target = np.linspace(-0.5, 0.5, 6)
    controller = ComputedTorqueControl(omega**2, 2 * omega, target)
    times = np.linspace(0.0, 1.0, 11)
    motion = simulate(model, target + offset, np.zeros(6), 1.0, torque=controller, at=times)
    expected = offset * (1 + omega * times) * np.exp(-omega * times)
    assert np.abs(motion.q - target - expected[:, None]).max() < 1e-8  # measured 5e-11


def test_external_wrench_carries_the_weight():
    model = slider(direction=(0.0, 0.0, 1.0))
    lifted = simulate(model, [0.1], [0.0], 1.0, external_wrenches=[[0.0, 0.0, 2.0 * G, 0.0, 0.0, 0.0]])
    assert np.abs(lifted.q - 0.1).max() < 1e-15
    pushed = simulate(model, [0.0], [0.0], 1.0, external_wrenches=lambda t, q, v: [[0, 0, 2 * G + 6 * t, 0, 0, 0]])
    assert pushed.q[-1, 0] == pytest.approx(0.5, rel=1e-9)  # m z̈ = 6 t


def test_rotor_inertia_slows():
    force, mass, rotor = 3.0, 2.0, 4.0
    motion = simulate(slider(mass=mass), [0.0], [0.0], 2.0, torque=[force], rotor_inertia=rotor)
    assert motion.q[-1, 0] == pytest.approx(force / (mass + rotor) * 2.0, rel=1e-12)
    assert motion.energy.drift < 1e-12
    assert motion.reactions.tau[0, 0] == pytest.approx(force * mass / (mass + rotor), rel=1e-12)
