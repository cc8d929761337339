"""Save one picture of a study's page as a file: python docs/studies/picture.py OUT TITLE FILE.svg."""

import sys
from pathlib import Path

from crosscheck.commands.study.report import study_report
from crosscheck.study.statistics.outcomes import read_outcomes


def picture(folder, title):
    """The first picture with this title, on a white background."""
    report = study_report(read_outcomes(folder), [], lambda scenario, run: [])
    blocks = [block for section in report.sections for block in section.blocks]
    drawn = next(block for block in blocks if block.title == title).draw("p")
    return str(drawn).replace('class="picture"', 'style="background: #ffffff; font-family: sans-serif"', 1)


if __name__ == "__main__":
    study, wanted, file = sys.argv[1:]
    Path(file).write_text(picture(Path(study), wanted), encoding="utf-8")
