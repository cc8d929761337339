"""Masses of CAD that a recording contradicts, those that it does not determine, and limits that are reached."""

from dataclasses import replace

import pytest
from identified import consistent_data as data
from long_check import LONG

from graphdyn.identification import (
    ConsistentWithPrior,
    PhysicalLimits,
    Problem,
    TorqueModel,
    contradicted_masses,
)
from graphdyn.identification.terms import KnownBodies, Viscous

NOISE = 1.0
"""[N m] of torques of hundreds: the recording determines what any motion could."""


def problem(wrong):
    """A recording of an arm whose CAD is right but for factors of some masses, by number of the body."""
    model = data.torque_model()
    cad = data.true_parameters()[:60].reshape(6, 10).copy()
    for body, factor in wrong.items():
        cad[body] *= factor
    robot = model.model.with_inertial_parameters(cad.ravel())
    return Problem(replace(model, model=robot), data.noisy(600, 0, NOISE), n_blocks=10)


def test_right_masses_are_not_contradicted():
    assert contradicted_masses(problem({}), PhysicalLimits()) == ()


@pytest.mark.parametrize(("body", "factor"), [(5, 6.0), pytest.param(4, 10.0, marks=LONG)])
def test_a_mass_that_shows_is_told(body, factor):
    """The wrist is not heavy enough for a third of what CAD states."""
    (found,) = contradicted_masses(problem({body: factor}), PhysicalLimits())
    true, name = data.true_parameters()[10 * body], f"B{body + 1}"
    assert found.body == name
    assert found.cad == pytest.approx(factor * true)
    assert found.limit == pytest.approx(found.cad / 3, rel=1e-3)
    assert true < found.mass + 3 * found.deviation < found.limit  # of all that fit, the one nearest to CAD
    assert 0.2 < found.gain < 1
    assert found.factor == pytest.approx(found.cad / found.mass)
    freed = PhysicalLimits(cad_factors={name: 1.2 * found.factor})
    assert contradicted_masses(problem({body: factor}), freed) == ()


def test_a_mass_that_does_not_show_is_at_its_limit_and_not_contradicted():
    wrong = problem({4: 1 / 6})
    estimate = ConsistentWithPrior(strength=100.0).estimate(wrong)
    (reached,) = estimate.limits.reached(estimate.parameters)
    assert (reached.body, reached.quantity) == ("B5", "mass")
    assert reached.value == pytest.approx(reached.limit, rel=0.02)
    assert reached.limit == pytest.approx(3 / 6 * data.true_parameters()[40])
    assert contradicted_masses(wrong, PhysicalLimits()) == ()


@LONG
def test_masses_that_are_wrong_together_are_told_together():
    (found,) = contradicted_masses(problem(dict.fromkeys(range(6), 1 / 6)), PhysicalLimits())
    assert found.body == ""
    assert found.cad == pytest.approx(data.true_parameters()[0:60:10].sum() / 6)
    assert found.mass > found.limit


def test_nothing_is_told_without_unknown_links_or_folds():
    known = TorqueModel(data.torque_model().model, (Viscous(),), known=(KnownBodies(),))
    assert contradicted_masses(Problem(known, data.exact(200, 3)), PhysicalLimits()) == ()
    one = Problem(problem({5: 6.0}).torque_model, data.noisy(600, 0, NOISE), n_blocks=1)
    assert contradicted_masses(one, PhysicalLimits()) == ()
