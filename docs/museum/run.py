"""Show the judge bugs that people had, and print what it says.

    python docs/museum/run.py                              every exhibit, on every robot that it is shown on
    python docs/museum/run.py --only "inertia turned" --json museum.json
    python docs/museum/run.py --page docs/museum.md        writes the tables of the page again
    python docs/museum/run.py --verdicts museum.json --page docs/museum.md

named: what the judge confirms is the bug, and nothing else; candidates: the bug is among faults that fit as well;
unnamed: the deviation is found, not what it is; missed: it is not found; WRONG: the judge claims another fault.
Exit code 0: nothing missed or wrong; 1 otherwise.
"""

import argparse
import json
import re
import sys
import time
import warnings
from collections import Counter
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import calls_and_arguments
import frames_and_energies
import reading_files
import recursions
from exhibit import EXHIBITS

import crosscheck
import urdf

HERE = Path(__file__).parent
HALLS = {hall.__name__: hall.__doc__ for hall in (reading_files, recursions, frames_and_energies, calls_and_arguments)}
CLAIMS = ("confirmed", "candidate", "part")
FAILED = ("missed", "WRONG")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--only", default="", help="exhibits or libraries whose names have these words")
    parser.add_argument("--samples", type=int, default=100, help="random states of each judgment")
    parser.add_argument("--json", type=Path, help="write all verdicts to this file")
    parser.add_argument("--page", type=Path, help="write the tables into this page")
    parser.add_argument("--verdicts", type=Path, help="do not judge: take the verdicts that --json wrote")
    given = parser.parse_args()
    chosen = [x for x in EXHIBITS if given.only.lower() in f"{x.name} {x.library}".lower()]
    if not chosen:
        parser.error(f"no exhibit has the words {given.only!r}")
    if given.page and len(chosen) < len(EXHIBITS):
        parser.error("--page needs every exhibit: leave out --only")
    rows = json.loads(given.verdicts.read_text())["rows"] if given.verdicts else list(judged(chosen, given.samples))
    print(summary(rows))
    if given.json:
        given.json.write_text(json.dumps({"rows": rows}, indent=1) + "\n")
    if given.page:
        given.page.write_text(with_tables(given.page.read_text(encoding="utf-8"), rows), encoding="utf-8")
    return int(any(row["outcome"] in FAILED for row in rows))


def in_hall(hall):
    return [x for x in EXHIBITS if x.hall == hall]


def judged(exhibits, samples):
    """The verdict of every exhibit on each of its robots, printed as it is found."""
    for exhibit in exhibits:
        for robot in exhibit.robots:
            row = shown(exhibit, robot, samples)
            print(_line(row), flush=True)
            yield row


def path_of(robot):
    known = {entry.name: str(entry.path) for entry in urdf.robots()}
    return known.get(robot, str(HERE / f"{robot}.urdf"))


def shown(exhibit, robot, samples):
    """One exhibit on one robot: what the judge says, and whether it is right."""
    start = time.process_time()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")  # of the axis that is no unit vector
        functions = {exhibit.judged_as: exhibit.build(path_of(robot))}
        judgment = crosscheck.judge(path_of(robot), samples=samples, **functions, **exhibit.options)
    diagnoses = [
        {"kind": x.kind, "status": x.status, "message": x.message, "also": list(x.also)} for x in judgment.diagnoses
    ]
    return {
        "exhibit": exhibit.name,
        "hall": exhibit.hall,
        "library": exhibit.library,
        "year": exhibit.year,
        "links": exhibit.links,
        "function": exhibit.judged_as,
        "robot": robot,
        "outcome": outcome(exhibit.truth, judgment.agrees, diagnoses),
        "diagnoses": diagnoses,
        "seconds": round(time.process_time() - start, 2),
    }


def outcome(truth, agrees, diagnoses):
    """How the diagnoses compare with the truth, expressions for their messages."""
    if agrees:
        return "missed"
    claims = [x for x in diagnoses if x["status"] in CLAIMS]
    messages = [x["message"] for x in claims if x["status"] != "part"]
    certain = all(x["status"] == "confirmed" for x in claims)
    strange = [x for x in claims if not any(re.search(words, x["message"]) for words in truth)]
    if certain and not strange and _covers(truth, messages):
        return "named"
    if _covers(truth, [*messages, *(other for x in claims for other in x["also"])]):
        return "candidates"
    if strange:
        return "WRONG"
    seen = [x["message"] for x in diagnoses if x["status"] in ("located", "unknown") and x["kind"] != "unknown"]
    return "named" if _covers(truth, seen) else "unnamed"


def _covers(truth, messages):
    return all(any(re.search(words, message) for message in messages) for words in truth)


def _line(row):
    said = " + ".join(f"{x['message'][:160]} [{x['status']}]" for x in row["diagnoses"])
    return f"{row['exhibit']:44} {row['robot']:4} {row['outcome']:10} {row['seconds']:5.1f} s  {said}"


OUTCOMES = ("named", "candidates", "unnamed", "missed", "WRONG")
"""From the best to the worst."""


def summary(rows):
    """Bugs by their worst outcome on any robot."""
    worst = {}
    for row in rows:
        worst[row["exhibit"]] = max(worst.get(row["exhibit"], "named"), row["outcome"], key=OUTCOMES.index)
    counts = Counter(worst.values())
    parts = ", ".join(f"{counts[outcome]} {outcome}" for outcome in OUTCOMES)
    return f"{len(worst)} bugs of {len({row['library'] for row in rows})} libraries and robots: {parts}"


def with_tables(page, rows):
    """The page with the summary, and the table of each hall below its heading."""
    for hall, title in HALLS.items():
        lines = [_row(x, rows) for x in in_hall(hall)]
        table = "\n".join(["| bug | library | year | what the judge says | |", "|---|---|---|---|---|", *lines])
        page = re.sub(rf"(## {title}\n).*?(?=\n## |\Z)", lambda found, t=table: f"{found[1]}\n{t}\n", page, flags=re.S)
    return re.sub(r"\d+ bugs of \d+ libraries.*", summary(rows), page)


def _row(exhibit, rows):
    ours = [row for row in rows if row["exhibit"] == exhibit.name]
    mark = " †" if exhibit.lines_unseen else ""
    links = ", ".join(f"[{link.rsplit('/')[-1]}]({link})" for link in exhibit.links)
    said = {_said(row): row["outcome"] for row in ours}
    messages = "; ".join(f"*{message}*" for message in said)
    outcomes = ", ".join(sorted({row["outcome"] for row in ours}, key=OUTCOMES.index))
    return f"| {exhibit.story}{mark} | {exhibit.library} {links} | {exhibit.year} | {messages} | {outcomes} |"


def _said(row):
    """The diagnoses in one cell, cut where they go on about where and how the answers deviate."""
    said = [re.split(r"; | the deviation ", x["message"])[0] for x in row["diagnoses"]]
    return " and ".join(said).replace("|", "∣") or "agrees"


if __name__ == "__main__":
    sys.exit(main())
