"""All ten inertial parameters per body from joint wrenches: trees, full tensors, excentric centers of mass."""

import numpy as np
import pytest
from identified.wrench_data import PAPER_TIMES, random_recording
from random_trees import NAMED, random_tree
from witnesses import outside_of, relative_error

import urdf
from graphdyn import BaseMotion, InvalidInput, body_regressor, inverse_dynamics, kr500, kr500_experiment
from graphdyn.identification import (
    IdentifiedBodies,
    identified_inertia,
    identify_inertial_parameters,
    identify_inertial_parameters_together,
    joint_wrench_regressor,
    link_wrenches,
)
from graphdyn.identification.algebra.rank_revealing import rank_revealing_least_squares
from graphdyn.model.inertia import PARAMETER_NAMES

EXACT = 1e-12
"""Relative to the largest parameter of its kind in the robot, with exact data; measured 5e-14."""

SAMPLES = 20

ROBOTS = {
    "ur5": lambda: urdf.load("ur5"),
    "kr500": kr500,
    "tree": lambda: random_tree(5, [0, 1, 1, 3, 3], ["revolute", "prismatic", "revolute", "revolute", "prismatic"]),
    "forest": lambda: random_tree(6, [0, 0, 1, 2], ["prismatic", "revolute"] * 2),
    "chain": lambda: random_tree(7, [0, 1, 2, 3, 4, 5], ["revolute"] * 6),
}

RANKS = {"ur5": (56, 41), "kr500": (56, 41), "tree": (44, 29), "forest": (25, 7), "chain": (57, 42)}
"""From the wrenches of all joints, and from that of the innermost alone. A first body that turns about a fixed axis e
shows m, m c and I e: seven of ten, or six where e is vertical, since the m c along gravity and e shows nothing.
From the innermost alone, each further hinge folds three parameters of its body into the body before it (5 × 3 = 15)."""


@pytest.fixture(scope="module", params=ROBOTS)
def robot(request):
    return request.param


@pytest.fixture(scope="module")
def model(robot):
    return ROBOTS[robot]()


@pytest.fixture(scope="module")
def data(model):
    return random_recording(model, 0, SAMPLES)


@pytest.fixture(scope="module", params=["bodies", "together"])
def identify(request):
    return {"bodies": identify_inertial_parameters, "together": identify_inertial_parameters_together}[request.param]


def true_parameters(model):
    return model.inertial_parameters.reshape(model.n_bodies, 10)


def largest_of_its_kind(model):
    """(10,): largest mass, first moment, moment of inertia."""
    size = np.abs(true_parameters(model)).max(axis=0)
    return np.repeat([size[0], size[1:4].max(), size[4:].max()], [1, 3, 6])


def assert_true(answer, model):
    """What is determined is right: single parameters, and combinations of them."""
    error = np.abs(answer.values - true_parameters(model)) / largest_of_its_kind(model)
    assert np.all(error[answer.determined] < EXACT)
    truth = true_parameters(model) if len(answer.systems) > 1 else [model.inertial_parameters]
    for system, pi in zip(answer.systems, truth, strict=True):
        terms = np.abs(system.combinations * pi).max(axis=1, initial=0.0)
        error = np.abs(system.combination_values - system.combinations @ pi)
        assert np.all(error <= EXACT * np.maximum(terms, np.tile(largest_of_its_kind(model), len(pi) // 10).max()))


class TestAnyRobot:
    def test_exact_data(self, robot, model, data, identify):
        answer = identify(model, data)
        assert answer.rank == RANKS[robot][0]
        assert answer.parameter_names == PARAMETER_NAMES
        assert_true(answer, model)
        assert answer.condition_number < 100

    def test_both_ways_determine_the_same(self, model, data):
        """Block triangular with square blocks of full knowledge: sums over the outside bodies hide nothing."""
        one, together = identify_inertial_parameters(model, data), identify_inertial_parameters_together(model, data)
        assert one.undetermined == together.undetermined
        assert one.rank == together.rank

    def test_null_space(self, model, data, identify):
        """Moving along it changes no wrench; no determined combination feels it."""
        answer = identify(model, data)
        w = joint_wrench_regressor(model, data.q, data.v, data.a).reshape(-1, 10 * model.n_bodies)
        for i, system in enumerate(answer.systems):
            columns = slice(None) if len(answer.systems) == 1 else slice(10 * i, 10 * i + 10)
            null = system.null_space
            assert null.shape == (len(system.names), len(system.names) - system.rank)
            scale = np.abs(w).max() * max(np.abs(null).max(initial=0.0), 1.0)
            assert np.abs(w[:, columns] @ null).max(initial=0.0) < EXACT * scale
            assert np.abs(system.combinations @ null).max(initial=0.0) < 1e-9 * scale
            assert np.linalg.matrix_rank(system.combinations) == system.rank

    def test_innermost_joint_alone(self, robot, model, data):
        answer = identify_inertial_parameters_together(model, data, measured_joints=model.joint_names[:1])
        w = joint_wrench_regressor(model, data.q, data.v, data.a)[:, 0].reshape(6 * SAMPLES, -1)
        assert answer.rank == RANKS[robot][1] == np.linalg.matrix_rank(w, rtol=1e-9)
        assert_true(answer, model)
        assert answer.residual.shape == (SAMPLES, 1, 6)
        carried = outside_of(model, 1)
        assert not answer.determined[[i - 1 for i in range(1, model.n_bodies + 1) if i not in carried]].any()

    def test_outermost_joint_alone(self, model, data):
        """Its wrench is that of the last body; nothing is said of the others."""
        one = identify_inertial_parameters(model, data)
        last = identify_inertial_parameters_together(model, data, measured_joints=model.joint_names[-1:])
        assert not last.determined[:-1].any()
        assert np.array_equal(last.determined[-1], one.determined[-1])
        assert_true(last, model)

    def test_inertial_parameters_of_the_model_are_not_read(self, model, data, identify):
        blind = model.with_inertial_parameters(np.zeros(10 * model.n_bodies))
        assert np.array_equal(identify(blind, data).values, identify(model, data).values, equal_nan=True)


@pytest.mark.parametrize("name", NAMED)
def test_joint_wrench_regressor(name):
    """W π are the joint wrenches of the inverse dynamics, for every shape of tree."""
    model, rng = NAMED[name], np.random.default_rng(0)
    q, v, a = rng.uniform(-2, 2, (3, 4, model.n_bodies))
    w = joint_wrench_regressor(model, q, v, a)
    assert w.shape == (4, model.n_bodies, 6, 10 * model.n_bodies)
    wrenches = inverse_dynamics(model, q, v, a).joint_wrenches
    assert relative_error(w @ model.inertial_parameters, wrenches) < 1e-13
    blocks = w.reshape(4, model.n_bodies, 6, model.n_bodies, 10)
    for j in range(1, model.n_bodies + 1):
        inside = [i for i in range(model.n_bodies) if i + 1 not in outside_of(model, j)]
        assert not blocks[:, j - 1, :, inside].any()


def test_link_wrenches(model, data):
    """Without a center of mass: the body regressor times the truth."""
    expected = np.einsum("siwp,ip->siw", body_regressor(model, data.q, data.v, data.a), true_parameters(model))
    assert relative_error(link_wrenches(model, data), expected, data.joint_forces, data.joint_moments) < 1e-13


@pytest.fixture(scope="module")
def rail():
    t = np.array(PAPER_TIMES)[:, None]
    along = np.array([2.0, 0, 0, 0, 0, 0])
    return BaseMotion(translation=along[:3] * t**2 / 2, velocity=along * t, acceleration=along + 0 * t)


class TestThePapersExperiment:
    """A moving base that moves: the base motion enters the regressor."""

    def test_more_than_table_3(self, rail, identify):
        """Centers of mass and mass come out too; the two turning axes leave some moments in combinations."""
        model = kr500()
        answer = identify(model, kr500_experiment(PAPER_TIMES), base=rail)
        assert_true(answer, model)
        assert np.isfinite(answer.values[:, 0]).all()
        assert answer.of("B1")["I_xx"] == pytest.approx(model.bodies[0].inertia[0, 0], rel=EXACT)
        b6 = identified_inertia(answer, "B6")
        np.testing.assert_allclose(b6.center_of_mass, [0.15, 0, 0], atol=1e-9)
        np.testing.assert_allclose(b6.inertia, model.bodies[5].inertia, atol=1e-9)

    def test_without_the_rail_nothing_fits(self, identify):
        answer = identify(kr500(), kr500_experiment(PAPER_TIMES))
        assert np.sqrt(np.mean(answer.residual[..., :3] ** 2)) > 100


class TestReading:
    def test_mass_center_and_tensor(self, model, data, identify):
        answer = identify(model, data)
        for body, known in zip(model.bodies, answer.determined, strict=True):
            read = identified_inertia(answer, body.name)
            size = largest_of_its_kind(model)
            assert read.mass == pytest.approx(body.mass, abs=EXACT * size[0]) or not known[0]
            assert np.array_equal(np.isfinite(read.center_of_mass), known[1:4] & known[0])
            if known.all():
                np.testing.assert_allclose(read.center_of_mass, body.center_of_mass, atol=1e-11)
                np.testing.assert_allclose(read.inertia, body.inertia, atol=1e-11 * max(size))
            else:
                assert np.isnan(read.inertia).any()

    def test_no_mass_no_center(self, data, model):
        """The parameters of a massless body have a mass of zero or rounding; it has no center to tell."""
        massless = kr500().with_inertial_parameters(np.zeros(60))
        answer = identify_inertial_parameters(massless, random_recording(massless, 0, 5))
        read = identified_inertia(answer, "B6")
        assert read.mass == 0
        assert np.isnan(read.center_of_mass).all()
        assert np.isnan(read.inertia).all()

    def test_combinations_in_words(self):
        """Of x and y only x + 2 y shows, z by itself."""
        matrix = np.array([[1.0, 2.0, 0.0], [2.0, 4.0, 1.0], [0.0, 0.0, 3.0]])
        right = matrix @ [1.0, 1.0, 5.0]
        answer = rank_revealing_least_squares(
            matrix, right, ("x", "y", "z"), column_scale=np.ones(3), groups=np.zeros(3, dtype=int)
        )
        assert answer.combination_names == ("y + 0.5 x", "z")
        assert answer.combination_values == pytest.approx([1.5, 5.0], rel=EXACT)
        assert answer.undetermined == ("x", "y")
        assert answer.rank == 2

    def test_the_worst_of_several_systems_tells_the_condition(self):
        systems = tuple(
            rank_revealing_least_squares(
                np.diag([1.0, size]), np.ones(2), ("x", "y"), column_scale=np.ones(2), groups=np.zeros(2, dtype=int)
            )
            for size in (0.5, 0.01, 0.2)
        )
        found = IdentifiedBodies(("A", "B", "C"), ("x", "y"), systems, np.zeros((1, 3, 6)))
        assert found.condition_number == pytest.approx(100.0)
        assert found.rank == 6

    @pytest.mark.parametrize("column_scale", [[1.0, 1.0, 1.0], [3.0, 0.5, 20.0]])
    def test_deviations_of_combinations(self, column_scale):
        """Those of the regression on the columns that are left: noise over N - 2, times (AᵀA)⁻¹."""
        w, z, noise = np.random.default_rng(0).normal(size=(3, 50))
        matrix = np.column_stack([w, 2 * w, z])
        answer = rank_revealing_least_squares(
            matrix, 3 * w - z + noise, ("x", "y", "z"),
            column_scale=np.array(column_scale), groups=np.zeros(50, dtype=int), precision=1e-12,
        )  # fmt: skip
        first = 0 if answer.combination_names[0].startswith("x") else 1
        left = np.column_stack([(w, 2 * w)[first], z])
        x, (squares,), *_ = np.linalg.lstsq(left, 3 * w - z + noise, rcond=None)
        deviations = np.sqrt(squares / 48 * np.diag(np.linalg.inv(left.T @ left)))
        assert answer.combination_values == pytest.approx(x)
        assert answer.combination_standard_deviations == pytest.approx(deviations)
        assert answer.standard_deviations[2] == pytest.approx(deviations[1])
        assert np.abs(matrix @ answer.null_space).max() < EXACT * np.abs(answer.null_space).max()

    def test_differences_in_words(self):
        matrix = np.array([[1.0, -2.0]])
        answer = rank_revealing_least_squares(
            matrix, np.array([3.0]), ("x", "y"), column_scale=np.ones(2), groups=np.zeros(1, dtype=int)
        )
        assert answer.combination_names == ("y - 0.5 x",)
        assert answer.combination_values == pytest.approx([-1.5], rel=EXACT)

    def test_nothing_seen(self):
        answer = rank_revealing_least_squares(
            np.zeros((4, 2)), np.ones(4), ("x", "y"), column_scale=np.ones(2), groups=np.zeros(4, dtype=int)
        )
        assert answer.rank == 0
        assert answer.condition_number == 1
        assert answer.undetermined == ("x", "y")
        assert answer.combination_names == ()


class TestNoise:
    def test_standard_deviations(self, identify):
        """Noise in forces and moments alone: over 40 recordings the errors are as large as said."""
        model = urdf.load("ur5")
        exact = random_recording(model, 1, 30)
        z = []
        for seed in range(40):
            noisy = exact.noisy(seed, absolute={"joint_forces": 0.1, "joint_moments": 0.02})
            answer = identify(model, noisy, precision=1e-10)
            z.append((answer.values - true_parameters(model)) / answer.standard_deviations)
        z = np.array(z)
        spread = np.sqrt(np.mean(z[:, answer.determined] ** 2))
        assert 0.85 < spread < 1.15
        assert np.array_equal(answer.determined, np.isfinite(z).all(axis=0))

    def test_seven_digits(self, model, data, identify):
        """Rounded data: the same parameters are determined, to five digits or so."""
        answer = identify(model, data.rounded(7))
        assert answer.undetermined == identify(model, data).undetermined
        error = np.abs(answer.values - true_parameters(model)) / largest_of_its_kind(model)
        assert np.nanmax(error) < 1e-5


class TestRefusals:
    def test_unknown_measured_joint(self, data, model):
        with pytest.raises(InvalidInput) as caught:
            identify_inertial_parameters_together(model, data, measured_joints=["gripper"])
        assert f"there is no joint 'gripper'; robot '{model.name}' has {model.joint_names[0]}" in str(caught.value)

    def test_no_measured_joint(self, data, model):
        with pytest.raises(InvalidInput, match="no measured joint is given; robot"):
            identify_inertial_parameters_together(model, data, measured_joints=[])

    def test_data_of_another_robot(self, identify):
        other = random_tree(7, [0, 1], ["revolute"] * 2)
        with pytest.raises(InvalidInput, match="bring them into the order of the robot"):
            identify(kr500(), random_recording(other, 0, 3))
