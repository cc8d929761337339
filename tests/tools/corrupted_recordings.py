"""What `identify` says of recordings corrupted in the ways in which users corrupt them.

    python tests/tools corrupted_recordings                     every variant of every recording, some minutes
    python tests/tools corrupted_recordings tx40 ur5            of these recordings
    python tests/tools corrupted_recordings kr300 --only tau4   variants with this in their name
    python tests/tools corrupted_recordings --data-quality            without any fit, a second or two each

Columns are spoilt where they are read, by a wrong mapping, in front of gears and offsets; instants and noise in the
arrays. The exit code is the number of variants that are judged otherwise than they must be.
"""

import argparse
import sys

from identified.spoilt_recordings import judged, variants


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("recordings", nargs="*", default=["ur5", "ur10", "tx40", "kr300"])
    parser.add_argument("--only", default="")
    parser.add_argument(
        "--data-quality", action="store_true", help="the data quality of the recording alone, without any fit"
    )
    arguments = parser.parse_args()
    wrong = 0
    print("| recording | variant | told | usable | best result | as it must be |\n|---|---|---|---|---|---|")
    for name in arguments.recordings:
        for variant in variants(name):
            if arguments.only not in variant.name:
                continue
            row = judged(name, variant, fitted=not arguments.data_quality)
            wrong += not row.right
            told = "; ".join(
                f"{finding.code} ({', '.join(finding.joints) if len(finding.joints) < 3 else 'all'})"
                for finding in row.data_quality.findings
            )
            usable = {True: "yes", False: "no", None: "not asked"}[row.usable]
            cells = (name, variant.name, told or "–", usable, row.best or "–", "yes" if row.right else "**no**")
            print(f"| {' | '.join(cells)} |", flush=True)
    sys.exit(min(wrong, 100))
