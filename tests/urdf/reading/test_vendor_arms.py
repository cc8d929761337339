"""The files of the makers: each loads, with exactly the warnings that it deserves."""

import warnings

import numpy as np
import pytest

import graphdyn
import urdf

MISSING = urdf.MissingInertialWarning
EXPECTED = {
    "GEN3-6DOF_NO-VISION_URDF_ARM_V01": (6, []),
    "PAROL6": (6, []),
    "aubo_i5": (6, []),
    "crx10ia_l": (6, []),
    "dof6xarm": (6, []),
    "gp8l": (6, [MISSING]),
    "irb2400": (6, [MISSING]),
    "j2s6s200_standalone": (10, []),
    "kr16_r1610_2": (6, []),
    "kr210_r2700_2": (6, []),
    "kr6_r900_sixx": (6, [MISSING]),
    "m1013": (6, []),
    "m10ia": (6, [MISSING]),
    "mk3": (8, []),
    "mycobot_280_m5": (6, [MISSING]),
    "piper": (8, []),
    "ra605_710_gb": (6, [MISSING]),
    "rv7frl": (6, [MISSING]),
    "talos_left_arm": (7, []),
    "tx2_60l": (6, [MISSING]),
    "ur10e": (6, []),
    "ur5e": (6, []),
    "vs060": (6, []),
    "vx300s": (9, []),
    "z1": (6, []),
}
"""Number of moving bodies, warnings."""


KINEMATICS_ONLY = {
    "gp8l",
    "irb2400",
    "kr16_r1610_2",
    "kr6_r900_sixx",
    "m10ia",
    "mycobot_280_m5",
    "ra605_710_gb",
    "rv7frl",
    "tx2_60l",
}
"""Their mass matrix is singular; every other file is good for dynamics."""

WARNINGS = {
    "aubo_i5": {"duplicate-material"},
    "kr16_r1610_2": {
        "inconsistent-body",
        "mass-matrix-singular",
        "singular-inertia",
        "tiny-mass",
        "triangle-inequality",
        "zero-inertia",
    },
    "mk3": {"effort-negative"},
    "talos_left_arm": {"triangle-inequality", "zero-inertia"},
    "vs060": {"effort-below-gravity", "effort-below-inertia", "gyration-radius", "placeholder-inertials"},
}
"""Codes of the findings that are no notes; of the others of KINEMATICS_ONLY: NO_INERTIALS; of all others: none."""

NO_INERTIALS = {"mass-matrix-singular", "missing-inertial"}


@pytest.mark.parametrize("name", EXPECTED)
def test_inspection(vendor_arms, name):
    report = urdf.inspect(vendor_arms / f"{name}.urdf")
    assert report.verdict == ("kinematics only" if name in KINEMATICS_ONLY else "dynamics")
    expected = WARNINGS.get(name, NO_INERTIALS if name in KINEMATICS_ONLY else set())
    assert {finding.code for finding in report.findings if finding.severity != "note"} == expected
    assert report.count("error") == 0


@pytest.mark.parametrize("name", EXPECTED)
def test_vendor_file(vendor_arms, tmp_path, name):
    n_bodies, expected = EXPECTED[name]
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        model = urdf.load(vendor_arms / f"{name}.urdf")
        urdf.save(model, tmp_path / "saved.urdf")
        again = urdf.load(tmp_path / "saved.urdf")
    assert model.n_bodies == n_bodies
    assert [warning.category for warning in caught] == expected + [kind for kind in expected if kind is MISSING]
    assert again.joint_names == model.joint_names
    q = np.linspace(-1, 1, model.nv)
    mass_matrix = graphdyn.mass_matrix(model, q)
    assert np.abs(graphdyn.mass_matrix(again, q) - mass_matrix).max() <= 1e-13 * np.abs(mass_matrix).max()


def test_every_vendor_file_is_expected(vendor_arms):
    assert {path.stem for path in vendor_arms.glob("*.urdf")} == set(EXPECTED)
