"""Right equations with other inertial parameters: told from wrong ones, with the mistake at each link."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from long_check import few

import urdf
from crosscheck.judging.faults.file_reading import faults_of_file
from crosscheck.judging.faults.link_mistakes import mistakes, shifted
from crosscheck.judging.faults.link_parameters import in_body, links_of, right
from crosscheck.judging.faults.recursion import DynamicsCode, torques_of
from crosscheck.judging.observing.observation import Observation
from crosscheck.judging.searching.parameters import OtherParameters, with_parameters
from crosscheck.reference.subject import subject
from graphdyn import RobotModel

MUSEUM_ARM = Path(__file__).parents[4] / "docs" / "museum" / "arm.urdf"
"""Its inertial frames are turned, and one of its links is fixed to another one."""

BOUND = 1e-9

MISTAKES = list(mistakes())


@pytest.fixture(scope="module")
def arm():
    with pytest.warns(urdf.AxisNotNormalizedWarning):
        robot = subject(str(MUSEUM_ARM), urdf.Reading())
    return robot.model, faults_of_file(robot).links


def rows_of(model, code, count=30):
    """What a code answers, as rows that are compared."""
    state = tuple(np.random.default_rng(1).normal(size=(3, count, model.n_bodies)))
    (answers,) = torques_of([code], state)
    scale = np.full((count, 1), np.abs(answers).max())
    return Observation(state, np.arange(count), np.full(count, -1), answers / scale, scale, np.full(count, "judged"))


def told(model, links, code):
    """The messages of mistakes that give what the code answers."""
    parameters = OtherParameters(DynamicsCode.of(model), rows_of(model, code), BOUND)
    assert parameters.fits
    return [next(iter(fault.say(fault.right))).message for fault in parameters.faults(links)]


def test_links_make_up_the_bodies(arm):
    model, links = arm
    whole = np.zeros((model.n_bodies, 13))
    for link in links:
        whole[link.body] += in_body(link, right(link))
    ours = [in_body(body, right(body)) for body in links_of(model, None)]
    assert len(links) == model.n_bodies + 1
    np.testing.assert_allclose(whole, ours, atol=1e-12 * np.abs(ours).max())


@pytest.mark.parametrize("mistake", few(MISTAKES, *MISTAKES[::15]), ids=lambda mistake: mistake.message)
def test_a_mistake_at_some_links_is_named(arm, mistake):
    """At every link, at one, at two: the words name the links, whatever the body that they belong to."""
    model, links = arm
    differences = mistake.differences(links)
    alike = [other for other in MISTAKES if np.allclose(other.differences(links), differences, atol=1e-12)]
    changing = [k for k, difference in enumerate(differences) if np.abs(difference).max() > 1e-9]
    for members in (changing, changing[-1:], changing[1:3]):
        change = with_parameters(DynamicsCode.of(model), [(links[k].body, differences[k]) for k in members])
        if change is None or not members or ("left out" in mistake.message and len(members) == len(links)):
            continue  # no code has such numbers, or all torques vanish
        every = len(members) == len(changing) > 1
        names = ", ".join(repr(links[k].name) for k in members)
        who = "every link" if every else f"link{'s' if len(members) > 1 else ''} {names}"
        found = told(model, links, change(DynamicsCode.of(model)))
        assert {other.message.format(who=who) for other in alike} & set(found)


def test_numbers_of_the_neighbors_are_named(arm):
    model, links = arm
    """Of links as the file has them, and of the bodies that they make up."""
    own = DynamicsCode.of(model)
    shifts = list(shifted(links, own))
    assert {"link", "body"} <= {message.split(" every ")[-1].split()[0] for message, _ in shifts}
    for message, of_bodies in shifts[::4]:
        assert message in told(model, links, with_parameters(own, of_bodies)(own))


def test_the_fewest_bodies_with_other_parameters(arm):
    model, _ = arm
    own = DynamicsCode.of(model)
    changed = own.but(masses=own.numbers.masses * [1, 1, 1.2, 1, 0.7, 1])
    parameters = OtherParameters(own, rows_of(model, changed), BOUND)
    assert (2, 4) in parameters.of_bodies()
    assert all(len(bodies) == 2 for bodies in parameters.of_bodies())
    every = own.but(masses=own.numbers.masses * np.linspace(1.1, 1.6, 6), tensors=own.numbers.tensors * 1.3)
    many = OtherParameters(own, rows_of(model, every), BOUND)
    assert many.fits
    assert many.of_bodies() == []
    said = many.smallest()
    assert "more than three bodies" in next(iter(said.say(said.right))).message
    (answers,) = torques_of([said.change(own, said.right)], rows_of(model, own).state)
    expected = rows_of(model, every)
    assert np.abs(answers / expected.scale - expected.answers).max() <= BOUND


def test_wrong_equations_are_no_other_parameters(arm):
    model, _ = arm
    own = DynamicsCode.of(model)
    wrong = own.but(gyroscopic=np.full(model.n_bodies, 0.9))
    assert not OtherParameters(own, rows_of(model, wrong), BOUND).fits
    assert not OtherParameters(own, rows_of(model, own, count=5), BOUND).fits  # too few answers to prove anything


def test_a_first_moment_without_mass_is_no_code():
    """Torques are computed from masses and centers of mass."""
    body = replace(urdf.load("ur5").bodies[0], mass=0.0, center_of_mass=np.zeros(3))
    model = RobotModel("one", (body,), urdf.load("ur5").joints[:1])
    moved = np.zeros(13)
    moved[1] = 1.0
    assert with_parameters(DynamicsCode.of(model), [(0, moved)]) is None
