"""Functions that are no formula: what the judge says of planted ones, and that it accuses no right one."""

import numpy as np
import pytest
from calls import batches, cut_off, joint_torques, quotients, solvers
from calls.planted import PLANTED, frame_of
from faults.textbook_faults import WRIST_LOCKED

import crosscheck
import graphdyn
import urdf
from crosscheck.quantities import FUNCTIONS

KINDS = (batches, cut_off, joint_torques, quotients, solvers)
KNOWN = {f"{x.name}, {x.judged_as}": x for x in PLANTED}
EVERY_DAY = (
    "quotients: gravity_torque, central 0.001, gravity_torque",
    "quotients: center_of_mass_velocity, forward 0.0001, center_of_mass_velocity",
    "quotients: center_of_mass_jacobian, forward 1e-08, center_of_mass_jacobian",
    "solvers: 3 steps of conjugate gradients, mass_matrix_inverse",
    "solvers: small singular values cut off, forward_dynamics",
    "clipped: answers, frame_velocity",
    "clipped: torques of forward dynamics, forward_dynamics",
    "clipped: velocities at 70 %, frame_velocity",
    "clipped: answers scaled down, forward_dynamics",
    "refusal: raises beyond positions, gravity_torque",
    "refusal: NaN beyond positions, frame_velocity",
    "batches: row before, inverse_dynamics",
    "batches: mean taken away, inverse_dynamics",
    "delay: two calls of a Jacobian, center_of_mass_jacobian",
    "degrees per second: turned into degrees, frame_velocity",
    "joint torques: wire spring at joint 2, inverse_dynamics",
    "joint torques: Stribeck with sign at joint 2, inverse_dynamics",
    "joint torques: magnetic detents at joint 2, inverse_dynamics",
)


def judged(case, robot="kinova", samples=20):
    model = urdf.load(robot).uncoupled
    frame = {"frame": frame_of(model)} if FUNCTIONS[case.judged_as].of_frame else {}
    return crosscheck.judge(robot, samples=samples, **{case.judged_as: case.build(model)}, **frame, **case.options)


@pytest.mark.parametrize("name", EVERY_DAY)
def test_what_is_no_formula_is_told(name):
    assert KNOWN[name].outcome(judged(KNOWN[name])) in ("named", "located", "candidates")


def test_numbers_of_a_clip_and_of_a_spring():
    (clip,) = judged(KNOWN["clipped: accelerations at 50, forward_dynamics"]).diagnoses
    assert clip.kind == "clipped"
    assert {number.theirs for number in clip.numbers} == {50.0}
    (spring,) = judged(KNOWN["joint torques: end stop at joint 2, inverse_dynamics"]).diagnoses
    assert [number.theirs for number in spring.numbers] == pytest.approx([50, 1.8], rel=1e-9)


def test_a_counterweight_is_a_candidate_beside_the_physical_fault():
    model = urdf.load("ur5")

    def gravity_torque(q):
        return graphdyn.gravity_torque(model, q) + 3 * np.sin(q - 0.4) * (np.arange(6) == 1)

    (diagnosis,) = crosscheck.judge("ur5", gravity_torque=gravity_torque, samples=10).diagnoses
    assert diagnosis.status == "candidate"
    words = "a torque that depends on the position of joint 'shoulder_lift_joint' alone is added: 3 sin(q - 0.4) N m"
    assert words in (diagnosis.message, *diagnosis.also)


def test_two_equal_maxima_are_no_clip():
    model = urdf.load("ur5", lock=WRIST_LOCKED)

    def gravity_torque(q):
        tau = graphdyn.gravity_torque(model, q)
        return np.where(np.abs(tau) > 40, 40.0, tau) + 1e-3 * np.sin(q[0] * q[1])

    assert all(
        x.kind != "clipped" for x in crosscheck.judge(model, gravity_torque=gravity_torque, samples=20).diagnoses
    )


@pytest.mark.parametrize("batched", [False, True])
def test_right_functions_of_many_kinds_are_not_accused(batched):
    model = urdf.load("ur5")
    rng = np.random.default_rng(0)
    functions = {
        "gravity_torque": lambda q: graphdyn.gravity_torque(model, q) * (1 + 1e-12 * rng.normal(size=6)),
        "center_of_mass_jacobian": lambda q: graphdyn.center_of_mass_jacobian(model, q),
        "mass_matrix": lambda q: graphdyn.mass_matrix(model, q),
    }
    rounded = {name: lambda q, f=f: np.asarray(f(q)).astype(np.float32) for name, f in functions.items()}
    assert crosscheck.judge("ur5", samples=10, batched=batched, mass_matrix=functions["mass_matrix"]).agrees
    assert crosscheck.judge("ur5", samples=10, batched=batched, precision="single", **rounded).agrees
    jacobian = quotients.derivative(lambda q: graphdyn.center_of_mass(model, q), "central", 6e-6)
    assert crosscheck.judge("ur5", samples=10, center_of_mass_jacobian=jacobian).agrees


def test_an_array_that_is_overwritten_is_copied_and_noted():
    model, buffer = urdf.load("ur5"), np.zeros(6)

    def gravity_torque(q):
        buffer[:] = graphdyn.gravity_torque(model, q)
        return buffer

    judgment = crosscheck.judge("ur5", gravity_torque=gravity_torque, samples=5)
    assert judgment.agrees
    note = "gravity_torque returns one array at every call and overwrites it: answers were copied at once"
    assert judgment.notes == (note,)


def test_complex_numbers_without_imaginary_part_are_real():
    model = urdf.load("ur5")
    assert crosscheck.judge("ur5", gravity_torque=lambda q: graphdyn.gravity_torque(model, q) + 0j, samples=5).agrees
