"""Quick fits of many torque models: against the cone solver, against single folds, and their errors by definition."""

from dataclasses import replace

import numpy as np
import pytest
from identified import torque_data

from graphdyn.identification import Problem, RobustConsistent, Samples, TorqueModel
from graphdyn.identification.choosing import FoldErrors, RobustFolds, TermColumns, every_row
from graphdyn.identification.choosing.body_newton import BARRIER_WEIGHT, DRIVE_WEIGHT, BodyNewton
from graphdyn.identification.consistent.coordinates import SYMMETRIC_BASIS
from graphdyn.identification.terms import (
    Coulomb,
    CoupledWrist,
    KnownBodies,
    Offset,
    Payload,
    RigidBodies,
    RotorInertia,
    Viscous,
)

ADDITIONS = {
    "viscous": Viscous(),
    "coulomb": Coulomb(),
    "rotors": RotorInertia(),
    "offsets": Offset(),
    "wrist": CoupledWrist(),
}

STRENGTH = 10.0

SAME_TORQUE = 0.2
"""Root mean square difference of predicted torques, in units of the noise: both iterations end a few hundredths away
from their limit; measured 0.13."""

OUTLIERS = slice(100, 130)
"""Rows with torques far off."""


def problem(samples=None):
    samples = samples or torque_data.noisy_samples()
    return Problem(TorqueModel(torque_data.robot(), (RigidBodies(),)), samples)


def folds_of(size, count=3):
    numbers = np.arange(size) * count // size
    return [(numbers != k, numbers == k) for k in range(count)]


@pytest.fixture(scope="module")
def spoilt():
    """Noisy torques, and a few that no model explains."""
    samples = torque_data.noisy_samples()
    tau = samples.tau.copy()
    tau[OUTLIERS] += 30 * torque_data.NOISE
    return replace(samples, tau=tau)


@pytest.fixture(scope="module")
def fits(spoilt):
    columns = TermColumns.of(problem(spoilt), ADDITIONS, 1)
    return RobustFolds(columns, ADDITIONS, folds_of(len(columns)), STRENGTH)


def test_predicts_as_the_cone_solver(spoilt, fits):
    """RobustConsistent with the same prior of the same strength, by linear matrix inequalities."""
    found = fits.fit(list(ADDITIONS))
    whole = Problem(TorqueModel(torque_data.robot(), (RigidBodies(), *ADDITIONS.values())), spoilt)
    estimate = RobustConsistent("entropic", strength=STRENGTH).estimate(whole)
    expected = whole.torque_model.torque(spoilt, estimate.parameters) - spoilt.tau
    difference = np.sqrt(np.mean((found.residuals - expected) ** 2, axis=0))
    assert np.all(difference <= SAME_TORQUE * torque_data.NOISE), difference / torque_data.NOISE
    assert np.all(np.abs(found.scale / estimate.noise - 1) <= 0.1)


def test_outliers_hardly_count(fits):
    residuals = fits.fit(list(ADDITIONS)).residuals
    rest = np.delete(residuals, np.arange(600)[OUTLIERS], axis=0)
    assert np.all(np.sqrt(np.mean(rest**2, axis=0)) <= 1.3 * torque_data.NOISE)


def test_errors_are_those_of_folds():
    """A fold is predicted from the other rows: fitting only these rows predicts it as well."""
    names = list(ADDITIONS)
    columns = TermColumns.of(problem(), ADDITIONS, 1)
    folds = folds_of(len(columns))
    train, test = folds[1]
    alone = RobustFolds(replace(columns, kept=columns.kept & train[:, None]), ADDITIONS, [(train, test)], STRENGTH)
    one = alone.fit(names).errors
    whole = RobustFolds(columns, ADDITIONS, folds, STRENGTH)
    several = whole.fit(names).errors
    np.testing.assert_allclose(one.measured[0], several.measured[1])
    np.testing.assert_allclose(one.errors[0], several.errors[1], rtol=0.2)
    assert several.mean < whole.fit(["viscous", "coulomb"]).errors.mean


def test_a_start_from_another_model_changes_nothing(fits):
    """Only the number of steps."""
    before = fits.fit(["viscous"])
    one, other = fits.fit(list(ADDITIONS)), fits.fit(list(ADDITIONS), before)
    assert one.errors.mean == pytest.approx(other.errors.mean, rel=0.02)


@pytest.mark.parametrize("fixed", [(RigidBodies(), Payload()), (Offset(),)])
def test_payloads_and_known_links(fixed):
    """A payload has a body of its own; without an unknown body there is no prior."""
    known = () if len(fixed) == 2 else (KnownBodies(),)
    samples = torque_data.noisy_samples()
    own = Problem(TorqueModel(torque_data.robot(), fixed, known), samples)
    additions = {name: term for name, term in ADDITIONS.items() if name != "offsets"}
    columns = TermColumns.of(own, additions, 2)
    fitted = RobustFolds(columns, additions, folds_of(len(columns))).fit(list(additions))
    assert len(fitted.bodies) == 10 * (7 if len(fixed) == 2 else 0)
    assert np.all(np.isfinite(fitted.residuals))
    assert fitted.errors.mean < 1


def test_newton_against_finite_differences():
    """At the minimum no direction lowers f, which is computed here by determinants."""
    rng = np.random.default_rng(0)
    root = rng.normal(size=(30, 12))
    h, g = root.T @ root, rng.normal(size=12)
    newton = BodyNewton(1, np.array([True, False]), 5.0)

    def f(u):
        s = SYMMETRIC_BASIS @ u[:10]
        prior = 5.0 * (np.trace(s) - np.log(np.linalg.det(s))) + DRIVE_WEIGHT * np.sum(u[10:] ** 2)
        return u @ h @ u - 2 * g @ u + prior - 2 * BARRIER_WEIGHT * np.log(u[10])

    (u,) = newton.minimum(h[None], g[None], newton.start(0.05)[None])
    for direction in np.eye(12):
        for step in (-0.02, 0.02):
            if u[10] + step * direction[10] > 0:
                assert f(u + step * direction) > f(u) - 1e-2


def test_what_one_fold_alone_shows_does_not_explode():
    """A joint that turns back in one fold only: the others do not tell offset and Coulomb friction apart."""
    samples = torque_data.noisy_samples()
    turned = (np.arange(len(samples)) >= 400) & (samples.v[:, 2] < 0)
    v = samples.v.copy()
    v[:, 2] = np.where(turned, v[:, 2], np.abs(v[:, 2]))
    whole = problem(replace(samples, v=v))
    columns = TermColumns.of(whole, ADDITIONS, 1)
    found = RobustFolds(columns, ADDITIONS, folds_of(len(columns))).fit(["viscous", "coulomb", "offsets"])
    assert found.errors.mean < 1


def test_thinned_rows_are_those_of_the_problem():
    samples = torque_data.noisy_samples()
    whole = problem(samples)
    rows = list(whole.rows())
    columns = TermColumns.of(whole, ADDITIONS, 7)
    np.testing.assert_array_equal(columns.measured, samples.tau[::7])
    np.testing.assert_array_equal(columns.matrix, np.concatenate([part.matrix for part in rows])[::7])
    np.testing.assert_allclose(columns.additions["offsets"], np.broadcast_to(np.eye(6), (86, 6, 6)))
    assert every_row(600, 100) == 6
    assert every_row(601, 100) == 7
    assert every_row(5, 100) == 1


@pytest.fixture
def parts():
    rng = np.random.default_rng(1)
    return [FoldErrors(rng.uniform(1, 2, (5, 3)), np.full((5, 3), 100.0)) for _ in range(2)]


class TestErrors:
    def test_mean_over_joints(self, parts):
        one = parts[0]
        expected = np.sqrt(one.errors.sum(axis=0) / 500)
        np.testing.assert_allclose(one.joints, expected)
        assert one.mean == pytest.approx(expected.mean())

    def test_jackknife_of_the_difference(self, parts):
        one, other = parts
        value, deviation = one.minus(other)
        assert value == pytest.approx(one.mean - other.mean)
        left = []
        for k in range(5):
            kept = np.arange(5) != k
            left.append(np.subtract(*(np.mean(np.sqrt(e.errors[kept].sum(axis=0) / 400)) for e in (one, other))))
        assert deviation == pytest.approx(np.sqrt(4 / 5 * np.sum((left - np.mean(left)) ** 2)))
        assert one.minus(one) == (0.0, 0.0)

    def test_rows_at_rest_do_not_count(self):
        """Unless a joint hardly moves: then all of its rows do."""
        n = 200
        velocity = np.zeros((n, 2))
        velocity[:100, 0] = 1.0
        q = np.zeros((n, 2))
        residuals = np.ones((n, 2))
        residuals[100:] = 5.0
        columns = TermColumns(None, None, q, {}, q, np.full((n, 2), 10.0), velocity, q == 0, 1)
        errors = FoldErrors.of(columns, residuals, [np.arange(n) < 150, np.arange(n) >= 150])
        np.testing.assert_allclose(errors.joints, [0.1, np.sqrt((100 + 2500) / 2e4)])


def test_exact_data_have_weights_within_bounds():
    samples = torque_data.exact_samples()
    columns = TermColumns.of(problem(Samples(samples.q, samples.v, samples.a, samples.tau)), ADDITIONS, 1)
    found = RobustFolds(columns, ADDITIONS, folds_of(len(columns))).fit(list(ADDITIONS))
    assert np.all(np.isfinite(found.residuals))
    assert found.errors.mean < 0.05
