"""Robots at the edge of arithmetic and of sense: the verdict stays "agrees", or says what it left out."""

import dataclasses

import numpy as np
import pytest
from long_check import LONG
from planting import flagged, with_body, with_joint

import crosscheck
from crosscheck.quantities import COMPARED
from graphdyn import Body, InvalidInput, Joint, JointLimits, Placement, RobotModel, kr500

SAMPLES = 5

FORWARD = {name for name, quantity in COMPARED.items() if quantity.solves}
TENSOR = np.diag([1.0, 2.0, 2.5])
AXES = np.eye(3)[[2, 1, 1, 0, 1, 0]]


def chain(masses, kinds="rrrrrr", limits=JointLimits()):  # noqa: B008 (frozen)
    """A serial arm of bodies of one shape, lever arms around 0.3 m. kinds: r and p, one letter per joint."""
    names = {"r": "revolute", "p": "prismatic"}
    placement = Placement(translation=[0.3, 0.0, 0.1])
    return RobotModel(
        "chain",
        tuple(Body(f"b{k}", mass, [0.1, 0.02, 0.2], TENSOR * mass / 100) for k, mass in enumerate(masses, start=1)),
        tuple(
            Joint(f"j{k}", names[kind], k - 1, placement, AXES[(k - 1) % 6], limits)
            for k, kind in enumerate(kinds, start=1)
        ),
    )


ARM = chain([1.0, 1.0, 1.0], "rrr")


def weightless_wrist(*axes):
    """Three revolute joints through one point; only the last body has inertia."""
    arm = ARM
    for k, axis in enumerate(axes, start=1):
        arm = with_joint(arm, k, axis=np.eye(3)[axis], placement=Placement())
    for k in (1, 2):
        arm = with_body(arm, k, mass=0.0, center_of_mass=np.zeros(3), inertia=np.zeros((3, 3)))
    return arm


@pytest.mark.parametrize("meters", [pytest.param(30, marks=LONG), 1e4])
def test_far_from_the_origin(meters):
    """A robot on a map: its dynamics do not depend on where it stands."""
    far = ARM.with_base(Placement(translation=[meters, meters, meters]))
    assert flagged(crosscheck.compare(far, SAMPLES)) == set()


@LONG
def test_first_joint_far_from_the_base():
    far = with_joint(ARM, 1, placement=Placement(ARM.joints[0].placement.rotation, [300.0, 0.0, 0.0]))
    assert flagged(crosscheck.compare(far, SAMPLES)) == set()


@pytest.mark.parametrize(
    "masses",
    [
        pytest.param([1e-6] * 6, id="micrograms", marks=LONG),
        pytest.param([1e5] * 6, id="hundred tons", marks=LONG),
        pytest.param(10.0 ** np.linspace(-6, 5, 4), id="growing"),
        pytest.param(10.0 ** np.linspace(5, -6, 6), id="shrinking", marks=LONG),
    ],
)
def test_masses_of_all_sizes(masses):
    assert flagged(crosscheck.compare(chain(masses, "r" * len(masses)), SAMPLES)) == set()


@pytest.mark.parametrize("rate", [pytest.param(1e3, marks=LONG), 9e5])
def test_absurd_velocities(rate):
    assert flagged(crosscheck.compare(chain([1.0] * 4, "rrrr", limits=JointLimits(velocity=rate)), SAMPLES)) == set()


@pytest.mark.parametrize("kinds", ["pprr", pytest.param("pppppp", marks=LONG), pytest.param("r" * 12, marks=LONG)])
def test_other_machines(kinds):
    assert flagged(crosscheck.compare(chain([1.0] * len(kinds), kinds), SAMPLES)) == set()


def test_negative_principal_moment():
    """Least squares produce such bodies; Pinocchio takes them as parameters only."""
    arm = with_body(ARM, 3, inertia=np.diag([-0.1, 0.2, 0.3]))
    assert flagged(crosscheck.compare(arm, SAMPLES)) == set()


def test_massless_body_with_a_center():
    """The center of nothing may be anywhere: it enters no equation."""
    arm = with_body(ARM, 2, mass=0.0, center_of_mass=[0.5, -0.2, 0.1])
    assert flagged(crosscheck.compare(arm, SAMPLES)) == set()


def test_singular_at_some_states():
    """Axes z, y, z without inertia but at the end: at q_2 = 0 joints 1 and 3 turn about one line."""
    comparison = crosscheck.compare(weightless_wrist(2, 1, 2), SAMPLES)
    assert flagged(comparison) == set()
    assert comparison.not_compared == {}
    assert set(comparison.quantities) >= FORWARD
    notes = [note for note in comparison.notes if "singular mass matrix" in note]
    assert [note.split("'")[1] for note in notes] == ["zero pose at rest", "zero pose"]
    assert notes[1].startswith(f"{SAMPLES} of the states")
    assert all(note.endswith("forward quantities left out there") for note in notes)
    assert "zero pose" not in comparison.quantities["forward_dynamics"].by_case
    assert "zero pose" in comparison.quantities["inverse_dynamics"].by_case
    assert comparison.conditioning.kkt_rank[0] < comparison.conditioning.kkt_rank[1] == 33


def test_singular_at_no_state_of_other_axes():
    """Axes y, z, x are independent at q_2 = 0."""
    comparison = crosscheck.compare(weightless_wrist(1, 2, 0), SAMPLES)
    assert flagged(comparison) == set()
    assert comparison.notes == ("route 'urdf' not taken: a RobotModel was given, not a file",)


@pytest.mark.parametrize("samples", [2.5, "3"])
def test_samples_are_a_whole_number(samples):
    with pytest.raises(InvalidInput, match=f"samples is {samples!r}; give a whole number"):
        crosscheck.compare(kr500(), samples)


@pytest.mark.parametrize("seed", [-1, 0.5, None])
def test_seed_is_a_whole_number(seed):
    with pytest.raises(InvalidInput, match=f"seed is {seed!r}; give a whole number"):
        crosscheck.compare(kr500(), 1, seed)


def test_numbers_of_numpy_are_numbers():
    assert dataclasses.asdict(crosscheck.compare(chain([1.0], "r"), np.int64(1), np.uint8(2)))["samples"] == 1
