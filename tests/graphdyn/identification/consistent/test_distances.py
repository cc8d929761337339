"""Pseudo-inertia, distances between inertias, and the prior among the real ones."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from identified import consistent_data

from graphdyn import InvalidInput
from graphdyn.identification.bodies.unknown_bodies import (
    MIN_PRIOR_MASS_SHARE,
    MIN_PRIOR_RADIUS,
    MIN_PRIOR_THINNESS,
    inertial_prior,
)
from graphdyn.identification.consistent.coordinates import upper_factor
from graphdyn.identification.consistent.polishing import Cost, entropic_divergence, pullback_distance
from graphdyn.model.inertia import (
    inertia_from_parameters,
    parameters_from_inertia,
    parameters_from_pseudo_inertia,
    pseudo_inertia,
    pseudo_inertia_from_parameters,
)

EXACT = 1e-12
"""4×4 matrices with condition numbers of some hundreds."""


@pytest.fixture
def rng():
    return np.random.default_rng(0)


@pytest.fixture(scope="module")
def coordinates():
    """Of an arm and its drives, without data, whose size would hide the further columns."""
    found, _ = consistent_data.coordinates(consistent_data.poor_problem())
    return replace(found, matrix=0 * found.matrix, right=0 * found.right)


def real_bodies(rng, n):
    """Pseudo-inertia matrices of bodies made of points with masses (n, 4, 4)."""
    points = np.concatenate([rng.normal(size=(n, 8, 3)), np.ones((n, 8, 1))], axis=-1)
    return np.einsum("npi,np,npj->nij", points, rng.uniform(0.1, 2.0, (n, 8)), points)


class TestPseudoInertia:
    def test_round_trip(self, rng):
        parameters = rng.normal(size=(7, 3, 10))
        back = parameters_from_pseudo_inertia(pseudo_inertia_from_parameters(parameters))
        assert np.abs(back - parameters).max() < EXACT

    def test_point_masses(self, rng):
        """Σ m [x; 1] [x; 1]ᵀ, from the tensor Σ m (x·x E - x xᵀ) of the same points."""
        x, m = rng.normal(size=(5, 3)), rng.uniform(0.5, 2.0, 5)
        mass, center = m.sum(), m @ x / m.sum()
        tensor = sum(
            m_k * ((y := x_k - center) @ y * np.eye(3) - np.outer(y, y)) for m_k, x_k in zip(m, x, strict=True)
        )
        of_points = np.einsum("p,pi,pj->ij", m, np.c_[x, np.ones(5)], np.c_[x, np.ones(5)])
        assert np.abs(pseudo_inertia(mass, center, tensor) - of_points).max() < EXACT
        parameters = parameters_from_inertia(mass, center, tensor)
        assert np.abs(parameters_from_pseudo_inertia(of_points) - parameters).max() < EXACT


class TestDistances:
    @pytest.fixture(params=[entropic_divergence, pullback_distance])
    def distance(self, request):
        return request.param

    def test_positive_and_zero_at_the_prior_alone(self, rng, distance):
        a, b = real_bodies(rng, 200), real_bodies(rng, 200)
        assert np.all(distance(a, b) > 0)
        assert np.abs(distance(a, a)).max() < EXACT

    def test_does_not_feel_frame_and_units(self, rng, distance):
        """x → R x + t, lengths and masses in other units: P → G P Gᵀ."""
        a, b = real_bodies(rng, 50), real_bodies(rng, 50)
        g = np.eye(4)
        g[:3, :3] = np.linalg.qr(rng.normal(size=(3, 3)))[0] * 10.0  # other axes, decimeters
        g[:3, 3] = rng.normal(size=3)
        moved_a, moved_b = (30.0 * g @ p @ g.T for p in (a, b))
        assert np.abs(distance(moved_a, moved_b) / distance(a, b) - 1).max() < 1e-9  # cond(P)² of rounding

    def test_pullback_is_the_second_order_of_the_entropic(self, rng):
        prior, direction = real_bodies(rng, 20), real_bodies(rng, 20) - real_bodies(rng, 20)
        for step in (1e-3, 1e-4):
            near = prior + step * direction
            ratio = entropic_divergence(near, prior) / pullback_distance(near, prior)
            assert np.abs(ratio - 1).max() < 100 * step

    def test_entropic_is_infinite_outside(self, rng):
        prior = real_bodies(rng, 1)
        outside = prior.copy()
        outside[0, 3, 3] = -1.0
        assert entropic_divergence(outside, prior)[0] == np.inf

    def test_upper_factor(self, rng):
        p = real_bodies(rng, 10)
        u = upper_factor(p)
        assert np.abs(u @ np.swapaxes(u, -1, -2) - p).max() < EXACT * np.abs(p).max()
        assert np.all(u == np.triu(u))
        assert np.all(np.diagonal(u, axis1=1, axis2=2) > 0)


class TestCost:
    def test_the_prior_costs_nothing(self, coordinates):
        model = consistent_data.poor_problem().torque_model
        prior = coordinates.parameters(coordinates.origin)
        assert pseudo_inertia_from_parameters(prior[:60].reshape(6, 10)) == pytest.approx(coordinates.prior)
        assert np.all(prior[60:] == 0)
        assert len(prior) == len(model.columns)
        for metric in ("entropic", "pullback"):
            cost = Cost(coordinates, metric, 3.0)
            assert cost.value(coordinates.origin) == pytest.approx(0, abs=EXACT)
            assert np.abs(cost.gradient(coordinates.origin)).max() < EXACT

    def test_the_nearest_best_fit(self, coordinates):
        """By the optimality conditions: of all best fits whose held entries are zero, u - found has no part along."""
        rng = np.random.default_rng(3)
        found, _ = consistent_data.coordinates(consistent_data.poor_problem())
        u, held = found.origin + rng.normal(size=len(found.origin)), np.zeros(len(found.origin), dtype=bool)
        held[[0, 3, 72]] = True  # of the first body, and a rotor that folds into it
        free = found.null @ scipy.linalg.null_space(found.null[held], rcond=1e-9)
        for which, along in ((held, free), (np.zeros_like(held), found.null)):
            nearest = found.nearest_best_fit(u, which)
            assert found.excess(nearest) <= 1e-12 * found.excess(u)
            assert np.abs(along.T @ (u - nearest)).max() <= 1e-9 * np.linalg.norm(u - nearest)
        inverse = np.linalg.pinv(found.null[held], rcond=1e-9)
        reached = found.fitting[held] - found.null[held] @ inverse @ found.fitting[held]
        assert np.abs(found.fitting[held]).max() > 0.1
        assert found.nearest_best_fit(u, held)[held] == pytest.approx(reached, abs=1e-9)

    @pytest.mark.parametrize("metric", ["entropic", "pullback"])
    def test_slopes_are_differences(self, coordinates, rng, metric):
        """Of each column in its own size: those of the further columns are a millionth of those of the bodies."""
        cost, step = Cost(coordinates, metric, 3.0), 1e-4
        u = coordinates.origin + 0.1 * rng.normal(size=len(coordinates.origin))
        for k in range(0, len(u), 7):
            aside = step * np.eye(len(u))[k]
            slope = (cost.value(u + aside) - cost.value(u - aside)) / (2 * step)
            curvature = (cost.gradient(u + aside) - cost.gradient(u - aside)) / (2 * step)
            size = 1.0 if k < coordinates.width else 1e-6
            assert cost.gradient(u)[k] == pytest.approx(slope, abs=1e-5 * size, rel=1e-5)
            assert cost.hessian(u)[k] == pytest.approx(curvature, abs=1e-5 * size, rel=1e-5)


class TestPrior:
    def parameters(self, mass=10.0, center=(0.1, 0.0, 0.3), moments=(0.5, 0.6, 0.4)):
        return parameters_from_inertia(mass, np.array(center), np.diag(moments))

    def test_real_bodies_stay(self):
        given = np.stack([self.parameters(), self.parameters(mass=3.0)])
        prior, lifted = inertial_prior(given)
        assert not lifted.any()
        assert np.array_equal(prior, pseudo_inertia_from_parameters(given))

    @pytest.mark.parametrize(
        "changed",
        [
            {"moments": (0.0, 0.0, 0.0)},
            {"moments": (0.0, 0.5, 0.5)},
            {"moments": (0.5, 0.5, 0.0)},
            {"moments": (0.5, 0.6, 3.0)},
            {"moments": (-0.1, 0.6, 0.4)},
            {"mass": 0.0, "center": (0.0, 0.0, 0.0), "moments": (0.0, 0.0, 0.0)},
            {"mass": -2.0},
        ],
        ids=["point", "rod", "singular", "triangle", "negative moment", "no mass", "negative mass"],
    )
    def test_others_are_moved_inside(self, changed):
        """Positive definite with the stated thickness and mass; mass and center kept where they make sense."""
        given = np.stack([self.parameters(), self.parameters(**changed)])
        prior, lifted = inertial_prior(given)
        assert list(lifted) == [False, True]
        mass, center, tensor = inertia_from_parameters(parameters_from_pseudo_inertia(prior[1]))
        spread = np.linalg.eigvalsh(np.trace(tensor) / 2 * np.eye(3) - tensor) / mass
        assert spread[0] > 0.99 * max(MIN_PRIOR_RADIUS**2, MIN_PRIOR_THINNESS**2 * spread[-1])
        assert mass >= MIN_PRIOR_MASS_SHARE * given[0, 0]
        if given[1, 0] > 0:
            assert mass == given[1, 0]
            assert np.abs(center - given[1, 1:4] / mass).max() < EXACT

    def test_without_any_mass(self):
        with pytest.raises(InvalidInput, match="no body of the prior has a mass; give a prior with at least rough"):
            inertial_prior(np.zeros((2, 10)))
