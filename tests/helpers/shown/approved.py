"""Whole reports, held against texts that a person has read: words to the letter, numbers to three digits.

Tests compute each number that matters anew; these texts hold what stands beside it: titles, units, order of columns and
rows, notes, and which sentence is said when. `GRAPHDYN_APPROVE=1 python -m pytest tests/crosscheck` writes them again;
read the difference before it is committed.
"""

import difflib
import math
import os
import re
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from pathlib import Path

import numpy as np
from shown.pages import opened, parsed

from crosscheck.report.html import page
from crosscheck.report.text import as_text

FOLDER = Path(__file__).with_name("reports")

APPROVE_VARIABLE = "GRAPHDYN_APPROVE"

NUMBER = re.compile(r"(?<![\w.])[-−+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")

DIGITS = 2e-3
"""Relative: half a unit of the fourth digit, which may be rounded either way, and what other processors round."""

ROUNDING = 1e-9
"""Numbers below, such as errors of two codes that agree, are other ones on other processors."""

BLOCKS = {"h1", "h2", "h3", "h4", "p", "tr", "li", "dt", "dd", "caption", "figcaption", "summary", "div"}


def approve(name, text, rounding="(?!)", *, numbers=True):
    """The text is the approved one.

    rounding: pattern of lines that rounding alone decides, which are left out
    numbers: False where they are those of a search, and other ones on other processors
    """
    path = FOLDER / (re.sub(r"[^\w/]+", "_", name) + ".txt")
    text = re.sub(r"\S*/(?=[^/\s]+\.\w+)", "", text)  # folders of this run
    lines = [line for line in _lines(text) if not re.search(rounding, line)]
    if os.environ.get(APPROVE_VARIABLE):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")
    wanted = path.read_text(encoding="utf-8").splitlines()
    pairs = zip(lines, wanted, strict=False)
    meant = [want if _alike(found, want, numbers) else found for found, want in pairs] + lines[len(wanted) :]
    changes = list(difflib.unified_diff(wanted, meant, "approved", "found", lineterm="", n=0))
    hint = f"{path.name} is not what is shown; if that is meant, set {APPROVE_VARIABLE}=1 and read what changes"
    assert not changes, "\n".join([hint, *changes[:60]])


def approve_report(name, report, rounding="(?!)", told=None):
    """What the terminal shows of a report, and what its page shows, which is drawn here unless it is given."""
    told = told or page(report, ["graphdyn"], {"graphdyn": "0"})
    approve(name, as_text(report) + "\n=== page ===\n" + page_text(told), rounding)


def approve_record(name, record, *, without=()):
    """What a JSON file says. without: names of fields that are left out, of times, versions and processors"""
    lines = []

    def read(where, value):
        if isinstance(value, dict):
            for key in value:
                if key not in without:
                    read(f"{where}.{key}", value[key])
        elif isinstance(value, list) and any(isinstance(each, dict | list) for each in value):
            for k, each in enumerate(value):
                read(f"{where}.{k}", each)
        else:
            values = value if isinstance(value, list) else [value]
            lines.append(f"{where}: " + " ".join(f"{x:.4g}" if isinstance(x, float) else str(x) for x in values))

    read("", record)
    approve(f"{name}_record", "\n".join(lines))


def approve_result(name, result, *, without=()):
    """All numbers and words in the fields of an object, and of objects in them. without: fields that are left out

    Of an array of more than twelve numbers: shape, norm, and the cosines of its angles to two fixed directions, plus 2.
    """
    lines = []

    def read(where, value):
        if is_dataclass(value):
            value = {each.name: getattr(value, each.name) for each in fields(value)}
        if isinstance(value, Mapping):
            for key in value:
                if key not in without:
                    read(f"{where}.{key}", value[key])
        elif isinstance(value, list | tuple) and not all(isinstance(each, float | int) for each in value):
            for k, each in enumerate(value):
                read(f"{where}.{k}", each)
        elif isinstance(value, list | tuple | float | np.ndarray | np.number):
            lines.append(f"{where}: {_summary(np.asarray(value))}")
        elif value is None or isinstance(value, str | int):
            lines.append(f"{where}: {value}")

    read("", result)
    approve(f"{name}_result", "\n".join(lines))


def _summary(values):
    if values.dtype.kind not in "fiub" or values.size <= 12:
        return " ".join(f"{x:.4g}" if isinstance(x, float) else str(x) for x in values.ravel().tolist())
    flat = np.nan_to_num(values.ravel().astype(float), posinf=1e9, neginf=-1e9)
    size = np.linalg.norm(flat) or 1.0
    places = np.arange(1.0, len(flat) + 1)
    cosines = [flat @ (way / np.linalg.norm(way)) / size for way in (np.cos(places), np.sin(places**1.5))]
    missing = int(np.isnan(values.astype(float)).sum())
    told = [str(values.shape), f"{size:.4g}", *(f"{2 + x:.4f}" for x in cosines), f"{missing} missing" * bool(missing)]
    return " ".join(told)


def page_text(text):
    """What a page shows: a line for each paragraph, row or picture, with what pointers see."""
    lines = [""]

    def add(words):
        lines[-1] += f" {' '.join((words or '').split())}"

    def read(element, in_row=False):
        if element.tag in ("script", "style", "nav", "footer", "pre", "svg") or not isinstance(element.tag, str):
            return
        starts_line = element.tag in BLOCKS and not in_row
        if starts_line:
            lines.append("")
        for said in (element.get("title"), element.text):
            add(said)
        for child in element:
            read(child, in_row or element.tag == "tr")
            add(child.tail)
        if starts_line:
            lines.append("")
        if element.tag in ("td", "th"):
            lines[-1] += " |"

    whole = opened(text).replace('</span><span class="tail">', "")  # a name in two parts, of which the first may be cut
    read(parsed(whole).find("body"))
    return "\n".join(lines)


def _lines(text):
    """Without frames, and without spaces that only align."""
    bare = (
        " ".join(re.sub("[┃│]", " | ", re.sub("[━─┏┳┓┡╇┩└┴┘├┼┤═╞╪╡]", " ", line)).split()) for line in text.splitlines()
    )
    return [line for line in bare if line.strip("| ")]


def _alike(found, wanted, numbers):
    words = [NUMBER.split(text) for text in (found, wanted)]
    values = [[float(n.replace("−", "-")) for n in NUMBER.findall(text)] for text in (found, wanted)]
    return words[0] == words[1] and (
        not numbers or all(math.isclose(x, y, rel_tol=DIGITS, abs_tol=ROUNDING) for x, y in zip(*values, strict=True))
    )
