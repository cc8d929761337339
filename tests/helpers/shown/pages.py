"""Pages of a comparison and of a judgment, and what a test reads in them."""

import html
import json
import math
import re
from base64 import b64decode
from gzip import decompress

import numpy as np
from lxml import etree

from crosscheck.commands.crosscheck.report import crosscheck_report
from crosscheck.report.html import page as page_of
from crosscheck.report.records.record import versions

COMMAND = ["graphdyn", "crosscheck", "my arm.urdf", "--html", "page.html"]
VOID = {"meta", "br", "hr", "img", "link", "input", "wbr"}


def comparison_page(comparisons, command, failures=()):
    return page_of(crosscheck_report(comparisons, failures), command, versions())


def parsed(text):
    return etree.fromstring(text.encode(), etree.HTMLParser(encoding="utf-8"))


def complaints(text):
    """What libxml2 finds wrong in a page; it knows no <svg>, <main>, <figure>."""
    parser = etree.HTMLParser()
    etree.fromstring(text.encode(), parser)
    known = {"ERR_HTML_UNKNOWN_TAG", "HTML_UNKNOWN_TAG"}
    return [error.message for error in parser.error_log if error.type_name not in known]


def opened(text):
    """The page with all that is compressed until it is opened, as the browser shows it then."""
    packed = re.compile(r'<div class="packed" data-packed="([^"]*)">.*?</div>', re.DOTALL)
    while found := packed.search(text):
        text = text.replace(found[0], decompress(b64decode(found[1])).decode())
    return text


def text_rows(text):
    """Cells of the rows of a terminal's tables; a long name goes on in the next line."""
    rows = []
    for line in (line for line in text.splitlines() if line.startswith("│")):
        first, *others = (cell.strip() for cell in line.split("│")[1:-1])
        if rows and not any(others[:2]):
            rows[-1][0] += first
        else:
            rows.append([first, *others])
    return rows


def first_cells(text, within=""):
    """First cells of the rows that hold some text."""
    return [row[0] for row in text_rows(text) if any(within in cell for cell in row)]


def all_tables(text, caption):
    """Texts of the cells, row by row, of every table with this caption."""
    found = [one for one in parsed(text).iter("table") if caption in "".join(one.xpath("caption//text()"))]
    return [
        [[" ".join("".join(cell.itertext()).split()) for cell in row] for row in one.find("tbody")] for one in found
    ]


def table(text, caption):
    """Those of the only one."""
    (found,) = all_tables(text, caption)
    return found


def rows(text, caption):
    """The same, by the first cell."""
    return {row[0]: row[1:] for row in table(text, caption)}


def snippets(text):
    """The Python of the page, in its order; the last block is the command."""
    return [html.unescape(code) for code in re.findall(r"<pre[^>]*><code>(.*?)</code></pre>", text, re.DOTALL)][:-1]


def executed(code, capsys, **names):
    """The names that a snippet leaves, and the last line that it prints as a number."""
    capsys.readouterr()
    exec(compile(code, "<page>", "exec"), names)
    return names, float(capsys.readouterr().out.splitlines()[-1])


def balanced(text):
    """Whether every element is closed, in order."""
    text = re.sub(r"<!DOCTYPE[^>]*>|<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r"<(script|style)>.*?</\1>", "", text, flags=re.DOTALL)
    stack = []
    for closing, tag, empty in re.findall(r"<(/?)([a-zA-Z][\w-]*)(?:\"[^\"]*\"|[^>\"])*?(/?)>", text):
        if closing:
            if not stack or stack.pop() != tag:
                return False
        elif tag not in VOID and not empty:
            stack.append(tag)
    return not stack


def facts(text):
    """What is said of each name in the lists of a page, that on how the page was made left out."""
    found = parsed(text)
    lists = found.xpath('//main//dl[@class="facts"]')
    return {
        " ".join(name.itertext()): "".join(said.itertext())
        for one in lists
        for name, said in zip(one.findall("dt"), one.findall("dd"), strict=True)
    }


def plots(text):
    """The plots of a page in their order: x (N,), and the curves (N,) by title of their panel and name."""
    found = []
    for script in parsed(text).xpath('//script[@type="application/json"]'):
        data = json.loads(script.text)
        curves = {
            panel["title"]: {one["name"]: np.frombuffer(b64decode(one["y"]), "<f4") for one in panel["series"]}
            for panel in data["panels"]
        }
        found.append((np.frombuffer(b64decode(data["x"]), "<f8"), curves))
    return found


def numbers(cells):
    """Cells as floats, NaN where there is no value."""
    return [math.nan if cell == "–" else float(cell.replace("−", "-")) for cell in cells]
