"""Values that are held although the robot moves: dead and clipped channels, repeated rows; standstill is none."""

import numpy as np
import pytest

from graphdyn.identification.data_quality import held_values

ROWS = 1000


def recorded():
    """Two joints in motion, with noise in the last digits."""
    rng, t = np.random.default_rng(0), np.linspace(0, 10, ROWS)
    q = np.stack([np.sin(t), 0.5 * np.cos(1.3 * t)], axis=1) + 1e-6 * rng.normal(size=(ROWS, 2))
    return q, 10 * q + rng.normal(size=(ROWS, 2))


def test_nothing_in_a_clean_recording():
    found = held_values(*recorded())
    assert not found.dead_torques.any()
    assert not found.dead_positions.any()
    assert not found.clipped_positions.any()
    assert found.measured.all()


def test_a_dead_torque():
    q, tau = recorded()
    tau[300:500, 1] = tau[300, 1]
    assert held_values(q, tau).dead_torques.mean(axis=0) == pytest.approx([0, 0.2], abs=0.002)


def test_a_torque_that_is_zero_for_a_part():
    q, tau = recorded()
    tau = np.abs(tau) + 5
    tau[600:, 0] = 0.0
    assert held_values(q, tau).dead_torques.mean(axis=0) == pytest.approx([0.4, 0], abs=0.002)


def test_a_clipped_torque_is_not_dead():
    q, tau = recorded()
    assert not held_values(q, np.clip(10 * q, -5, 5) + 0 * tau).dead_torques.any()


def test_a_dead_position():
    q, tau = recorded()
    q[250:400, 0] = q[250, 0]
    found = held_values(q, tau)
    assert found.dead_positions.mean(axis=0) == pytest.approx([0.15, 0], abs=0.002)


def test_a_clipped_position():
    q, tau = recorded()
    q[:, 0] = np.minimum(q[:, 0], 0.8)
    found = held_values(q, tau)
    assert found.clipped_positions[:, 0] == pytest.approx(np.isclose(q[:, 0], 0.8))
    assert not found.clipped_positions[:, 1].any()


def test_a_position_that_stops_at_its_largest_and_jumps_back_is_dead():
    q, tau = recorded()
    top = int(np.argmax(q[:, 0]))
    q[top : top + 150, 0] = q[top, 0]
    found = held_values(q, tau)
    assert found.dead_positions.mean(axis=0) == pytest.approx([0.15, 0], abs=0.002)
    assert not found.clipped_positions.any()


def test_a_joint_that_comes_to_rest_is_none():
    """It slows down before, and its position then does not change."""
    t = np.linspace(0, 10, ROWS)
    smooth = np.where(t < 5, 1 - np.cos(np.pi * np.minimum(t, 5) / 5), 2.0)
    _, tau = recorded()
    found = held_values(np.stack([smooth, np.sin(t)], axis=1), tau)
    assert not found.dead_positions.any()
    assert not found.clipped_positions.any()


def test_velocities_tell_that_a_position_is_dead():
    q, tau = recorded()
    v = np.gradient(q, axis=0)
    q[100:300, 1] = q[99, 1] + np.linspace(0, 1e-9, 200)[0]
    assert held_values(q, tau, v).dead_positions[:, 1].mean() > 0.15


def test_missing_rows():
    """Both joints jump at once; one alone may be a sensor, and a stop or a start is no jump."""
    q, tau = recorded()
    left = np.r_[0:300, 320:700, 712:ROWS]
    assert held_values(q[left], tau[left]).gaps.tolist() == [299, 679]
    q[500:, 0] += 0.5
    assert not held_values(q, tau).gaps.size
    stopped = np.where(np.arange(ROWS)[:, None] < 400, q, q[400])
    assert not held_values(stopped, tau).gaps.size


def test_a_torque_in_coarse_steps_is_not_dead():
    q, tau = recorded()
    assert not held_values(q, 10 * np.round(tau / 10)).dead_torques.any()


def test_repeated_rows():
    q, tau = recorded()
    doubled = held_values(np.repeat(q, 2, axis=0), np.repeat(tau, 2, axis=0))
    assert doubled.repeated.mean() > 0.4
    order = np.r_[0:500, 300:500, 500:ROWS]
    assert held_values(q[order], tau[order]).repeated.mean() == pytest.approx(200 / 1200, abs=0.02)
