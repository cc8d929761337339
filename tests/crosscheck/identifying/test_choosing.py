"""Terms of the drives that the recording chooses, and what residuals still hold, on arms with planted terms."""

import functools
import sys
from dataclasses import replace

import numpy as np
import pytest
from identified.identified_arm import CUTOFF, POSES, virtual
from long_check import LONG
from planting import mixed_tree

import crosscheck
from crosscheck.commands.identify.reports.ladder_report import ladder_section, residual_section
from crosscheck.identifying import CandidateModel, Folds, friction_terms, virtual_robot
from crosscheck.identifying.choosing.drive_models import DriveModel, every_term, parts_without_use
from crosscheck.identifying.choosing.ladder import climbed
from crosscheck.identifying.choosing.residual_causes import residual_causes
from crosscheck.identifying.data_quality.data_quality import data_quality
from crosscheck.identifying.identify import number_of_steps
from crosscheck.recordings import samples_of
from graphdyn import Body, kr500
from graphdyn.identification.terms import KnownBodies, Offset, RigidBodies

SHARE, SHARE_ERROR = 0.5, 0.2
"""Part of a planted residual, and how exactly it is found."""


@functools.cache
def recorded(*names):
    """A small arm with these terms, and its prepared recording."""
    arm = virtual_robot(mixed_tree(), friction_terms(names), seconds=10.0)
    return arm, CUTOFF.differentiated(arm.fitted)


@functools.cache
def ladder(*names):
    arm, prepared = recorded(*names)
    return climbed(arm.subject.model, (RigidBodies(),), (), prepared, CUTOFF)


class TestLadder:
    @pytest.mark.parametrize(
        ("planted", "parts"),
        [
            (("viscous", "coulomb"), set()),
            (("viscous", "coulomb", "offset"), {"offsets"}),
            pytest.param(("viscous", "coulomb", "rotor"), {"rotors"}, marks=LONG),
            pytest.param(("viscous", "load"), {"load", "curve"}, marks=LONG),
        ],
    )
    def test_takes_what_was_planted(self, planted, parts):
        """And nothing else; without Coulomb friction the curve is another one."""
        model = ladder(*planted).model
        assert {part for part, start in vars(DriveModel()).items() if getattr(model, part) != start} == parts

    def test_steps(self):
        found = ladder("viscous", "coulomb", "offset")
        first = [step for step in found.steps if step.rung == 1]
        assert {step.change for step in first} >= {"offsets", "rotors", "load", "smooth", "slip, 0.01"}
        for step in found.steps:
            before = found.start_error if step.rung == 1 else found.taken[step.rung - 2].error
            assert step.error - before == pytest.approx(step.difference)
            assert step.deviation >= 0
        for step in found.taken:
            assert step.change.startswith("without") or -step.difference > step.deviation
        assert found.error == pytest.approx(found.taken[-1].error)
        assert found.error < found.start_error
        assert found.terms == ('"viscous"', '"coulomb"', '"offset"')
        assert found.offsets.change == "without offsets"
        assert found.offsets.difference > found.offsets.deviation

    def test_too_short(self):
        arm, prepared = recorded("viscous", "coulomb")
        short = prepared.take(slice(0, 500))
        found = climbed(arm.subject.model, (RigidBodies(),), (), short, CUTOFF)
        assert found.reason == "2 s are too short for 8 folds with 0.25 s left out around each; record 4 s or more"
        assert found.model == DriveModel(offsets="offsets")
        assert not found.steps
        assert found.offsets is None

    def test_the_beginning_of_a_long_recording(self, monkeypatch):
        """Chooses, and its residuals are examined."""
        arm, prepared = recorded("viscous", "coulomb", "offset")
        monkeypatch.setattr("crosscheck.identifying.choosing.folds.MAX_ROWS", 1500)
        found = climbed(arm.subject.model, (), (KnownBodies(),), prepared, CUTOFF, memory=False)
        assert (found.of_rows, found.rows) == (1500, 750)
        assert climbed(
            arm.subject.model, (), (KnownBodies(),), prepared.take(slice(0, 1500)), CUTOFF, memory=False
        ).error == pytest.approx(found.error)
        noise = np.random.default_rng(0).normal(size=prepared.q.shape)
        causes = residual_causes(arm.subject.model, prepared, CUTOFF, noise)
        noise[1500:] = np.nan
        assert all(np.all(np.isfinite(cause.shares)) for cause in causes)
        again = residual_causes(arm.subject.model, prepared, CUTOFF, noise)
        np.testing.assert_array_equal([cause.shares for cause in again], [cause.shares for cause in causes])

    def test_no_mass(self):
        """Without any mass there is no prior to begin from."""
        arm, prepared = recorded("viscous", "coulomb")
        model = arm.subject.model
        light = replace(model, bodies=tuple(Body(body.name, 0.0, [0, 0, 0], np.zeros((3, 3))) for body in model.bodies))
        found = climbed(light, (RigidBodies(),), (), prepared, CUTOFF)
        assert found.reason == "no body of the prior has a mass; give a prior with at least rough masses"

    def test_known_links(self):
        """The same drives are found where no link is unknown."""
        _, prepared = recorded("viscous", "coulomb", "offset")
        found = climbed(mixed_tree(), (), (KnownBodies(),), prepared, CUTOFF, memory=False)
        assert not found.reason
        assert found.model == DriveModel(offsets="offsets")
        assert not any(step.change.startswith("slip") for step in found.steps)

    def test_parts_that_are_not_tried(self):
        """A wrist is coupled where both axes turn; what a fixed term is already comes no second time."""
        assert parts_without_use(kr500(), (), memory=True) == set()
        assert parts_without_use(kr500(), (RigidBodies(),), memory=False) == {"memory"}
        assert parts_without_use(mixed_tree(), (), memory=True) == {"coupling"}
        assert parts_without_use(kr500(), (Offset(),), memory=True) == {"offsets"}

    def test_every_term_has_its_own_key(self):
        terms = every_term()
        everything = DriveModel("smooth", "load", "slip, 0.01", "rotors", "coupled wrist", "offsets")
        assert set(everything.keys) <= set(terms)
        assert not any(getattr(term, "has_memory", False) for term in every_term(["memory"]).values())
        assert sum(getattr(term, "has_memory", False) for term in terms.values()) == 3


class TestIdentified:
    @pytest.fixture(scope="class")
    @staticmethod
    def chosen():
        """Identified without terms."""
        arm, _ = recorded("viscous", "coulomb", "offset")
        said = []
        found = crosscheck.identify(
            arm.subject.model, arm.fitted, methods=["wls"], preparation=CUTOFF, held_out=Folds(4), poses=POSES,
            progress=lambda what, _: said.append(what),
        )  # fmt: skip
        return found, said

    def test_terms_are_those_of_the_ladder(self, chosen):
        found, said = chosen
        kinds = [type(term).__name__ for term in found.torque_model.terms]
        assert kinds == ["RigidBodies", "Viscous", "Coulomb", "Offset"]
        assert found.ladder.taken[0].change == "offsets"
        assert found.others[0].ladder is None
        assert said.count("terms of the drives") == 1
        model = CandidateModel("", (RigidBodies(),), methods=["wls"], choose_drives=True)
        assert number_of_steps([model], Folds(4)) == len(said)

    def test_report(self, chosen):
        found, _ = chosen
        (section,) = ladder_section(found)
        facts = dict(section.blocks[0].items)
        step = found.ladder.offsets
        assert facts["chosen"] == "viscous; Coulomb; offsets"
        assert facts["offsets"].startswith(
            f"kept: {100 * found.ladder.error:.2f} % with, {100 * step.error:.2f} % without, a difference of -"
        )
        assert section.blocks[2].text == '[chosen]\nterms = ["viscous", "coulomb", "offset"]'
        rows = {row.cells[0]: row.cells[1:] for row in section.blocks[1].rows}
        assert rows["offsets"][0].endswith("✓")
        assert rows["without offsets"] == ("–", f"{100 * step.difference:+.2f} ± {100 * step.deviation:.2f}")
        assert "8 folds of 783 rows, robust fits" in facts["held out"]
        partly = replace(found, ladder=replace(found.ladder, of_rows=1000))
        assert "783 rows of the first 1000, robust" in dict(ladder_section(partly)[0].blocks[0].items)["held out"]
        correlated = replace(found, ladder=replace(found.ladder, correlation_times=30.0))
        (section,) = ladder_section(correlated)
        assert dict(section.blocks[0].items)["errors of folds"] == (
            "a lower bound of those on other runs: the rows are 30 correlation times long, fewer than 80"
        )
        left_out = replace(found, ladder=ladder("viscous", "coulomb"))
        facts = dict(ladder_section(left_out)[0].blocks[0].items)
        assert facts["offsets"].startswith("left out: ")
        assert facts["steps"] == "none: no change predicts better by more than its deviation"

    @pytest.mark.usefixtures("unexamined")
    def test_standard_terms(self):
        arm = virtual()
        options = {"methods": ["wls"], "preparation": CUTOFF, "poses": 1}
        found = crosscheck.identify(arm.subject.model, arm.fitted, terms="standard", **options)
        assert [type(term).__name__ for term in found.torque_model.terms] == [
            "RigidBodies", "Viscous", "Coulomb", "Offset",
        ]  # fmt: skip
        assert found.ladder is None
        assert ladder_section(found) == ()

    @pytest.mark.usefixtures("unexamined")
    def test_too_short(self):
        arm = virtual()
        short = arm.fitted.take(slice(0, 1000))
        found = crosscheck.identify(arm.subject.model, short, methods=["wls"], preparation=CUTOFF, poses=1)
        (section,) = ladder_section(found)
        assert section.blocks[0].text == (
            f"Terms of the drives are the standard ones (viscous; Coulomb; offsets), not chosen: {found.ladder.reason}."
        )


class TestResidualCauses:
    @pytest.fixture(scope="class")
    @staticmethod
    def white():
        """An arm, its recording, and a white residual."""
        arm, prepared = recorded("viscous", "coulomb")
        (samples,) = samples_of(prepared)
        return arm.subject.model, prepared, samples, np.random.default_rng(0).normal(size=samples.q.shape)

    def test_chance_explains_nothing(self, white):
        model, prepared, _, noise = white
        causes = residual_causes(model, prepared, CUTOFF, noise)
        assert [cause.name for cause in causes] == ["position ripple", "memory", "drift"]
        assert np.mean([cause.shown for cause in causes]) <= 0.15
        assert all(np.all(cause.shares < 0.02) for cause in causes)

    @pytest.mark.parametrize(
        ("name", "effect", "joints"),
        [
            ("position ripple", lambda s: np.cos(2 * s.q + 0.3), [0, 2]),  # the other one slides by decimeters
            ("drift", lambda s: s.time[:, None] - s.time.mean(), [0, 1, 2]),
        ],
    )
    def test_share_of_a_planted_cause(self, white, name, effect, joints):
        model, prepared, samples, noise = white
        planted = samples.row_filter(np.broadcast_to(effect(samples), noise.shape))
        planted = planted / np.sqrt(np.mean(planted**2, axis=0))
        causes = {cause.name: cause for cause in residual_causes(model, prepared, CUTOFF, noise + planted)}
        assert np.all(np.abs(causes[name].shares[joints] - SHARE) <= SHARE_ERROR)
        assert np.all(causes[name].shown[joints])

    def test_temperature_where_it_was_recorded(self, white):
        model, prepared, samples, noise = white
        degrees = 30 + 5 * np.sin(np.linspace(0, 20, len(noise))[:, None] * [0.9, 1, 1.1])
        warm = replace(prepared, temperature=degrees)
        filtered = samples.row_filter((degrees - 30) * samples.v)
        planted = filtered / np.sqrt(np.mean(filtered**2, axis=0))
        causes = {cause.name: cause for cause in residual_causes(model, warm, CUTOFF, noise + planted)}
        assert np.all(np.abs(causes["temperature"].shares - SHARE) <= SHARE_ERROR)

    @pytest.mark.usefixtures("unexamined")
    def test_report(self, white):
        arm = virtual()
        options = {"methods": ["wls"], "preparation": CUTOFF, "poses": 1}
        found = crosscheck.identify(arm.subject.model, arm.fitted, terms=(RigidBodies(), Offset()), **options)
        (section,) = residual_section(found, found.shown())
        (table,) = section.blocks
        assert [column.title for column in table.columns] == ["joint", "position ripple", "memory", "drift"]
        memory = found.residual_causes(found.shown())[1]
        assert np.all(memory.shown)
        assert table.rows[0].cells[2] == f"{100 * memory.shares[0]:.0f} ± {100 * memory.deviations[0]:.0f}"
        assert "memory: the term slip" in table.caption

    def test_too_short(self, white):
        model, prepared, _, noise = white
        assert residual_causes(model, prepared.take(slice(0, 500)), CUTOFF, noise[:500]) == ()


def test_load_friction_of_a_joint_without_load():
    """A simulated joint that gravity does not load has none of it, and the ladder tries it all the same."""
    weightless = mixed_tree().with_gravity([0.0, 0.0, 0.0])
    arm = virtual_robot(weightless, friction_terms(["viscous", "coulomb", "load"]), seconds=10.0)
    assert np.all(arm.truth[-3:] == 0)
    assert np.all(arm.truth[-9:-3] > 0)
    prepared = CUTOFF.differentiated(arm.fitted)
    tried = climbed(arm.subject.model, (RigidBodies(),), (), prepared, CUTOFF, memory=False).steps
    assert next(step for step in tried if step.change == "load").difference == pytest.approx(0.0, abs=1e-4)


def test_faults_are_those_that_chosen_terms_leave(monkeypatch):
    """A recording with a fault is examined again with the terms that it chose; a torque with a wrong sign stays one."""
    arm, _ = recorded("viscous", "coulomb")
    tau = np.array(arm.fitted.tau)
    tau[:, 1] *= -1
    asked = []

    def examined(torque_model, recordings, preparation):
        asked.append(torque_model)
        return data_quality(torque_model, recordings, preparation)

    monkeypatch.setattr(sys.modules["crosscheck.identifying.identify"], "data_quality", examined)
    found = crosscheck.identify(
        arm.subject.model, replace(arm.fitted, tau=tau), methods=["wls"], preparation=CUTOFF, poses=POSES
    )
    assert [type(term).__name__ for term in asked[0].terms] == ["RigidBodies", "Viscous", "Coulomb", "Offset"]
    assert asked[1].columns == found.problem.torque_model.columns
    assert [fault.code for fault in found.data_quality.faults] == ["reversed-torque"]
    assert len(asked) == 2
