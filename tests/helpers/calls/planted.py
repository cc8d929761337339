"""Functions that are no formula: a planted fault, what the judge must say of it, and whether it does."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

PLANTED: list["Planted"] = []
"""All of them, by kind, in the order in which they are written."""

CLAIMS = ("confirmed", "candidate", "part")


@dataclass(frozen=True)
class Planted:
    """A function that is right but for one thing.

    name: such as "quotients: central 1e-3"; judged_as: the argument of crosscheck.judge
    build: of the model, the function; truth: expression that the messages must match
    aside: whether nothing was tuned on it; options: further arguments of crosscheck.judge
    """

    name: str
    judged_as: str
    build: Callable
    truth: str
    aside: bool = False
    options: Mapping[str, object] = field(default_factory=dict)

    def outcome(self, judgment) -> str:
        """named, candidates, located, unknown, missed or WRONG."""
        if judgment.agrees:
            return "missed"
        claims = [x for x in judgment.diagnoses if x.status in CLAIMS]
        strange = [x for x in claims if not re.search(self.truth, x.message)]
        if claims and not strange:
            return "named" if all(x.status == "confirmed" for x in claims) else "candidates"
        if strange:
            also = any(re.search(self.truth, text) for x in claims for text in x.also)
            return "candidates" if also else "WRONG"
        told = any(re.search(self.truth, x.message) for x in judgment.diagnoses)
        return "located" if told else "unknown"


def plant(kind, name, judged_as, truth, *, aside=False, **options):
    """Registers what the decorated function of a model builds."""

    def registered(build):
        PLANTED.append(Planted(f"{kind}: {name}", judged_as, build, truth, aside, options))
        return build

    return registered


def frame_of(model) -> str:
    """The frame of functions of frames."""
    return model.body_names[-1]
