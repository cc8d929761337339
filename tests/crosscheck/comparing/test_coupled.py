"""The cross-check of robots whose joints drive each other: further quantities, which can fail."""

import json
from dataclasses import replace

import pytest
from planting import mixed_tree
from typer.testing import CliRunner

import crosscheck
import graphdyn
import urdf
from crosscheck.commands import app
from crosscheck.quantities import COMPARED, COUPLED
from crosscheck.reference.pinocchio_model import PinocchioAnswers, PinocchioModel
from crosscheck.report.snippets import worst_call
from graphdyn import Coupling

SAMPLES = 5


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    """A tree with a turning and a sliding joint that follow another."""
    tree = mixed_tree().with_gravity((0.0, 0.0, -9.81))  # what a URDF file stands for
    name = tree.joint_names
    path = tmp_path_factory.mktemp("coupled") / "tree.urdf"
    couplings = (Coupling(name[1], {name[0]: -0.5}, 0.1), Coupling(name[2], {name[1]: 2.0}))
    urdf.save(replace(tree, couplings=couplings), path)
    return path


@pytest.fixture(scope="module")
def comparison(file):
    return crosscheck.compare(file, samples=SAMPLES)


def test_agrees_in_all_quantities(comparison):
    assert comparison.agrees
    assert comparison.routes == ("urdf", "model")
    assert set(comparison.quantities) - set(COMPARED) == set(COUPLED)
    assert comparison.model.couplings == ()
    assert crosscheck.compare(comparison.model, samples=1).quantities.keys().isdisjoint(COUPLED)


@pytest.mark.usefixtures("random_states_alone")
@pytest.mark.parametrize(
    ("place", "field", "seen"),
    [
        (PinocchioAnswers, "tau", {"coupled_inverse_dynamics", "coupling_multipliers", "coupled_forward_dynamics"}),
        (PinocchioAnswers, "mass_matrix", {"coupled_mass_matrix"}),
        (PinocchioModel, "torque_regressor", {"coupled_joint_torque_regressor"}),
    ],
)
def test_an_error_of_pinocchio_is_seen(file, monkeypatch, place, field, seen):
    original = getattr(place, field)
    compute = getattr(original, "func", None) or getattr(original, "fget", None)
    planted = property(lambda there: compute(there) * (1 + 1e-9)) if compute else lambda *x: original(*x) * (1 + 1e-9)
    monkeypatch.setattr(place, field, planted)
    found = crosscheck.compare(file, samples=SAMPLES).quantities
    assert {name for name in COUPLED if not found[name].agrees} == seen


@pytest.mark.usefixtures("random_states_alone", "unpictured")
def test_on_the_command_line(file, tmp_path):
    out, page = tmp_path / "out.json", tmp_path / "page.html"
    command = ["crosscheck", str(file), "--samples", str(SAMPLES), "--json", str(out), "--html", str(page)]
    result = CliRunner().invoke(app, command)
    assert result.exit_code == 0
    assert "coupled_inverse_dynamics" in result.output
    (robot,) = json.loads(out.read_text())["robots"]
    assert set(COUPLED) < set(robot["quantities"])
    assert ").uncoupled" in page.read_text()


def test_judged_as_if_independent(file):
    free = urdf.load(file).uncoupled
    judgment = crosscheck.judge(file, mass_matrix=lambda q: graphdyn.mass_matrix(free, q), samples=5)
    assert judgment.agrees
    assert judgment.notes == ("joints that others drive are judged as if they were independent",)
    assert ").uncoupled" in worst_call(judgment, judgment.functions["mass_matrix"])
