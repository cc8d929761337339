"""Cases that only the long check runs (python -m pytest -m long): they repeat what the others show."""

import pytest

LONG = pytest.mark.long


def few(cases, *chosen):
    """The cases for pytest.mark.parametrize, a tuple for each of several arguments; those not chosen are long."""
    missing = [case for case in chosen if case not in cases]
    assert not missing, missing
    return [
        case if case in chosen else pytest.param(*(case if isinstance(case, tuple) else [case]), marks=LONG)
        for case in cases
    ]
