"""Motions, laws of noise and errors of the model of one's own, FILE.py:NAME in scenarios."""

from dataclasses import replace

import numpy as np
import pytest
from identified import small_study as small
from identified.small_study import ARM, InThisProcess

from crosscheck.study.running import run_study
from crosscheck.study.settings.configuration import configuration_of
from crosscheck.study.settings.settings import BadConfiguration
from crosscheck.study.simulated.runs import simulated
from crosscheck.study.so_far import read_so_far
from graphdyn import InvalidInput

CODE = """
import numpy as np
from graphdyn.motion_laws import FourierSeries

def waves(model, limits, rng, duration):
    return [FourierSeries(2 * np.pi / duration, rng.normal(size=2) * 0.1, [0.2, 0.1]) for _ in range(model.nv)]

def drifting(rng, tau):
    return np.cumsum(rng.standard_normal(tau.shape), axis=0) / np.sqrt(len(tau))

def magnets(q, v, a):
    return 3.0 * np.sin(6 * q)

def one(model, limits, rng, duration):
    return waves(model, limits, rng, duration)[:1]

def two(model, limits, rng, duration):
    return [lambda times: (times, times)] * model.nv

def lost(model, limits, rng, duration):
    return [lambda times: (times, times, np.nan * times)] * model.nv

def short(rng, tau):
    return rng.standard_normal(3)
"""

SCENARIO = "[scenario]\nduration = 4\nsampling_rate = 200\ncontrol_rate = 200\ncutoff = 20\ntorque_noise = 0.5\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("laws")
    (folder / "small.urdf").write_text(ARM, encoding="utf-8")
    (folder / "laws.py").write_text(CODE, encoding="utf-8")
    return folder


def study_of(folder, further, allow_code=True):
    text = small.STUDY + small.ROBOT + SCENARIO + further
    return configuration_of(text.encode(), "study.toml", folder, allow_code=allow_code)


def test_a_motion_and_noise(folder):
    """Each run has its own motion, and noise of the torques that drifts."""
    study = study_of(folder, 'motion = "laws.py:waves"\ntorque_noise_law = "laws.py:drifting"\n')
    (scenario,) = study.scenarios
    assert (scenario.motion, study.own_laws) == ("laws.py:waves", tuple(
        f"{folder.resolve() / 'laws.py'}:{name}" for name in ("waves", "drifting")
    ))  # fmt: skip
    first, again, other = (simulated(study, scenario, study.design.draw(run)).recording for run in (0, 0, 1))
    assert np.array_equal(first.channel("q"), again.channel("q"))
    assert np.abs(first.channel("q") - other.channel("q")).max() > 0.01
    loud = replace(scenario, torque_noise=20.0)
    normal = replace(loud, torque_noise_law="normal")
    drift, white = (simulated(study, one, study.design.draw(0)).recording.channel("tau") for one in (loud, normal))
    assert np.median(np.abs(np.diff(drift, axis=0))) < 0.2 * np.median(np.abs(np.diff(white, axis=0)))


def test_an_error_of_the_model(folder):
    """What the actuators give beyond the model is in the recorded torques, and nothing else changes."""
    study = study_of(
        folder, 'position_noise = 0\n[[grid]]\ncutoff = "none"\nmodel_error = ["none", "laws.py:magnets"]\n'
    )
    right, off = (simulated(study, one, study.design.draw(0)).recording for one in study.scenarios)
    assert study.own_laws == (f"{folder.resolve() / 'laws.py'}:magnets",)
    assert np.array_equal(right.channel("q"), off.channel("q"))
    added = off.channel("tau") - right.channel("tau")
    q = right.channel("q")
    moved = np.abs(np.gradient(q, right.t, axis=0)).max() / 200  # in a period, while torques are held
    np.testing.assert_allclose(added, 3.0 * np.sin(6 * q), atol=18 * moved)
    assert np.abs(added).max() > 2


def test_results_are_kept_with_the_hash_of_the_code(folder, tmp_path):
    study = study_of(folder, 'motion = "laws.py:waves"\n')
    run_study(study, tmp_path / "out", InThisProcess())
    assert str(folder.resolve() / "laws.py") in study.own_files
    found = read_so_far(tmp_path / "out").outcomes
    assert found.scenarios[0].axes["motion"] == "laws.py:waves"
    assert found.scenarios[0].found.all()


@pytest.mark.parametrize(
    ("further", "said"),
    [
        ('motion = "waves"\n', r"motion in \[scenario\] is 'waves'; use one of random, .*, or FILE\.py:NAME"),
        ('motion = "none.py:waves"\n', r"there is no file .*none\.py for a motion, noise or an error"),
    ],
)
def test_refused_configurations(further, said, folder):
    with pytest.raises(BadConfiguration, match=said):
        study_of(folder, further)


def test_code_that_is_not_allowed(folder):
    with pytest.raises(BadConfiguration, match=r"scenarios: names Python code, .*laws\.py:waves.* add --allow-code"):
        study_of(folder, 'motion = "laws.py:waves"\n', allow_code=False)


@pytest.mark.parametrize(
    ("further", "said"),
    [
        ('motion = "laws.py:one"\n', r"laws\.py:one gives 1 laws for 2 joints; give one function for each"),
        ('motion = "laws.py:two"\n', r"laws\.py:two: the law of 'shoulder' gives no q, v and a \(N,\) of times"),
        ('motion = "laws.py:lost"\n', r"laws\.py:lost: the law of 'shoulder' gives no q, v and a \(N,\) of times"),
        ('torque_noise_law = "laws.py:short"\n', r"laws\.py:short gives noise of shape \(3,\); \(801, 2\) is needed"),
    ],
)
def test_laws_that_are_none(further, said, folder):
    study = study_of(folder, further)
    with pytest.raises(InvalidInput, match=said):
        simulated(study, study.scenarios[0], study.design.draw(0))
