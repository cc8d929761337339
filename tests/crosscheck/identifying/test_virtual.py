"""The virtual robot of crosscheck.identify, whose truth is known, and what all methods find of it."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.stats
from identified.identified_arm import NOISE_FLOOR, compared, virtual
from planting import mixed_tree

import urdf
from crosscheck.identifying import friction_terms, virtual_robot
from crosscheck.identifying.results.parameters import base_rows
from crosscheck.identifying.virtual import DRIVE_TORQUE_SHARE, _motion, true_parameters
from crosscheck.recordings import samples_of
from graphdyn import InvalidInput
from graphdyn.identification import TorqueModel
from graphdyn.identification.terms import Coulomb, RigidBodies, Viscous

ALIKE = 1e-10
"""The same torques computed in pieces, relative."""

NEARER = 0.1
"""One percent of noise against CAD values that are wrong by up to twenty."""


class TestVirtualRobot:
    def test_every_method_predicts_down_to_the_noise(self):
        for result in compared().comparison.results:
            assert result.failure is None, result.name
            assert np.all(result.held_out.moving.relative < NOISE_FLOOR), result.name

    def test_truth_is_nearer_than_cad(self):
        found = replace(compared(), truth=virtual().truth)
        rows = base_rows(found, found.comparison.of("consistent"))
        bodies = [row for row in rows if row.unit.startswith("kg")]
        off, wrong = (np.array([getattr(row, name) for row in bodies]) for name in ("error", "cad"))
        true = np.array([row.truth for row in bodies])
        assert np.linalg.norm(off) < NEARER * np.linalg.norm(wrong - true)
        assert all(row.error == pytest.approx(row.value - row.truth) for row in rows)

    def test_motion_stays_within_its_limits(self):
        robot = urdf.load("ur5")
        arm = virtual_robot(robot, (), seconds=10.0)
        for recording in (arm.fitted, arm.held_out):
            v = np.abs(np.diff(recording.q, axis=0)).max(axis=0) * 250
            for joint, q, speed in zip(robot.joints, recording.q.T, v, strict=True):
                assert joint.limits.lower <= q.min() <= q.max() <= joint.limits.upper, joint.name
                assert speed < joint.limits.velocity, joint.name
        assert not np.allclose(virtual().fitted.q[: len(virtual().held_out.t)], virtual().held_out.q, atol=0.01)

    def test_torques_of_drives_have_half_to_one_and_a_half_times_their_size(self):
        """By draws: their root mean squares, as parts of that of their joint's torque, are spread evenly."""
        model = TorqueModel(mixed_tree(), (RigidBodies(), Viscous(), Coulomb()))
        rng = np.random.default_rng(0)
        motion = _motion(model.model, rng, 10.0)
        (samples,) = samples_of(motion)
        (few,) = samples_of(motion.take(slice(None, None, 2)))
        columns, tau = model.rows(few), np.sqrt(np.mean(samples.tau**2, axis=0))
        drives = slice(10 * model.model.n_bodies, None)
        shares = []
        for _ in range(60):
            x = true_parameters(model, samples, rng)
            assert np.array_equal(x[: drives.start], model.prior()[: drives.start])
            sizes = np.sqrt(np.mean((columns * x)[..., drives] ** 2, axis=0))
            shares += list((sizes / tau[:, None]).max(axis=0) / DRIVE_TORQUE_SHARE)
        assert scipy.stats.kstest(shares, scipy.stats.uniform(0.5, 1.0).cdf).pvalue > 0.01

    def test_same_seed_same_numbers(self):
        again = virtual_robot(mixed_tree(), friction_terms(["viscous", "coulomb"], width=0.05), seconds=10.0)
        other = virtual_robot(mixed_tree(), friction_terms(["viscous", "coulomb"], width=0.05), seconds=10.0, seed=1)
        assert np.array_equal(again.fitted.tau, virtual().fitted.tau)
        assert not np.array_equal(other.fitted.tau, virtual().fitted.tau)

    def test_refusals(self):
        with pytest.raises(InvalidInput, match="5 s are less than one period of the excitation; give 10 or more"):
            virtual_robot(mixed_tree(), (), seconds=5.0)
        with pytest.raises(InvalidInput, match="has no mass: there is nothing to identify"):
            virtual_robot(mixed_tree().skeleton, ())

    def test_friction_with_memory_does_not_forget(self, monkeypatch):
        """The regressor in memory at once is a matter of memory alone."""
        at_once = virtual_robot(mixed_tree(), friction_terms(["slip"]), seconds=10.0).fitted
        monkeypatch.setattr("crosscheck.identifying.virtual.ROWS_PER_PIECE", 100)
        in_pieces = virtual_robot(mixed_tree(), friction_terms(["slip"]), seconds=10.0).fitted
        assert np.allclose(in_pieces.tau, at_once.tau, rtol=0, atol=ALIKE * np.abs(at_once.tau).max())
