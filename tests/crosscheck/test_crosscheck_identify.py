"""crosscheck.identify: a virtual robot whose truth is known, ways to hold out, baselines, recommendation, refusals."""

import json
import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torque_data
from identified_arm import CUTOFF, POSES, compared, identified, virtual
from jsonschema import Draft202012Validator
from planted_records import planted
from planting import mixed_tree

import crosscheck
import graphdyn
import urdf
from crosscheck.identifying import (
    METHODS,
    TERMS,
    ByRows,
    ByTime,
    Candidate,
    Folds,
    FromWrenches,
    LastPart,
    OtherRecordings,
    Preparation,
    WithPinocchio,
    friction_terms,
    method_named,
    recommendation,
    virtual_robot,
)
from crosscheck.identifying.baselines import constant_errors
from crosscheck.identifying.parameters import base_rows, body_rows, deviations_of
from crosscheck.identifying.pooling import pooled_sizes
from crosscheck.identifying.result_errors import joint_errors, mean_error
from crosscheck.identifying.torque_terms import with_setting
from crosscheck.recordings import Recording, concatenated
from crosscheck.referee.pinocchio_model import PinocchioModel
from crosscheck.report.json import plain
from crosscheck.report.records.identify import record
from graphdyn import EstimationFailed, InvalidInput, mass_matrix
from graphdyn.identification import Plausibility, Problem, ResidualSizes, Samples, WeightedLeastSquares
from graphdyn.identification.terms import KnownBodies, KnownPayload, Offset, Payload, RigidBodies, Viscous

NOISE = [2.0, 3.0, 1.0, 0.5, 0.4, 0.2]
"""[N m] Given for the torques of an arm."""

SAME = 1e-10
"""Estimates by Pinocchio's regressor and by ours, relative; measured below 1e-14."""

NOISE_FLOOR = 0.01
"""Relative error of a torque with one percent of noise, of which the low-pass leaves less."""

NEARER = 0.1
"""One percent of noise against CAD values that are wrong by up to twenty."""


class TestVirtualRobot:
    def test_every_method_predicts_down_to_the_noise(self):
        for result in compared().comparison.results:
            assert result.failure is None, result.name
            assert np.all(result.held_out.moving.relative < NOISE_FLOOR), result.name

    def test_truth_is_nearer_than_cad(self):
        found = replace(compared(), truth=virtual().truth)
        rows = base_rows(found, found.comparison.of("consistent"))
        bodies = [row for row in rows if row.unit.startswith("kg")]
        off, wrong = (np.array([getattr(row, name) for row in bodies]) for name in ("error", "cad"))
        true = np.array([row.truth for row in bodies])
        assert np.linalg.norm(off) < NEARER * np.linalg.norm(wrong - true)
        assert all(row.error == pytest.approx(row.value - row.truth) for row in rows)

    def test_motion_stays_within_its_limits(self):
        robot = urdf.load("ur5")
        arm = virtual_robot(robot, (), seconds=10.0)
        for recording in (arm.fitted, arm.held_out):
            v = np.abs(np.diff(recording.q, axis=0)).max(axis=0) * 250
            for joint, q, speed in zip(robot.joints, recording.q.T, v, strict=True):
                assert joint.limits.lower <= q.min() <= q.max() <= joint.limits.upper, joint.name
                assert speed < joint.limits.velocity, joint.name
        assert not np.allclose(virtual().fitted.q[: len(virtual().held_out.t)], virtual().held_out.q, atol=0.01)

    def test_same_seed_same_numbers(self):
        again = virtual_robot(mixed_tree(), friction_terms(["viscous", "coulomb"], width=0.05), seconds=10.0)
        other = virtual_robot(mixed_tree(), friction_terms(["viscous", "coulomb"], width=0.05), seconds=10.0, seed=1)
        assert np.array_equal(again.fitted.tau, virtual().fitted.tau)
        assert not np.array_equal(other.fitted.tau, virtual().fitted.tau)

    def test_refusals(self):
        with pytest.raises(InvalidInput, match="5 s are less than one period of the excitation; give 10 or more"):
            virtual_robot(mixed_tree(), (), seconds=5.0)
        with pytest.raises(InvalidInput, match="has no mass: there is nothing to identify"):
            virtual_robot(mixed_tree().skeleton, ())

    def test_friction_with_memory_does_not_forget(self, monkeypatch):
        """The regressor in memory at once is a matter of memory alone."""
        at_once = virtual_robot(mixed_tree(), friction_terms(["slip"]), seconds=10.0).fitted
        monkeypatch.setattr("crosscheck.identifying.virtual.PIECE", 100)
        in_pieces = virtual_robot(mixed_tree(), friction_terms(["slip"]), seconds=10.0).fitted
        assert np.allclose(in_pieces.tau, at_once.tau, rtol=0, atol=SAME * np.abs(at_once.tau).max())


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

    def test_another_regressor_would_be_noticed(self):
        """Pinocchio's reading of a robot with one joint moved."""
        model = virtual().subject.model
        placement = model.joints[1].placement
        moved = replace(placement, translation=placement.translation + 0.01)
        joints = (model.joints[0], replace(model.joints[1], placement=moved), *model.joints[2:])
        other = PinocchioModel.from_model(replace(model, joints=joints))
        found = identified([WithPinocchio(WeightedLeastSquares(), other)]).comparison.results[0]
        assert found.failure is not None or found.estimate.settings["difference"] > 1e-4

    def test_graph_method_uses_wrenches(self):
        result = compared().comparison.of("graph method")
        assert result.estimate.settings["determined by wrenches"] == 21
        assert "21 of 30 parameters of the bodies from wrenches" in result.estimate.remarks[0]

    def test_graph_method_says_why_not(self):
        bare = replace(virtual().fitted, joint_wrenches=None)
        found = identified_from(bare, ["graph", "wls"])
        assert "the method needs all six components" in found.comparison.of("graph method").failure
        assert found.comparison.of("WLS").failure is None

    def test_a_channel_that_is_zero(self):
        recording = CUTOFF.differentiated(virtual().fitted)
        dead = replace(recording, tau=recording.tau * [0, 1, 1])
        found = constant_errors(virtual().subject.model, CUTOFF, LastPart().divide([dead]))
        assert found.everything.rms[0] == 0
        assert np.all(found.everything.rms[1:] > 1)

    def test_known_bodies_leave_nothing_to_exchange(self):
        found = identified(["graph", "wls-pinocchio", "wls"], terms=(Viscous(), Offset()), known=(KnownBodies(),))
        assert found.comparison.of("graph method").failure == "no body is unknown"
        assert "no body is unknown" in found.comparison.of("WLS, Pinocchio's regressor").failure
        assert found.comparison.of("WLS").failure is None


def identified_from(recording, methods):
    """With the last quarter held out."""
    arm = virtual()
    return crosscheck.identify(
        arm.subject.model, recording, methods=methods, preparation=CUTOFF, terms=arm.torque_model.terms, poses=POSES
    )


class TestHoldingOut:
    @pytest.fixture(scope="class")
    @staticmethod
    def recording():
        return CUTOFF.differentiated(virtual().fitted)

    def test_by_time_since_the_first_row(self, recording):
        late = replace(recording, t=recording.t + 1e9)
        for given, start in ((recording, 0.0), (late, 1e9)):
            fit, (split,), words, _ = ByTime((0, 6), (6, 9)).divide([given])
            assert fit is split.train
            assert fit.t[-1] == pytest.approx(start + 6, abs=0.005)
            assert split.test.t[0] == pytest.approx(start + 6, abs=0.005)
            assert words == "6 to 9 s"

    def test_by_rows_of_the_file(self, recording):
        fit, (split,), words, _ = ByRows((100, 1000), (1500, np.inf)).divide([recording])
        assert (fit.rows[0], fit.rows[-1], split.test.rows[0]) == (100, 999, 1500)
        assert words == "rows from 1500 on"

    def test_last_part_of_every_recording(self, recording):
        fit, (split,), words, _ = LastPart(0.25).divide([recording, recording])
        assert len(split.test.t) == pytest.approx(0.5 * len(recording.t), abs=2)
        assert split.test.t[0] - fit.t[fit.t < split.test.t[0]].max() >= 0.25
        assert words == "the last 25 % of every recording"
        with pytest.raises(InvalidInput, match=r"the part to hold out is 1; choose one between 0 and 1"):
            LastPart(1.0).divide([recording])

    def test_folds_fit_everything(self, recording):
        fit, splits, words, _ = Folds(4).divide([recording])
        assert len(fit.t) == len(recording.t) == sum(len(split.test.t) for split in splits)
        assert words == "4 consecutive folds, each from the others"
        for split in splits:
            distance = np.abs(split.train.t[:, None] - split.test.t[[0, -1]]).min()
            assert 0.25 <= distance < 0.26  # [s] neither fitted nor predicted
            assert [recording.take(rows).t.tolist() for rows in split.fold] == [
                split.train.t.tolist(),
                split.test.t.tolist(),
            ]
        slow = Folds(2).divide([replace(recording, torque_cutoff=np.full(len(recording.t), 2.0))]).trials[0]
        assert slow.train.t[0] - slow.test.t[-1] == pytest.approx(0.96, abs=0.01)  # e^(-2π 2 sin(π/8) t) = 0.01

    def test_several_recordings_have_no_common_time(self, recording):
        with pytest.raises(
            InvalidInput, match="2 recordings cannot be divided by time; give one, or separate recordings"
        ):
            ByTime((0, 1), (1, 2)).divide([recording, recording])
        with pytest.raises(InvalidInput, match="2 recordings cannot be divided by rows"):
            ByRows((0, 1), (1, 2)).divide([recording, recording])

    def test_folds_pool_their_errors(self):
        found = identified(["wls", "graph"], held_out=Folds(3))
        wls = found.comparison.of("WLS")
        curves = [curve for trial in found.trials for curve in trial.curves("WLS")]
        error = np.concatenate([curve.predicted - curve.measured for curve in curves])
        measured = np.concatenate([curve.measured for curve in curves])
        assert len(found.trials) == 3
        np.testing.assert_allclose(wls.held_out.everything.rms, np.sqrt(np.mean(error**2, axis=0)), rtol=1e-9)
        relative = np.linalg.norm(error, axis=0) / np.linalg.norm(measured, axis=0)
        np.testing.assert_allclose(wls.held_out.everything.relative, relative, rtol=1e-9)
        assert np.all(wls.held_out.everything.rms > wls.training.everything.rms)

    @pytest.mark.parametrize("folds", [0, 3])
    def test_progress_is_told_as_often_as_promised(self, folds):
        said = []
        held_out = {"held_out": Folds(folds)} if folds else {}
        identified(["ols", "wls"], progress=said.append, **held_out)
        assert len(said) == 3 + 3 * (1 + folds)
        assert said[:4] == ["health", "filter", "read", "OLS"]
        assert said[-1] == "CAD links: WLS"

    def test_a_method_that_fails_in_a_fold_fails(self):
        calls = []

        class Moody(WeightedLeastSquares):
            def estimate(self, problem):
                calls.append(problem)
                if len(calls) == 2:
                    raise EstimationFailed("not today")
                return super().estimate(problem)

        result = identified([Moody()], held_out=Folds(2)).comparison.results[0]
        assert result.failure == "in 1 of 2 folds: not today"

    def test_pooled_sizes_skip_empty_parts(self):
        part = ResidualSizes(*(np.array([x]) for x in (4, 1.0, 2.0, 3.0, 0.5)))
        empty = ResidualSizes(np.array([0]), *(np.array([np.nan]) for _ in range(4)))
        sizes = pooled_sizes([part, empty, part])
        assert [float(getattr(sizes, n)[0]) for n in ("count", "mean", "rms", "largest", "relative")] == [
            8,
            1,
            2,
            3,
            0.5,
        ]
        assert np.isnan(pooled_sizes([empty, empty]).rms[0])


class TestPreparation:
    def test_decimation_keeps_times_and_rows_together(self):
        found = identified(["wls"], preparation=Preparation(10.0, decimate=(5,), min_speed=0.05))
        for trial in (found.fit, *found.trials):
            for curve in trial.curves("WLS"):
                assert len(curve.t) == len(curve.measured) == len(curve.velocity)
                assert np.median(np.diff(curve.t)) == pytest.approx(0.02)
        errors = found.fitted_errors(found.comparison.of("WLS"))
        assert np.all(errors < NOISE_FLOOR)

    def test_blocks_too_short_for_decimation(self):
        with pytest.raises(InvalidInput, match=r"no block has the \d+ rows that decimation by \(10, 10\) needs"):
            identified(
                ["wls"], preparation=Preparation(10.0, decimate=(10, 10)), held_out=ByRows((100, 800), (900, 950))
            )

    def test_other_joints(self):
        other = replace(virtual().fitted, joint_names=("a", "b", "c"))
        with pytest.raises(InvalidInput, match=r"has the joints a, b, c, the robot has .*load it with joints="):
            identified_from(other, ["wls"])

    def test_a_record_without_torque(self):
        with pytest.raises(InvalidInput, match="has no tau; record it, or map its columns"):
            identified_from(replace(virtual().fitted, tau=None), ["wls"])


class TestRecommendation:
    def test_the_smallest_error_among_real_robots(self):
        found = compared()
        consistent = [found.candidate(name) for name in ("consistent", "consistent, entropic prior", "CAD links: WLS")]
        best = min(consistent, key=lambda candidate: mean_error(candidate.result))
        assert best.name != "CAD links: WLS"
        assert found.usable
        assert "the only such result" in answer_of(best.result).reason
        worse = replace(best.result, held_out=scaled(best.result.held_out, 1.5))
        assert "the smallest of 2 such results" in answer_of(best.result, replace(worse, name="worse")).reason

    def test_the_simpler_of_two_that_differ_by_less_than_the_pieces(self):
        """Noise of 30 % on the torque, and CAD without error: nothing is gained by identifying links."""
        arm, rng = virtual(), np.random.default_rng(0)
        true = arm.subject.model.with_inertial_parameters(arm.truth[:30])

        def noisy(recording):
            return replace(
                recording, tau=recording.tau + 0.3 * recording.tau.std(axis=0) * rng.normal(size=recording.tau.shape)
            )

        found = crosscheck.identify(
            true, noisy(arm.fitted), terms=arm.torque_model.terms, methods=["wls", "consistent"],
            preparation=CUTOFF, held_out=OtherRecordings((noisy(arm.held_out),)), poses=POSES,
        )  # fmt: skip
        assert found.recommendation.best == "CAD links: WLS"

    def test_equal_but_for_rounding_is_a_tie(self):
        good = compared().comparison.of("consistent")
        again = replace(good, name="again", held_out=scaled(good.held_out, 1 - 1e-9))
        better = replace(good, name="better", held_out=scaled(good.held_out, 1 - 1e-3))
        answers = [answer_of(good, other).name for other in (again, better)]
        assert answers == ["consistent", "better"]

    def test_none_without_a_real_robot(self):
        found = identified(["ols", "wls"])
        assert "no result is physically consistent" in answer_of(*found.comparison.results).reason
        assert found.recommendation.best == "CAD links: WLS"
        assert not found.usable
        assert any("times that of parameters without constraints" in words for words in found.recommendation.doubts)

    def test_none_without_an_answer(self):
        found = identified_from(replace(virtual().fitted, joint_wrenches=None), ["graph"])
        assert found.shown() is found.candidate("CAD links: WLS").result
        found = replace(found, others=())
        assert found.recommendation.reason.startswith("no method has a result")
        assert found.shown() is None
        with pytest.raises(InvalidInput, match="graph method has no result: the recording has torques"):
            found.shown("graph method")

    def test_none_where_zero_predicts_as_well(self):
        good = compared().comparison.of("consistent")
        lost = replace(good.held_out.moving, relative=np.full(3, 2.0))
        bad = replace(good, held_out=replace(good.held_out, moving=lost))
        answer = answer_of(bad)
        assert answer.name is None
        assert "predicts with a mean error of 200 %, no better than a torque of zero" in answer.reason

    def test_a_joint_that_hardly_moves_counts_with_all_its_rows(self):
        statistics = compared().comparison.of("WLS").held_out
        still = replace(statistics, moving=replace(statistics.moving, count=np.array([49, 50, 1000])))
        assert statistics.everything.relative[0] != statistics.moving.relative[0]
        assert joint_errors(still)[0] == statistics.everything.relative[0]
        assert np.array_equal(joint_errors(still)[1:], statistics.moving.relative[1:])

    @pytest.mark.parametrize(
        ("bodies", "poses", "usable"),
        [
            ([0.0, 1e-9, 1.0], [1e-9] * 20, True),
            ([-1e-9, 1.0, 1.0], [1.0] * 20, False),
            ([1.0, 1.0, 1.0], [1.0] * 19 + [0.0], False),
            ([1.0, 1.0, 1.0], [1.0] * 19 + [-1e-9], False),
        ],
        ids=["barely real", "one body is not real", "one pose is singular", "one pose is not positive definite"],
    )
    def test_every_body_and_every_pose_counts(self, bodies, poses, usable):
        good = compared().comparison.of("consistent")
        result = replace(good, plausibility=Plausibility(np.array(bodies), np.array(poses)))
        answer = answer_of(result)
        assert answer.name == ("consistent" if usable else None)


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

    def test_a_known_payload_is_no_part_of_the_links(self):
        load = KnownPayload([1.0, *[0.0] * 9])
        with_load = identified(["wls"], known=(load,))
        without = identified(["wls"])
        links = [found.body_parameters(found.comparison.of("WLS")) for found in (without, with_load)]
        lighter = links[0] - links[1]
        model = virtual().subject.model
        assert mass_of_base(with_load, lighter) == pytest.approx(
            mass_of_base(with_load, load_parameters(model)), abs=1e-8
        )

    def test_an_unknown_payload_belongs_to_its_link(self):
        terms = (Payload(), *virtual().torque_model.terms[1:])
        found = identified(["wls"], terms=terms, known=(KnownBodies(),))
        x = found.shown().estimate.parameters
        model = virtual().subject.model
        expected = model.inertial_parameters.reshape(-1, 10).copy()
        expected[-1] += x[:10]
        np.testing.assert_allclose(found.body_parameters(found.shown()), expected)

    def test_links_make_the_mass_matrix_of_the_estimate(self):
        found = compared()
        result = found.comparison.of("consistent")
        robot = virtual().subject.model.with_inertial_parameters(found.body_parameters(result).ravel())
        q, _ = robot.random_state(np.random.default_rng(0), POSES)
        smallest = np.linalg.eigvalsh(mass_matrix(robot, q))[:, 0]
        np.testing.assert_allclose(smallest, result.plausibility.mass_matrix_eigenvalues, rtol=1e-6)
        assert all(row.eigenvalue > 0 for row in body_rows(found, result))


def answer_of(*results):
    """Which of these results of compared() is recommended."""
    return recommendation([Candidate(result.name, compared(), result) for result in results])


def scaled(statistics, factor):
    moving = replace(statistics.moving, relative=factor * statistics.moving.relative)
    return replace(statistics, moving=moving)


def load_parameters(model):
    ten = np.zeros((model.n_bodies, 10))
    ten[-1, 0] = 1.0
    return ten


def mass_of_base(found, links):
    """Base parameters that belong to links alone."""
    x = np.zeros(len(found.torque_model.columns))
    x[found.torque_model.slice_of(RigidBodies)] = links.ravel()
    return found.problem.base.values(x)


class TestRecord:
    """What --json writes, also of a method without an answer and of numbers that are not finite."""

    def checked(self, whole):
        schema = Path(__file__).parents[2] / "docs/schemas/identify-2.schema.json"
        Draft202012Validator(json.loads(schema.read_text(encoding="utf-8"))).validate(plain(whole))
        return plain(whole)

    @pytest.mark.parametrize("number", [math.nan, math.inf])
    def test_every_number_that_may_be_null(self, number):
        found = compared()
        whole = record(found, found.comparison.results[0], ["identify"])
        spoiled = self.checked(planted(whole, number))
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
        assert len({method_named(name).name for name in METHODS}) == len(METHODS)
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

    def test_a_method_of_ones_own_stands_beside_the_others(self):
        class Half:
            name, reference, assumptions, needs = "half", "none", "none", "nothing"

            def estimate(self, problem):
                return graphdyn.identification.Estimate(problem.torque_model.prior() / 2)

        found = identified(["wls", Half()])
        assert found.comparison.of("half").failure is None
        assert found.recommendation.name is None


def test_rows_that_are_fitted_are_not_predicted():
    recording = virtual().fitted
    with pytest.raises(InvalidInput, match=rf"{len(recording.t)} rows are fitted and predicted; predict another"):
        OtherRecordings((recording,)).divide([recording])
    half = len(recording.t) // 2
    first, second = recording.take(slice(0, half)), recording.take(slice(half, None))
    assert len(OtherRecordings((second,)).divide([first]).fit.t) == half


def test_other_records_are_prepared_alike():
    found = identified(["wls"])
    assert [split.test.provenance.steps for split in found.division.trials] == [found.division.fit.provenance.steps]
    assert isinstance(concatenated([virtual().fitted]), Recording)
    assert (
        OtherRecordings((virtual().held_out,)).divide([virtual().fitted]).words.startswith("all of simulated motion 2")
    )
    assert FromWrenches().recording is None
