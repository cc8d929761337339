"""crosscheck.identify: baselines, the parameters of the links, what --json writes, names of methods and terms."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest
import scipy.linalg
from faults.planted_records import planted
from identified import torque_data
from identified.identified_arm import CUTOFF, POSES, compared, identified, identified_from, virtual
from jsonschema import Draft202012Validator
from shared_data import REPOSITORY

import graphdyn
from crosscheck.commands.identify.record import record
from crosscheck.identifying import ESTIMATORS, TERMS, LastPart, WithPinocchio, friction_terms, method_named
from crosscheck.identifying.methods.torque_terms import term_with, with_setting
from crosscheck.identifying.methods.wrench_method import _completed
from crosscheck.identifying.preparing.trials import constant_errors
from crosscheck.identifying.results.parameters import base_rows, body_rows, deviations_of
from crosscheck.reference.pinocchio_model import PinocchioModel
from crosscheck.report.records.record import plain
from graphdyn import InvalidInput, mass_matrix
from graphdyn.identification import Estimate, Problem, Samples, WeightedLeastSquares, model_prior
from graphdyn.identification.terms import KnownBodies, KnownPayload, Offset, Payload, RigidBodies, Viscous
from graphdyn.model.inertia import PARAMETER_NAMES

NOISE = [2.0, 3.0, 1.0, 0.5, 0.4, 0.2]
"""[N m] Given for the torques of an arm."""

LOAD = [1.0, 0.02, -0.05, 0.1, 0.03, 0.001, -0.002, 0.025, 0.004, 0.015]
"""A kilogram with its center off the axes."""

SAME = 1e-10
"""Estimates by Pinocchio's regressor and by ours, relative; measured below 1e-14."""


class TestBaselines:
    def test_pinocchio_gives_the_same_answer(self):
        found = compared().comparison
        ours, theirs = found.of("WLS"), found.of("WLS, Pinocchio's regressor")
        assert theirs.estimate.settings["difference"] <= SAME
        assert np.allclose(ours.base_values, theirs.base_values, rtol=0, atol=SAME * np.abs(ours.base_values).max())
        assert np.allclose(ours.standard_deviations, theirs.standard_deviations, rtol=1e-6)
        assert "differs from WLS by" in theirs.estimate.remarks[-1]

    def test_pinocchio_weighs_with_the_noise_that_is_given(self):
        problem = Problem(replace(torque_data.torque_model(), noise=NOISE), torque_data.noisy_samples())
        estimate = WithPinocchio(WeightedLeastSquares()).estimate(problem)
        assert estimate.settings["difference"] <= SAME
        assert np.array_equal(estimate.noise, NOISE)

    @pytest.mark.usefixtures("unexamined")
    def test_another_regressor_would_be_noticed(self):
        """Pinocchio's reading of a robot with one joint moved."""
        model = virtual().subject.model
        placement = model.joints[1].placement
        moved = replace(placement, translation=placement.translation + 0.01)
        joints = (model.joints[0], replace(model.joints[1], placement=moved), *model.joints[2:])
        other = PinocchioModel.from_model(replace(model, joints=joints))
        found = identified([WithPinocchio(WeightedLeastSquares(), other)]).comparison.results[0]
        assert found.failure is not None or found.estimate.settings["difference"] > 1e-4

    def test_the_answer_is_that_on_the_regressor_of_pinocchio(self):
        """With its deviations and remarks, and how far it is from the answer on ours, here twice as large."""

        class Says:
            name = "guess"

            def estimate(self, problem):
                p, r = len(problem.torque_model.columns), problem.base.rank
                ours = any(type(term) is RigidBodies for term in problem.torque_model.terms)
                size, said = (2.0, "ours") if ours else (3.0, "theirs")
                return Estimate(
                    size * np.ones(p), size * np.eye(r), size * np.eye(r), remarks=(said,), settings={"k": size}
                )

        problem = compared().problem
        found = WithPinocchio(Says()).estimate(problem)
        p, r = len(problem.torque_model.columns), problem.base.rank
        assert np.array_equal(found.parameters, 3 * np.ones(p))
        assert np.array_equal(found.covariance, 3 * np.eye(r))
        assert np.array_equal(found.block_covariance, 3 * np.eye(r))
        assert found.settings == {"k": 3.0, "difference": pytest.approx(0.5)}
        assert WithPinocchio(WeightedLeastSquares()).needs == f"{WeightedLeastSquares().needs}; unknown rigid bodies"
        assert found.remarks == ("theirs", "differs from guess by 5.0e-01 of the torque")

    def test_graph_method_uses_wrenches(self):
        result = compared().comparison.of("graph method")
        assert result.estimate.settings["determined by wrenches"] == 21
        assert "21 of 30 parameters of the bodies from wrenches" in result.estimate.remarks[0]

    @pytest.mark.parametrize("unknown", [slice(30, None), slice(3, 41, 2), slice(0, None, 5)])
    def test_what_wrenches_do_not_tell_is_the_best_fit_nearest_to_the_model(self, unknown):
        """No slope of ‖R x - z‖² along an unknown entry, and no step from the model that has no effect."""
        problem, rng = compared().problem, np.random.default_rng(0)
        noise, x = np.array([1.0, 0.2, 3.0]), virtual().truth * rng.uniform(0.9, 1.1, len(virtual().truth))
        x[unknown] = np.nan
        free = np.isnan(x)
        found, prior = _completed(problem, x, noise), model_prior(problem.torque_model)
        r, z = problem.standard_equations(noise)
        scale = np.where(np.isfinite(prior.scale), prior.scale, 1.0)
        columns = (r * scale)[:, free]
        assert np.array_equal(found[~free], x[~free])
        slope = np.linalg.norm(columns, axis=0) * np.linalg.norm(z)
        assert np.all(np.abs(columns.T @ (r @ found - z)) <= 1e-9 * slope)
        idle = scipy.linalg.null_space(columns, rcond=1e-9)
        step = ((found - prior.mean) / scale)[free]
        assert np.abs(idle.T @ step).max(initial=0) <= 1e-9 * np.linalg.norm(step)

    @pytest.mark.usefixtures("unexamined")
    def test_graph_method_says_why_not(self):
        bare = replace(virtual().fitted, joint_wrenches=None)
        found = identified_from(bare, ["graph", "wls"])
        assert "the method needs all six components" in found.comparison.of("graph method").failure
        assert found.comparison.of("WLS").failure is None

    @pytest.mark.usefixtures("unexamined")
    def test_a_channel_that_is_zero(self):
        recording = CUTOFF.differentiated(virtual().fitted)
        dead = replace(recording, tau=recording.tau * [0, 1, 1])
        found = constant_errors(virtual().subject.model, CUTOFF, LastPart().divide([dead]))
        assert found.everything.rms[0] == 0
        assert np.all(found.everything.rms[1:] > 1)

    @pytest.mark.usefixtures("unexamined")
    def test_known_bodies_leave_nothing_to_exchange(self):
        found = identified(["graph", "wls-pinocchio", "wls"], terms=(Viscous(), Offset()), known=(KnownBodies(),))
        assert found.comparison.of("graph method").failure == "no body is unknown"
        assert "no body is unknown" in found.comparison.of("WLS, Pinocchio's regressor").failure
        assert found.comparison.of("WLS").failure is None


class TestParameters:
    def test_deviations_stand_in(self):
        found = compared()
        entropic = found.comparison.of("consistent, entropic prior")
        bare = replace(entropic, standard_deviations=None, block_deviations=None)
        source, words = deviations_of(found, bare)
        assert source.name == "WLS"
        assert words.startswith("of WLS, because consistent, entropic prior gives none")
        alone = replace(found, comparison=replace(found.comparison, results=(bare,)), others=())
        assert deviations_of(alone, bare) == (None, "consistent, entropic prior gives none")
        assert np.isnan(base_rows(alone, bare)[0].deviation)

    def test_rows_of_parameters(self):
        """Found minus true, and the smallest eigenvalue of [[tr(I)/2 - I, m c], [m c, m]] of every link."""
        arm, found = virtual(), replace(compared(), truth=virtual().truth)
        result = found.comparison.of("WLS")
        truth = found.problem.base.values(arm.truth)
        for row, value, true in zip(base_rows(found, result), result.base_values, truth, strict=True):
            assert (row.value, row.truth) == pytest.approx((value, true), abs=1e-12)
            assert row.error == pytest.approx(value - true, abs=1e-12)
        for row, ten in zip(body_rows(found, result), found.body_parameters(result), strict=True):
            of = dict(zip(PARAMETER_NAMES, ten, strict=True))
            tensor = np.array([[of["I_" + "".join(sorted(a + b))] for b in "xyz"] for a in "xyz"])
            moment = np.array([[of[f"mc_{a}"]] for a in "xyz"])
            whole = np.block([[np.trace(tensor) / 2 * np.eye(3) - tensor, moment], [moment.T, np.array([[of["m"]]])]])
            assert row.eigenvalue == pytest.approx(np.linalg.eigvalsh(whole)[0])
            assert row.mass == of["m"]

    @pytest.mark.usefixtures("unexamined")
    def test_a_known_payload_is_no_part_of_the_links(self):
        load = KnownPayload(LOAD)
        with_load = identified(["wls"], known=(load,))
        without = identified(["wls"])
        links = [found.body_parameters(found.comparison.of("WLS")) for found in (without, with_load)]
        (trial,) = with_load.trials
        (curve,) = trial.curves("WLS")
        left = np.sqrt(np.mean((curve.predicted - curve.measured) ** 2, axis=0))
        np.testing.assert_allclose(left, with_load.comparison.of("WLS").held_out.everything.rms, rtol=1e-9)
        lighter = links[0] - links[1]
        model = virtual().subject.model
        assert mass_of_base(with_load, lighter) == pytest.approx(
            mass_of_base(with_load, load_parameters(model)), abs=1e-8
        )

    @pytest.mark.usefixtures("unexamined")
    def test_an_unknown_payload_belongs_to_its_link(self):
        terms = (Payload(), *virtual().torque_model.terms[1:])
        found = identified(["wls"], terms=terms, known=(KnownBodies(),))
        x = found.shown().estimate.parameters
        model = virtual().subject.model
        expected = model.inertial_parameters.reshape(-1, 10).copy()
        expected[-1] += x[:10]
        np.testing.assert_allclose(found.body_parameters(found.shown()), expected)

    def test_a_result_of_another_torque_model_is_read_with_its_own(self):
        """The links of CAD, whose drives alone are fitted."""
        found = compared()
        cad = found.candidate("CAD links: WLS")
        links = virtual().subject.model.inertial_parameters.reshape(-1, 10)
        np.testing.assert_allclose(found.body_parameters(cad.result), links)
        (curve,) = cad.model.fit.curves("WLS")
        error = np.linalg.norm(curve.predicted - curve.measured, axis=0) / np.linalg.norm(curve.measured, axis=0)
        np.testing.assert_allclose(found.fitted_errors(cad.result), error, rtol=1e-9)

    def test_links_make_the_mass_matrix_of_the_estimate(self):
        found = compared()
        result = found.comparison.of("consistent")
        robot = virtual().subject.model.with_inertial_parameters(found.body_parameters(result).ravel())
        q, _ = robot.random_state(np.random.default_rng(0), POSES)
        smallest = np.linalg.eigvalsh(mass_matrix(robot, q))[:, 0]
        np.testing.assert_allclose(smallest, result.plausibility.mass_matrix_eigenvalues, rtol=1e-6)
        assert all(row.eigenvalue > 0 for row in body_rows(found, result))


def load_parameters(model):
    ten = np.zeros((model.n_bodies, 10))
    ten[-1] = LOAD
    return ten


def mass_of_base(found, links):
    """Base parameters that belong to links alone."""
    x = np.zeros(len(found.torque_model.columns))
    x[found.torque_model.slice_of(RigidBodies)] = links.ravel()
    return found.problem.base.values(x)


class TestRecord:
    """What --json writes, also of a method without an answer and of numbers that are not finite."""

    schema = json.loads((REPOSITORY / "docs/schemas/identify-3.schema.json").read_text(encoding="utf-8"))

    def checked(self, whole):
        Draft202012Validator(self.schema).validate(plain(whole))
        return plain(whole)

    @pytest.mark.parametrize("number", [math.nan, math.inf])
    def test_every_number_that_may_be_null(self, number):
        found = compared()
        whole = record(found, found.comparison.results[0], ["identify"])
        spoiled = self.checked(planted(whole, self.schema, number))
        assert set(spoiled["methods"][0]["parameters"]) == {None}
        assert spoiled["shown"]["base_parameters"][0]["error"] is None
        assert set(self.checked(whole)["methods"][0]["parameters"]) != {None}

    def test_failure(self):
        found = identified_from(replace(virtual().fitted, joint_wrenches=None), ["graph", "wls"])
        written = self.checked(record(found, None, []))
        assert written["shown"] is written["methods"][0]["held_out"] is written["methods"][0]["parameters"] is None
        assert written["methods"][1]["failure"] is None


class TestNames:
    def test_every_method_and_term_has_a_name(self):
        assert len({method_named(name).name for name in ESTIMATORS}) == len(ESTIMATORS)
        assert len(friction_terms(list(TERMS))) == len(TERMS)

    def test_unknown_ones(self):
        with pytest.raises(InvalidInput, match="there is no method 'magic'; known: ols, wls"):
            method_named("magic")
        with pytest.raises(InvalidInput, match="there is no term 'magic'; known: viscous"):
            friction_terms(["magic"])
        with pytest.raises(InvalidInput, match="the term 'offset' is given twice"):
            friction_terms(["offset", "offset"])

    @pytest.mark.parametrize("option", ["width", "stribeck_velocity", "stribeck_exponent"])
    def test_no_term_ignores_an_option(self, option):
        """A term either changes with it, or it is refused."""
        model = graphdyn.kr500()
        q, v = model.random_state(np.random.default_rng(0), 10)
        samples = Samples(q, v, np.ones_like(q), np.zeros_like(q))
        for name in TERMS:
            (plain,) = friction_terms([name])
            if name in with_setting(option.removeprefix("stribeck_")):
                (other,) = friction_terms([name], **{option: 0.7})
                assert not np.array_equal(plain.rows(model, samples), other.rows(model, samples)), name
            else:
                with pytest.raises(InvalidInput, match=rf"is given, but none of the terms \({name}\) has one"):
                    friction_terms([name], **{option: 0.7})

    def test_stribeck_friction_as_the_command_line_has_it(self):
        """sign(v) exp(-(v / v_s)²), v_s = 0.1 rad/s, of each joint alone."""
        model = graphdyn.kr500()
        q, v = model.random_state(np.random.default_rng(0), 10)
        v *= 0.1
        (term,) = friction_terms(["stribeck"])
        rows = term.rows(model, Samples(q, v, np.ones_like(q), np.zeros_like(q)))
        expected = (np.sign(v) * np.exp(-100 * v**2))[..., None] * np.eye(model.nv)
        np.testing.assert_allclose(rows, expected, rtol=1e-12)

    @pytest.mark.usefixtures("unexamined")
    def test_a_method_of_ones_own_stands_beside_the_others(self):
        class Half:
            name, reference, assumptions, needs = "half", "none", "none", "nothing"

            def estimate(self, problem):
                return graphdyn.identification.Estimate(problem.torque_model.prior() / 2)

        found = identified(["wls", Half()])
        assert found.comparison.of("half").failure is None
        assert found.recommendation.name is None


def test_the_deflection_of_a_slip_is_the_one_that_is_given():
    """One element, or one for each of several."""
    assert np.array_equal(term_with("slip", deflection=0.07).deflections, [0.07])
    assert np.array_equal(term_with("slip", deflections=[0.07, 0.2]).deflections, [0.07, 0.2])
