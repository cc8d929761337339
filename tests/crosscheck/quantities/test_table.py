"""The table of quantities in other processes."""

import pickle

import pytest

from crosscheck.quantities import COMPARED, COUPLED, LOOPED


@pytest.mark.parametrize("table", [COMPARED, COUPLED, LOOPED])
def test_rows_travel_by_their_names(table):
    assert [pickle.loads(pickle.dumps(row)) for row in table.values()] == list(table.values())
