"""The comparison can fail: for every quantity an error is planted, and that quantity, no other, disagrees."""

import math
import sys
from itertools import product

import numpy as np
import pytest
from long_check import few
from planting import SAMPLES, SEED, compared, flagged, mixed_tree, with_body, with_joint
from shown.pages import first_cells

import crosscheck
from crosscheck.commands import main
from crosscheck.commands.crosscheck.record import robot_record
from crosscheck.commands.program.exits import DISAGREED
from crosscheck.comparing import compare as comparing
from crosscheck.comparing.baseline import BaselineIdentification
from crosscheck.comparing.error_record import ErrorTable
from crosscheck.paper.errata import world_axis_rows
from crosscheck.quantities import COMPARED, QUANTITIES
from crosscheck.quantities.states import cases
from crosscheck.reference.pinocchio_model import PinocchioAnswers, PinocchioModel
from crosscheck.reference.subject import FRAME_REFERENCES
from crosscheck.report.records.record import plain
from graphdyn import Placement, inverse_dynamics
from graphdyn.equations.system.constraints import constraints
from graphdyn.equations.system.unconstrained import mass_terms
from graphdyn.model.spatial import rotation_about

PLANTED = 1e-11
"""Relative error planted in one entry: ten times the widest bound without a condition number."""

PLANTED_FORWARD = 1e-9
"""The same where the bound grows with cond(M), below 10 here, or the scale with the terms that were summed."""

PHYSICAL = 1e-9
"""Relative change of a mass, a tensor, a lever, an axis, gravity; its effect is at least a thousandth of that."""

MEASURED = 1e-3
"""How well an error of 1e-9 is measured: rounding is 1e-15 to 1e-13 of the same scale."""

SHARED = {
    "rotation": {
        "link_placement",
        "multipliers",
        "multipliers_recursive",
        "forward_multipliers",
        "forward_multipliers_recursive",
    },
    "joint_wrenches": {"joint_wrenches", "joint_wrenches_recursive", "multipliers", "multipliers_recursive"},
}
"""Numbers of Pinocchio that several quantities take, and which these are."""

OURS_ALONE = {"dynamics_residual", "constraint_residual", "constraint_rank", "kkt_rank"}
"""Judged without the reference."""

DERIVED = [name for name, row in QUANTITIES.items() if any(form.when != "all" for form in row.forms)]
"""Quantities that are compared at the first random states only, by two methods."""

BACKWARD = {name for name in COMPARED if name.startswith("backward_error")}
"""Judged by the torques that Pinocchio computes at our accelerations."""

SOLVED = {name for name, row in QUANTITIES.items() if row.solves} | {"multipliers", "link_placement"}
"""Their bounds grow with cond(M), or their scales with the terms that were summed."""

VISIBLE_IN = {
    (name, loaded): {f"{name}{form.suffix}" for form in row.forms if form.loaded == loaded}
    for name, row in QUANTITIES.items()
    for loaded in (False, True)
    if name not in OURS_ALONE and not row.from_file and any(form.loaded == loaded for form in row.forms)
}
"""Which quantities a wrong answer of Pinocchio shows in, without and with external wrenches."""

OWN_TEST = {"frame_placement", "base_parameters"}
"""Judged otherwise."""

KINEMATIC = {"link_placement", "body_velocities", "body_accelerations"}

DIGITS = (len(VISIBLE_IN) - 1).bit_length()
"""Binary digits of the numbers of the answers, in one of which any two answers differ."""

numbered = pytest.mark.parametrize("number", few([1, 2, 3], 3))


def test_every_quantity_is_planted():
    assert set().union(*VISIBLE_IN.values()) | OURS_ALONE | OWN_TEST == set(COMPARED)


def test_without_a_plant_it_agrees(tree):
    comparison = crosscheck.assert_agrees(tree, SAMPLES, SEED)
    assert flagged(comparison) == set()
    assert set(comparison.quantities) == set(COMPARED) - {"frame_placement"}  # no file, no frames


@pytest.mark.parametrize("digit", range(DIGITS))
@pytest.mark.parametrize("value", [0, 1])
def test_one_wrong_entry_of_the_pinocchio(request, tree, plant, monkeypatch, digit, value):
    """Flagged in its quantities only and in its case only; named by every channel that reports it.

    Planted in all answers whose numbers have this digit: for any two answers, in each of them without the other. Once
    in every answer with the other cases beside.
    """
    if digit:
        request.getfixturevalue("random_states_alone")
    chosen = [key for number, key in enumerate(VISIBLE_IN) if number >> digit & 1 == value]
    planted = {key: plant.pinocchio_quantity(key[0], slightly_off(key[0]), key[1]) for key in chosen}
    with pytest.raises(crosscheck.Disagreement) as caught:
        crosscheck.assert_agrees(tree, SAMPLES, SEED)
    comparison = caught.value.comparison
    assert not comparison.agrees
    visible = set().union(*(VISIBLE_IN[key] for key in chosen))
    assert flagged(comparison) == visible
    for key in chosen:
        for name in VISIBLE_IN[key]:
            result = comparison.quantities[name]
            wrong = {case for case, error in result.by_case.items() if error > result.quantity.tolerance.bound}
            assert wrong == {"random"}
            assert result.worst.case == "random"
            assert result.worst.q == planted[key]["q"]
    assert isinstance(caught.value, AssertionError)
    assert f"'{tree.name}'" in str(caught.value).splitlines()[0]
    assert set(first_cells(str(caught.value), "DISAGREES")) == visible
    shown = next(result for result in comparison.quantities.values() if result.quantity.name in visible)
    assert f"{shown.quantity.name} where its error is largest: random, route model" in str(caught.value)
    if digit == 0:
        assert exit_code(monkeypatch, comparison) == DISAGREED


def slightly_off(name):
    factor = 1 + (PLANTED_FORWARD if name in {*DERIVED, *SOLVED} else PLANTED)
    return lambda x: x * factor


@pytest.mark.usefixtures("random_states_alone")
@pytest.mark.parametrize("field", SHARED)
def test_one_wrong_number_of_several_quantities(tree, plant, field):
    plant.pinocchio_value(field, lambda x: x * (1 + PLANTED_FORWARD))
    assert flagged(compared(tree)) == SHARED[field]


def test_every_route_has_errors_of_its_own():
    """Beside our answers with the loads of the case."""
    case, *_ = cases(mixed_tree(), SAMPLES, SEED)
    seen, table = [], ErrorTable()

    def errors(of, ours, size):
        seen.append((of, ours.loads))
        return {"momentum": np.full(len(ours.q), size)}

    table.add_of_routes(case, errors, {"urdf": 1e-3, "model": 2e-3})
    assert table.results()["momentum"].by_route == {"urdf": 1e-3, "model": 2e-3}
    assert all(of is case and loads is case.external_wrenches for of, loads in seen)


@pytest.mark.usefixtures("random_states_alone")
@pytest.mark.parametrize("reference", FRAME_REFERENCES)
def test_one_wrong_reference_of_frames(tree, plant, reference):
    planted = plant.pinocchio_reference(reference, 1 + PLANTED_FORWARD)
    assert planted
    assert flagged(compared(tree)) == planted


@pytest.mark.usefixtures("random_states_alone")
@pytest.mark.parametrize("value", [math.nan, math.inf])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")  # arithmetic with infinities
def test_answers_that_are_not_finite(tree, plant, value):
    """All of them at once: each disagrees, and none hides another."""
    for name, loaded in VISIBLE_IN:
        plant.pinocchio_quantity(name, lambda _: value, loaded)
    comparison = compared(tree)
    assert not comparison.agrees
    assert flagged(comparison) >= set().union(*VISIBLE_IN.values())
    record = plain(robot_record(comparison))
    for name in set().union(*VISIBLE_IN.values()):
        assert comparison.quantities[name].max_relative_error == math.inf
        assert record["quantities"][name]["max_relative_error"] is None


@pytest.mark.usefixtures("random_states_alone")
@pytest.mark.parametrize(
    ("loaded", "value"),
    few(
        [*product([False, True], [1 + PLANTED_FORWARD, math.nan, math.inf])],
        *((False, 1 + PLANTED_FORWARD), (True, 1 + PLANTED_FORWARD), (False, math.inf)),
    ),
)
def test_one_wrong_torque_at_our_accelerations(tree, plant, loaded, value):
    plant.pinocchio_required(loaded, lambda x: x * value)
    assert flagged(compared(tree)) == {name for name in BACKWARD if ("external" in name) == loaded}


def exit_code(monkeypatch, comparison):
    """Of the program when its comparison comes out like this one."""
    monkeypatch.setattr(comparing, "compare", lambda *arguments, **options: comparison)
    monkeypatch.setattr(sys, "argv", ["graphdyn", "crosscheck", "kr500"])
    with pytest.raises(SystemExit) as caught:
        main()
    return caught.value.code


@pytest.mark.usefixtures("random_states_alone")
@pytest.mark.parametrize("which", [0, 1], ids=["rotation", "position"])
def test_wrong_frame(small_arm, plant, which):
    plant.pinocchio_frames(which, lambda x: x * (1 + PLANTED))
    comparison = compared(small_arm)
    assert flagged(comparison) == {"frame_placement"}
    assert set(comparison.quantities["frame_placement"].by_route) == {"urdf"}


class TestOursAlone:
    """Quantities that no reference can be wrong about."""

    @pytest.mark.usefixtures("random_states_alone")
    def test_projected_accelerations(self, tree, plant):
        plant.projected_accelerations(1 + PLANTED_FORWARD)
        assert flagged(compared(tree)) == {
            "forward_dynamics_projected",
            "backward_error_projected",
            "backward_error_projected_external",
        }

    @pytest.mark.usefixtures("random_states_alone")
    def test_recursive_accelerations(self, tree, plant):
        plant.recursive_accelerations(1 + PLANTED_FORWARD)
        assert flagged(compared(tree)) == {
            "forward_dynamics_recursive",
            "backward_error_recursive",
            "backward_error_external_recursive",
        }

    @pytest.mark.usefixtures("random_states_alone")
    def test_dense_accelerations(self, tree, plant):
        plant.dense_solution(acceleration=1 + PLANTED_FORWARD)
        assert flagged(compared(tree)) == {
            "forward_dynamics",
            "forward_dynamics_external",
            "backward_error",
            "backward_error_external",
            "forward_body_accelerations",
            "dynamics_residual",
            "constraint_residual",
        }

    @pytest.mark.usefixtures("random_states_alone")
    def test_dense_multipliers(self, tree, plant):
        plant.dense_solution(multipliers=1 + PLANTED_FORWARD)
        assert flagged(compared(tree)) == {
            "forward_joint_wrenches",
            "forward_joint_wrenches_external",
            "forward_multipliers",
            "dynamics_residual",
        }

    def test_system_without_inertia(self, tree, plant):
        """A body without inertia in Eq. (111): the constraints keep their rank, the system does not."""

        def massless(state):
            mass = mass_terms(state).copy()
            mass[..., -6:, :] = mass[..., :, -6:] = 0
            return mass

        plant.in_system("mass_terms", massless)
        comparison = compared(tree)
        assert not comparison.quantities["kkt_rank"].agrees
        assert comparison.quantities["constraint_rank"].agrees
        assert comparison.conditioning.kkt_rank[0] < 11 * tree.n_bodies

    def test_printed_constraint_rows(self, tree, plant):
        """World x and y rows of Eq. (71), (72) lose rank where an axis is horizontal (docs/deviations.md, A2)."""
        plant.in_system("constraints", lambda state: (world_axis_rows(state), constraints(state)[1]))
        comparison = compared(tree)
        assert flagged(comparison) >= {"constraint_rank", "kkt_rank"}
        assert comparison.conditioning.constraint_rank[0] < 5 * tree.n_bodies
        assert comparison.conditioning.kkt_rank[0] < 11 * tree.n_bodies
        # nothing else is computed from these rows
        passive = {name for name, quantity in COMPARED.items() if not quantity.solves} & set(comparison.quantities)
        assert all(comparison.quantities[name].agrees for name in passive - {"constraint_rank"})


@pytest.mark.usefixtures("random_states_alone")
class TestBaseParameters:
    """The baseline identification notices a regressor that differs."""

    def test_every_entry_slightly(self, tree, plant):
        plant.pinocchio_regressor(lambda w: w * (1 + PLANTED_FORWARD))
        comparison = compared(tree)
        assert flagged(comparison) == {"base_parameters"}
        assert comparison.identification.difference > COMPARED["base_parameters"].tolerance.bound
        assert comparison.identification.rank == comparison.identification.rank_there

    def test_rank(self, tree, plant):
        """A body without columns: fewer parameters there than here, whatever the estimates."""
        rank = compared(tree).identification.rank
        plant.pinocchio_regressor(lambda w: np.where(np.arange(w.shape[-1]) // 10 == 1, 0.0, w))
        short = compared(tree)
        assert short.identification.rank == rank > short.identification.rank_there
        assert flagged(short) == {"base_parameters"}
        assert short.quantities["base_parameters"].max_relative_error == math.inf

    @pytest.mark.parametrize("rank_there", [11, 13])
    def test_another_rank_alone(self, rank_there):
        """However well the estimates agree."""
        record = ErrorTable()
        record.add_identification(BaselineIdentification(12, rank_there, 5.0, 1e3, difference=0.0, error=0.0))
        (result,) = record.results().values()
        assert result.max_relative_error == math.inf
        assert not result.agrees

    def test_against_the_model(self, tree, plant):
        """The estimates are judged against the model itself too: both cannot be wrong together."""
        plant.pinocchio_model(lambda model: heavier(model, 2))
        identification = compared(tree).identification
        bound = COMPARED["base_parameters"].tolerance.bound
        assert identification.difference <= bound < identification.error


def heavier(model, body):
    return with_body(model, body, mass=model.bodies[body - 1].mass * (1 + PHYSICAL))


def skewed(model, body):
    """One off-diagonal entry, and its mirror image, larger by a part of the largest entry."""
    tensor = model.bodies[body - 1].inertia.copy()
    tensor[0, 1] += PHYSICAL * tensor.max()
    tensor[1, 0] = tensor[0, 1]
    return with_body(model, body, inertia=tensor)


def longer(model, joint):
    placement = model.joints[joint - 1].placement
    moved = placement.translation + PHYSICAL * np.array([0.6, -0.5, 0.7])
    return with_joint(model, joint, placement=Placement(placement.rotation, moved))


def twisted(model, joint):
    placement = model.joints[joint - 1].placement
    turn = rotation_about(np.array([0.0, 0.6, 0.8]), PHYSICAL)
    return with_joint(model, joint, placement=Placement(turn @ placement.rotation, placement.translation))


def tilted(model, joint):
    axis, normals = model.joints[joint - 1].axis, model.joints[joint - 1].axis_normals
    return with_joint(model, joint, axis=axis + PHYSICAL * normals.sum(axis=0))


class TestAnotherRobot:
    """Pinocchio computes a robot that differs in one number by a part in a thousand million."""

    @pytest.mark.usefixtures("random_states_alone")
    @numbered
    def test_mass(self, tree, plant, number):
        """Visible in every force, in no motion, and not in W of τ = W π."""
        plant.pinocchio_model(lambda model: heavier(model, number))
        found = flagged(compared(tree))
        assert found >= {"inverse_dynamics", "joint_wrenches", "multipliers", "joint_wrenches_external", "bias_torque"}
        assert not found & (KINEMATIC | {"joint_torque_regressor", "body_regressor", "constraint_rank"})

    @pytest.mark.usefixtures("random_states_alone")
    @numbered
    def test_inertia(self, tree, plant, number):
        """Visible as a reaction even where no torque feels it."""
        plant.pinocchio_model(lambda model: skewed(model, number))
        found = flagged(compared(tree))
        assert found >= {"joint_wrenches", "multipliers", "joint_wrenches_external"}
        assert not found & (KINEMATIC | {"joint_torque_regressor", "body_regressor", "constraint_rank"})

    @pytest.mark.usefixtures("random_states_alone")
    @pytest.mark.parametrize("number", few([1, 2, 3], 1, 3))
    def test_placement(self, tree, plant, number):
        """Moving the first joint moves the whole robot: it is elsewhere, and not another robot."""
        plant.pinocchio_model(lambda model: longer(model, number))
        found = flagged(compared(tree))
        everywhere = {"body_velocities", "body_accelerations", "inverse_dynamics", "mass_matrix"}
        assert "link_placement" in found
        assert (found >= everywhere) if number > 1 else not (found & everywhere)

    @pytest.mark.usefixtures("random_states_alone")
    @pytest.mark.parametrize("change", [twisted, tilted])
    @numbered
    def test_direction_of_an_axis(self, tree, plant, change, number):
        plant.pinocchio_model(lambda model: change(model, number))
        assert flagged(compared(tree)) >= KINEMATIC | {
            "inverse_dynamics",
            "joint_wrenches",
            "joint_torque_regressor",
            "body_regressor",
        }

    def test_gravity(self, tree, plant):
        """Only what is weighed: inertia and kinematics do not know gravity, and without gravity all agree."""
        plant.pinocchio_gravity(1 + PHYSICAL)
        comparison = compared(tree)
        found = flagged(comparison)
        assert found >= {
            "inverse_dynamics",
            "joint_wrenches",
            "multipliers",
            "bias_torque",
            "joint_torque_regressor",
            "body_regressor",
        }
        assert not found & (KINEMATIC | {"mass_matrix", "constraint_rank", "kkt_rank"})
        for name in found - {"base_parameters"}:
            result = comparison.quantities[name]
            assert result.by_case.get("zero gravity", 0.0) <= result.quantity.tolerance.bound

    def test_damping_and_friction_are_no_rigid_dynamics(self, tree, plant):
        plant.pinocchio_model(lambda model: with_joint(model, 2, damping=7.0, friction=3.0))
        assert compared(tree).agrees

    def test_the_error_is_measured(self, tree, plant):
        """All bodies heavier by a part x: every wrench and the mass matrix are off by x, no torque by more."""
        plant.pinocchio_model(lambda model: model.with_inertial_parameters((1 + PHYSICAL) * model.inertial_parameters))
        quantities = compared(tree).quantities
        assert quantities["mass_matrix"].max_relative_error == pytest.approx(PHYSICAL, rel=MEASURED)
        # the scale of a wrench is that of the terms that are summed, a little above the largest wrench
        assert PHYSICAL / 2 < quantities["joint_wrenches"].max_relative_error <= PHYSICAL * (1 + MEASURED)
        assert quantities["inverse_dynamics"].max_relative_error <= PHYSICAL * (1 + MEASURED)

    @pytest.mark.usefixtures("random_states_alone")
    def test_the_file_differs_from_the_model(self, small_arm, monkeypatch):
        """The two routes are two witnesses: a wrong import shows on one of them only."""
        original = PinocchioModel.from_urdf

        def another_file(path, model, reading):
            path.write_text(path.read_text().replace('mass value="1.5"', f'mass value="{1.5 * (1 + PHYSICAL)!r}"'))
            return original(path, model, reading)

        monkeypatch.setattr(PinocchioModel, "from_urdf", staticmethod(another_file))
        torque = compared(small_arm).quantities["inverse_dynamics"]
        assert torque.worst.route == "urdf"
        assert torque.by_route["urdf"] > torque.quantity.tolerance.bound > torque.by_route["model"]


def test_worst_state_reproduces_the_error(tree, plant):
    """The state in the record, fed back, gives the recorded error."""
    plant.pinocchio_model(lambda model: heavier(model, 1))
    result = compared(tree).quantities["inverse_dynamics"]
    case = next(case for case in cases(tree, SAMPLES, SEED) if case.name == result.worst.case)
    q, v, a = (np.array([x]) for x in (result.worst.q, result.worst.v, result.worst.a))
    pinocchio = PinocchioModel.from_model(case.model)  # the heavier one
    values = PinocchioAnswers(pinocchio, case.model, q, v, a, np.zeros_like(q))
    error = np.abs(inverse_dynamics(case.model, q, v, a).tau - values.tau).max()
    scale = max(np.abs(values.tau).max(), np.abs(values.joint_wrenches).max())
    assert error / scale == pytest.approx(result.max_relative_error, rel=MEASURED)
