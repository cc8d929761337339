"""Findings about recordings, the mapping lines that undo them, and the verdict that depends on them."""

import functools
import json
import re
import tomllib
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from identified import identified_arm, several_faults, spoilt_recordings
from long_check import few
from shared_data import DATA, existing
from shown.approved import approve_record, approve_result
from typer.testing import CliRunner

import crosscheck.identifying
import urdf
from crosscheck import identify
from crosscheck.commands import app
from crosscheck.commands.identify.record import record
from crosscheck.commands.identify.reports.report import identify_report
from crosscheck.identifying import OtherRecordings, friction_terms, virtual_robot
from crosscheck.identifying.data_quality.data_quality import QualityFinding, data_quality
from crosscheck.identifying.data_quality.mapping_lines import mapping_lines, recorded_columns
from crosscheck.identifying.preparing.trials import Baselines
from crosscheck.identifying.results.rejection_reasons import rejection_reasons, residual_ratio
from crosscheck.recordings import BadMapping, Recording, StreamedRecording, load_recording, mapping_of
from crosscheck.report.records.record import plain
from crosscheck.report.text import as_text
from graphdyn.identification import TorqueModel
from graphdyn.identification.data_quality import Change, DataFault
from graphdyn.identification.data_quality.channels.measured_torque import Gains
from graphdyn.identification.data_quality.fits.held_out import HeldOutGain
from graphdyn.identification.terms import MaxwellSlip, RigidBodies

RATE = 100.0
"""[Hz] Of the files."""


LOCKED = {"wrist_2_joint": 0.0, "wrist_3_joint": 0.0}
"""Four joints are left: each more makes more changes to try, and each trial longer."""


@functools.cache
def arm():
    return virtual_robot("ur5", friction_terms(["viscous", "coulomb"], width=0.05), seconds=10.0, lock=LOCKED)


def quality_of(recording):
    return data_quality(arm().torque_model, [recording], identified_arm.CUTOFF)


def quality_of_three(change):
    """What is said of the recording of an arm of three joints, changed, in half the time; and its joints."""
    small = identified_arm.virtual()
    found = data_quality(small.torque_model, [change(small.fitted)], identified_arm.CUTOFF)
    return found, small.torque_model.model.joint_names


RECORDINGS = ("ur10", "tx40", "kr300")
SPOILT = ("tau4 reversed", "q2, q3 exchanged", "tau 20 ms early")

NAMES = ("shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint", "wrist_1_joint")

RIGHT = {
    "q": {
        "columns": [f"q_{k}" for k in range(1, 5)],
        "unit": "rad",
        "sign": [1, 1, 1, -1],
        "offset": [0, 90, -90, 0],
        "offset_unit": "deg",
    },
    "tau": {"columns": [f"tau_{k}" for k in range(1, 5)], "unit": "N m", "sign": [1, 1, 1, -1]},
}
"""The mapping that fits the file: columns have signs and zeros of their own."""


@pytest.fixture(scope="module")
def file(tmp_path_factory):
    recording, every = arm().fitted, round(250 / RATE)
    from scipy.signal import decimate

    q = decimate(recording.q, every, ftype="fir", axis=0) - np.deg2rad(RIGHT["q"]["offset"])
    tau = decimate(recording.tau, every, ftype="fir", axis=0)
    columns = np.column_stack([q * RIGHT["q"]["sign"], tau * RIGHT["tau"]["sign"]])
    path = tmp_path_factory.mktemp("data_quality") / "log.csv"
    header = ",".join([*RIGHT["q"]["columns"], *RIGHT["tau"]["columns"]])
    np.savetxt(path, columns, delimiter=",", header=header, comments="")
    return path


@pytest.fixture(scope="module")
def right(file):
    """What is said of the file as the right mapping reads it."""
    return quality_of(loaded(file, RIGHT))


MAX_PASTED_DIFFERENCE = 0.05
"""Of torques, relative to their largest: delays are found to some milliseconds."""


def loaded(file, tables):
    """The recording as a mapping with these tables reads it; texts and lists are written alike in JSON and TOML."""
    lines = [f"joints = {json.dumps(NAMES)}", f"rate = {250 / round(250 / RATE)}"]
    for name, table in tables.items():
        if not isinstance(table, dict):
            continue
        lines += [f"[{name}]", *(f"{key} = {json.dumps(value)}" for key, value in table.items())]
    mapping = file.parent / "mapping.toml"
    mapping.write_text("\n".join(lines), encoding="utf-8")
    return load_recording(file, mapping, joints=NAMES)


def wrong(name, **values):
    return RIGHT | {name: RIGHT[name] | values}


MISTAKES = {
    "reversed-torque": wrong("tau", sign=[1, 1, -1, -1]),
    "reversed-position": wrong("q", sign=[1, -1, 1, -1]),
    "exchanged-torques": wrong("tau", columns=["tau_1", "tau_3", "tau_2", "tau_4"]),
    "exchanged-positions": wrong("q", columns=["q_1", "q_3", "q_2", "q_4"]),
    "zero": wrong("q", offset=[0, 90, 0, 0]),
    "radians": wrong("q", unit="deg"),
    "late-torque": wrong("tau", delay=-0.03),
    "gear-ratio": wrong("q", gain=[1, 1, 1.3, 1]),
    "coupling": wrong("q", side="motor")
    | {"transmission": {"matrix": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, -1, 1]]}},
}


@functools.cache
def found_of(file, mistake):
    return quality_of(loaded(file, MISTAKES[mistake]))


class TestRemedies:
    def test_whole(self, right):
        approve_result("data_quality", right)

    def test_right(self, right):
        assert right.findings == ()

    def test_lines_for_a_torque_in_another_unit(self, file):
        """What was said of sign and gain stays: ±1000 of the columns, divided by 1000."""
        recording = loaded(file, wrong("tau", gain=[1000, 1000, 2000, 1000]))
        change = Change("scaled torque", (0, 1, 2, 3), torque=np.diag([1e-3, 2e-3, 1e-3, 1e-3]), factor=1000.0)
        assert mapping_lines([change], recording)[0] == (
            "[tau]", 'unit = "N m"', "sign = [1, 1, 1, -1]", "gain = [1, 2, 2, 1]",
        )  # fmt: skip

    @pytest.mark.parametrize(
        ("change", "without", "with_own"),
        [
            (
                Change("exchanged torques", (0, 2), torque=np.eye(3)[[2, 1, 0]]),
                ("[tau]", "columns = [3, 2, 1]"),
                ("[tau]", 'columns = ["tau_a", "tau_c", "tau_b"]'),
            ),
            (
                Change("reversed torque", (2,), torque=np.diag([1.0, 1, -1])),
                ("[tau]", "sign = [1, 1, -1]"),
                ("[tau]", "sign = [-1, 1, 1]"),
            ),
            (
                Change("reversed position", (1,), np.diag([1.0, -1, 1]), np.diag([1.0, -1, 1])),
                ("[q]", "sign = [1, -1, 1]"),
                ("[q]", "sign = [1, -1, -1]"),
            ),
            (Change("degrees", (0, 1, 2), np.eye(3) * np.pi / 180), ("[q]", 'unit = "deg"'), ("[q]", 'unit = "deg"')),
            (
                Change("zero", (1,), zero=np.deg2rad([0, 180, 0])),
                ("[q]", "offset = [0, 180, 0]", 'offset_unit = "deg"'),
                ("[q]", "offset = [0, 10, 0]", 'offset_unit = "deg"'),
            ),
            (
                Change("late torque", (1,), factor=0.0203),
                ("[tau]", "delay = [0, 0.0203, 0]"),
                ("[tau]", "delay = [0.01, 0.01, 0.0303]"),
            ),
        ],
    )
    def test_lines_are_in_the_order_of_the_mapping(self, change, without, with_own):
        """Of a recording without one, whose columns count from 1, and of one with other signs, zeros and delays."""
        rows = np.random.default_rng(0).normal(size=(5, 3))
        bare = Recording(("a", "b", "c"), np.arange(5.0), rows, tau=rows)
        assert mapping_lines([change], bare)[0] == without
        q = {"columns": ["q_c", "q_a", "q_b"], "sign": [1, -1, 1], "offset": [0, 10, 180], "offset_unit": "deg"}
        tau = {"columns": ["tau_c", "tau_a", "tau_b"], "delay": 0.01}
        columns = mapping_of({"joints": ["c", "a", "b"], "rate": 1, "q": q, "tau": tau}, "m.toml")
        own = replace(bare, provenance=replace(bare.provenance, columns=columns))
        assert mapping_lines([change], own)[0] == with_own
        zeros = np.deg2rad([10, 180, 0])
        assert recorded_columns(own).zero == pytest.approx(zeros)
        assert not recorded_columns(bare).zero.any()

    @pytest.mark.parametrize("code", few(MISTAKES))
    def test_pasted_lines_undo_the_mistake(self, file, right, code):
        found = found_of(file, code)
        finding = found.findings[0]
        assert (finding.code, finding.severity) == (code, "fault")
        pasted = tomllib.loads("\n".join(finding.lines))
        mended = {name: table | pasted.get(name, {}) for name, table in MISTAKES[code].items()}
        again = quality_of(loaded(file, mended))
        assert again.findings == ()
        np.testing.assert_allclose(again.measures.errors, right.measures.errors, rtol=0.1)


SEVERAL = (
    "torques 2 and 4 exchanged, torque 4 reversed",
    "torque 2 reversed, torques 2 and 3 exchanged, torque 3 late",
    "zero of 2, torques 3 and 4 exchanged, torque 3 reversed",
    "in degrees, torques 2 and 3 exchanged, late",
)


class TestSeveralFaults:
    """Lines pasted one after the other, each over the keys of its tables, leave no fault."""

    def check(self, found):
        assert len(found.found) > 1
        assert found.left == ()
        q, tau = several_faults.same_motion(found.clean, found.mended)
        assert q == pytest.approx(0.0, abs=1e-6)
        assert tau < MAX_PASTED_DIFFERENCE

    @pytest.mark.parametrize("what", few(SEVERAL, SEVERAL[0]))
    def test_in_a_file(self, file, what):
        tables = several_faults.whole({"joints": [*NAMES], "rate": 1.0} | RIGHT)
        planted = several_faults.PLANTED[what]
        self.check(
            several_faults.pasted(
                tables, planted, lambda found: loaded(file, found), arm().torque_model, identified_arm.CUTOFF
            )
        )

    @pytest.mark.long
    @pytest.mark.parametrize("what", several_faults.PLANTED)
    def test_in_a_log_of_a_ur10(self, what):
        existing(DATA / "data" / "ur10")
        self.check(several_faults.pasted_in("ur10", several_faults.PLANTED[what]))


class TestWords:
    def test_of_a_reversed_torque(self, file):
        (finding,) = found_of(file, "reversed-torque").findings
        assert finding.message.startswith(
            "the torque of elbow_joint is reversed: undone, the equations of motion fit with "
        )
        assert finding.text.endswith("[reversed-torque]")
        assert finding.joints == ("elbow_joint",)
        assert finding.lines == ("[tau]", "sign = [1, 1, 1, -1]")

    def test_of_a_delay(self, file):
        (finding,) = found_of(file, "late-torque").findings
        said = re.match(r"the torques were recorded (\S+) ± (\S+) ms late: ", finding.message)
        late, deviation = map(float, said.groups())
        assert abs(late - 30.0) <= 2 * deviation < 1.0

    def test_of_channels(self):
        recording = arm().fitted
        tau = np.array(recording.tau)
        tau[:, 2], tau[:, 3] = tau[:, 1], 0.0
        found = quality_of(replace(recording, tau=tau))
        assert [finding.text for finding in found.faults] == [
            "the torques of shoulder_lift_joint and elbow_joint are the same signal; name the right column for each "
            "[duplicated]",
            "the torque of wrist_1_joint does not change; name the right column, or lock the joint [constant-torque]",
        ]

    def test_of_units(self):
        found, _ = quality_of_three(lambda recording: replace(recording, tau=1000 * recording.tau))
        (finding,) = found.findings
        assert (finding.code, finding.severity) == ("torque-unit", "fault")
        pasted = tomllib.loads("\n".join(finding.lines))["tau"]
        assert (pasted["unit"], pasted["sign"]) == ("N m", [1.0] * 3)
        assert pasted["gain"] == pytest.approx([1e-3] * 3, rel=0.3)

    @pytest.mark.parametrize(
        ("gain", "severity"),
        [
            ([1, 1.1, 0.95, 11.6], None),
            ([3, 3.3, 2.9, 3], "fault"),
            ([3, 3.3, 2.9, 36], "warning"),
            ([0.01, 0.011, 0.0095, 0.116], "fault"),
            ([0.01, 0.011, 0.116, 0.12], "warning"),
        ],
        ids=["of-one-joint", "all", "most", "most-and-far", "half"],
    )
    def test_of_units_on_which_joints_agree(self, monkeypatch, right, gain, severity):
        gains = np.array(gain + [np.nan] * 2)
        found = replace(right.measures, gains=Gains(gains, 0.1 * gains, np.ones(6), gains))
        monkeypatch.setattr("crosscheck.identifying.data_quality.data_quality.assess_recording", lambda *_, **__: found)
        said = quality_of(arm().fitted).findings
        assert [(finding.code, finding.severity) for finding in said] == [("torque-unit", severity)] * bool(severity)
        if severity == "fault":
            pasted = tomllib.loads("\n".join(said[0].lines))["tau"]
            assert pasted["gain"] == pytest.approx([1 / gain[0]] * 4, rel=0.1)
            assert said[0].remedy.endswith("if the unit is right, the masses of the robot's file are not")

    def test_of_noise(self):
        found, names = quality_of_three(spoilt_recordings.noise)
        assert {finding.code for finding in found.faults} == {"unrelated"}
        assert {joint for finding in found.faults for joint in finding.joints} >= set(names[1:])

    def test_of_halves(self):
        """What changed in between is told first, then the fault of the half that has it, which no mapping corrects."""
        found, (_, name, _) = quality_of_three(spoilt_recordings.half_reversed(1))
        first, *others = found.faults
        assert (first.code, first.joints) == ("halves", (name,))
        assert first.message.startswith(f"the two halves of the recording contradict each other at {name}")
        (second,) = [finding for finding in others if finding.code != "halves"]
        assert second.message.startswith(
            f"in the second half alone the torque of {name} is reversed: undone there, the equations of "
        )
        assert second.remedy == "correct it in that part of the file, or use the other part, by --split"
        assert second.lines == ()

    @pytest.mark.parametrize(("gained", "words"), [(0.02, "falls by 0.5 ± 1 %"), (-0.02, "rises by 0.5 ± 1 %")])
    def test_of_a_delay_that_improves_nothing(self, monkeypatch, right, gained, words):
        late = replace(right.measures.lag_left, common=-0.0063, deviation=0.002, held_out=HeldOutGain(gained, 0.04))
        found = replace(right.measures, lag_left=late)
        monkeypatch.setattr("crosscheck.identifying.data_quality.data_quality.assess_recording", lambda *_, **__: found)
        (hint,) = quality_of(arm().fitted).findings
        assert (hint.severity, hint.code, hint.lines) == ("hint", "late-torque", ())
        assert hint.message == (
            "perhaps the torques were recorded 6.3 ± 2.0 ms early: undone, the error of blocks predicted by the others "
            f"{words} (mean over the joints)"
        )
        assert hint.remedy == "compare with delay in [tau] of the mapping"

    def test_of_what_one_half_shows_elsewhere(self, monkeypatch, right):
        swap = np.eye(4)[[0, 1, 3, 2]] * [1, 1, 2, 0.5]
        change = Change("exchanged torques", (2, 3), torque=swap)
        fault = DataFault(change, 1.0, np.full(4, 0.2), np.full(4, 0.1))
        found = replace(right.measures, doubtful=(fault,))
        monkeypatch.setattr("crosscheck.identifying.data_quality.data_quality.assess_recording", lambda *_, **__: found)
        (hint,) = quality_of(arm().fitted).findings
        assert (hint.severity, hint.code) == ("hint", "exchanged-torques")
        assert hint.message.startswith(
            "perhaps the torques of elbow_joint and wrist_1_joint are exchanged, their signs and gains are not: undone"
        )
        assert hint.remedy == "look first what changed in between"

    def test_of_what_cannot_be_seen(self):
        said = " ".join(quality_of(arm().fitted).unseen)
        assert "a zero offset of 90° or 180° at shoulder_pan_joint" in said
        assert "the URDF of a similar robot" in said

    def test_expected_values_of_terms_that_it_leaves_out(self):
        """The data quality asks rows one by one; friction with memory is no part of it."""
        robot = identified_arm.virtual()
        model = replace(robot.torque_model, terms=(RigidBodies(), MaxwellSlip()), expected={"FM_1": (1.0, 1.0)})
        found = data_quality(model, [robot.fitted.take(slice(0, 500))], identified_arm.CUTOFF)
        assert found.measures.joint_names == robot.torque_model.model.joint_names

    def test_too_short(self):
        assert quality_of(arm().fitted.take(slice(0, 30))) is None


class TestDelay:
    def test_rows_without_torque_are_cut(self, file):
        right, late = loaded(file, RIGHT), loaded(file, wrong("tau", delay=0.048))
        step = right.t[1] - right.t[0]
        cut = round(0.048 / step)
        assert abs(len(right.t) - len(late.t) - cut) <= 1
        np.testing.assert_allclose(late.q, right.q[: len(late.q)])
        np.testing.assert_allclose(late.tau[:-1], right.tau[cut:][: len(late.tau) - 1], rtol=1e-6, atol=1e-6)
        assert late.provenance.steps[-1] == "torques 48 ms earlier"

    def test_too_long(self, file):
        with pytest.raises(BadMapping, match=r"\[tau\]: a delay of 50 s leaves no row"):
            loaded(file, wrong("tau", delay=50))

    def test_streamed(self, file):
        loaded(file, wrong("tau", delay=0.05))
        with pytest.raises(BadMapping, match="delay is not possible for a recording that is streamed"):
            next(iter(StreamedRecording(file, mapping=file.parent / "mapping.toml", cutoff=10.0)))


class TestVerdict:
    def test_clean(self):
        found = identified_arm.identified()
        assert found.usable
        assert found.recommendation.rejection_reasons == ()

    def test_a_fault_of_the_recording(self):
        clean = identified_arm.virtual()
        spoilt = replace(clean.fitted, tau=clean.fitted.tau * [1, -1, 1])
        found = identify(
            clean.subject.model, spoilt, terms=clean.torque_model.terms, methods=["wls", "consistent"],
            preparation=identified_arm.CUTOFF, poses=20,
        )  # fmt: skip
        assert not found.usable
        assert found.recommendation.name is None
        assert found.recommendation.rejection_reasons
        text = as_text(identify_report(found, found.shown()))
        assert "no usable model" in text
        assert "Why no model is recommended" in text
        assert "Lines of the file of --mapping" in text
        approve_record("data_quality", plain(record(found, None, []))["data_quality"])

    def test_a_fault_of_a_recording_that_is_predicted(self):
        """It says nothing of the model, and is told."""
        arm = identified_arm.virtual()
        spoilt = replace(arm.held_out, tau=arm.held_out.tau * [1, -1, 1])
        found = identified_arm.identified(["wls", "consistent"], held_out=OtherRecordings((spoilt,)))
        assert found.data_quality.faults == ()
        assert not found.usable
        name = arm.held_out.provenance.files[0]
        assert any(
            words.startswith(f"{name}, which is predicted: the torque of")
            for words in found.recommendation.rejection_reasons
        )
        assert f"Of {name}, which is predicted:" in as_text(identify_report(found, found.shown()), 250)
        assert record(found, None, [])["validation_data_quality"][0]["findings"][0].code == "reversed-torque"

    def test_a_hint_refuses_nothing(self):
        """It is shown with its number, and is no reason against a model."""
        found = identified_arm.identified()
        hint = QualityFinding("zero", "hint", ("elbow_joint",), "a zero of 3.1 ± 1.0°", "compare it with a picture")
        hinted = replace(found.data_quality, findings=(hint,))
        assert hinted.faults == ()
        assert rejection_reasons(None, found.problem, (), found.baselines, hinted) == ()
        text = as_text(identify_report(replace(found, data_quality=hinted), found.shown()), 250)
        assert "hint: a zero of 3.1 ± 1.0°; compare it with a picture" in text
        assert (
            json.loads(json.dumps(plain(record(replace(found, data_quality=hinted), None, []))))["data_quality"][
                "findings"
            ][0]["severity"]
            == "hint"
        )

    def test_every_joint_counts(self):
        found = identified_arm.compared()
        best = found.comparison.of(found.recommendation.name)
        sizes = best.held_out.moving
        names, joints = found.torque_model.model.joint_names, np.arange(3)

        def rejected(relative, constant=None, cad=None):
            held_out = replace(best.held_out, moving=replace(sizes, relative=np.array(relative)))
            changed = {
                "constant": found.baselines.constant if constant is None else replace(
                    found.baselines.constant, moving=replace(sizes, relative=np.array(constant))),
                "cad": found.baselines.cad if cad is None else replace(
                    found.baselines.cad, moving=replace(sizes, relative=np.array(cad))),
            }  # fmt: skip
            return rejection_reasons(replace(best, held_out=held_out), found.problem, names, Baselines(**changed), None)

        assert len(joints) == len(names)
        assert rejected([0.01, 0.01, 0.01], cad=[0.5, 0.5, 0.5], constant=[1, 1, 1]) == ()
        (said,) = rejected([0.01, 0.6, 0.01], cad=[0.5, 0.5, 0.5], constant=[1, 1, 1])
        assert said == f"{names[1]} is predicted with an error of 60.0 %, more than 50.0 %"
        (said,) = rejected([0.01, 0.01, 0.3], cad=[0.5, 0.5, 0.5], constant=[1, 1, 0.2])
        assert said == f"{names[2]} is predicted no better than by a constant: 30.0 % against 20.0 %"
        (said,) = rejected([0.01, 0.01, 0.3], cad=[0.5, 0.5, 0.1], constant=[1, 1, 1])
        assert said == f"{names[2]} is predicted worse than by CAD with fitted drives: 30.0 % against 10.0 %"
        said = rejected([0.12, 0.12, 0.12], cad=[0.1, 0.1, 0.1], constant=[1, 1, 1])
        assert said == (
            "CAD with fitted drives predicts better on the mean over the joints: 10.0 % against 12.0 %; use "
            "--known-bodies",
        )

    def test_a_residual_that_real_bodies_do_not_explain(self):
        found = identified_arm.compared()
        best = found.comparison.of("consistent")
        np.testing.assert_allclose(residual_ratio(found.problem, best.base_values), 1.0, atol=0.2)
        far = replace(best, base_values=2 * best.base_values)
        names = found.torque_model.model.joint_names
        said = rejection_reasons(far, found.problem, names, found.baselines, None)
        assert any("times that of parameters without constraints" in words for words in said)
        parts = [(part.kept, found.problem.reduced(part), part.right) for part in found.problem.rows()]
        kept, matrix, tau = (np.concatenate(arrays) for arrays in zip(*parts, strict=True))
        tried = far.base_values, found.comparison.of("WLS").base_values, np.zeros(matrix.shape[-1])
        sizes = [np.linalg.norm(kept * (matrix @ x - tau), axis=0) for x in tried]
        expected = sizes[0] / np.maximum(sizes[1], 0.01 * sizes[2])
        np.testing.assert_allclose(residual_ratio(found.problem, far.base_values), expected, rtol=1e-6)
        assert f"residual of {names[np.argmax(expected)]} is {expected.max():.3g} times" in said[-1]


class TestRealRecordings:
    """A few of the variants of `python tests/tools corrupted_recordings`, without any fit; simulated ones are above."""

    def judged(self, name, variant):
        existing(DATA / "data" / name)
        (chosen,) = [known for known in spoilt_recordings.variants(name) if known.name == variant]
        return spoilt_recordings.judged(name, chosen, fitted=False)

    @pytest.mark.parametrize("name", few(RECORDINGS))
    def test_clean(self, name):
        row = self.judged(name, "clean")
        assert row.data_quality.findings == ()
        assert row.data_quality.unseen

    @pytest.mark.parametrize(("name", "variant"), few([*product(RECORDINGS, SPOILT)]))
    def test_spoilt(self, name, variant):
        assert self.judged(name, variant).right


@pytest.mark.usefixtures("unexamined")
def test_no_urdf_of_a_doubted_model(file, tmp_path, monkeypatch):
    """Unless a method is chosen; the exit code says that there is no usable model in any case."""
    monkeypatch.chdir(tmp_path)
    found = []

    def once(*values, **options):
        found.append(found[0] if found else identify(*values, **options))
        return found[0]

    monkeypatch.setattr(crosscheck.identifying, "identify", once)
    loaded(file, MISTAKES["reversed-torque"])
    urdf.save(arm().subject.model, "arm.urdf")
    arguments = ["identify", str(file), "--robot", "arm.urdf", "--mapping", str(file.parent / "mapping.toml")]
    arguments += ["--cutoff", "10", "--terms", "viscous,coulomb", "--width", "0.05", "--methods", "wls,consistent"]
    arguments += ["--poses", "10", "--urdf", "better.urdf"]
    done = CliRunner().invoke(app, arguments)
    assert done.exit_code == 1
    assert "better.urdf is not written: no model is recommended; --choose METHOD writes one all the same" in done.output
    assert not (tmp_path / "better.urdf").exists()
    done = CliRunner().invoke(app, [*arguments, "--choose", "consistent"])
    assert done.exit_code == 1, done.output
    assert (tmp_path / "better.urdf").exists()
    assert len(found) == 2


def test_data_quality_of_known_bodies_alone():
    """Drives and payload are identified, the links are those of CAD."""
    from graphdyn.identification.terms import KnownBodies

    terms = tuple(friction_terms(["viscous", "coulomb"], width=0.05))
    model = TorqueModel(arm().subject.model, terms, (KnownBodies(),))
    assert data_quality(model, [arm().fitted], identified_arm.CUTOFF) is not None
