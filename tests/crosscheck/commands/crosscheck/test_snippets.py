"""The code on the page of a comparison, which computes both sides of every quantity again."""

import dataclasses

import numpy as np
import pytest
from long_check import few
from planting import PLANTED, SAMPLES, SEED, with_body
from shown.pages import COMMAND, comparison_page, executed, opened, snippets

import urdf
from crosscheck.comparing.comparison import WorstState
from crosscheck.quantities import COMPARED
from crosscheck.quantities.states import cases
from crosscheck.report.snippets import worst_state


def state_of(model, name):
    """The first state of a case, on the route that Pinocchio takes through the file."""
    case = next(case for case in cases(model, SAMPLES, SEED) if case.name == name)
    tau = None if case.tau is None else tuple(case.tau[0].tolist())
    numbers = (tuple(x[0].tolist()) for x in (case.q, case.v, case.a))
    wrenches = tuple(map(tuple, case.external_wrenches[0].tolist()))
    turn = tuple(map(tuple, case.turn.rotation.tolist()))
    return WorstState("urdf", name, *numbers, tau, wrenches, turn, tuple(case.model.gravity.tolist()))


WITH_STATE = sorted(set(COMPARED) - {"base_parameters"})
ALIKE = {f"{what}_{by}_recursive" for what in ("dmultipliers", "dwrenches") for by in ("dv", "da")}
"""Written like the derivatives by q, and half a second each to compile."""


class TestSnippets:
    @pytest.mark.parametrize("name", few(WITH_STATE, *(set(WITH_STATE) - ALIKE)))
    def test_both_sides_of_every_quantity(self, small_comparison, name, capsys):
        _, difference = executed(worst_state(small_comparison, small_comparison.quantities[name]), capsys)
        assert difference < PLANTED

    def test_every_quantity_with_a_state_has_one(self, small_comparison):
        with_state = {name for name, result in small_comparison.quantities.items() if result.worst}
        assert with_state == set(WITH_STATE)

    def test_the_first_of_the_page_shows_the_disagreement(self, wrong_comparison, tree, plant, capsys):
        """A RobotModel was compared: the reader puts it into `model`."""
        code, *others = snippets(opened(comparison_page([wrong_comparison], COMMAND)))
        results = [result for result in wrong_comparison.quantities.values() if result.worst]
        assert len(others) == len(results) - 1
        worst = max(results, key=lambda result: result.max_relative_error / (result.quantity.tolerance.bound or 1))
        assert not worst.agrees
        names, same = executed(code, capsys, model=tree)
        assert tuple(names["q"].tolist()) == worst.worst.q
        plant.pinocchio_model(lambda model: with_body(model, 1, mass=tree.bodies[0].mass * (1 + PLANTED)))
        _, different = executed(code, capsys, model=tree)
        assert same < 1e-3 * PLANTED < PLANTED < different

    @pytest.mark.parametrize("case", ["gimbal lock of fore", "zero gravity", "torques of a"])
    @pytest.mark.parametrize("name", ["inverse_dynamics", "forward_dynamics_external", "forward_multipliers"])
    def test_turned_weightless_and_balanced_states(self, small_comparison, case, name, capsys):
        """The snippet carries the base, the gravity and the torques of its case."""
        state = state_of(small_comparison.model, case)
        result = dataclasses.replace(small_comparison.quantities[name], worst=state)
        names, difference = executed(worst_state(small_comparison, result), capsys)
        np.testing.assert_allclose(names["model"].gravity, state.gravity)
        assert difference < PLANTED

    def test_numbers_survive(self, small_comparison, capsys):
        result = small_comparison.quantities["inverse_dynamics"]
        names, _ = executed(worst_state(small_comparison, result), capsys)
        for name in ("q", "v", "a"):
            assert tuple(names[name].tolist()) == getattr(result.worst, name)

    def test_names_of_the_catalog(self, small_comparison):
        kr500 = next(entry for entry in urdf.robots() if entry.name == "kr500")
        renamed = dataclasses.replace(small_comparison, robot="kr500", file=str(kr500.path.resolve()))
        assert "urdf.load('kr500', gravity=[0.0, 0.0, -9.81])" in worst_state(
            renamed, small_comparison.quantities["inverse_dynamics"]
        )
        elsewhere = dataclasses.replace(small_comparison, robot="kr500")  # a file of that name
        assert f"urdf.load({small_comparison.file!r}, " in worst_state(
            elsewhere, small_comparison.quantities["inverse_dynamics"]
        )
