"""What identification says of its own accuracy: no bias by filters, on simulated robots whose parameters are known."""

from dataclasses import replace

import numpy as np
import pytest
from planting import mixed_tree

import crosscheck
from crosscheck.identifying import LastPart, Preparation, friction_terms, virtual_robot
from graphdyn.identification.terms import KnownTorque, RigidBodies, UserColumns

UNBIASED = 1e-3
"""Relative error of a parameter without noise, where the torque is filtered and its regressor with it; measured 7e-4,
from the rows in which the filtered velocity changes its sign elsewhere. Filtering the torque alone leaves 5e-2."""


def detent(q, v, a):
    """(N, n) A torque that jumps, as cogging does."""
    return np.sign(np.sin(6 * q))


@pytest.mark.parametrize(
    "preparation",
    [Preparation(6.0), Preparation("residual"), Preparation(None, decimate=(10,)), Preparation(12.0, decimate=(5, 4))],
    ids=["low-pass", "residual analysis", "decimation", "both"],
)
def test_filters_do_not_bias(preparation, monkeypatch):
    """Friction, a column of the user's own and a known torque, none of them smooth."""
    monkeypatch.setattr("crosscheck.identifying.virtual.TORQUE_NOISE", 0.0)
    monkeypatch.setattr("crosscheck.identifying.virtual.ENCODER", 0.0)
    cogging = UserColumns(lambda q, v, a: detent(q, v, a)[:, :, None] * np.eye(3)[0][:, None], ["C"], ["N m"])
    drives = (*friction_terms(["viscous", "coulomb", "offset"]), cogging)
    arm = virtual_robot(mixed_tree(), drives, seconds=10.0)
    known = KnownTorque(lambda q, v, a: 5.0 * detent(q, v, a) * [0, 1, 1])
    measured = replace(arm.fitted, tau=arm.fitted.tau + 5.0 * detent(arm.fitted.q, None, None) * [0, 1, 1])
    found = crosscheck.identify(
        arm.subject.model,
        measured,
        terms=(RigidBodies(), *drives),
        known=[known],
        methods=["ols", "wls"],
        preparation=preparation,
        held_out=LastPart(0.2),
        poses=1,
    )
    truth = found.problem.base.values(arm.truth)
    drive = [k for k, name in enumerate(found.comparison.base_names) if name.startswith(("FV", "FC", "OFF", "C"))]
    assert len(drive) == 10
    for result in found.comparison.results:
        print(result.name, np.abs(result.base_values / truth - 1)[drive])
        assert np.all(np.abs(result.base_values / truth - 1)[drive] < UNBIASED), result.name
