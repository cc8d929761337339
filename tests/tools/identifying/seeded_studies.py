"""Whether studies of other seeds agree: python tests/tools seeded_studies [SEEDS [RUNS]].

The same study of a small arm, with each method compared with each, again and again with another seed. The verdicts of a
pair contradict each other where one seed calls better what another calls worse. The ratio is the geometric mean over
all seeds, which an interval should hold.
"""

import sys
import tempfile
from collections import Counter, defaultdict
from pathlib import Path

import numpy as np
from identified.small_study import ARM, ROBOT, InThisProcess, study_of

from crosscheck.study.running import run_study
from crosscheck.study.statistics.outcomes import ERRORS, read_outcomes
from crosscheck.study.statistics.summary import summarized

STUDY = """
[study]
seed = {seed}
runs = {runs}
vary = {vary}
pairs = "all"
methods = ["wls", "ols", "ridge", "iv", "consistent"]
"""
SCENARIO = """
[scenario]
duration = 5
sampling_rate = 200
control_rate = 200
cutoff = 20
torque_noise = 0.3

[[grid]]
position_noise = [1e-5, 1e-4]
"""
VARIED = {"everything": '["noise", "motion", "cad", "start"]', "noise": '["noise"]'}


VERDICTS = ("better", "equivalent", "worse", "undecided")


def found(seed, runs, vary):
    """The comparisons of one study, by the error."""
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "small.urdf").write_text(ARM, encoding="utf-8")
        study = study_of(folder, STUDY.format(seed=seed, runs=runs, vary=vary), ROBOT, SCENARIO)
        run_study(study, Path(folder) / "out", InThisProcess())
        comparisons = summarized(read_outcomes(Path(folder) / "out"), study.design).comparisons
    return {error: comparisons["torques", error] for error in ERRORS}


def common_ratio(pairs):
    """The geometric mean of the ratios of all seeds."""
    return float(np.exp(np.mean([np.log(pair.ratio.value) for pair in pairs])))


def main() -> None:
    given = [int(number) for number in sys.argv[1:]]
    seeds, runs = (*given, *(20, 12)[len(given) :])
    for name, vary in VARIED.items():
        pairs = defaultdict(list)
        for seed in range(seeds):
            for error, comparison in found(seed, runs, vary).items():
                for pair in comparison.pairs:
                    pairs[error, pair.method, pair.other].append(pair)
        print(f"{name} drawn anew in each of {runs} runs, {seeds} seeds")
        for error in ERRORS:
            own = {key[1:]: of for key, of in pairs.items() if key[0] == error}
            verdicts = [{pair.verdict for pair in of} for of in own.values()]
            against = sum({"better", "worse"} <= said for said in verdicts)
            held = [pair.ratio.low <= common_ratio(of) <= pair.ratio.high for of in own.values() for pair in of]
            print(f"  {error}: {against} of {len(own)} pairs contradict, {np.mean(held):.1%} of the intervals hold")
            for (one, other), of in own.items():
                counts = Counter(pair.verdict for pair in of)
                said = ", ".join(f"{counts[verdict]} {verdict}" for verdict in VERDICTS if counts[verdict])
                print(f"    {one:10} {other:10} {common_ratio(of):7.3f}: {said}", flush=True)
