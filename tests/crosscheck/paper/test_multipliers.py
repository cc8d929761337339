"""Section 3.2 of the paper: the printed multipliers reproduced, and the corrected ones beside rnea."""

import numpy as np
import pytest

from crosscheck.paper.multipliers import INSTANT, corrected_multipliers, printed_multipliers, printed_rank
from crosscheck.paper.tables import joint_motion, rail
from graphdyn import inverse_dynamics, kr500

SIX_DIGITS = 1e-6
"""The paper prints seven digits of numbers that it rounded before."""

AGAINST_PINOCCHIO = 1e-12
"""Of the multipliers against rnea; measured 7e-16."""

PRINTED_FORCES = (-1.136554e5, -5.086735e4, -2.393758e4, -1.230526e4, -9.277012e3, -6.489101e3)
"""λ_i3 of Eq. (113)-(118), that of B_3 with the sign of the others (docs/deviations.md, B6)."""


@pytest.fixture(scope="module")
def printed():
    return printed_multipliers()


@pytest.fixture(scope="module")
def corrected():
    return corrected_multipliers()


class TestAsPrinted:
    def test_ranks(self, printed):
        assert (printed.rank, printed.n_rows) == (27, 30)
        assert printed_rank(0.0) == 25
        assert printed.left < 1e-14

    def test_vertical_forces(self, printed):
        np.testing.assert_allclose(printed.values[:, 2], PRINTED_FORCES, rtol=SIX_DIGITS)
        masses = np.array([body.mass for body in kr500().bodies])
        np.testing.assert_allclose(printed.values[:, 2], -9.80665 * masses[::-1].cumsum()[::-1], rtol=1e-12)

    def test_horizontal_forces_are_rounding(self, printed):
        assert np.abs(printed.values[:, :2]).max() < 1e-9

    @pytest.mark.parametrize(("joint", "values"), [(6, (1211.238, 809.3237)), (4, (8285.916, 5536.472))])
    def test_moments(self, printed, joint, values):
        np.testing.assert_allclose(printed.values[joint - 1, 3:], values, rtol=SIX_DIGITS)

    def test_moments_of_the_last_joint_by_hand(self, printed):
        """The moment of λ_63 about the center of B_6."""
        model, angle = kr500(), np.deg2rad(33.75)
        size = model.bodies[5].mass * 9.80665 * 0.15 / np.tan(angle)
        np.testing.assert_allclose(printed.values[5, 3:], size * np.array([np.cos(angle), np.sin(angle)]), rtol=1e-12)

    def test_dependent_rows(self, printed):
        """Joints 2, 3, 5: not determined; the ratio of the null vector is that of the printed 1e10 to 1e11."""
        assert set(printed.ratios) == {2, 3, 5}
        assert np.isnan(printed.values[[1, 2, 4], 3:]).all()
        for joint, (fourth, fifth) in {
            2: (-1.233380e11, -1.845883e11),
            3: (-1.431100e11, -2.141792e11),
            5: (-1.631801e10, -2.442163e10),
        }.items():
            assert printed.ratios[joint] == pytest.approx(np.tan(np.deg2rad(33.75)), rel=1e-12)
            assert printed.ratios[joint] == pytest.approx(fourth / fifth, rel=1e-5)

    def test_what_is_not_reproduced(self, printed):
        """λ_14 is printed as -5868.432."""
        assert abs(printed.values[0, 3] / -5868.432 - 1) > 0.5


class TestCorrected:
    def test_against_rnea(self, corrected):
        assert corrected.difference <= AGAINST_PINOCCHIO
        assert np.isfinite(corrected.multipliers).all()

    def test_forces(self, corrected):
        np.testing.assert_allclose(corrected.forces[0], (24853.75, -7277.143, 110108.77), rtol=SIX_DIGITS)
        np.testing.assert_allclose(corrected.forces[5], (854.4671, -2008.935, 5947.395), rtol=SIX_DIGITS)
        np.testing.assert_array_equal(corrected.multipliers[:, :3].round(6), corrected.forces.round(6))

    def test_readings(self, corrected):
        assert len(corrected.reading) == 6
        assert corrected.reading[0].startswith(
            "O1 carries 110.1 kN upwards and 25.9 kN sideways; its actuator gives 0.12"
        )

    def test_other_instants(self):
        for time in (0.0, 0.6, 2.0):
            assert corrected_multipliers(time).difference <= AGAINST_PINOCCHIO


def test_the_instant():
    q, v, a = joint_motion(INSTANT)
    np.testing.assert_allclose(np.rad2deg([q, v, a])[:, :2], [[33.75, -33.75], [45, -45], [30, -30]])
    assert not np.any([q[2:], v[2:], a[2:]])
    motion = rail(INSTANT)
    assert motion.translation.tolist() == [2.25, 0, 0]
    assert motion.velocity.tolist() == [3, 0, 0, 0, 0, 0]
    assert motion.acceleration.tolist() == [2, 0, 0, 0, 0, 0]
    model = kr500()
    compensated = (
        inverse_dynamics(model, q, v, a, base=motion).joint_wrenches - inverse_dynamics(model, q, v, a).joint_wrenches
    )
    assert np.abs(compensated).max() > 1e3
