"""What the study takes from Leboutet et al. (2021): their robot, several robots in one study, their distances."""

from dataclasses import replace

import numpy as np
import pyarrow.parquet as parquet
import pytest
from identified import small_study as small
from identified.small_study import ARM, InThisProcess, study_of

from crosscheck.commands.study.report import study_report
from crosscheck.report.text import as_text
from crosscheck.study.distances import distances
from crosscheck.study.running import run_study
from crosscheck.study.settings.configuration import read_configuration
from crosscheck.study.settings.settings import BadConfiguration
from crosscheck.study.simulated.plants import plant_of
from crosscheck.study.simulated.runs import simulated
from crosscheck.study.statistics.outcomes import read_outcomes
from graphdyn.identification import structure

HEAVY = '[[robot]]\nname = "small.urdf"\nlabel = "heavy"\nviscous = 2\ncoulomb = 1\nrotor_inertia = 1\n'
TWO = small.ROBOT.replace("[robot]", "[[robot]]") + HEAVY
SHORT = "[scenario]\nduration = 4\nsampling_rate = 200\ncontrol_rate = 200\ncutoff = 20\nstart = 0.15\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("literature")
    (folder / "small.urdf").write_text(ARM, encoding="utf-8")
    return folder


@pytest.fixture(scope="module")
def both(folder):
    """A study of two robots with distances, and its folder."""
    study = study_of(folder, '[study]\nruns = 2\nmethods = ["wls", "iv"]\ndistances = true\n', TWO, SHORT)
    run_study(study, folder / "both", InThisProcess())
    return study, folder / "both"


def test_their_robot():
    """Masses and drives are those of the paper's program; a link's tensor is about its frame there."""
    study = read_configuration("birdy")
    tx40, ur5 = (plant_of(robot) for robot in study.robots)
    assert [robot.label for robot in study.robots] == ["tx40", "ur5"]
    assert [body.mass for body in tx40.model.bodies] == [8.61, 4.85, 4.07, 3.62, 1.02, 0.2]
    about_frame = tx40.model.inertial_parameters.reshape(-1, 10)
    assert about_frame[3, 4:] == pytest.approx([0.109, 2.9e-5, 0.108, 1.35e-3, -1.17e-3, 4.07e-3], abs=1e-7)
    assert about_frame[1, 1:4] == pytest.approx([0.392, -7.2e-3, 0.162], rel=1e-5)
    assert structure(tx40.known_exactly).base.rank == structure(ur5.known_exactly).base.rank == 52
    assert study.design.vary == ("noise", "start")


def test_every_robot_has_its_scenarios(both):
    study, out = both
    assert [scenario.robot for scenario in study.scenarios] == ["small", "heavy"]
    rows = {row["robot"]: row for row in parquet.read_table(out / "scenarios.parquet").to_pylist()}
    drives = {label: row["truth"][-4:] for label, row in rows.items()}
    assert drives["heavy"] != drives["small"]
    results = parquet.read_table(out / "results.parquet").to_pylist()
    assert len(results) == 2 * 2 * 2
    assert all(row["status"] == "found" and row["parameter_error"] < 0.1 for row in results)


def test_a_grid_chooses_robots(folder):
    grids = '[[grid]]\nrobot = "heavy"\n[[grid]]\nposition_noise = [1e-6, 1e-5]\n'
    study = study_of(folder, TWO, SHORT, grids)
    assert [scenario.robot for scenario in study.scenarios] == ["heavy", "small", "small", "heavy", "heavy"]
    assert study.robot_of(study.scenarios[0]).viscous == 2


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (TWO + HEAVY, r"label in \[robot 3\] is 'heavy', as that of another robot; give a label of its own"),
        (TWO + '[scenario]\nrobot = "other"\n', r"robot in \[grid\] is 'other'; the labels of the robots are: small"),
        ("[[robot]]\n[[robot]]\nname = 'x'\n", r"name in \[robot 1\] is missing; give a robot"),
        (TWO.replace("coulomb = 1\n", "") + '[scenario]\nmodel_error = "lugre"\n', r"coulomb in \[robot 2\] must be"),
        ("[study]\ndistances = 1\n" + TWO, r"distances in \[study\] is 1; give true or false"),
        (TWO + "[errors]\nbreakaway = 0.9\n", r"breakaway in \[errors\] is 0.9; give a number from 1 on"),
    ],
)  # fmt: skip
def test_bad_robots(text, said, folder):
    with pytest.raises(BadConfiguration, match=said):
        study_of(folder, text)


def test_distances(both):
    """Zero at the truth; a tenth in all parameters is 2 / 21, and a tenth of the torque; nonsense has diverged."""
    study, _ = both
    record = simulated(study, replace(study.scenarios[0], torque_noise=0.0, position_noise=0.0), study.design.draw(0))
    base, truth = structure(record.problem.torque_model).base, record.truth
    with np.errstate(all="ignore"):  # of a robot that runs away
        exact, off, far = (distances(record, base, factor * truth) for factor in (1.0, 1.1, -100.0))
    assert (exact.d_beta, exact.diverged, off.diverged) == (0.0, False, False)
    assert off.d_beta == pytest.approx(2 / 21)
    assert exact.d_tau < 0.01
    assert off.d_tau == pytest.approx(0.1, rel=0.1)
    assert exact.d_q < 1e-4 < off.d_q
    assert (far.diverged, far.d_q) == (True, None)
    assert distances(replace(record, start=None), base, truth).diverged is None


def test_distances_in_report_and_tables(both):
    study, out = both
    outcomes = read_outcomes(out)
    report = study_report(outcomes, [], lambda scenario, run: [], study.design)
    shown = as_text(report, width=140)
    assert "Distances of Leboutet et al. 2021" in shown
    results = parquet.read_table(out / "results.parquet").to_pylist()
    wls = np.mean([row["d_tau"] for row in results if row["method"] == "wls"])
    assert f"{100 * wls:.3f}" in shown
    assert "Distances of" not in as_text(study_report(outcomes, [], lambda scenario, run: []), width=140)
