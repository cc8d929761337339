"""crosscheck.identify: which rows are fitted and which are predicted, and how both are prepared."""

from dataclasses import replace

import numpy as np
import pytest
from identified.identified_arm import CUTOFF, NOISE_FLOOR, compared, identified, identified_from, virtual

from crosscheck.identifying import ByRows, ByTime, Folds, FromWrenches, LastPart, OtherRecordings, Preparation
from crosscheck.identifying.preparing.holding_out import Division, Fold
from crosscheck.identifying.preparing.trials import pooled_sizes
from crosscheck.identifying.results.identified_model import HeldOutPrediction
from crosscheck.recordings import Recording, concatenated
from graphdyn import EstimationFailed, InvalidInput
from graphdyn.identification import ResidualSizes, WeightedLeastSquares


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

    @pytest.mark.usefixtures("unexamined")
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
        identified(["ols", "wls"], progress=lambda what, _: said.append(what), **held_out)
        assert len(said) == 3 + 3 * (1 + folds)
        assert said[:4] == ["data_quality", "filter", "read", "OLS"]
        assert said[-1] == "CAD links: WLS"

    @pytest.mark.usefixtures("unexamined")
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
        assert result.estimate is None

    def test_squares_of_consecutive_pieces(self):
        """Of three chunks of rows or more; N rows in seven pieces, and those of them that move."""
        (trial,) = compared().trials
        (curve,) = trial.curves("WLS")
        found, piece = trial.squares(7), np.arange(trial.n_rows) * 7 // trial.n_rows
        moves = np.abs(curve.velocity) > 0.02
        assert found.moving_rows.tolist() == moves.sum(axis=0).tolist()
        error = curve.predicted - curve.measured
        for number in range(7):
            here = (piece == number)[:, None]
            for values, everything, moving in (
                (error, found.everything["WLS"], found.moving["WLS"]),
                (curve.measured, found.measured, found.measured_moving),
            ):
                expected = [np.sum(values**2 * rows, axis=0) for rows in (here, here & moves)]
                np.testing.assert_allclose([everything[number], moving[number]], expected, rtol=1e-7)

    def test_period_of_the_longest_interval(self):
        """Whose last row came late."""
        times = [np.array([0.0, 1.0]), np.array([5.0, 5.1, 5.2, 5.3, 5.9])]
        assert HeldOutPrediction(None, times, {}, {}).period == pytest.approx(0.1)
        assert HeldOutPrediction(None, times, {}, {}).n_rows == 7
        assert np.isnan(HeldOutPrediction(None, [np.zeros(1)], {}, {}).period)

    def test_errors_of_the_fit(self):
        found = compared()
        (curve,) = found.fit.curves("WLS")
        error = np.linalg.norm(curve.predicted - curve.measured, axis=0) / np.linalg.norm(curve.measured, axis=0)
        np.testing.assert_allclose(found.fitted_errors(found.comparison.of("WLS")), error, rtol=1e-9)

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

    def test_pooled_sizes_are_those_of_all_rows(self):
        rng = np.random.default_rng(0)
        rows = [rng.normal(0.5 * count, 1.0, (count, 2)) for count in (3, 9, 1)]

        def sizes(e, tau):
            rms, size = np.sqrt(np.mean(e**2, axis=0)), np.linalg.norm(tau, axis=0)
            relative = np.linalg.norm(e, axis=0) / size
            return ResidualSizes(np.full(2, len(e)), e.mean(axis=0), rms, np.abs(e).max(axis=0), relative)

        found = vars(pooled_sizes([sizes(part, 7 + part**2) for part in rows]))
        whole = np.concatenate(rows)
        for name, expected in vars(sizes(whole, 7 + whole**2)).items():
            np.testing.assert_allclose(found[name], expected, rtol=1e-12, err_msg=name)


class TestPreparation:
    @pytest.mark.usefixtures("unexamined")
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


def test_recordings_of_their_own_are_named():
    """Those by which results are chosen, then those that have no influence; no folds of what is fitted."""
    found = compared()
    fit = found.division.fit
    trials = [Fold("fold 1", fit, fit), Fold("b.csv", fit, fit, own_recording=True)]
    division = Division(fit, trials, "", (Fold("a.csv", fit, fit, own_recording=True),))
    assert replace(found, division=division).predicted_recordings == ("b.csv", "a.csv")


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
