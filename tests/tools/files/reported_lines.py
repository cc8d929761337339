"""Whether SARIF files name the lines of planted faults: python tests/tools reported_lines [--share N] [--only WORDS].

Faults of every kind of number and name (tests/helpers/inspected/planted_lines.py) in URDF files, in .xacro files, in
included files, in arguments and defaults of macros, and in properties. A line for each finding elsewhere, or none.
"""

import argparse
import os
import tempfile
from collections import Counter
from pathlib import Path

from inspected.planted_lines import planted_faults, reported


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--share", type=int, default=1, help="every N-th fault")
    parser.add_argument("--only", default="", help="those whose name has these words")
    options = parser.parse_args()
    totals = Counter()
    chosen = [fault for fault in planted_faults() if options.only in fault.name][:: options.share]
    for fault in chosen:
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            found = reported(fault, Path(folder))
            os.chdir("/")
        right = found == {(fault.file, fault.line)}
        totals[right] += 1
        if not right:
            print(f"{fault.name}: {fault.code} at {fault.file}:{fault.line}, told at {sorted(found)}", flush=True)
    print(f"{len(chosen)} planted faults: {totals[True]} told at their file and line, {totals[False]} elsewhere or not")
    return bool(totals[False])
