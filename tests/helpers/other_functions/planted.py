"""All planted faults, and what a judgment of one is worth."""

import re

from other_functions import (
    derivative_faults,
    frame_faults,
    fresh_faults,
    mass_faults,
    matrix_faults,
    regressor_faults,
    second_faults,
    special_faults,
    third_faults,
    torque_faults,
)
from other_functions.fault import SpecialFault

FAULTS = (
    *torque_faults.FAULTS,
    *frame_faults.FAULTS,
    *mass_faults.FAULTS,
    *matrix_faults.FAULTS,
    *derivative_faults.FAULTS,
    *regressor_faults.FAULTS,
)
SPECIAL_FAULTS = special_faults.FAULTS
SECOND_FAULTS = second_faults.FAULTS
THIRD_FAULTS = third_faults.FAULTS
FRESH_FAULTS = (*fresh_faults.FAULTS, *SECOND_FAULTS, *THIRD_FAULTS)
CLAIMS = ("confirmed", "candidate", "part")


def verdict(fault, judgment):
    """One word: named, candidates, equal, unknown, missed or WRONG; of special states also: found."""
    if judgment.agrees:
        return "missed"
    named, equal = (fault.words(judgment.model, x) for x in (fault.named, fault.equal or "$^"))
    claims = [x for x in judgment.diagnoses if x.status in CLAIMS]
    strange = [x for x in claims if not re.search(named, x.message)]
    if isinstance(fault, SpecialFault):
        said = any(re.search(named, x.message) for x in judgment.diagnoses)
        return "WRONG" if strange else "named" if said else "found"
    if not claims:
        return "unknown"
    if not strange:
        return "named"
    if all(re.search(named, text) for text in (" | ".join((x.message, *x.also)) for x in claims)):
        return "candidates"
    return "equal" if all(re.search(f"{named}|{equal}", x.message) for x in claims) else "WRONG"
