"""The kinds of spoilt recordings by which the data quality is measured: they spoil, and are undone exactly."""

from collections import Counter

import numpy as np
import pytest
from identified.spoilt_recordings.kinds import half, kinds
from identified.spoilt_recordings.random_kinds import random_kinds
from identified.spoilt_recordings.remedied import Filed
from identified.spoilt_recordings.verdicts import base_of, clean

from crosscheck.identifying.data_quality.data_quality import data_quality

ARM = "ur5"
"""The simulated one, whose recording needs no file."""

LINES = (["[q]", "sign = [1, -1, 1, 1, 1, 1]"], ["[tau]", "sign = [1, 1, -1, 1, 1, 1]"])
"""Of the mapping, for two findings."""

ROUNDING = 1e-9
"""Error of a channel relative to its largest value: fifty times that of two products with a matrix and its inverse."""


def arrays(case):
    recording = case.recording
    found = {name: getattr(recording, name) for name in ("t", "q", "v", "tau")} | {"gravity": case.model.gravity}
    return {name: values for name, values in found.items() if values is not None}


def differ(case, other, tolerance):
    ours, theirs = arrays(case), arrays(other)
    return ours.keys() != theirs.keys() or any(
        values.shape != ours[name].shape
        or np.abs(values - ours[name]).max() > tolerance * np.abs(ours[name]).max(initial=1.0)
        for name, values in theirs.items()
    )


@pytest.mark.parametrize("kind", [*kinds(), *random_kinds(0)], ids=lambda kind: kind.name)
def test_spoils_and_is_undone(kind):
    base = base_of(ARM, kind)
    spoilt = kind.spoilt(base)
    assert differ(base, spoilt, 1e-6)
    if kind.has_inverse:
        assert not differ(base, kind.undone(spoilt), ROUNDING)


def test_the_oracle_has_the_errors_of_the_program():
    case = clean(ARM)
    found = data_quality(case.torque_model, [case.recording], case.preparation)
    np.testing.assert_allclose(case.errors, found.measures.errors, rtol=ROUNDING)


def test_halves_are_disjoint_and_even():
    first, second = half("first"), half("second")
    names = [kind.name for kind in (*first, *second)]
    assert sorted(names) == sorted({kind.name for kind in kinds()})
    counts = [Counter(kind.of for kind in part) for part in (first, second)]
    assert max(abs(counts[0][of] - counts[1][of]) for of in counts[0] | counts[1]) <= 1
    assert abs(len(first) - len(second)) <= 1


def test_remedies_are_pasted_one_after_the_other():
    filed = Filed.of(clean(ARM))
    assert not differ(filed.case, clean(ARM), ROUNDING)
    turned = filed.remedied(LINES).case
    for name, j in (("q", 1), ("tau", 2)):
        expected = np.array(getattr(clean(ARM).recording, name))
        expected[:, j] *= -1
        np.testing.assert_allclose(getattr(turned.recording, name), expected, rtol=ROUNDING)
