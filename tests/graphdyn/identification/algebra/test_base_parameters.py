"""Base parameters: which combinations of inertial parameters the torques depend on."""

import functools
from dataclasses import replace

import numpy as np
import pytest

import urdf
from graphdyn import Body, InvalidInput, Joint, Placement, RobotModel, joint_torque_regressor, kr500
from graphdyn.identification import TorqueModel, base_parameters
from graphdyn.identification.algebra.base_parameters import MIN_COLUMN_SHARE, RANK_TOLERANCE
from graphdyn.identification.terms import RigidBodies

STATES = 40

SYMBOLS = [column.symbol for column in RigidBodies().columns(kr500())]

CLEAR = 1e-4
"""The weakest parameter of an arm under random motion; rounding is eleven orders below."""

NOISE = 1e-12
"""Rounding of a rank-revealing factorization of some hundred rows."""

SAME = 1e-12
"""W π and W_b π_b: two sums of up to sixty terms, relative to the largest term."""

ROBOTS = {"kr500": kr500, "ur10": lambda: urdf.load("ur10")}
"""Both have 36: six hinges, the first one along gravity, joints 2 and 3 (and 4 of the UR10) parallel."""


@functools.cache
def regressor_of(name, seed=0):
    model, rng = ROBOTS[name](), np.random.default_rng(seed)
    q, v = model.random_state(rng, STATES)
    a = rng.uniform(-10, 10, q.shape)
    return joint_torque_regressor(model, q, v, a).reshape(-1, 60)


@pytest.fixture(params=ROBOTS)
def robot(request):
    return request.param


@pytest.fixture
def w(robot):
    return regressor_of(robot)


def random_parameters(seed=1):
    return np.random.default_rng(seed).normal(size=60)


def assert_regroups(w, base, pi):
    """W π = W_b π_b."""
    assert np.abs(w @ pi - w[:, base.independent] @ base.values(pi)).max() <= SAME * np.abs(w * pi).max() * w.shape[1]


class TestArms:
    def test_rank_and_gap(self, robot, w):
        base = base_parameters(w)
        assert base.rank == 36
        accepted, rejected = base.gap
        assert accepted > CLEAR
        assert rejected < NOISE

    def test_singular_values_say_the_same(self, w):
        """Another witness of the rank: no pivoting, columns at unit length, null columns left out."""
        length = np.linalg.norm(w, axis=0)
        columns = w[:, length > MIN_COLUMN_SHARE * length.max()] / length[length > MIN_COLUMN_SHARE * length.max()]
        values = np.linalg.svd(columns, compute_uv=False)
        assert np.count_nonzero(values > RANK_TOLERANCE * values[0]) == base_parameters(w).rank

    def test_every_column_is_accounted_for_once(self, w):
        base = base_parameters(w)
        assert sorted([*base.independent, *base.dependent]) == list(range(60))
        assert list(base.independent) == sorted(base.independent)
        assert base.regrouping.shape == (len(base.independent), len(base.dependent))

    @pytest.mark.parametrize("seed", range(5))
    def test_regrouping(self, w, seed):
        assert_regroups(w, base_parameters(w), random_parameters(seed))

    def test_regrouping_holds_at_other_states(self, robot, w):
        """It belongs to the robot, not to the samples."""
        assert_regroups(regressor_of(robot, seed=7), base_parameters(w), random_parameters())

    def test_order_of_the_rows_does_not_matter(self, w):
        """Which column represents a combination may change with rounding; what is represented may not."""
        shuffled = w[np.random.default_rng(3).permutation(len(w))]
        base, other = base_parameters(w), base_parameters(shuffled)
        assert other.rank == base.rank
        assert_regroups(w, other, random_parameters())

    def test_a_change_that_no_torque_feels(self, w):
        """Moving along a null vector of W changes the standard parameters and not the base parameters."""
        base = base_parameters(w)
        d = base.dependent[0]
        direction = np.zeros(60)
        direction[d] = 1.0
        direction[base.independent] = -base.regrouping[:, 0]
        pi = random_parameters()
        assert np.abs(base.values(pi + direction) - base.values(pi)).max() <= SAME * np.abs(base.regrouping).max()


class TestConstructed:
    @pytest.fixture
    def independent(self):
        return np.random.default_rng(0).normal(size=(20, 4))

    def test_full_rank(self, independent):
        base = base_parameters(independent)
        assert list(base.independent) == [0, 1, 2, 3]
        assert base.dependent.size == 0
        pi = np.arange(1.0, 5.0)
        assert np.array_equal(base.values(pi), pi)
        assert base.gap[1] == 0

    def test_known_combination(self, independent):
        """Column 4 = 2 × column 0 - 3 × column 1: one of the three folds into the other two, exactly so."""
        w = np.column_stack([independent, independent[:, 0] * 2 - independent[:, 1] * 3])
        base = base_parameters(w)
        assert base.rank == 4
        assert {2, 3} < set(base.independent)
        pi = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
        estimate = w[:, base.independent] @ base.values(pi)
        assert np.abs(estimate - w @ pi).max() <= SAME * np.abs(w * pi).sum(axis=1).max()

    def test_rounding_is_relative_to_the_columns_own_size(self):
        """One of 10⁻⁸ in length takes another with 10⁸; beside it a twentieth still counts."""
        e, f = np.linalg.qr(np.random.default_rng(0).normal(size=(9, 2)))[0].T
        found = base_parameters(np.column_stack([1e-8 * e, e, f, 0.05 * f]))
        assert found.names(("e", "d", "f", "g")) == ("e + 1e+08 d", "f + 0.05 g")
        assert found.alone.size == 0

    def test_gap_between_the_last_that_counts_and_the_first_that_does_not(self):
        """Of three orthogonal columns and four copies of them, off by 1e-11, 1e-12, …."""
        basis = np.linalg.qr(np.random.default_rng(0).normal(size=(12, 7)))[0].T
        copies = [basis[0] + 10.0**-k * basis[3 + k - 11] for k in range(11, 15)]
        found = base_parameters(np.column_stack([*basis[:3], *copies]))
        assert found.gap == pytest.approx((1.0, 1e-11), rel=1e-3)

    @pytest.mark.parametrize("size", [0.0, 1e-11])
    def test_null_columns_are_dropped(self, independent, size):
        """Noise of 1e-11 (π/2 rounded in a file) is no parameter, although its direction is independent."""
        noise = np.random.default_rng(1).normal(size=(20, 1))
        w = np.hstack([independent[:, :2], size * noise, independent[:, 2:]])
        base = base_parameters(w)
        assert list(base.independent) == [0, 1, 3, 4]
        assert list(base.dependent) == [2]
        assert not base.regrouping.any()

    def test_small_columns_are_kept(self, independent):
        """Units may differ by much: a column of 1e-6 is a parameter."""
        base = base_parameters(independent * np.array([1.0, 1e-6, 1.0, 1.0]))
        assert base.rank == 4

    def test_weak_combination_is_a_parameter(self, independent):
        """Columns that differ by 1e-6 of their length are two parameters; by 1e-12, one. The gap tells."""
        for difference, rank in ((1e-6, 5), (1e-12, 4)):
            last = independent[:, 0] + difference * np.random.default_rng(2).normal(size=20)
            base = base_parameters(np.column_stack([independent, last]))
            assert base.rank == rank
            assert base.gap[1] < RANK_TOLERANCE < base.gap[0]

    def test_zero(self):
        base = base_parameters(np.zeros((5, 3)))
        assert base.rank == 0
        assert list(base.dependent) == [0, 1, 2]
        assert base.values([1.0, 2.0, 3.0]).shape == (0,)
        assert base.gap == (0.0, 0.0)

    def test_one_column(self):
        base = base_parameters([[2.0], [1.0]])
        assert base.rank == 1
        assert list(base.values([7.0])) == [7.0]


class TestInWords:
    def test_a_planar_arm(self):
        """Two links in a horizontal plane, axes z, the second joint at distance 0.4 along x: textbook regrouping.

        ZZ_1 + 0.16 M_2, ZZ_2, MX_2, MY_2 (Khalil and Dombre, 2002, section 9.4: ZZR_1 = ZZ_1 + d² M_2).
        """
        body = Body("link", 1.0, np.zeros(3), np.eye(3))
        first = Joint("a", "revolute", 0, Placement(), np.array([0.0, 0.0, 1.0]))
        second = Joint("b", "revolute", 1, Placement(np.eye(3), np.array([0.4, 0.0, 0.0])), np.array([0.0, 0.0, 1.0]))
        arm = RobotModel("planar", (body, replace(body, name="tip")), (first, second), gravity=np.zeros(3))
        columns = TorqueModel(arm, (RigidBodies(),)).columns
        rng = np.random.default_rng(0)
        w = joint_torque_regressor(arm, *rng.uniform(-3, 3, (3, 50, 2))).reshape(-1, 20)
        base = base_parameters(w)
        assert base.names([column.symbol for column in columns]) == ("ZZ_1 + 0.16 M_2", "MX_2", "MY_2", "ZZ_2")
        assert base.symbols([column.symbol for column in columns]) == ("ZZR_1", "MX_2", "MY_2", "ZZ_2")
        assert base.names([column.name for column in columns])[0] == "link I_zz + 0.16 tip m"
        assert [columns[k].symbol for k in base.alone] == ["MX_2", "MY_2", "ZZ_2"]

    def test_outer_bodies_fold_into_inner_ones(self, robot, w):
        """Khalil and Gautier's order: what is folded away comes later than the first column it folds into."""
        base = base_parameters(w)
        for column, coefficients in zip(base.dependent, base.regrouping.T, strict=True):
            into = base.independent[np.abs(coefficients) > NOISE * np.abs(coefficients).max(initial=1.0)]
            assert into.size == 0 or into.min() < column

    def test_kr500(self):
        names = base_parameters(regressor_of("kr500")).names(SYMBOLS)
        assert names[1] == "MX_2 + 1.245 M_3 + 1.245 M_4 + 1.245 M_5 + 1.245 M_6"  # the length of body 2, 1.245 m
        assert names[4] == "XY_2 - 1.245 MY_3"
        assert names[-1] == "YZ_6"

    def test_structural_and_numerical_zeros(self):
        """Body 1 of the KR500 turns about the vertical: nothing but its I_xx shows. Turned by π/2 with ten digits, some
        of these columns are 1e-10 instead."""
        base = base_parameters(regressor_of("kr500"))
        assert {SYMBOLS[k] for k in base.structural_zeros} >= {"M_1", "MX_1", "MY_1", "MZ_1", "XY_1", "YY_1"}
        assert base.numerical_zeros.size == 0
        w = regressor_of("kr500").copy()
        w[:, 0] = 1e-11 * np.random.default_rng(0).normal(size=len(w)) * np.linalg.norm(w[:, 20])
        rounded = base_parameters(w)
        assert [SYMBOLS[k] for k in rounded.numerical_zeros] == ["M_1"]
        assert rounded.rank == base.rank

    def test_matrix(self, w):
        base, pi = base_parameters(w), random_parameters()
        assert base.matrix @ pi == pytest.approx(base.values(pi), rel=1e-12)

    def test_then(self, w):
        """First the structure, then a record that shows less: the same as the record at once."""
        base = base_parameters(w)
        record = w[:30]
        both, once = base.then(base_parameters(record[:, base.independent])), base_parameters(record)
        assert both.rank == once.rank < 36
        assert_regroups(record, both, random_parameters())
        assert set(both.structural_zeros) >= set(base.structural_zeros)

    def test_tolerance(self, w):
        """What shows too weakly for the user is undetermined."""
        base = base_parameters(w)
        assert base_parameters(w, tolerance=1.01 * base.gap[0]).rank < 36 == base.rank

    def test_fewer_rows_than_columns(self, w):
        assert base_parameters(w[:7]).rank == 7


class TestRefusals:
    @pytest.mark.parametrize(
        "regressor",
        [np.ones(5), np.ones((0, 3)), np.ones((2, 4, 3)), [[1.0], [np.nan]], [[1.0], [np.inf]]],
        ids=["vector", "empty", "stack", "nan", "inf"],
    )
    def test_bad_regressor(self, regressor):
        with pytest.raises(InvalidInput) as caught:
            base_parameters(regressor)
        assert f"regressor has shape {np.shape(regressor)}" in str(caught.value)
        assert "a finite matrix (rows, parameters) needed" in str(caught.value)
