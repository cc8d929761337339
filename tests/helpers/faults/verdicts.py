"""A planted fault judged, and whether the diagnosis names it: the long check is `python tests/tools named_faults`."""

import re
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
from faults.case import ROBOTS, Case, path_of
from faults.textbook import TextbookArm

import urdf
from crosscheck.judging.judge import judge


def judged(case: Case, samples: int, *, single: bool = False):
    """The judgment of the code that has the fault, and the processor seconds that it took."""
    with tempfile.TemporaryDirectory() as folder, warnings.catch_warnings():
        warnings.simplefilter("ignore")
        robot = ROBOTS[case.robot]
        if case.from_file:
            robot, arm = case.plant(path_of(case.robot), Path(folder))
            function = (arm.in_single_precision() if single else arm).inverse_dynamics
        else:
            model = urdf.load(robot)
            arm = TextbookArm.of(model)
            function = case.plant(arm.in_single_precision() if single else arm, model)
        if single:
            function = in_single_precision(function)
        start = time.process_time()
        judgment = judge(robot, **{case.function: function}, samples=samples)
        return judgment, time.process_time() - start


def in_single_precision(function):
    """Arguments and answers rounded to 24 bits."""

    def rounded(*arguments):
        return np.asarray(function(*(x.astype(np.float32) for x in arguments))).astype(np.float32)

    return rounded


def verdict(case: Case, judgment) -> str:
    if judgment.agrees:
        return "missed"
    claims = [x for x in judgment.diagnoses if x.status in ("confirmed", "candidate", "part")]
    strange = [x for x in claims if not matches(case.named, x.message)]
    if not strange and all(
        any(re.search(words, x.message) and x.status == "confirmed" for x in claims) for words in case.named
    ):
        return "named"
    fitting = [text for x in claims if x.status != "part" for text in (x.message, *x.also)]
    if all(any(re.search(words, text) for text in fitting) for words in case.named):
        return "candidates"
    if any(not re.search(case.located or "$^", x.message) for x in strange):
        return "WRONG"
    return (
        "located" if claims or matches((case.located or "$^",), *(x.message for x in judgment.diagnoses)) else "unknown"
    )


def matches(expressions, *texts) -> bool:
    return any(re.search(words, text) for words in expressions for text in texts)
