"""Findings of a size, of held values, of the clock: words, remedies and lines; the mounting of an identification."""

import re
from dataclasses import replace

import numpy as np
import pytest
from identified import identified_arm

from crosscheck.commands.identify.reports.report import identify_report
from crosscheck.identifying import identify
from crosscheck.identifying.data_quality.causes import cause_in_words, code_of, remedy_of
from crosscheck.identifying.data_quality.data_quality import data_quality
from crosscheck.identifying.data_quality.mapping_lines import mapping_lines
from crosscheck.identifying.data_quality.row_findings import (
    clock_findings,
    clock_rate,
    held_findings,
    held_rows,
    measured_parts,
    model_findings,
)
from crosscheck.recordings import BadMapping, Provenance, mapping_of
from crosscheck.report.text import as_text
from graphdyn import InvalidInput
from graphdyn.identification.data_quality import Addition, Change, DataFault

NAMES = ("base", "shoulder", "elbow")
EVERY, ONE = (0, 1, 2), (1,)
DOWN = np.array([0.0, 0.0, -9.81])
COLUMNS = np.zeros((1, 3, 1))


def fault(cause, deviation=0.02, parameters=None):
    return DataFault(cause, 1.0, np.ones(3), np.ones(3), deviation=deviation, parameters=parameters)


def words(cause, deviation=0.02, parameters=None):
    return cause_in_words(fault(cause, deviation, parameters), NAMES, DOWN)


EYE = np.eye(3)


@pytest.mark.parametrize(
    ("cause", "code", "said", "remedy"),
    [
        (
            Change("zero", ONE, zero=np.deg2rad([0, 12.5, 0])),
            "zero",
            "the zero of shoulder is -12.5 ± 0.02° away from that of the model",
            "correct it in the mapping",
        ),
        (
            Change("gear ratio", ONE, position=EYE, factor=0.5),
            "gear-ratio",
            "the position of shoulder is 2 ± 0.08 times the right one, as with another gear ratio",
            "correct it in the mapping",
        ),
        (
            Change("gear ratio", ONE, position=EYE, torque=EYE, factor=0.5),
            "gear-ratio",
            "the position of shoulder is 2 ± 0.08 times the right one, and its torque 0.5 times, as with another gear "
            "ratio",
            "correct it in the mapping",
        ),
        (
            Change("scaled torque", ONE, torque=EYE, factor=1.3),
            "scaled-torque",
            "the torque of shoulder is 1.3 ± 0.02 times that of the others, as in another unit",
            "correct it in the mapping",
        ),
        (
            Change("time scale", EVERY, velocity=EYE, factor=2.0),
            "time-scale",
            "the clock runs at 0.5 ± 0.005 times the right rate, or gravity has another size than in the model",
            "correct it in the mapping",
        ),
        (
            Change("degrees", ONE, position=EYE),
            "degrees",
            "the position of shoulder is in degrees",
            "correct it in the mapping",
        ),
        (
            Change("gravity", EVERY, gravity=np.array([0.0, 9.81, 0.0])),
            "gravity",
            "gravity is (0, 9.81, 0) m/s² in world axes, 90 ± 0.02° from that of the model: the robot is mounted "
            "turned by this angle about (-1, 0, 0)",
            "correct the mounting of the robot: --gravity 0 9.81 0",
        ),
        (
            Change("gravity", EVERY, gravity=2 * DOWN),
            "gravity",
            "gravity is (0, 0, -19.6) m/s² in world axes, 2 times its size",
            "correct the mounting of the robot: --gravity 0 0 -19.62",
        ),
        (
            Change("gravity subtracted", EVERY, gravity=np.zeros(3)),
            "gravity-subtracted",
            "the torques hold no gravity; it was subtracted before they were recorded",
            "record whole torques, or take --gravity 0 0 0 to model what is left",
        ),
        (
            Change("coupled positions", (2, 1), position=EYE, factor=-1.0),
            "coupling",
            "the angle of elbow is its column minus that of shoulder",
            "correct it in the mapping",
        ),
        (
            Change("coupled joints", (2, 1), position=EYE, torque=EYE),
            "coupling",
            "the angle of elbow is its column plus that of shoulder, and its torque acts on both",
            "correct it in the mapping",
        ),
    ],
)
def test_a_change_of_a_size(cause, code, said, remedy):
    assert (code_of(cause), words(cause), remedy_of(cause)) == (code, said, remedy)


def test_ratios_of_data_sheets():
    gear = Change("gear ratio", ONE, position=EYE, factor=81 / 101)
    ratios = "101 in place of 81 or 50 in place of 40 or 100 in place of 80"
    assert (
        words(gear, 0.002)
        == f"the position of shoulder is 1.247 ± 0.003 times the right one, as with a gear ratio of {ratios}"
    )
    assert words(gear, 0.02).endswith("as with another gear ratio")


@pytest.mark.parametrize(
    ("kind", "joints", "code", "said", "remedy"),
    [
        (
            "torque drift",
            EVERY,
            "torque-drift",
            "the torque of all joints grows by 43 ± 4 % during the recording, beside what the motion explains",
            "correct the torques for it, or use a part of the recording, by --split",
        ),
        (
            "gain jump",
            ONE,
            "torque-drift",
            "the gain of the torque of shoulder jumps by 43 ± 4 % after 40 % of the recording",
            "use one part of the recording, by --split",
        ),
        (
            "friction drift",
            ONE,
            "torque-drift",
            "the friction of shoulder grows by -30 ± 2 % during the recording",
            "give it to the model: --terms with coulomb*time and viscous*time beside coulomb and viscous",
        ),
        (
            "torque jump",
            ONE,
            "torque-drift",
            "the torque of shoulder jumps by -0.3 ± 0.02 N m or N after 40 % of the recording",
            "use one part of the recording, by --split",
        ),
        (
            "attached load",
            EVERY,
            "payload-change",
            "a load of -0.3 ± 0.02 kg was attached after 40 % of the recording",
            "use one part of the recording, by --split",
        ),
        (
            "detached load",
            EVERY,
            "payload-change",
            "a load of -0.3 ± 0.02 kg was taken off after 40 % of the recording",
            "use one part of the recording, by --split",
        ),
        (
            "friction subtracted",
            ONE,
            "friction-subtracted",
            "the torque of shoulder holds negative friction; too much was subtracted before it was recorded",
            "record whole torques, or take --terms none",
        ),
    ],
)
def test_what_changed_in_between(kind, joints, code, said, remedy):
    cause = Addition(kind, joints, COLUMNS, instant=0.4, growth=np.array([0.0, 0.5, 1.0]))
    assert (code_of(cause), words(cause, 0.02, np.array([-0.3])), remedy_of(cause)) == (code, said, remedy)


def test_a_low_pass():
    cause = Addition("filtered torque", ONE, COLUMNS)
    assert code_of(cause) == "filtered-torque"
    assert words(cause, 0.002, np.array([0.08])) == (
        "the torque of shoulder went through a low-pass of 1.99 Hz, a time constant of 80 ± 2 ms"
    )
    assert remedy_of(cause) == "record the torque in front of that filter"


def with_mapping(recording, **tables):
    """The recording as if a mapping file with these tables had read it."""
    joints = list(recording.joint_names)
    names = {name: [f"{name}_{k}" for k in range(len(joints))] for name in ("q", "tau")}
    document = {"joints": joints, "q": {"columns": names["q"]}, "tau": {"columns": names["tau"]}} | tables
    columns = mapping_of(document, "columns.toml")
    return replace(recording, provenance=Provenance(("log.csv",), "columns.toml", (), columns))


class TestLines:
    def slower(self, n, factor=1.25):
        rate = np.eye(n) / factor
        return Change("time scale", tuple(range(n)), velocity=rate, acceleration=rate / factor, factor=factor)

    def test_of_the_clock(self):
        own = identified_arm.virtual().fitted
        by_column = with_mapping(own, time={"column": "t", "unit": "ms", "gain": 2.0})
        assert mapping_lines([self.slower(own.n_joints)], by_column) == [("[time]", "gain = 2.5")]
        by_rate = with_mapping(own, rate=250)
        assert mapping_lines([self.slower(own.n_joints)], by_rate) == [("rate = 200",)]

    def test_of_a_gain_of_the_clock(self):
        table = {"joints": ["a"], "q": {"columns": ["q"]}, "time": {"column": "t", "unit": "ms", "gain": 1.5}}
        assert mapping_of(table, "m.toml").time.factor == pytest.approx(1.5e-3)
        with pytest.raises(
            BadMapping, match=r"m\.toml, \[time\]: gain is -1; give the true time per recorded time, above"
        ):
            mapping_of(table | {"time": {"column": "t", "gain": -1}}, "m.toml")

    def test_of_coupled_torques(self):
        own = with_mapping(identified_arm.virtual().fitted, rate=250)
        position = np.eye(own.n_joints)
        position[2, 1] = 1.0
        torque = np.linalg.inv(position).T
        change = Change("coupled joints", (2, 1), position=position, velocity=position, torque=torque)
        (lines,) = mapping_lines([change], own)
        assert lines == (
            "[q]",
            'side = "motor"',
            "[tau]",
            'side = "motor"',
            "[transmission]",
            "matrix = [[1, 0, 0], [0, 1, 0], [0, -1, 1]]",
            "torque_matrix = [[1, 0, 0], [0, 1, -1], [0, 0, 1]]",
        )


class TestRows:
    """Values that are held while the robot moves."""

    def recording(self, **changed):
        own = identified_arm.virtual().fitted
        return replace(own, **{name: change(np.array(getattr(own, name))) for name, change in changed.items()})

    def found(self, **changed):
        recording = self.recording(**changed)
        return list(held_findings(held_rows([recording]), recording.joint_names))

    def test_none(self):
        assert self.found() == []
        recordings = [self.recording()]
        assert measured_parts(recordings, held_rows(recordings)) == recordings

    def test_of_a_dead_torque(self):
        def hold(tau):
            tau[500:900, 1] = tau[500, 1]
            return tau

        (found,) = self.found(tau=hold)
        assert (found.code, found.severity, found.joints) == ("dead-channel", "fault", ("joint2",))
        assert found.message.startswith("the torque of joint2 holds one value in ")
        assert found.message.endswith(" % of the rows while the joint moves")
        assert found.remedy == "the channel was dead there: use another part, by --split"

    def test_of_a_clipped_position(self):
        def clip(q):
            q[:, 0] = np.minimum(q[:, 0], np.quantile(q[:, 0], 0.7))
            return q

        (found,) = self.found(q=clip)
        assert (found.code, found.joints) == ("clipped-position", ("joint1",))
        assert found.message.startswith("the position of joint1 is held at an end of its range in ")
        assert found.remedy == "the sensor stops there while the joint moves on: use another part, by --split"

    def test_of_repeated_rows(self):
        def double(values):
            return np.repeat(values[::2], 2, axis=0)[: len(values)]

        (found,) = self.found(q=double, tau=double)
        assert found.code == "repeated-rows"
        assert found.message.endswith(" % of the rows repeat other rows exactly while the robot moves")
        assert found.remedy == "record each sample once: drop the copies, or give the rate at which the robot sends"

    def test_of_missing_rows(self):
        left = np.r_[0:300, 340:700, 760:1000]
        recording = self.recording().take(left, t=np.arange(len(left)) * 0.01)
        (found,) = held_findings(held_rows([recording]), recording.joint_names)
        assert (found.code, found.severity, found.joints) == ("missing-rows", "fault", recording.joint_names)
        assert found.message == "all positions jump at once 2 times: rows are missing there, and the times hide it"
        assert found.remedy == "give the robot's own time stamps, or use the parts between the jumps, by --split"
        (part,) = measured_parts([recording], held_rows([recording]))
        assert [rows.start for rows in part.block_slices] == [0, 300, 660]

    def test_of_a_torque_in_coarse_steps(self):
        def step(tau):
            size = np.ptp(tau[:, 1]) / 20
            tau[:, 1] = size * np.round(tau[:, 1] / size)
            return tau

        found = data_quality(identified_arm.virtual().torque_model, [self.recording(tau=step)], identified_arm.CUTOFF)
        (finding,) = [finding for finding in found.findings if finding.code == "quantized"]
        assert (finding.severity, finding.joints) == ("warning", ("joint2",))
        assert re.fullmatch(
            r"the torque of joint2 takes 2\d values only: it was recorded in coarse steps", finding.message
        )
        assert finding.remedy == "record it with more digits or bits"

    def test_what_was_measured(self):
        """Rows that hold a value are left out; blocks begin anew behind them, but not behind single rows."""

        def hold(tau):
            tau[500:900, 1] = tau[500, 1]
            return tau

        dead, double = self.recording(tau=hold), self.recording()
        double = double.take(np.repeat(np.arange(len(double.t)), 2), t=np.arange(2 * len(double.t)) / 2)
        first, second = measured_parts([dead, double], held_rows([dead, double]))
        assert len(first.t) == len(dead.t) - 400
        assert [rows.start for rows in first.block_slices] == [0, 500]
        assert len(second.t) == len(double.t) // 2
        assert len(second.block_slices) == 1

    def test_causes_are_searched_in_what_was_measured(self):
        """A dead channel beside another fault: both are named, the rows first, and nothing else."""

        def spoil(tau):
            tau[200:600, 2] = 0.0
            tau[:, 1] *= -1
            return tau

        found = data_quality(identified_arm.virtual().torque_model, [self.recording(tau=spoil)], identified_arm.CUTOFF)
        assert [(finding.code, finding.joints) for finding in found.faults] == [
            ("dead-channel", ("joint3",)),
            ("reversed-torque", ("joint2",)),
        ]


class TestModelTorques:
    def measures(self, **changed):
        robot = identified_arm.virtual()
        found = data_quality(robot.torque_model, [robot.fitted], identified_arm.CUTOFF).measures
        gains = replace(found.gains, without_gain=np.array(changed.pop("without_gain", found.gains.without_gain)))
        return replace(found, gains=gains, **{name: np.array(value) for name, value in changed.items()})

    def test_measured_ones(self):
        assert list(model_findings(self.measures())) == []

    def test_those_of_cad(self):
        (found,) = model_findings(self.measures(without_gain=[1e-3, 1e-3, 1.2e-3]))
        assert (found.code, found.severity) == ("model-torque", "fault")
        assert found.message == "the torques are those of CAD with drives, to 0.12 %: the output of a model"
        assert found.remedy.startswith("name the columns that were measured; of a simulation, identify with links that")

    def test_that_of_one_joint(self):
        (found,) = model_findings(replace(self.measures(errors=[0.02, 1e-3, 0.04]), modeled=(1,)))
        assert found.joints == ("joint2",)
        assert found.message == (
            "the torque of joint2 has no error of measurement (0.1 %, the others 3 %): the output of a model"
        )
        assert found.remedy == "name the column that was measured"


class TestClock:
    def test_velocities_tell_it(self):
        robot = identified_arm.virtual()
        measures = data_quality(robot.torque_model, [robot.fitted], identified_arm.CUTOFF).measures
        assert np.isnan(clock_rate(measures))
        assert list(clock_findings(measures)) == []
        fast = replace(measures, channels=replace(measures.channels, velocity_gain=np.full(3, 1.25)))
        (found,) = clock_findings(fast)
        assert (found.code, found.severity) == ("time-scale", "fault")
        assert found.message == (
            "all velocities are 1.25 times the rates of the positions: the time stamps are 1.25 times too close, or "
            "the unit of velocities is another one"
        )
        assert found.remedy == "correct the clock, or the unit of [v]"
        one = replace(measures, channels=replace(measures.channels, velocity_gain=np.array([1.0, 1.25, 1.0])))
        assert np.isnan(clock_rate(one))


class TestFreeGravity:
    def options(self, robot):
        return {
            "terms": robot.torque_model.terms,
            "methods": ["wls"],
            "preparation": identified_arm.CUTOFF,
            "poses": 1,
        }

    def test_a_robot_on_a_wall(self):
        robot = identified_arm.virtual()
        wall = robot.subject.model.with_gravity([9.81, 0, 0])
        told = identify(wall, robot.fitted, **self.options(robot))
        assert "gravity" in {finding.code for finding in told.data_quality.faults}
        found = identify(wall, robot.fitted, free_gravity=True, **self.options(robot))
        unit = [vector / np.linalg.norm(vector) for vector in (found.gravity.gravity, robot.subject.model.gravity)]
        angle = np.rad2deg(np.arccos(unit[0] @ unit[1]))
        assert angle < max(0.5, 3 * found.gravity.deviation)
        assert not {finding.code for finding in found.data_quality.faults} & {"gravity"}
        assert "m/s² in world axes, direction ± " in as_text(identify_report(found, found.shown()))

    def test_is_not_of_partitioned_recordings(self, tmp_path):
        from crosscheck.recordings import PartitionedRecording

        with pytest.raises(InvalidInput, match="gravity is found from recordings in memory only; give it, or load one"):
            identify("ur5", PartitionedRecording(["a.parquet"]), free_gravity=True)
