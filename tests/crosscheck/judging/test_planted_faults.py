"""Errors of every kind, planted in a textbook recursion: found, and named rightly."""

import functools

import numpy as np
import pytest
from faults.textbook import TextbookArm
from faults.textbook_faults import FIRST, LOCKED, PLANTS, WRIST_LOCKED
from long_check import few
from shown.approved import approve
from urdf_text import inertial

import urdf
from crosscheck.commands.judge.report import judge_report
from crosscheck.judging.faults.terms import velocity_terms
from crosscheck.judging.judge import judge
from crosscheck.report.text import as_text
from graphdyn import joint_torque_regressor

SAMPLES = 10
ROUNDED = 1e-12
TEN_KINDS = (*(kind for kind in FIRST if kind not in ("rotor_inertia", "inertial_parameters")), "fixed_link")
"""The kinds that are counted; the other two are tested below like all variants."""

TOOL = (
    f'<link name="gripper">{inertial(4.0, "0.05 0.02 0.1", tensor="0.02 0.001 0 0.03 0 0.01")}</link>'
    '<joint name="screws" type="fixed"><origin xyz="0 0.01 0.05" rpy="0.2 0 0.4"/>'
    '<parent link="{last}"/><child link="gripper"/></joint></robot>'
)


def kinds(judgment):
    return {diagnosis.kind for diagnosis in judgment.diagnoses}


@pytest.fixture(scope="module")
def dropped_tool(tmp_path_factory):
    """The catalog's file with a gripper screwed to the last link, judged by the arm without it."""
    entry = next(entry for entry in urdf.robots() if entry.name == "ur5")
    path = tmp_path_factory.mktemp("robots") / "ur5.urdf"
    text = entry.path.read_text(encoding="utf-8").replace("</robot>", TOOL.format(last="wrist_3_link"))
    path.write_text(text, encoding="utf-8")
    return judge(path, inverse_dynamics=TextbookArm.of(urdf.load("ur5")).inverse_dynamics, samples=SAMPLES)


@functools.cache
def model():
    return urdf.load("ur5", lock=LOCKED)


def arm():
    return TextbookArm.of(model())


def judged(samples=SAMPLES, **functions):
    return judge("ur5", lock=LOCKED, samples=samples, **functions)


@functools.cache
def planted(kind, variant):
    return judged(inverse_dynamics=PLANTS[kind][variant](arm(), model()))


def test_ten_kinds_are_found_and_named(dropped_tool):
    judgments = {kind: planted(kind, FIRST[kind]) for kind in TEN_KINDS if kind != "fixed_link"}
    judgments["fixed_link"] = dropped_tool
    assert len(judgments) == 10
    found = {kind for kind, judgment in judgments.items() if not judgment.agrees and judgment.decided}
    named = {kind for kind, judgment in judgments.items() if kinds(judgment) == {kind}}
    assert found == named == set(TEN_KINDS)


SENTENCES = {
    ("gravity", "reversed"): "gravity has the opposite sign",
    ("gravity", "left out"): "gravity is left out",
    ("gravity", "9.7"): "gravity is 9.7 m/s², not 9.81 m/s²",
    ("gravity", "along y"): "gravity acts along (0, -9.81, 0), not (0, 0, -9.81) m/s², or the base is turned",
    ("coriolis", "none at all"): "all velocity terms are left out",
    ("coriolis", "doubled"): "all velocity terms are multiplied by 2",
    ("coriolis", "wrong sign of ω × q̇ p"): "the terms ω × q̇ p in the angular accelerations have the opposite sign",
    ("sign", "axis of joint 3"): "the axis of joint 'elbow_joint' points the other way",
    ("sign", "torque of joint 2"): "the torque of joint 'shoulder_lift_joint' has the opposite sign",
    ("unit", "degrees"): "joint positions, velocities and accelerations are taken as degrees",
    ("unit", "torques in kN m"): "all inertial parameters of every body, or all torques, multiplied by 1e-3",
    ("unit", "tensors in kg mm²"): "the tensor of every body multiplied by 1e6",
    ("unit", "translations in mm"): "the placement of every joint is in millimeters, the rest in meters",
    ("frame", "rotation of joint 2 transposed"): "the rotation of joint 'shoulder_lift_joint' is transposed",
    ("inertia_point", "of body 3 alone"): (
        "the tensor of body 'forearm_link' is about the link origin and used as if about the center of mass"
    ),
    ("continuous_joint", "sine and cosine exchanged at joint 4"): (
        "the angle of joint 'wrist_1_joint' is the other angle of (cos, sin), π/2 - q"
    ),
    ("friction", "both"): (
        "viscous friction (3, 3, 3, 3) N m s/rad or N s/m and dry friction (2, 2, 2, 2) N m or N per joint is included"
    ),
    ("rotor_inertia", "drives"): "a constant diagonal (1, 2, 3, 4) is added to the mass matrix",
    ("inertial_parameters", "bodies 2 and 3 exchanged"): (
        "the inertial parameters of bodies 'upper_arm_link' and 'forearm_link' are exchanged"
    ),
}


REPEATED = {
    *(("gravity", variant) for variant in ("left out", "9.7", "along y")),
    *(("coriolis", variant) for variant in ("none at all", "doubled")),
    ("sign", "torque of joint 2"),
    *(("unit", variant) for variant in ("torques in kN m", "tensors in kg mm²", "translations in mm")),
}
"""Further faults of kinds whose first one is judged above."""


@pytest.mark.parametrize(("kind", "variant"), few(SENTENCES, *(SENTENCES.keys() - REPEATED)))
def test_sentences(kind, variant):
    judgment = planted(kind, variant)
    (diagnosis,) = judgment.diagnoses
    assert diagnosis.message == SENTENCES[kind, variant]
    approve(f"judged/{kind}, {variant}", as_text(judge_report(judgment)))


def test_a_dropped_link_has_its_name(dropped_tool):
    (diagnosis,) = dropped_tool.diagnoses
    assert diagnosis.message == "the mass of fixed link 'gripper' is left out"
    assert "'wrist_3_link'" in diagnosis.remedy


def test_growth_with_the_velocity_is_evidence():
    (coriolis,) = planted("coriolis", FIRST["coriolis"]).diagnoses
    assert "at rest (v = 0, a = 0): agrees" in coriolis.evidence
    assert "at twice the velocity the error is 4 times as large" in coriolis.evidence
    (viscous,) = planted("friction", FIRST["friction"]).diagnoses
    assert "at twice the velocity the error is 2 times as large" in viscous.evidence


def test_two_faults_in_different_terms_are_two_diagnoses():
    faulty = arm().but(gyroscopic=0.0)
    judgment = judged(inverse_dynamics=faulty.but(gravity=-faulty.gravity).inverse_dynamics, samples=1)
    assert [diagnosis.message for diagnosis in judgment.diagnoses] == [
        "gravity has the opposite sign",
        "the gyroscopic moments ω × I ω are left out",
    ]


def test_unnamed_parameters_still_have_their_body():
    faulty = arm()
    faulty.masses[2] *= 1.31
    faulty.centers[2] += [0.01, 0.05, -0.02]
    (diagnosis,) = judged(inverse_dynamics=faulty.inverse_dynamics, samples=1).diagnoses
    assert diagnosis.kind == "inertial_parameters"
    assert "'forearm_link'" in diagnosis.message


def test_what_has_no_name_is_located():
    short = urdf.load("ur5", lock=WRIST_LOCKED)
    right = TextbookArm.of(short)
    (diagnosis,) = judge(
        short, inverse_dynamics=lambda q, v, a: right.inverse_dynamics(q, v, a) + np.sin(3 * q[::-1]), samples=1
    ).diagnoses
    assert diagnosis.kind == "unknown"
    assert diagnosis.message == "no fault of the catalog explains the deviation at rest (v = 0, a = 0)"
    assert "accelerated from rest, one joint at a time, gravity subtracted: agrees" in diagnosis.evidence


def test_single_precision_is_recognized():
    right = arm()
    judgment = judged(inverse_dynamics=lambda q, v, a: right.inverse_dynamics(q, v, a).astype(np.float32), samples=5)
    assert not judgment.agrees
    assert "as in single precision" in judgment.diagnoses[0].message


def test_a_fault_that_shows_only_where_terms_meet():
    right = arm()
    judgment = judged(
        inverse_dynamics=lambda q, v, a: right.inverse_dynamics(q, v, a) + v * a * (np.abs(v) > 0), samples=5
    )
    (diagnosis,) = judgment.diagnoses
    assert diagnosis.message == (
        "gravity, mass matrix and velocity terms are right separately; only certain states or their sum deviate"
    )


def test_decompositions_of_the_velocity_terms_add_up():
    q, v = model().random_state(np.random.default_rng(0), 3)
    (whole,), *decompositions = (tuple(terms.values()) for terms in velocity_terms(model(), q, v))
    assert len(decompositions) == 3
    for parts in decompositions:
        assert np.abs(sum(parts) - whole).max() <= ROUNDED * np.abs(whole).max()
    *_, products = velocity_terms(model(), q, v * [0, 1, 0, 0])[-1].values()
    assert np.abs(products).max() <= ROUNDED * np.abs(whole).max()


def mass_of(inverse_dynamics, q):
    """M, column by column."""
    zero = np.zeros_like(q)
    at_rest = inverse_dynamics(q, zero, zero)
    return np.stack([inverse_dynamics(q, zero, e) - at_rest for e in np.eye(len(q))], axis=-1)


@pytest.mark.parametrize(
    "kind",
    few(
        ["gravity", "coriolis", "sign", "joint_order", "frame", "inertia_point", "unit"],
        *("gravity", "coriolis", "frame"),
    ),
)
def test_forward_dynamics_are_taken_apart_too(kind):
    """Dynamics solved with the faulty recursion have its fault."""
    faulty = PLANTS[kind][FIRST[kind]](arm(), model())

    def forward_dynamics(q, v, tau):
        return np.linalg.solve(mass_of(faulty, q), tau - faulty(q, v, np.zeros_like(q)))

    assert kinds(judged(forward_dynamics=forward_dynamics)) == {kind}


@pytest.mark.parametrize(
    "kind",
    few(
        ["joint_order", "frame", "inertia_point", "continuous_joint", "rotor_inertia"],
        *("joint_order", "rotor_inertia"),
    ),
)
def test_mass_matrices_are_diagnosed_too(kind):
    name = "translations in joint axes" if kind == "frame" else FIRST[kind]  # M alone cannot tell the first from a sign
    faulty = PLANTS[kind][name](arm(), model())
    assert kinds(judged(mass_matrix=lambda q: mass_of(faulty, q))) == {kind}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (
            lambda w: w.reshape(4, 4, 10)[:, :, [0, 1, 2, 3, 4, 5, 7, 6, 8, 9]],
            "the ten columns of each body are in the order m, mc_x, mc_y, mc_z, I_xx, I_xy, I_xz, I_yy, I_yz, I_zz",
        ),
        (
            lambda w: w.reshape(4, 4, 10) * [1, 1, 1, 1, 1, 2, 1, 2, 2, 1],
            "columns are scaled: I_xy × 2, I_xz × 2, I_yz × 2",
        ),
        (
            lambda w: w.reshape(4, 4, 10) * [1, 0.001, 0.001, 0.001, 1, 1, 1, 1, 1, -1],
            "columns are scaled: mc_x × 0.001, mc_y × 0.001, mc_z × 0.001, I_zz × -1",
        ),
        (
            lambda w: w.reshape(4, 4, 10)[:, [1, 2, 0, 3]],
            "the columns are in the order of the bodies upper_arm_link, forearm_link, shoulder_link, wrist_1_link",
        ),
        (
            lambda w: (w.reshape(4, 4, 10) * [0.5, 1, 1, 1, 1, 1, 1, 1, 1, 1]).swapaxes(1, 2),
            "the columns are grouped by type (m of every body, then mc_x of every body, …), scaled: m × 0.5",
        ),
    ],
)  # fmt: skip
def test_columns_of_a_regressor(change, message):
    judgment = judged(
        joint_torque_regressor=lambda q, v, a: change(joint_torque_regressor(model(), q, v, a)).reshape(4, 40),
        samples=3,
    )
    (diagnosis,) = judgment.diagnoses
    assert (diagnosis.kind, diagnosis.message) == ("parameter_order", message)


def test_a_regressor_under_the_wrong_gravity():
    upside_down = model().with_gravity(-model().gravity)
    judgment = judged(joint_torque_regressor=lambda *state: joint_torque_regressor(upside_down, *state), samples=3)
    assert kinds(judgment) == {"gravity"}
