"""What `identify` says of recordings corrupted in the ways in which users corrupt them.

    python tests/tools corrupted_recordings                     every variant of every recording, some minutes
    python tests/tools corrupted_recordings tx40 ur5            of these recordings
    python tests/tools corrupted_recordings kr300 --only tau4   variants with this in their name
    python tests/tools corrupted_recordings --data-quality            without any fit, a second or two each
    python tests/tools corrupted_recordings --kinds both        176 further kinds of faults, and combinations of them

Columns are spoilt where they are read, by a wrong mapping, in front of gears and offsets; instants and noise in the
arrays. The exit code is the number of variants that are judged otherwise than they must be.

Each further kind has an exact correction, and an oracle counts those that show: the correction must lower Σ log ‖e_j‖
of the program's own bounded fit by 0.5. They are split into two halves of the same classes: `--kinds first` for
development, `--kinds second` to be kept aside; of the latter only totals are printed, unless `--list` is given.
`--seed 1` draws the sizes, joints and combinations of some hundred others. The exit code is then the number of visible
kinds that are not named, and of kinds without need to be named whose cause is wrong.

    python tests/tools corrupted_recordings ur10e m1013:3 --kinds first     simulated arms, by a seed
    python tests/tools corrupted_recordings --kinds clean                   recordings without a fault: no finding

`--remedies` writes each recording to a file, pastes the lines of all findings into its mapping, one after the other,
and reads it again: *left* is what the exact correction would still gain, and the last column of the totals counts
those with less than 0.5.

Simulated arms are those of `graphdyn robots`, and the files of the folder urdf/arms in the shared data.
"""

import argparse
import sys
from collections import Counter

from identified.spoilt_recordings import judged, variants
from identified.spoilt_recordings.kinds import half, kinds
from identified.spoilt_recordings.random_kinds import random_kinds
from identified.spoilt_recordings.simulated import CLEAN
from identified.spoilt_recordings.verdicts import MIN_VISIBLE_GAIN, VERDICTS, clean, examined, identified, verdict

RECORDINGS = ["ur5", "ur10", "tx40", "kr300"]


def main():
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("recordings", nargs="*", metavar="RECORDING")
    parser.add_argument("--only", default="", help="kinds with this in their name")
    parser.add_argument(
        "--data-quality", action="store_true", help="the data quality of the recording alone, without any fit"
    )
    parser.add_argument("--kinds", choices=[*ACCEPTED], default="variants")
    parser.add_argument("--seed", type=int, help="of random kinds, in place of --kinds")
    parser.add_argument("--list", action="store_true", help="every kind of the second half, too")
    parser.add_argument("--remedies", action="store_true", help="put the lines of the findings to the test, in a file")
    arguments = parser.parse_args()
    wrong = (_kinds if arguments.seed is not None else ACCEPTED[arguments.kinds])(arguments)
    sys.exit(min(wrong, 100))


def _clean(arguments):
    found = 0
    print("| recording | findings |\n|---|---|")
    for name in arguments.recordings or [*RECORDINGS, *CLEAN]:
        case = clean(name)
        findings, refused, error = examined(case) if arguments.data_quality else identified(name, case)
        found += refused or any(finding.severity != "hint" for finding in findings)
        told = "; ".join(f"{finding.code} ({', '.join(finding.joints)}) [{finding.severity}]" for finding in findings)
        print(f"| {name} | {told or error or ('refused' if refused else '–')} |", flush=True)
    return found


def _variants(arguments):
    wrong = 0
    print("| recording | variant | told | usable | best result | as it must be |\n|---|---|---|---|---|---|")
    for name in arguments.recordings or RECORDINGS:
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
    return wrong


def _kinds(arguments):
    listed = arguments.seed is not None or arguments.kinds != "second" or arguments.list
    if listed:
        print(
            "| recording | kind | class | gain | visible | verdict | left | told |\n|---|---|---|---|---|---|---|---|"
        )
    found = []
    for name in arguments.recordings or RECORDINGS:
        if arguments.seed is not None:
            chosen = random_kinds(arguments.seed, clean(name).n)
        else:
            chosen = kinds() if arguments.kinds == "both" else half(arguments.kinds)
        for kind in chosen:
            if arguments.only not in kind.name:
                continue
            row = verdict(name, kind, fitted=not arguments.data_quality, remedies=arguments.remedies)
            found.append((name, row))
            if listed:
                visible = "by construction" if kind.shows else "yes" if row.visible else "no"
                judgment = row.judgment + (", told" if row.hinted else "")
                left = "–" if row.left is None else f"{row.left:.2f}"
                cells = (name, kind.name, kind.of, f"{row.gain:.2f}", visible, judgment, left, row.told)
                print(f"| {' | '.join(cells)} |", flush=True)
    _totals(found)
    return sum(not row.right for _, row in found)


def _totals(found):
    """Counts of verdicts on visible kinds by recording and by class, and wrong causes among the others."""
    judged_rows = [(name, row) for name, row in found if row.kind.judged]
    header = [
        "",
        "kinds",
        "visible",
        *VERDICTS,
        "share named",
        "with a wrong cause beside",
        "not visible: wrong cause",
        "undone by their lines",
    ]
    print(f"\n| {' | '.join(header)} |\n|{'---|' * len(header)}")
    groups = [(name, [row for other, row in judged_rows if other == name]) for name in dict(judged_rows)]
    classes = dict.fromkeys(row.kind.of for _, row in judged_rows)
    groups += [(of, [row for _, row in judged_rows if row.kind.of == of]) for of in classes]
    for title, rows in [*groups, ("all", [row for _, row in judged_rows])]:
        visible = [row for row in rows if row.visible]
        counts = Counter(row.judgment for row in visible)
        share = f"{100 * (counts['named'] + counts['equivalent']) / len(visible):.0f} %" if visible else "–"
        beside = sum(row.beside for row in visible)
        hidden = sum(not row.visible and row.judgment == "wrong cause" for row in rows)
        numbers = (len(rows), len(visible), *(counts[judgment] for judgment in VERDICTS))
        lines = [row.left < MIN_VISIBLE_GAIN for row in visible if row.left is not None]
        undone = f"{sum(lines)} of {len(lines)}"
        print(f"| {title} | {' | '.join(map(str, numbers))} | {share} | {beside} | {hidden} | {undone} |")


ACCEPTED = {"variants": _variants, "first": _kinds, "second": _kinds, "both": _kinds, "clean": _clean}


if __name__ == "__main__":
    main()
