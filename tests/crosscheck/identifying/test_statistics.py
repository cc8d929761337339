"""What identification says of its own accuracy, on simulated robots whose parameters are known: no bias by filters,
standard deviations that cover the truth, and where they are a lower bound.
"""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from identified.coverage_trials import correlated_noise, virtual_coverage
from long_check import LONG
from planting import mixed_tree

import crosscheck
from crosscheck.commands.identify.record import record
from crosscheck.commands.identify.reports.report import identify_report
from crosscheck.identifying import LastPart, Preparation, friction_terms, virtual_robot
from crosscheck.identifying.results.parameters import base_rows, correlation_of, deviations_of
from crosscheck.report.text import as_text
from graphdyn.identification.terms import KnownTorque, RigidBodies, UserColumns

UNBIASED = 1e-3
"""Relative error of a parameter without noise, where the torque is filtered and its regressor with it; measured 7e-4,
from the rows in which the filtered velocity changes its sign elsewhere. Filtering the torque alone leaves 5e-2."""


def detent(q, v, a):
    """(N, n) A torque that jumps, as cogging does."""
    return np.sign(np.sin(6 * q))


@pytest.mark.usefixtures("unexamined")
@pytest.mark.parametrize(
    "preparation",
    [
        pytest.param(Preparation(6.0), marks=LONG),
        Preparation("residual"),
        pytest.param(Preparation(None, decimate=(10,)), marks=LONG),
        Preparation(12.0, decimate=(5, 4)),
    ],
    ids=["low-pass", "residual analysis", "decimation", "both"],
)
def test_filters_do_not_bias(preparation, monkeypatch):
    """Friction, a column of the user's own and a known torque, none of them smooth."""
    monkeypatch.setattr("crosscheck.identifying.virtual.TORQUE_NOISE", 0.0)
    monkeypatch.setattr("crosscheck.identifying.virtual.ENCODER_NOISE", 0.0)
    cogging = UserColumns(lambda q, v, a: detent(q, v, a)[:, :, None] * np.eye(3)[0][:, None], ["C"], ["N m"])
    drives = (*friction_terms(["viscous", "coulomb", "offset"]), cogging)
    arm = virtual_robot(mixed_tree(), drives, seconds=10.0)
    known = KnownTorque(lambda q, v, a: 5.0 * detent(q, v, a) * [0, 1, 1])
    measured = replace(arm.fitted, tau=arm.fitted.tau + 5.0 * detent(arm.fitted.q, None, None) * [0, 1, 1])
    found = crosscheck.identify(
        arm.subject.model,
        measured,
        terms=(RigidBodies(), *drives),
        known=[known],
        methods=["ols", "wls"],
        preparation=preparation,
        held_out=LastPart(0.2),
        poses=1,
    )
    truth = found.problem.base.values(arm.truth)
    drive = [k for k, name in enumerate(found.comparison.base_names) if name.startswith(("FV", "FC", "OFF", "C"))]
    assert len(drive) == 10
    for result in found.comparison.results:
        assert np.all(np.abs(result.base_values / truth - 1)[drive] < UNBIASED), result.name


@pytest.mark.parametrize("seeds", [2, pytest.param(20, marks=LONG)])
def test_two_standard_deviations_cover_the_truth_of_the_virtual_robot(seeds):
    """Of 54 parameters of a UR5; those for white noise cover a third."""
    block, white = virtual_coverage(seeds, seconds=10.0)
    assert 0.90 <= block <= 0.98
    assert white < 0.6


@pytest.mark.usefixtures("unexamined")
class TestCorrelation:
    """A recording of a three-joint arm whose residual is correlated for a known time."""

    @staticmethod
    @cache
    def identified(time):
        arm = virtual_robot(mixed_tree(), friction_terms(["viscous"]), seconds=10.0)
        size = 0.02 * np.abs(arm.fitted.tau).max(axis=0)
        noise = correlated_noise(np.random.default_rng(0), arm.fitted.tau.shape, time * 250 / 50)
        return crosscheck.identify(
            arm.subject.model,
            replace(arm.fitted, tau=arm.fitted.tau + size * noise),
            terms=arm.torque_model.terms,
            methods=["wls", "consistent"],
            preparation=Preparation({"q": 10.0}),
            held_out=LastPart(0.01),
            poses=5,
        )

    @pytest.mark.parametrize(("time", "lower_bound"), [(0.05, False), (0.4, True)])
    def test_is_reported(self, time, lower_bound):
        found = self.identified(time)
        shown = found.comparison.of("WLS")
        correlation = correlation_of(found, shown)
        rows = len(found.fit.times[0])
        assert correlation.time == pytest.approx(time, rel=0.5)
        assert correlation.times == pytest.approx(rows / 250 / correlation.time)
        assert correlation.lower_bound == lower_bound == (correlation.times < 80)
        text = plain_text(found, shown)
        assert f"of WLS correlated over {correlation.time:.2g} s at {correlation.joint}" in text
        assert f"the fitted rows are {correlation.times:.0f} times as long" in text
        assert ("fewer than 80: σ is a lower bound" in text) == lower_bound
        assert ("σ of WLS (a lower bound: the recording is too short for its correlation)" in text) == lower_bound
        written = record(found, shown, [])["shown"]
        assert (written["correlation_time"], written["correlation_times"]) == (correlation.time, correlation.times)
        assert written["lower_bound"] is lower_bound

    @pytest.mark.usefixtures("unexamined")
    def test_of_a_white_residual(self):
        arm = virtual_robot(mixed_tree(), (), seconds=10.0)
        options = {"terms": (RigidBodies(),), "methods": ["wls"], "preparation": Preparation({"q": 5.0}), "poses": 5}
        found = crosscheck.identify(arm.subject.model, arm.fitted, **options)
        assert correlation_of(found, found.comparison.of("WLS")).times == np.inf
        assert "of WLS white" in plain_text(found, found.comparison.of("WLS"))

    def test_percentages_are_those_of_the_blocks(self):
        found = self.identified(0.05)
        for name in ("WLS", "consistent"):  # which has no standard deviations of its own
            shown = found.comparison.of(name)
            deviations = 2.0, found.comparison.of("WLS").block_deviations
            rows = base_rows(found, shown)
            for row, value, deviation in zip(rows, shown.base_values, deviations[1], strict=True):
                assert row.block_deviation == pytest.approx(deviation)
                assert row.relative_deviation == pytest.approx(100 * deviation / abs(value))
            text = plain_text(found, shown)
            assert "%σ blocks" in text
            assert f"{rows[0].relative_deviation:.2g}" in text

    def test_without_standard_deviations(self):
        found = self.identified(0.05)
        shown = found.comparison.of("consistent")
        found = replace(found, comparison=replace(found.comparison, results=(shown,)))
        assert deviations_of(found, shown) == (None, "consistent gives none")
        assert "No σ: consistent gives none" in plain_text(found, shown)
        assert record(found, shown, [])["shown"]["lower_bound"] is None


def plain_text(found, shown):
    """The report of the terminal in one line."""
    return " ".join(as_text(identify_report(found, shown), 250).split())
