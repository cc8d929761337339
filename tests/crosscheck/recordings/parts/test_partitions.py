"""Recordings in parts: together the same as the whole, wherever the parts are worked on."""

import gzip
import os
import shutil
import signal
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
from identified import identified_arm
from identified.identified_arm import virtual
from long_check import LONG
from planting import mixed_tree
from pyarrow import csv, parquet
from typer.testing import CliRunner

import crosscheck
from crosscheck.commands import app
from crosscheck.distributing import DaskWorkers, Lost, NoWorkers
from crosscheck.identifying import ByTime, CandidateModel, Preparation
from crosscheck.identifying.long_recordings import METHODS_OF_SUMS, SAMPLE_METHODS, STANDARD_METHODS_OF_SUMS
from crosscheck.identifying.methods.methods import ESTIMATORS, method_named
from crosscheck.identifying.results.identified_model import HeldOutPrediction
from crosscheck.recordings import (
    BadRecordingFile,
    PartitionedRecording,
    chosen_cutoff,
    differentiated,
    load_recording,
    samples_of,
    split_by_rows,
)
from crosscheck.recordings.preparation.filtering import border
from graphdyn import InvalidInput
from graphdyn.identification import Problem, TorqueModel, WeightedLeastSquares, residual_statistics
from graphdyn.identification.data.samples import merged_in_tree
from graphdyn.identification.terms import Drift, KnownBodies, Viscous

CUTOFF, ROWS = 20.0, 700

MAPPING = """
joints = ["joint1", "joint2", "joint3"]
[time]
column = "time_s"
[q]
columns = "q_{number}"
[tau]
columns = "tau_{number}"
[temperature]
columns = "motor_degC"
"""

FORGOTTEN = 1e-5
"""Relative difference to the whole: two borders leave BORDER_DECAY², which two derivatives enlarge."""


def written(path, columns, rows=slice(None)):
    path.parent.mkdir(exist_ok=True)
    parquet.write_table(pa.table({name: values[rows] for name, values in columns.items()}), path, row_group_size=500)
    return path


def as_text(path, columns):
    csv.write_csv(pa.table(columns), path)
    return path


@pytest.fixture(scope="module")
def columns():
    return identified_arm.columns()


@pytest.fixture(scope="module")
def folder(tmp_path_factory, columns):
    """The rows as one file, and as a folder of eleven, whose order is that of their numbers."""
    place = tmp_path_factory.mktemp("logs")
    written(place / "log.parquet", columns)
    for k in range(11):
        written(place / "log" / f"part.{k}.parquet", columns, slice(230 * k, 230 * (k + 1)))
    return place


def summed(*paths, **options):
    return problem(*paths, **options).recorded


def problem(*paths, **options):
    data = PartitionedRecording(paths, **{"cutoff": CUTOFF, "rows": ROWS} | options)
    return Problem(virtual().torque_model, data, n_blocks=3)


class TestWhole:
    @pytest.mark.parametrize("name", ["log.parquet", "log"])
    @pytest.mark.parametrize("cutoff", [CUTOFF, {"q": CUTOFF}, None])
    def test_factors(self, folder, name, cutoff):
        whole = Problem(
            virtual().torque_model, samples_of(differentiated(load_recording(folder / "log.parquet"), cutoff))
        )
        parts = problem(folder / name, cutoff=cutoff)
        assert len(parts.data.parts(3)) > 3
        rows = np.bincount([p.block for p in parts.data.parts(3)], [p.last - p.first for p in parts.data.parts(3)])
        lost = 4 + (border(250.0, CUTOFF) if cutoff else 0)  # two difference quotients of five points; the filter
        assert [block.counts[0] for block in parts.recorded] == (rows - [lost, 0, lost]).tolist()
        assert np.array_equal(parts.equations.counts, whole.equations.counts)
        gram, expected = (np.einsum("gab,gac->gbc", f, f) for f in (parts.equations.factors, whole.equations.factors))
        np.testing.assert_allclose(gram, expected, rtol=0, atol=FORGOTTEN * np.abs(expected).max())

    @pytest.mark.parametrize("name", ["log.csv", "log.csv.gz"])
    def test_text_is_the_same_to_the_last_bit(self, folder, tmp_path, columns, name):
        path = as_text(tmp_path / "log.csv", columns)
        if name.endswith(".gz"):
            path = tmp_path / name
            path.write_bytes(gzip.compress((tmp_path / "log.csv").read_bytes()))
        for one, other in zip(summed(path), summed(folder / "log.parquet"), strict=True):
            assert np.array_equal(one.factors, other.factors)

    def test_the_cutoff_is_that_of_the_beginnings(self, folder, monkeypatch):
        monkeypatch.setattr("crosscheck.recordings.parts.partitioned.CHECKED_ROWS", 1500)
        recording = load_recording(folder / "log.parquet")
        found = problem(folder / "log", folder / "log.parquet", cutoff=None).data.residual_cutoff()
        assert found == chosen_cutoff(recording.take(slice(0, 1500)))

    def test_residuals(self, folder):
        whole = Problem(
            virtual().torque_model, samples_of(differentiated(load_recording(folder / "log.parquet"), CUTOFF))
        )
        parameters = WeightedLeastSquares().estimate(whole).parameters[None]
        (one,), (other,) = (residual_statistics(each, parameters) for each in (whole, problem(folder / "log")))
        for name in ("count", "mean", "rms", "largest", "relative"):
            for rows in ("everything", "moving"):
                here, there = (getattr(getattr(found, rows), name) for found in (one, other))
                np.testing.assert_allclose(there, here, rtol=1e-3, atol=1e-6, err_msg=name)
        np.testing.assert_allclose(other.durbin_watson, one.durbin_watson, rtol=0.02)

    def test_one_after_the_other(self, folder):
        """For methods that look at samples: the parts of a log continue each other, two logs do not."""
        shutil.copy(folder / "log.parquet", folder / "again.parquet")
        pieces = list(problem(folder / "log", folder / "again.parquet").data)
        assert [piece.continues for piece in pieces] == 2 * [False, True, True, True]
        whole = differentiated(load_recording(folder / "log.parquet"), CUTOFF)
        assert np.array_equal(np.concatenate([piece.time for piece in pieces[:4]]), whole.t)
        q = np.concatenate([piece.q for piece in pieces[:4]])
        np.testing.assert_allclose(q, whole.q, rtol=0, atol=FORGOTTEN * np.abs(whole.q).max())

    def test_temperature(self, tmp_path, columns):
        """Terms that drift with it have the samples of the whole."""
        warm = {**columns, "motor_degC": 20 + columns["time_s"]}
        path = written(tmp_path / "log.parquet", warm)
        (tmp_path / "map.toml").write_text(MAPPING, encoding="utf-8")
        torque_model = TorqueModel(virtual().subject.model, (Viscous(), Drift(Viscous(), "temperature")))
        whole = Problem(torque_model, samples_of(differentiated(load_recording(path, tmp_path / "map.toml"), None)))
        data = PartitionedRecording([path], tmp_path / "map.toml", rows=ROWS)
        x, expected = (WeightedLeastSquares().estimate(Problem(torque_model, d)).parameters for d in (data, whole.data))
        np.testing.assert_allclose(x, expected, rtol=1e-6)

    def test_between(self, folder):
        """The beginning and the end of a log, whose filters do not reach into each other."""
        begun = problem(folder / "log", between=(0.0, 0.6))
        read = load_recording(folder / "log.parquet")
        expected = differentiated(split_by_rows(read, (0, 1500 - 62), (1500, 2500)).train, CUTOFF)
        assert set(begun.equations.counts) == {len(expected.t)}

    def test_tree(self):
        assert merged_in_tree(lambda a, b: f"({a}{b})", "abcdefg") == "(((ab)(cd))((ef)g))"


class TestRefusals:
    def test_chosen_rows(self, folder):
        with pytest.raises(InvalidInput, match="rows of data in parts cannot be chosen by `used`"):
            problem(folder / "log").part(np.ones(2500, dtype=bool))

    def test_what_cannot_be_sent(self, folder):
        torque_model = replace(virtual().torque_model, known=(lambda robot, samples: 0.0,))
        with pytest.raises(InvalidInput, match=r"cannot be sent to other processes: .*; define its terms and known"):
            _ = replace(problem(folder / "log"), torque_model=torque_model).recorded

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"paths": []}, r"there is no log; give at least one"),
            ({"paths": ["log", "log/part.3.parquet"]}, r"part.3.parquet is given twice; rows that count twice look"),
            ({"cutoff": "residual"}, r"cutoff is 'residual'; give it in Hz, or per channel, or None"),
            (
                {"cutoff": 1.0},
                r"log: 2500 of 2500 rows, too few for the borders of the filter, which need 5777; leave",
            ),
            (
                {"between": (0.9, 1.0)},
                r"log: 250 of 2500 rows, too few for the borders of the filter, which need",
            ),
            ({"rate": 0}, r"rate is 0; give samples per second"),
            ({"rows": 100}, r"parts of 100 rows are too short for the borders of the filter; give more than"),
            ({"between": (0.5, 0.5)}, r"between is \(0.5, 0.5\); give two numbers from 0 to 1, the smaller one first"),
        ],
    )
    def test_options(self, folder, monkeypatch, options, message):
        monkeypatch.chdir(folder)
        with pytest.raises(InvalidInput, match=message):
            summed(*options.pop("paths", ["log"]), **options)

    def test_files(self, tmp_path, columns):
        (tmp_path / "empty").mkdir()
        (tmp_path / "log.npz").write_bytes(b"PK")
        (tmp_path / "words.csv").write_text("q_1,tau_1\n1,2\n1,2,3\n", encoding="utf-8")
        (tmp_path / "damaged.parquet").write_bytes(b"PAR1")
        written(tmp_path / "mixed" / "a.parquet", columns)
        written(tmp_path / "mixed" / "b.parquet", {"other": columns["q_1"]})
        with pytest.raises(FileNotFoundError, match="no such file or folder"):
            summed(tmp_path / "none")
        for name, message in {
            "empty": "no Parquet file in this folder; a folder is one log in parts",
            "log.npz": "only Parquet and CSV files are read in parts; convert it to one",
            "words.csv": "words.csv: CSV parse error: (Row #3: )?Expected 2 columns, got 3",
            "damaged.parquet": "; repair the file",
            "mixed": "b.parquet: its columns are not those of .*a.parquet; the files of a folder are parts of one log",
        }.items():
            with pytest.raises(BadRecordingFile, match=message):
                summed(tmp_path / name)

    def test_rows_of_text_are_named_by_their_file(self, tmp_path, columns):
        bad = {name: values.copy() for name, values in columns.items()}
        bad["q_1"][1234] = np.nan
        with pytest.raises(InvalidInput, match=r"log.csv, row 1234: not a number"):
            summed(as_text(tmp_path / "log.csv", bad))
        with pytest.raises(InvalidInput, match=r"log.csv is given twice"):
            summed(tmp_path / "log.csv", tmp_path / "log.csv")

    def test_a_gap_between_two_files(self, tmp_path, columns):
        """Whoever names different logs like parts of one is told."""
        written(tmp_path / "log" / "1.parquet", columns, slice(0, 1000))
        written(tmp_path / "log" / "2.parquet", columns, slice(1250, 2500))
        with pytest.raises(InvalidInput, match=r"log: after row 999 the time steps by 1\.\d+ s instead of 0.004 s"):
            summed(tmp_path / "log")

    def test_not_a_number(self, tmp_path, columns):
        """The row of its file."""
        bad = {name: values.copy() for name, values in columns.items()}
        bad["q_1"][1234] = np.nan
        for k in range(2):
            written(tmp_path / "log" / f"{k}.parquet", bad, slice(1000 * k, 1000 * (k + 1)))
        with pytest.raises(InvalidInput, match=r"1.parquet, row 234: not a number"):
            summed(tmp_path / "log")

    def test_an_empty_file_is_no_gap(self, tmp_path, columns):
        for k, rows in enumerate([slice(0), slice(0, 1500), slice(0), slice(1500, 2500)]):
            written(tmp_path / "log" / f"{k}.parquet", columns, rows)
        assert problem(tmp_path / "log").data.n_rows == 2500
        assert set(problem(tmp_path / "log", cutoff=None).equations.counts) == {2500 - 8}
        written(tmp_path / "none.parquet", columns, slice(0))
        with pytest.raises(InvalidInput, match=r"none.parquet: no rows; leave it out"):
            summed(tmp_path / "none.parquet")

    def test_lost(self, folder):
        class Losing:
            def each(self, function, tasks):
                yield 2, Lost("its process died")

        with pytest.raises(NoWorkers, match=r"log, rows 1250 to 1875: its process died"):
            summed(folder / "log", workers=Losing())

    @pytest.mark.parametrize(
        ("place", "changed", "message"),
        [
            (
                1,
                lambda base: base[:-8] + (99).to_bytes(8, "little"),
                "a worker finds other base parameters; use workers",
            ),
            (
                1,
                lambda base: base[:-8],
                "a worker finds other base parameters; use workers with processors of one type",
            ),
            (3, lambda _: b"cnowhere\nf\n.", r"cannot import a part of the torque model \(No module named 'nowhere'\)"),
        ],
        ids=["another", "fewer", "a module that is not there"],
    )
    def test_workers_unlike_the_first(self, folder, place, changed, message):
        """What a worker of another processor, or without a module, finds where it works on what it was sent."""

        class Unlike:
            def each(self, work, tasks):
                sent = list(work.args)
                sent[place] = changed(sent[place])
                yield 0, work.func(*sent, tasks[0])

        with pytest.raises(NoWorkers, match=message):
            summed(folder / "log", workers=Unlike())


@LONG
def test_a_worker_is_killed(folder, monkeypatch):
    """The same bits from this process and from two workers of a scheduler, one of which is killed half way."""
    from distributed import LocalCluster

    monkeypatch.setenv("GRAPHDYN_BACKEND", "numpy")  # which takes less than compiling in every process
    here = problem(folder / "log").recorded
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None, silence_logs=50) as cluster:
        with cluster.get_client() as client:
            victim = next(iter(client.run(os.getpid).values()))
        done = []

        def kill(rows):
            done.append(rows)
            if len(done) == 1:
                os.kill(victim, signal.SIGKILL)

        there = problem(folder / "log", workers=DaskWorkers(cluster.scheduler_address))
        found = replace(there, progress=kill).recorded
    assert len(done) == len(there.data.parts(3)) == 4
    for one, other in zip(here, found, strict=True):
        assert one.factors.tobytes() == other.factors.tobytes()


@pytest.fixture(scope="module")
def long(folder):
    """An identification of which rows beyond the first thousand are never in memory together."""
    arm = virtual()
    model = CandidateModel("", arm.torque_model.terms, (), ["wls"])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("crosscheck.identifying.long_recordings.EXCERPT_ROWS", 1000)
        return crosscheck.identify(arm.subject.model, problem(folder / "log").data, models=[model], poses=5)


class TestIdentified:
    def test_every_method_needs_sums_or_samples(self):
        samples = {name for name in ESTIMATORS if isinstance(method_named(name), SAMPLE_METHODS)}
        assert samples.isdisjoint(METHODS_OF_SUMS)
        assert samples | set(METHODS_OF_SUMS) == set(ESTIMATORS)

    def test_rows(self, long):
        assert long.fit.n_rows == 1875 - 62
        assert long.recordings[0].t[-1] < 5
        (log,) = long.problem.data.logs
        begun = differentiated(load_recording(log.log.files[0]), CUTOFF).provenance
        for shown in (long.division.fit, long.division.trials[0].test):
            excerpt = f"data quality and curves from the first {len(shown.t)} rows"
            assert shown.provenance.files == (str(log.log.path),)
            assert shown.provenance.steps == (*begun.steps, excerpt)
            assert shown.provenance.mapping == begun.mapping
        assert long.fit.squares(1).everything["WLS"].shape == (len(long.problem.data.parts(20)), 3)

    @pytest.mark.usefixtures("unexamined")
    def test_terms_that_choose_themselves(self, folder, monkeypatch):
        """From the beginning, without memory; standard ones where it is too short."""
        data, options = problem(folder / "log").data, {"methods": ["wls"], "poses": 5}
        monkeypatch.setattr("crosscheck.identifying.long_recordings.EXCERPT_ROWS", 1500)
        chosen = crosscheck.identify(virtual().subject.model, data, **options)
        assert not chosen.ladder.reason
        assert not any("slip" in step.change for step in chosen.ladder.steps)
        assert [type(term) for term in chosen.torque_model.terms[1:]] == [type(t) for t in chosen.ladder.model.terms]
        monkeypatch.setattr("crosscheck.identifying.long_recordings.EXCERPT_ROWS", 700)
        standard = crosscheck.identify(virtual().subject.model, data, **options)
        assert "are too short for 8 folds" in standard.ladder.reason
        assert [type(term).__name__ for term in standard.torque_model.terms[1:]] == ["Viscous", "Coulomb", "Offset"]

    def test_parameters(self, long):
        """Those of the same rows in memory."""
        read = load_recording(next(iter(long.problem.data.logs)).log.path.with_suffix(".parquet"))
        rows = differentiated(split_by_rows(read, (0, 1875 - 62), (1875, 2500)).train, CUTOFF)
        expected = WeightedLeastSquares().estimate(Problem(virtual().torque_model, samples_of(rows)))
        found = long.comparison.of("WLS").estimate
        np.testing.assert_allclose(found.parameters, expected.parameters, rtol=1e-3, atol=1e-3)

    def test_squares(self, long, monkeypatch):
        """Of parts that come in several chunks each: together those of the same rows in memory."""
        read = load_recording(next(iter(long.problem.data.logs)).log.path.with_suffix(".parquet"))
        (rows,) = samples_of(differentiated(split_by_rows(read, (0, 1875 - 62), (1875, 2500)).train, CUTOFF))
        parameters, times = long.fit.parameters, [np.arange(float(rows.row_filter(rows.v).shape[0]))]
        whole = HeldOutPrediction(Problem(virtual().torque_model, rows), times, parameters, {}).squares(1)
        monkeypatch.setattr("graphdyn.identification.data.rows.MIN_FILTERED_ROWS", 100)
        parts = replace(long.fit).squares(1)
        assert len(parts.measured) == len(long.problem.data.parts(20))
        assert parts.moving_rows.tolist() == whole.moving_rows.tolist()
        for found, expected in (
            (parts.measured, whole.measured),
            (parts.measured_moving, whole.measured_moving),
            (parts.everything["WLS"], whole.everything["WLS"]),
            (parts.moving["WLS"], whole.moving["WLS"]),
        ):
            np.testing.assert_allclose(found.sum(axis=0), expected[0], rtol=1e-3)

    def test_other_logs_are_predicted(self, folder, monkeypatch):
        """They are examined too, from rows that fit into memory however many logs there are; none may be fitted."""
        shutil.copy(folder / "log.parquet", folder / "other.parquet")
        drives = CandidateModel("", (Viscous(),), (KnownBodies(),), ["wls"])
        monkeypatch.setattr("crosscheck.identifying.long_recordings.EXCERPT_ROWS", 500)

        def found(name):
            data, ahead = (problem(*(folder / n for n in names)).data for names in (["log", "log.parquet"], [name]))
            prepared = Preparation(CUTOFF, min_speed=0.3)
            return crosscheck.identify(
                mixed_tree(), data, models=[drives], held_out=ahead, preparation=prepared, poses=5
            )

        one = found("other.parquet")
        assert one.predicted_recordings == (str(folder / "other.parquet"),)
        assert len(one.validation_data_quality) == 1
        assert len(one.recordings) == 1
        (whole,) = samples_of(differentiated(load_recording(folder / "log.parquet"), CUTOFF))
        fast = np.abs(whole.row_filter(whole.v)) >= 0.3
        assert one.problem.equations.counts.tolist() == (2 * fast.sum(axis=0)).tolist()
        with pytest.raises(
            InvalidInput, match=r"part.0.parquet: its rows are fitted and predicted; predict another log"
        ):
            found("log")

    @pytest.mark.parametrize(
        ("asked", "message"),
        [
            ({"held_out": ByTime((0, 1), (1, 2))}, "other ways to hold out rows than their last quarter or another"),
            ({"preparation": Preparation(cutoff=3.0)}, "a PartitionedRecording is filtered by its own cutoff"),
            ({"preparation": Preparation(cutoff=CUTOFF, decimate=(2,))}, "prepared in no other way"),
            ({"methods": ["gls"]}, "looks at samples, of which only sums are kept here"),
        ],
    )
    def test_what_needs_the_recording_in_memory(self, folder, asked, message):
        with pytest.raises(InvalidInput, match=message):
            crosscheck.identify(mixed_tree(), problem(folder / "log").data, **asked)

    def test_command(self, long, folder, small_arm, monkeypatch, words):
        asked = []
        monkeypatch.setattr(
            "crosscheck.identifying.identify",
            lambda robot, data, models, **more: asked.append((data, models[0].methods)) or long,
        )
        options = ["--robot", str(small_arm), "--cutoff", "10", "--scheduler", "tcp://a:1"]
        done = CliRunner().invoke(app, ["identify", f"{folder}/lo*.parquet", *options])
        assert "held out the last 25 % of every log, 625 rows" in words(done.output)
        assumed = "q in columns without units (q_1 … q_3); rad is assumed; give units in the header [assumed-unit]"
        assert words(done.output).count(assumed) == 1
        ((data, methods),) = asked
        assert (data.paths, data.cutoff, data.workers) == (
            [str(folder / "log.parquet")],
            10.0,
            DaskWorkers("tcp://a:1"),
        )
        assert [method if isinstance(method, str) else method.name for method in methods] == list(
            STANDARD_METHODS_OF_SUMS
        )

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ([], "--jobs and --scheduler need LOGs; a simulated robot is identified without them"),
            (["log.parquet", "--folds", "3"], "--folds needs the recording in memory; leave it out with --jobs and"),
            (
                ["log.parquet", "--cutoff", "10", "--methods", "huber"],
                "IRLS Huber looks at samples, of which only sums are kept here; use ols, wls, ridge",
            ),
            *(
                (["log.parquet", "--cutoff", "10", *terms], "friction with memory, and settings that are to be found,")
                for terms in (["--terms", "slip"], ["--terms", "coulomb", "--width", "fit"])
            ),
            (["none*.parquet", "--cutoff", "10"], "none*.parquet: no such file or folder; check the name"),
        ],
    )
    def test_refused(self, folder, small_arm, monkeypatch, words, options, message):
        monkeypatch.chdir(folder)
        done = CliRunner().invoke(app, ["identify", *options, "--robot", str(small_arm), "--jobs", "1"])
        assert done.exit_code == 2
        assert message in words(done.output)
