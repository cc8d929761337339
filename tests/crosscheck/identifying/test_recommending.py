"""crosscheck.identify: which result is recommended, or none."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import scipy.stats
from identified.identified_arm import CUTOFF, POSES, compared, identified, identified_from, virtual

import crosscheck
from crosscheck.identifying import Candidate, OtherRecordings, recommendation
from crosscheck.identifying.results import recommending
from crosscheck.identifying.results.identified_model import PieceSquares
from crosscheck.identifying.results.recommending import Difference, difference, joint_errors, mean_error
from graphdyn import InvalidInput
from graphdyn.identification import Plausibility


def answer_of(*results):
    """Which of these results of compared() is recommended."""
    return recommendation([Candidate(result.name, compared(), result) for result in results])


def scaled(statistics, factor):
    moving = replace(statistics.moving, relative=factor * statistics.moving.relative)
    return replace(statistics, moving=moving)


def test_deviation_of_a_difference():
    """Squares that vary by a ten-thousandth: half of their standard error, over the pieces of two trials."""
    pieces = np.random.default_rng(0).normal(size=(2, 10))

    def candidate(squares):
        def of_trial(half):
            errors = squares[half, None] * [4.0, 4.0]
            measured = np.ones((5, 2))
            return PieceSquares({"m": errors}, {"m": 9 * errors}, measured, measured, np.array([20.0, 20.0]))

        halves = [of_trial(slice(5)), of_trial(slice(5, None))]
        trials = [SimpleNamespace(squares=lambda count, half=half: half if count == 5 else None) for half in halves]
        return SimpleNamespace(model=SimpleNamespace(trials=trials), result=SimpleNamespace(name="m"))

    first, second = (candidate(1 + 1e-4 * z) for z in pieces)
    apart = difference(first, second)
    assert apart.value == pytest.approx(2 * 0.5e-4 * np.subtract(*pieces.mean(axis=1)), rel=1e-3)
    assert apart.deviation == pytest.approx(2 * 0.5e-4 * scipy.stats.sem(pieces[0] - pieces[1]), rel=1e-3)


def test_there_are_ten_pieces_or_more():
    asked, one = [], np.ones((4, 1))
    trial = SimpleNamespace(
        squares=lambda count: asked.append(count) or PieceSquares({"m": one}, {"m": one}, one, one, np.ones(1))
    )
    candidate = SimpleNamespace(model=SimpleNamespace(trials=[trial] * 3), result=SimpleNamespace(name="m"))
    difference(candidate, candidate)
    assert asked == [4] * 6


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

    @pytest.mark.usefixtures("unexamined")
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

    @pytest.mark.parametrize(("worse", "best"), [(0.99, "CAD links: WLS"), (1.01, "consistent")])
    def test_a_simpler_one_may_be_worse_by_one_standard_deviation(self, worse, best, monkeypatch):
        """As Breiman and others have it: not by two."""
        monkeypatch.setattr(recommending, "difference", lambda first, second: Difference(worse, 1.0))
        found = compared()
        assert recommendation([found.candidate(name) for name in ("consistent", "CAD links: WLS")]).best == best

    def test_the_stronger_prior_is_the_simpler_one(self, monkeypatch):
        monkeypatch.setattr(recommending, "difference", lambda first, second: Difference(0.0, 1.0))
        good = compared().comparison.of("consistent")
        weak, strong = (
            replace(good, name=name, estimate=replace(good.estimate, settings={"strength": strength}))
            for name, strength in (("weak", 1.0), ("strong", 100.0))
        )
        assert answer_of(weak, replace(strong, held_out=scaled(good.held_out, 1.1))).best == "strong"
        assert answer_of(replace(weak, held_out=scaled(good.held_out, 1.1)), strong).best == "strong"
        unreal = replace(strong, plausibility=Plausibility(np.array([-1e-9, 1.0, 1.0]), np.ones(20)))
        assert answer_of(weak, unreal).best == "weak"

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
        assert any(
            "times that of parameters without constraints" in words for words in found.recommendation.rejection_reasons
        )

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
