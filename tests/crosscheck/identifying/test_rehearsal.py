"""Rehearsals of motions of a small arm: deviations that cover the truth of further robots, and what is undetermined."""

from dataclasses import replace

import numpy as np
import pytest
from identified.small_study import ARM

import urdf
from crosscheck.identifying import Conditions, Preparation, rehearse, term_with
from crosscheck.identifying.rehearsal import CHOOSING_RUNS, _another, _correlated
from graphdyn import InvalidInput
from graphdyn.excitation import TabulatedCourse
from graphdyn.identification import TorqueModel, plausibility
from graphdyn.identification.terms import RigidBodies, Viscous

RUNS = 25

COVERED = (0.88, 1.0)
"""Share of errors within two deviations, which themselves come from RUNS errors and are right to 14 %: 95 % in the
mean, over few and dependent parameters."""

METHODS = ("wls", "consistent")


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("arm") / "small.urdf"
    path.write_text(ARM, encoding="utf-8")
    return path


def course(*joints):
    """Ten seconds in which these of the two joints move."""
    t = np.arange(0, 10.01, 0.05)
    q = np.column_stack([np.sin(1.3 * t) + 0.5 * np.sin(2.9 * t), 0.8 * np.cos(1.1 * t) + 0.7 * np.sin(2.3 * t)])
    return TabulatedCourse(t, np.where(np.isin([0, 1], joints), q, 0.3))


def rehearsed(arm, *joints, methods=METHODS, **conditions):
    made = Conditions(rate=50.0, runs=conditions.pop("runs", RUNS), **conditions)
    return rehearse(arm, course(*joints), methods=methods, preparation=Preparation(5.0), conditions=made)


@pytest.fixture(scope="module")
def found(arm):
    return rehearsed(arm, 0, 1)


def test_twice_the_deviation_covers_the_truth_of_further_robots(arm, found):
    further = rehearsed(arm, 0, 1, seed=7)
    assert found.complete
    inside = []
    for name, outcome in found.outcomes.items():
        inside.append(np.abs(further.outcomes[name].base) <= 2 * outcome.base_deviations)
    links, errors = found.outcomes["consistent"], further.outcomes["consistent"]
    assert links.consistent
    inside.append(np.abs(errors.masses) <= 2 * links.mass_deviations)
    inside.append(np.abs(errors.centers) <= 2 * links.center_deviations)
    assert COVERED[0] <= np.mean(np.concatenate([part.ravel() for part in inside])) <= COVERED[1]


def test_strengths_of_priors_are_chosen_in_the_first_runs(arm):
    entropic = rehearsed(arm, 0, 1, methods=("entropic",), runs=7)
    (strengths,) = entropic.strengths.values()
    assert len(strengths) == CHOOSING_RUNS
    assert entropic.best_of_links == entropic.best == "consistent, entropic prior"
    assert np.all(entropic.outcomes[entropic.best].mass_deviations < 0.2 * entropic.masses)


def test_the_deviations_that_wls_will_state_are_those_that_it_has(found):
    outcome = found.outcomes["WLS"]
    assert COVERED[0] - 0.05 <= outcome.covered <= 1.0
    assert np.median(outcome.stated / outcome.base_deviations) == pytest.approx(1.0, abs=0.35)


def test_a_recording_with_less_noise_tells_more(arm, found):
    quiet = rehearsed(arm, 0, 1, methods=("wls",), torque_noise=0.005)
    ratio = quiet.outcomes["WLS"].base_deviations / found.outcomes["WLS"].base_deviations
    assert np.median(ratio) == pytest.approx(0.1, rel=0.3)  # the positions have noise too
    assert quiet.share("WLS") < found.share("WLS")


def test_what_the_motion_does_not_determine_is_named(arm):
    one = rehearsed(arm, 1, methods=("wls",), runs=2)
    assert not one.complete
    assert one.identifiability.rank < one.identifiability.structural_rank
    assert one.still_joints == ("shoulder",)
    assert one.identifiability.lost


def test_the_robots_differ_from_the_file_and_are_real(arm):
    model = urdf.load(arm)
    rng = np.random.default_rng(0)
    others = [_another(model, rng, 0.2) for _ in range(50)]
    masses = np.array([[body.mass for body in other.bodies] for other in others]) / [body.mass for body in model.bodies]
    assert 0.8 <= masses.min() < 0.85
    assert 1.15 < masses.max() <= 1.2
    parameters = np.array([other.inertial_parameters for other in others])
    assert all(found.consistent for found in plausibility(TorqueModel(model, (RigidBodies(),)), parameters, poses=1))


def test_noise_is_as_stated():
    conditions = Conditions(noise_time=0.1, rate=100.0)
    noise = _correlated((200_000, 2), conditions, np.random.default_rng(0))
    assert np.std(noise, axis=0) == pytest.approx(1.0, rel=0.05)
    assert np.mean(noise[10:] * noise[:-10], axis=0) == pytest.approx(np.exp(-1), abs=0.05)
    white = _correlated((200_000, 2), replace(conditions, noise_time=0.0), np.random.default_rng(0))
    assert np.mean(white[1:] * white[:-1], axis=0) == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize(
    ("conditions", "message"),
    [
        ({"torque_noise": -0.1}, "torque_noise is -0.1; give a number that is not below zero"),
        ({"cad_error": 1.0}, "cad_error is 1; give a relative error between 0 and 1"),
        ({"rate": 0.0}, "rate is 0; give Hz above zero"),
        ({"runs": 1}, "runs is 1; deviations need two or more"),
    ],
)
def test_impossible_conditions(conditions, message):
    with pytest.raises(InvalidInput, match=message):
        Conditions(**conditions)


def test_refusals(arm):
    slip = term_with("slip", deflection=0.01)
    with pytest.raises(InvalidInput, match="friction with memory, and settings that are to be found, cannot be"):
        rehearse(arm, course(0, 1), terms=[Viscous(), slip])
