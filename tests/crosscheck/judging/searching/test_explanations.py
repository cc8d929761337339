"""Explanations made by hand: which hold, which are preferred, to which a second is added, what is said of them."""

from types import SimpleNamespace

import numpy as np
import pytest

import urdf
from crosscheck.judging.faults.fault import CodeFault
from crosscheck.judging.faults.recursion import DynamicsCode
from crosscheck.judging.judgment import Diagnosis
from crosscheck.judging.observing.noise import precision_said
from crosscheck.judging.searching import search as search_room
from crosscheck.judging.searching.explanation import Explanation, _differing, firsts, preference
from crosscheck.judging.searching.fitting import _least_squares
from crosscheck.judging.searching.search import Search, _of_states
from crosscheck.judging.verdicts.diagnosis import _distinct, _no_worse, evidence_of, explained, merged
from crosscheck.judging.verdicts.distinguishing import _tilt, same_code, what_distinguishes

BOUND = 1e-9
PARTS = np.array(["gravity", "gravity", "inertia", "velocity"])
"""Of the rows of the experiments; two judged states follow."""


def fault(message, kind="sign", size=1):
    return CodeFault.of(kind, message, "mend it", lambda code: code, size)


def explanation(*faults, worst=(0.0,) * 6, left=None, code=None):
    """Of faults, with the largest entry of each row."""
    worst = np.array(worst, dtype=float)
    size = float(np.sqrt(np.mean(worst**2))) if left is None else left
    return Explanation(tuple((one, np.zeros(0)) for one in faults), code, size, worst, PARTS)


def untold():
    return CodeFault(np.zeros(0), lambda code, _: code, lambda _: [])


def test_rows_of_experiments_and_of_judged_states():
    found = explanation(fault("a", size=2), fault("b", "gravity"), worst=[1, 5, 3, 2, 7, 8])
    assert (found.experiments.tolist(), found.judged.tolist()) == ([1, 5, 3, 2], [7, 8])
    assert found.by_part == {"gravity": 5, "inertia": 3, "velocity": 2}
    assert (found.size, found.kinds, found.is_told) == (3, {"sign", "gravity"}, True)
    assert not explanation().is_told
    assert not explanation(fault("a"), untold()).is_told


@pytest.mark.parametrize(
    ("found", "holds"),
    [
        (explanation(fault("a"), worst=[0, 0, 0, 0, 0, BOUND]), True),
        (explanation(fault("a"), worst=[0, 0, 0, 0, 0, 1.1 * BOUND]), False),  # whose mean is within the bound
        (explanation(fault("a"), worst=[1.1 * BOUND, 0, 0, 0, 0, 0]), False),
        (explanation(fault("a"), worst=[0, 0, 0, 0]), False),  # not tried at the judged states
        (explanation(fault("a"), untold()), False),
        (explanation(), False),
    ],
)
def test_an_explanation_holds_at_every_state_and_in_words(found, holds):
    search = SimpleNamespace(bound=BOUND, all_rows=SimpleNamespace(part=[*PARTS, "judged", "judged"]))
    assert Search.holds(search, found) is holds


def test_fewer_numbers_first_then_kinds_in_their_order():
    found = [explanation(fault(*x)) for x in (("b", "sign"), ("a", "sign"), ("a", "clipped"), ("z", "gravity"))]
    large = explanation(fault("a", "gravity", 2))
    told = [x.said[0].message + " " + x.said[0].kind for x in sorted([large, *found], key=preference)]
    assert told == ["z gravity", "a sign", "b sign", "a clipped", "a gravity"]


def test_a_second_fault_is_added_to_those_that_mend_whole_parts_and_to_those_that_leave_least():
    """Two of the former, those that mend most first; one that breaks as many parts as it mends is none."""
    nothing = explanation(worst=[1, 1, 1, 0, 0, 0])
    both = explanation(fault("both"), worst=[0, 0, 0, 0, 9, 9], left=9.0)
    one, other = (
        explanation(fault(name), worst=[0, 0, 1, 0, 0, 0], left=left) for name, left in (("one", 8.0), ("other", 7.0))
    )
    moved = explanation(fault("moved"), worst=[0, 0, 1, 1, 0, 0], left=6.0)
    least = [explanation(fault(f"least {k}"), worst=[1, 1, 1, 0, 0, 0], left=1.0 + k / 10) for k in range(4)]
    same = explanation(fault("same"), worst=[1, 1, 1, 0, 0, 0], left=1.0 + 1e-8)
    found = sorted([both, one, other, moved, *least, same], key=lambda x: x.left)
    chosen = firsts(found, nothing, 0.5)
    assert [x.said[0].message for x in chosen] == ["both", "other", "least 0", "least 1", "least 2"]
    assert _differing([least[0], same, least[1]]) == [least[0], least[1]]


@pytest.mark.parametrize(("holds", "asked"), [(2, ["small"]), (3, ["small", "large"]), (9, ["small", "large", "huge"])])
def test_pairs_are_sought_from_the_smallest_on_until_none_can_be_as_small(holds, asked):
    """holds: size of the first pair that explains all."""
    seen = []

    def alone(first):
        seen.append(first.said[0].message)
        return [explanation(*(one for one, _ in first.elements), fault("second"))]

    search = SimpleNamespace(alone=alone, _refitted=list, holds=lambda x: x.size >= holds)
    started = [explanation(fault(name, size=size)) for name, size in (("large", 2), ("huge", 3), ("small", 1))]
    found = Search.together(search, started)
    assert seen == asked
    assert [x.size for x in found] == [2, 3, 4][: len(asked)]


@pytest.mark.parametrize(
    ("worst", "is_sought"),
    [([0, 0, 0, 1], True), ([0, 0, 0, 0], False), ([0, 1, 0, 1], False), ([0, 0, 1, 1], False), ([1, 0, 0, 0], False)],
)
@pytest.mark.parametrize("less", [-1, 0])
def test_smooth_friction_is_sought_where_answers_deviate_in_motion_alone(worst, is_sought, less, monkeypatch):
    """From what is left of the answers of a known scale; not from those of one part, of which another was taken."""
    seen = {}

    def friction(*given):
        seen["friction"] = given
        return [fault("friction")]

    def bounds(*given):
        seen["limits"] = given
        return iter([fault("limit")])

    monkeypatch.setattr(search_room, "limits", bounds)
    monkeypatch.setattr(search_room, "smooth_friction", friction)
    judged = SimpleNamespace(
        less=np.array([-1, less]),
        torques=lambda: np.ones((2, 3)),
        state=("q", "v", "a"),
        scale=np.array([[2.0], [5.0]]),
        residuals=lambda codes: np.array([[[1.0, 2, 3], [4, 5, 6]]]) * len(codes),
    )
    experiments = SimpleNamespace(torques=lambda: np.zeros((1, 3)))
    search = SimpleNamespace(model="arm", judged=judged, experiments=experiments, bound=BOUND)
    found = Search._from_answers(search, explanation(worst=[*worst, 0, 0]))
    if less >= 0:
        assert not found
        assert not seen
        return
    assert [one.say(np.zeros(0))[0].message for one in found] == ["limit", "friction"][: 1 + is_sought]
    np.testing.assert_array_equal(seen["limits"][1], [[0, 0, 0], [1, 1, 1], [1, 1, 1]])
    if is_sought:
        model, v, deviation, bound = seen["friction"]
        assert (model, v, bound) == ("arm", "v", 5 * BOUND)
        np.testing.assert_array_equal(deviation, [[-2, -4, -6], [-20, -25, -30]])


def test_experiments_at_the_first_and_the_last_states():
    """Rows in any order of states; of an odd number one more of the first."""
    q = np.array([[5.0, 0], [1.0, 2], [5.0, 0], [3.0, 1], [0.0, 7], [1.0, 2]])
    experiments = SimpleNamespace(state=(q,), of=np.array([0, 1, 2, 3, 4, 5, 0]))
    assert _of_states(experiments, 2).tolist() == [True, False, True, False, True, False, True]
    assert _of_states(experiments, 3).tolist() == [True, True, True, False, True, True, True]
    assert _of_states(experiments, 1).tolist() == [True, False, True, False, False, False, True]


def test_numbers_of_any_unit_are_fitted():
    """A column that is a trillion times as short as another; two that are one, of which each takes half."""
    columns = np.array([[1.0, 0, 0], [0, 1e-12, 1e-12], [0, 0, 0]])
    np.testing.assert_allclose(_least_squares(columns, np.array([2.0, 3e-12, 9.0]), 1e-16), [2, 1.5, 1.5])
    assert _least_squares(columns, np.array([np.nan, 0, 0]), 1e-16).tolist() == [0, 0, 0]


@pytest.mark.parametrize(
    ("relative", "said"),
    [
        (0.0, "double precision"),
        (1e-14, "double precision"),
        (1.1e-14, "the answers scatter by 1.1e-14 from one state to the next"),
        (1e-8, "the answers have a noise of 1.0e-08, as in single precision"),
        (2e-6, "the answers have a noise of 2.0e-06, as in single precision"),
        (2.1e-6, "the answers scatter by 2.1e-06 from one state to the next"),
    ],
)
def test_what_noise_means(relative, said):
    assert precision_said(relative) == said


def test_evidence_has_the_errors_of_the_parts_how_they_grow_and_noise_that_matters():
    """Noise from a tenth of the tolerance on: ten times it is what a fault may leave."""
    quiet, noisy = (SimpleNamespace(bound=BOUND, noise=noise, tolerance=BOUND) for noise in (0.9e-10, 2e-10))
    assert evidence_of(quiet, {"gravity": BOUND}, None, None) == "at rest (v = 0, a = 0): agrees"
    assert evidence_of(noisy, {"gravity": 2e-9}, None, None) == (
        "at rest (v = 0, a = 0): relative error 2.0e-09; the answers scatter by 2.0e-10 from one state to the next"
    )
    own = SimpleNamespace(velocity=np.array([1.0, 2.0]), doubled=np.array([4.0, 8.0]))
    observed = SimpleNamespace(velocity=np.array([1.5, 2.25]), doubled=np.array([6.0, 9.0]))
    assert evidence_of(quiet, {"velocity": 0.1}, observed, own).endswith(
        "; at twice the velocity the error is 4 times as large"
    )


@pytest.fixture(scope="module")
def own(ur5):
    return DynamicsCode.of(ur5)


def test_codes_are_the_same_up_to_rounding(own):
    def heavier(share):
        return own.but(masses=own.numbers.masses * (1 + share))

    assert same_code(own, heavier(1e-12))
    assert not same_code(own, heavier(1e-6))
    assert not same_code(own, own.giving(lambda tau, state: tau))


def test_what_tells_explanations_apart(own, ur5):
    """Another mass anywhere; a center of mass aside that only another gravity feels, unless gravity is the fault."""
    search = SimpleNamespace(model=ur5, own=own, bound=BOUND, noise=0.0)

    def apart(first, *others):
        named = [explanation(fault(str(k)), code=code) for k, code in enumerate((first, *others))]
        return what_distinguishes(named[0], named[1:], search)

    heavier = own.but(masses=own.numbers.masses * [1, 1, 1, 1, 1, 2])
    center, inertia = np.zeros((6, 3)), np.zeros((6, 3, 3))
    center[0, 0] = 0.02  # of the body with the upright axis, of the same inertia about it: gravity along it is not felt
    inertia[0, 2, 2] = own.numbers.masses[0] * 0.02**2
    aside = own.but(centers=own.numbers.centers + center, tensors=own.numbers.tensors - inertia)
    sideways = own.but(gravity=own.numbers.gravity * 1.5)
    identical = "nothing: they are the same change of the numbers"
    states = "states beyond the limits of the joints"
    tilted = "states beyond the limits of the joints, or gravity in another direction (a tilted base)"
    torques = "nothing: these faults give identical torques; check each place in the code"
    assert apart(heavier, heavier) == identical
    assert apart(own, heavier) == states == apart(own, sideways)
    assert apart(own, aside) == tilted == apart(own, aside, heavier)
    assert apart(own, own.giving(lambda tau, state: 1.0 * tau)) == torques
    assert (
        apart(
            sideways,
            own.but(gravity=own.numbers.gravity * 1.5, centers=aside.numbers.centers, tensors=aside.numbers.tensors),
        )
        == torques
    )
    assert not _tilt(explanation(fault("a"), code=aside), explanation(fault("b"), code=sideways), search)


def test_no_part_is_worse_than_before():
    before = explanation(worst=[1, 1, 1, 1e-10, 0, 0])
    for part, worse in enumerate([[2, 1, 1, 0], [1, 1, 2, 0], [1, 1, 1, 2e-9]]):
        assert not _no_worse(explanation(worst=[*worse, 0, 0]), before, BOUND), part
    assert _no_worse(explanation(worst=[1, 1, 0, 1e-9, 5, 5]), before, BOUND)


def test_explanations_that_say_more_than_another_are_left_out():
    a, b = fault("a"), fault("b")
    kept = [explanation(a), explanation(b, fault("c")), explanation(fault("d"))]
    assert _distinct([kept[0], explanation(a), explanation(a, b), *kept[1:]]) == kept


def test_the_smallest_of_those_that_fit_as_well_and_the_others(own, ur5):
    """Half as much again as the least is as good, and what is below rounding; one number more is told, two are not."""
    search = SimpleNamespace(model=ur5, own=own, bound=BOUND, noise=0.0)
    deviation = SimpleNamespace(function="f")
    heavier = own.but(masses=2 * own.numbers.masses)

    def told(lefts, code=own):
        names = ("small", "alike", "one more", "two more")
        found = [
            explanation(fault(name, size=size), left=left, code=own if k == 0 else code)
            for k, (name, size, left) in enumerate(zip(names, (1, 1, 2, 3), lefts, strict=True))
            if left is not None
        ]
        (diagnosis,) = explained(deviation.function, search, found, "seen")
        return diagnosis.message, diagnosis.also, diagnosis.status

    assert told([1e-10] * 4) == ("alike", ("small", "one more"), "confirmed")
    assert told([1e-10] * 4, heavier) == ("alike", ("small", "one more"), "candidate")
    assert told([1e-10, None, 1e-10, 1e-10], heavier) == ("small", ("one more",), "confirmed")
    assert told([1.4e-10, 1e-10, 1.6e-10, None]) == ("alike", ("small",), "confirmed")
    assert told([9e-13, 1e-14, 1e-15, 1e-16]) == ("alike", ("small", "one more"), "confirmed")


def test_a_diagnosis_of_two_functions_is_told_once():
    both = [Diagnosis(name, kind, "m", "", "", 0.0) for name, kind in (("f", "sign"), ("g", "sign"), ("h", "unit"))]
    assert [(one.function, one.kind) for one in merged(both)] == [("f, g", "sign"), ("h", "unit")]


def test_faults_that_cannot_be_fitted_together_are_left_out():
    """Angles of a rotation cannot be taken of the complex numbers by which another fault turns it."""

    def turned(code, x):
        return code.but(rotations=code.numbers.rotations * (1 + x[0]))

    def angles(code):
        return code.but(axes=np.arctan2(code.numbers.rotations[:, 0], 1.0))

    family = CodeFault(np.zeros(1), turned, lambda _: [])
    own = DynamicsCode.of(urdf.load("ur5"))
    pair = (family, np.zeros(1)), (CodeFault.of("frame", "the other order", "mend it", angles), np.zeros(0))
    assert not search_room._takes_steps(pair, own)
    assert search_room._takes_steps(pair[:1], own)
    alone, never = (SimpleNamespace(elements=x) for x in (((fault("a"), np.zeros(0)),), pair))
    assert Search._refitted(SimpleNamespace(own=own, _refitted=lambda left: left), [alone, never]) == [alone]
