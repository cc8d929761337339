"""Errors against exact values: those of numbers known otherwise, planted ones, and what is left out."""

import dataclasses
from fractions import Fraction

import numpy as np
import pytest
from long_check import few
from planting import mixed_tree
from random_trees import random_tree
from urdf_text import joint, link, robot_text

import crosscheck
import graphdyn
import urdf
from crosscheck.comparing.accuracy import measuring
from crosscheck.comparing.accuracy.measured_states import MeasuredQuantity, measured_quantities
from crosscheck.quantities import COMPARED, QUANTITIES, TabulatedQuantity
from crosscheck.quantities.states import RANDOM, cases
from crosscheck.quantities.tolerances import EPS
from crosscheck.reference.pinocchio_model import PinocchioAnswers
from graphdyn import Body, InvalidInput, Joint, Placement, RobotModel

pytest.importorskip("flint", reason="the extra graphdyn[exact] is not installed")

SAMPLES = 2
METHODS = {"recursive", "projected"}
PLANTED = 1e-12
ROUNDED = 10
"""Eps of the scale; measured below 2."""


def wheel(mass=1.3, inertia=0.7):
    """One joint about the z axis through its body's center of mass."""
    body = Body("wheel", mass, np.zeros(3), np.diag([0.5, 0.5, inertia]))
    return RobotModel("wheel", (body,), (Joint("spin", "revolute", 0, Placement(), np.array([0.0, 0.0, 1.0])),))


@pytest.fixture
def only(monkeypatch):
    """only("kinetic_energy"): no other quantity is measured."""

    def only(*names):
        known = measured_quantities()
        monkeypatch.setattr(measuring, "measured_quantities", lambda: {name: known[name] for name in names})

    return only


def crane():
    """A joint that turns, and one that slides on it."""
    return random_tree(5, [0, 1], ["revolute", "prismatic"])


@pytest.fixture(scope="module", params=few(["crane", "branching"], "crane"))
def robot(request):
    return {"crane": crane, "branching": mixed_tree}[request.param]()


@pytest.fixture(scope="module")
def errors(robot):
    """Of every quantity."""
    return crosscheck.true_errors(robot, SAMPLES)


def test_every_quantity_is_measured_or_named(errors):
    measured = {name for name, quantity in measured_quantities().items() if quantity is not None}
    assert set(errors.quantities) == measured
    assert set(errors.not_measured) == set(measured_quantities()) - measured
    rows = {quantity.row.name for quantity in COMPARED.values() if isinstance(quantity, TabulatedQuantity)}
    known = {q.row.name if isinstance(q, MeasuredQuantity) else name for name, q in measured_quantities().items()}
    assert rows <= {name.removesuffix("_external") for name in known} | known
    exact = {name for name, row in QUANTITIES.items() if row.ours.verb and row.forms} | {"frame_placement"}
    assert {q.row.name for q in measured_quantities().values() if q} == exact
    assert {"dynamics_residual", "kkt_rank"} <= set(errors.not_measured)


def test_placements_of_frames(monkeypatch):
    """Of all frames at once; one whose offset is off by 1e-12 m is as far from the exact one."""
    chosen = {"frame_placement": measured_quantities()["frame_placement"]}
    monkeypatch.setattr(measuring, "measured_quantities", lambda: chosen)
    model = urdf.load("ur5")
    codes = crosscheck.true_errors(model, SAMPLES).quantities["frame_placement"].codes
    assert 0 < max(code.largest for code in codes.values()) < ROUNDED
    right = graphdyn.frame_placement

    def planted(model, q, frame):
        rotation, position = right(model, q, frame)
        return rotation, position + PLANTED

    monkeypatch.setattr(graphdyn, "frame_placement", planted)
    codes = crosscheck.true_errors(model, SAMPLES).quantities["frame_placement"].codes
    assert codes["Pinocchio"].largest < ROUNDED
    reach = max(np.abs(right(model, np.zeros(6), frame.name)[1]).max() for frame in model.frames)
    assert PLANTED / EPS / (2 * reach) < codes["recursive"].largest < PLANTED / EPS / (0.1 * reach)


def test_every_code_rounds_and_none_exceeds_a_bound(errors):
    assert errors.agrees
    for quantity in errors.quantities.values():
        assert METHODS | {"Pinocchio"} <= set(quantity.codes)
        for code in quantity.codes.values():
            assert 0 <= code.median <= code.quantile_99 <= code.largest <= quantity.bound
    assert "dense" in errors.quantities["forward_dynamics"].codes
    assert "dense" not in errors.quantities["mass_matrix"].codes
    assert all(code.largest > 0 for code in errors.quantities["inverse_dynamics"].codes.values())


def test_states_are_those_of_the_cross_check(errors, robot):
    of_case = {case.name: len(case.q) for case in cases(robot, SAMPLES, 0)}
    found = errors.quantities["inverse_dynamics"].codes["recursive"].by_case
    assert {name: errors.shape[1] for name, errors in found.items()} == of_case
    assert errors.quantities["inverse_dynamics"].states == sum(of_case.values())
    assert set(errors.quantities["dtau_dq"].codes["recursive"].by_case) == {RANDOM}


def test_energy_of_a_wheel_against_fractions(only):
    """Its exact kinetic energy is I v² / 2, a fraction of doubles."""
    only("kinetic_energy")
    model = wheel()
    found = crosscheck.true_errors(model, SAMPLES).quantities["kinetic_energy"].codes["projected"]
    v = next(cases(model, SAMPLES, 0)).v
    expected = []
    for q, rate in zip(next(cases(model, SAMPLES, 0)).q, v[:, 0], strict=True):
        exact = Fraction(0.7) * Fraction(float(rate)) ** 2 / 2
        computed = graphdyn.kinetic_energy(model, q, np.array([rate]), method="projected")
        expected.append(float(abs(Fraction(float(computed)) - exact) / exact) / EPS)
    assert np.allclose(found.by_case[RANDOM], [expected] * 2, rtol=1e-4, atol=0)


def test_the_scale_is_that_of_the_bound(only):
    """Planted far above rounding, an error in eps is that of the cross-check over eps."""
    only("inverse_dynamics", "forward_dynamics")
    planted, tau = 1e-7, PinocchioAnswers.tau.fget
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(PinocchioAnswers, "tau", property(lambda there: (1 + planted) * tau(there)))
        measured, compared = crosscheck.true_errors(crane(), 1), crosscheck.compare(crane(), 1)
    found = measured.quantities["inverse_dynamics"].codes["Pinocchio"]
    assert found.largest_by_case == pytest.approx(
        {name: error / EPS for name, error in compared.quantities["inverse_dynamics"].by_case.items()}, rel=1e-6
    )
    assert found.quantile_99_of_values == pytest.approx(planted / EPS, rel=1e-6)
    assert measured.quantities["inverse_dynamics"].beyond == ("Pinocchio",)
    assert measured.quantities["forward_dynamics"].beyond == ()
    assert not measured.agrees
    assert compared.quantities["inverse_dynamics"].max_relative_error / EPS == pytest.approx(found.largest, rel=1e-6)


def test_answers_that_are_not_finite(only):
    only("kinetic_energy")
    with pytest.MonkeyPatch.context() as patch:
        row = QUANTITIES["kinetic_energy"]
        known = measured_quantities()["kinetic_energy"]
        broken = dataclasses.replace(row, pinocchio=lambda there, _: np.full(len(there.q), np.nan))
        wrong = {"kinetic_energy": dataclasses.replace(known, row=broken)}
        patch.setattr(measuring, "measured_quantities", lambda: wrong)
        found = crosscheck.true_errors(wheel(), SAMPLES).quantities["kinetic_energy"]
    assert found.codes["Pinocchio"].largest == np.inf
    assert found.beyond == ("Pinocchio",)


def test_states_that_are_not_regular_are_counted(only):
    """A point mass on a slide turns about the axis: at the zero pose its distance is zero, and so is its inertia."""
    only("inverse_dynamics", "forward_dynamics")
    z, x = np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])
    bodies = (Body("arm", 0.0, np.zeros(3), np.zeros((3, 3))), Body("point", 2.0, np.zeros(3), np.zeros((3, 3))))
    joints = (Joint("turn", "revolute", 0, Placement(), z), Joint("slide", "prismatic", 1, Placement(), x))
    found = crosscheck.true_errors(RobotModel("slider", bodies, joints), SAMPLES)
    assert found.not_regular == {"zero pose at rest": 1, "zero pose": SAMPLES}
    forward, inverse = (found.quantities[name] for name in ("forward_dynamics", "inverse_dynamics"))
    assert inverse.states - forward.states == 1 + SAMPLES
    assert "zero pose" not in forward.codes["recursive"].by_case


def test_massless_robots_have_no_forward_dynamics(only):
    only("inverse_dynamics", "forward_dynamics", "center_of_mass")
    bodies = (Body("wheel", 0.0, np.zeros(3), np.zeros((3, 3))),)
    found = crosscheck.true_errors(dataclasses.replace(wheel(), bodies=bodies), 1)
    assert list(found.quantities) == ["inverse_dynamics"]
    assert "singular" in found.not_measured["forward_dynamics"]
    assert found.not_measured["center_of_mass"] == "no body has mass: kinematics only"
    assert any(note.startswith("MuJoCo does not take part: ") for note in found.notes)


@pytest.mark.parametrize("samples", [0, 1.5])
def test_refused_counts(samples):
    with pytest.raises(InvalidInput, match="give a whole number of random states, at least 1"):
        crosscheck.true_errors(wheel(), samples)


def test_errors_of_reading_count_where_the_file_is_the_truth(only, tmp_path):
    """The double of a mass of 0.1 kg is not the decimal, and the torque m g l of a pendulum inherits that."""
    only("gravity_torque")
    path = tmp_path / "pendulum.urdf"
    hanging = link("bob", 0.1, xyz="1 0 0"), joint("pivot", "base", "bob", "continuous", '<axis xyz="0 1 0"/>')
    path.write_text(robot_text("pendulum", link("base", None), *hanging), encoding="utf-8")
    computed = abs(Fraction(graphdyn.gravity_torque(urdf.load(path), [0.0], method="projected").item()))
    for truth, mass in (("file", Fraction(1, 10)), ("model", Fraction(0.1))):
        found = crosscheck.true_errors(path, 1, truth=truth)
        assert found.truth == truth
        errors = found.quantities["gravity_torque"].codes["projected"]
        exact = mass * Fraction(9.81)
        expected = float(abs(computed - exact) / exact) / EPS
        assert errors.largest_by_case["zero pose at rest"] == pytest.approx(expected, rel=1e-6)


def test_the_truth_of_a_file_needs_one():
    with pytest.raises(InvalidInput, match="is a model: there is no file of it"):
        crosscheck.true_errors(wheel(), 1, truth="file")
    with pytest.raises(InvalidInput, match="use 'file' or 'model'"):
        crosscheck.true_errors(wheel(), 1, truth="files")
