"""Masses and principal moments from joint wrenches: the paper's section 2.3 and its Tables 3 and 4."""

import dataclasses

import numpy as np
import pytest
from identified.wrench_data import PAPER_TIMES, random_recording, recorded
from random_trees import random_tree

from graphdyn import InvalidInput, kr500, kr500_experiment
from graphdyn.identification import (
    PRINCIPAL_PARAMETER_NAMES,
    body_wrenches,
    identify_principal_parameters,
    identify_principal_parameters_together,
    mass_rows,
    moment_rows,
    principal_regressor,
)
from graphdyn.identification.algebra.rank_revealing import PRECISION_MARGIN
from graphdyn.identification.wrenches.wrench_equations import MAX_RANK_TOLERANCE

EXACT = 1e-12
"""Relative error with exact data: some hundred eps times a condition number of 27; measured 3e-13."""

SAME = 1e-13
"""Body by body and all at once: two factorizations of the same numbers; measured 3e-15."""

KR500 = kr500()
TRUTH = np.array([[body.mass] * 3 + list(np.diag(body.inertia)) for body in KR500.bodies])

UNSEEN = ("B1 m(e_2)", "B1 J_22", "B1 J_33")
"""B_1 never accelerates along e_2 and turns about its e_1 alone (errata C3)."""

TABLE_4 = np.array(
    [
        [-0.0012, np.nan, -0.0070, 0.0001, -0.0006, -0.0006],
        [-0.0006, -0.0003, -0.0003, 0.0424, -0.0251, 0.0175],
        [-0.0002, 0, -0.0001, -0.0027, -0.0017, -0.0116],
        [0.0005, 0.0002, 0.0002, 0.0002, -0.0001, 0.0006],
        [-0.0002, -0.0002, 0, -0.0002, -0.0005, 0],
        [-0.0001, 0.0001, 0, 0.0002, 0, 0.0003],
    ]
)
"""The paper's absolute errors, B_1 to B_6 [kg, kg m²]."""


@pytest.fixture(scope="module")
def experiment():
    return kr500_experiment(PAPER_TIMES)


@pytest.fixture(scope="module", params=["bodies", "together"])
def identify(request):
    return {"bodies": identify_principal_parameters, "together": identify_principal_parameters_together}[request.param]


class TestThePapersExperiment:
    def test_exact_data(self, experiment, identify):
        answer = identify(KR500, experiment)
        assert answer.undetermined == UNSEEN
        assert answer.rank == 33
        assert np.nanmax(np.abs(answer.values / TRUTH - 1)) < EXACT
        assert answer.condition_number < 30
        force, moment = np.sqrt(np.mean(answer.residual.reshape(-1, 2, 3) ** 2, axis=(0, 2)))
        assert force < EXACT * np.abs(experiment.joint_forces).max()
        assert moment < EXACT * np.abs(experiment.joint_moments).max()

    def test_undetermined_entries_are_no_numbers(self, experiment, identify):
        answer = identify(KR500, experiment)
        assert np.array_equal(np.isnan(answer.values[0]), [False, True, False, False, True, True])
        assert np.array_equal(answer.determined, np.isfinite(answer.standard_deviations))
        assert np.isnan(answer.of("B1")["J_22"])
        assert answer.of("B6")["m(e_3)"] == pytest.approx(661.7042, abs=5e-5)

    @pytest.mark.parametrize("convention", ["half even", "truncated"])
    def test_seven_digits_do_better_than_table_4(self, experiment, identify, convention):
        """Largest error 0.0080 (rounded) and 0.0114 (cut) against 0.0424; rms 0.0021 and 0.0032 against 0.0092."""
        answer = identify(KR500, experiment.rounded(7, convention))
        error = answer.values - TRUTH
        both = np.isfinite(error) & np.isfinite(TABLE_4)
        assert answer.undetermined == UNSEEN
        assert np.abs(error[both]).max() < 0.015 < np.nanmax(np.abs(TABLE_4))
        assert np.sqrt(np.mean(error[both] ** 2)) < 0.004 < np.sqrt(np.mean(TABLE_4[both] ** 2))

    def test_the_three_masses_of_a_body_agree(self, experiment, identify):
        """As Table 3 shows it: within some milligrams to a gram of hundreds of kilograms."""
        masses = identify(KR500, experiment.rounded()).values[:, :3]
        assert np.nanmax(np.nanmax(masses, axis=1) - np.nanmin(masses, axis=1)) < 0.002

    @pytest.mark.parametrize("digits", [3, 5, 7, 9])
    def test_the_fit_shows_the_precision(self, experiment, identify, digits):
        """Rounded angles tilt ω by 1e-7 and more: to eps that looks like a parameter, to the fit it does not."""
        assert identify(KR500, experiment.rounded(digits)).undetermined == UNSEEN

    def test_a_wrong_precision_invents_parameters(self, experiment, identify):
        """Why the precision matters: at eps the tilt passes for a motion about e_2."""
        invented = identify(KR500, experiment.rounded(7), precision=1e-16)
        assert invented.undetermined == ("B1 m(e_2)",)
        assert np.abs(invented.values[0, 4:] - TRUTH[0, 4:]).max() > 1e4

    def test_noise(self, identify):
        """101 samples with 0.1 % of noise: masses within 0.3 %, weak moments within 13 %, as the deviations say."""
        answer = identify(KR500, kr500_experiment().noisy(0, relative=1e-3))
        assert answer.undetermined == UNSEEN
        assert np.nanmax(np.abs(answer.values[:, :3] / TRUTH[:, :3] - 1)) < 3e-3
        z = np.abs(answer.values - TRUTH) / answer.standard_deviations
        assert np.nanmax(z) < 4
        assert np.nanmedian(z) > 0.1

    def test_loud_noise_needs_a_precision(self, identify):
        """At 1 % the tilt of B_1 looks like a hundredth of a full column."""
        loud = kr500_experiment().noisy(0, relative=1e-2)
        assert identify(KR500, loud, precision=2 * MAX_RANK_TOLERANCE / PRECISION_MARGIN).undetermined == UNSEEN

    def test_one_sample(self, experiment, identify):
        """Six equations for six parameters: the numbers stand, their standard deviations do not."""
        answer = identify(KR500, experiment.at([0.9]))
        known = answer.determined
        assert known.sum() >= 30
        assert np.abs(answer.values[known] / TRUTH[known] - 1).max() < 1e-9
        assert np.isnan(answer.standard_deviations[1:]).all()

    def test_masses_and_moments_of_the_model_are_not_read(self, experiment, identify):
        other = [dataclasses.replace(body, mass=1.0, inertia=np.eye(3)) for body in KR500.bodies]
        blind = dataclasses.replace(KR500, bodies=tuple(other))
        assert np.array_equal(identify(blind, experiment).values, identify(KR500, experiment).values, equal_nan=True)


@pytest.mark.parametrize("digits", [7, 15])
def test_body_by_body_and_together(experiment, digits):
    data = experiment.rounded(digits)
    one, all_at_once = (f(KR500, data) for f in (identify_principal_parameters, identify_principal_parameters_together))
    assert one.undetermined == all_at_once.undetermined
    assert one.rank == all_at_once.rank
    assert np.nanmax(np.abs(one.values / all_at_once.values - 1)) < SAME
    assert [len(one.systems), len(all_at_once.systems)] == [6, 1]
    if digits == 7:  # with exact data the residual is rounding of the solver
        assert np.nanmax(np.abs(one.standard_deviations / all_at_once.standard_deviations - 1)) < 1e-8
        np.testing.assert_allclose(one.residual, all_at_once.residual, atol=1e-9)
    sigma = np.sort(np.concatenate([system.singular_values for system in one.systems]))[::-1]
    np.testing.assert_allclose(sigma, all_at_once.systems[0].singular_values, atol=SAME)


@pytest.mark.parametrize("seed", range(3))
def test_any_motion_any_gravity(identify, seed):
    """Gravity askew, all joints moving: everything is determined but what B_1 turning about e_1 alone hides."""
    model = KR500.with_gravity(np.random.default_rng(seed).uniform(-10, 10, 3))
    answer = identify(model, random_recording(model, seed, 20))
    assert set(answer.undetermined) == {"B1 J_22", "B1 J_33"}
    assert np.nanmax(np.abs(answer.values / TRUTH - 1)) < EXACT


def principal_robot(seed, inside, kinds):
    """A tree of any shape whose link axes are principal axes; centers of mass anywhere."""
    model = random_tree(seed, inside, kinds)
    rng = np.random.default_rng(seed)
    bodies = [dataclasses.replace(body, inertia=np.diag(rng.uniform(0.5, 1.0, 3) * body.mass)) for body in model.bodies]
    return dataclasses.replace(model, bodies=tuple(bodies))


@pytest.mark.parametrize("seed", range(3))
def test_trees_with_sliding_joints(identify, seed):
    """Branches and sliding joints: the levers C^e slide along."""
    model = principal_robot(seed, [0, 1, 1, 3, 3], ["revolute", "prismatic", "revolute", "revolute", "prismatic"])
    answer = identify(model, random_recording(model, seed, 20))
    truth = np.array([[body.mass] * 3 + list(np.diag(body.inertia)) for body in model.bodies])
    assert answer.rank >= 28
    assert np.nanmax(np.abs(answer.values / truth - 1)) < EXACT * answer.condition_number


class TestEquations:
    def test_mass_rows(self):
        """Eq. (44): the sign of g is that of z̈ + g (A6)."""
        r = mass_rows([1.0, 2.0, 3.0], [0.0, 0.0, -9.8])
        assert np.array_equal(r, np.diag([1.0, 2.0, 12.8]))

    def test_moment_rows(self):
        """Eq. (48) against Euler's equation, Eq. (30)."""
        rng = np.random.default_rng(0)
        omega, alpha, moments = rng.normal(size=(3, 3))
        j = np.diag(moments)
        expected = j @ alpha + np.cross(omega, j @ omega)
        np.testing.assert_allclose(moment_rows(omega, alpha) @ moments, expected, rtol=1e-14)

    def test_regressor_times_parameters_is_the_wrench(self, experiment):
        """Eq. (50): Y X = Z, with X the truth and Z the resultants of the joint wrenches (A5: their sum, -S^e F^e)."""
        z = np.concatenate(body_wrenches(KR500, experiment), axis=-1)
        y = principal_regressor(KR500, experiment) @ TRUTH[..., None]
        np.testing.assert_allclose(y[..., 0], z, atol=EXACT * np.abs(experiment.joint_moments).max())

    def test_resultants_are_newton_and_euler(self, experiment):
        """F_i^R = m (r̈ - g), whatever the joints carry."""
        force, _ = body_wrenches(KR500, experiment)
        expected = TRUTH[:, :1] * (experiment.acceleration - KR500.gravity)
        np.testing.assert_allclose(force, expected, atol=EXACT * np.abs(experiment.joint_forces).max())

    def test_names(self):
        assert PRINCIPAL_PARAMETER_NAMES == ("m(e_1)", "m(e_2)", "m(e_3)", "J_11", "J_22", "J_33")


@dataclasses.dataclass
class Loose:
    """Data that do not check themselves, as Recording does."""

    joint_names: tuple[str, ...]
    q: np.ndarray
    v: np.ndarray
    a: np.ndarray
    rotation: np.ndarray
    acceleration: np.ndarray
    angular_velocity: np.ndarray
    angular_acceleration: np.ndarray
    joint_forces: np.ndarray
    joint_moments: np.ndarray


class TestRefusals:
    @pytest.fixture
    def loose(self, experiment):
        names = [field.name for field in dataclasses.fields(Loose)]
        return Loose(**{name: np.copy(getattr(experiment, name)) for name in names[1:]}, joint_names=KR500.joint_names)

    def test_other_joints(self, loose, identify):
        loose.joint_names = tuple(reversed(loose.joint_names))
        with pytest.raises(InvalidInput) as caught:
            identify(KR500, loose)
        assert "the data have joints O6, O5, O4, O3, O2, O1, robot 'kr500' has O1, O2" in str(caught.value)
        assert "bring them into the order of the robot" in str(caught.value)

    @pytest.mark.parametrize("name", ["rotation", "acceleration", "angular_velocity", "joint_forces", "joint_moments"])
    def test_shape(self, loose, identify, name):
        wrong = getattr(loose, name)[:, :5]
        setattr(loose, name, wrong)
        with pytest.raises(InvalidInput) as caught:
            identify(KR500, loose)
        message = str(caught.value)
        assert f"{name} has shape {wrong.shape}, expected ('N', 6, 3" in message
        assert "the same N ≥ 1 in all arrays" in message

    def test_no_sample(self, loose, identify):
        for field in dataclasses.fields(loose)[1:]:
            setattr(loose, field.name, getattr(loose, field.name)[:0])
        with pytest.raises(InvalidInput, match="N ≥ 1"):
            identify(KR500, loose)

    @pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
    def test_not_finite(self, loose, identify, value):
        loose.joint_forces[3, 1, 2] = value
        with pytest.raises(InvalidInput) as caught:
            identify(KR500, loose)
        assert "joint_forces contains NaN or infinity at sample 3, body 'B2'; leave the sample out" in str(caught.value)

    @pytest.mark.parametrize("precision", [0.0, -1e-7, 1.0, np.nan])
    def test_precision(self, experiment, identify, precision):
        with pytest.raises(InvalidInput) as caught:
            identify(KR500, experiment, precision=precision)
        assert f"precision is {precision}; give the relative rounding of the data, such as 1e-7" in str(caught.value)

    def test_unknown_body(self, experiment, identify):
        with pytest.raises(InvalidInput, match="there is no body 'B7'; known: B1, B2, B3, B4, B5, B6"):
            identify(KR500, experiment).of("B7")


def test_a_robot_at_rest_shows_its_weight_alone(identify):
    q, _ = KR500.random_state(np.random.default_rng(0), 3)
    answer = identify(KR500, recorded(KR500, q, 0 * q, 0 * q))
    assert np.array_equal(np.flatnonzero(answer.determined), 2 + 6 * np.arange(6))
    assert np.nanmax(np.abs(answer.values / TRUTH - 1)) < EXACT
