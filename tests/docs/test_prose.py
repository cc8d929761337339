"""README and documentation are written in sentences that a reader takes in at the first reading."""

import re
from statistics import mean

import pytest
from shared_data import REPOSITORY

README = REPOSITORY / "README.md"
DOCUMENTS = [README, *sorted((REPOSITORY / "docs").glob("*.md"))]
MEAN_WORDS = 20
"""Largest mean number of words of a sentence, over all documents."""
MAX_WORDS = 45
"""Largest number of words of any sentence."""
README_WORDS = 1200
"""Largest number of words of the README, as `wc -w` counts them."""
NO_PROSE = (
    r"^(```|~~~|:::).*?^\1[`:~]*$",  # blocks of code and of the site's markup
    r"^\$\$.*?^\$\$$",
    r"^\|.*$",  # rows of tables
    r"^#+ .*$",
    r"<!--.*?-->",
    r"!\[[^\]]*\]\([^)]*\)",
)
ABBREVIATIONS = r"(?:et al|e\.g|i\.e|vs|cf|Eq|Eqs|Fig|Sec|No|approx|resp|pp|p|Vol|vol)"


def prose(text):
    """The runs of text between headings, tables and blocks, in words alone: code, formulas and links count as what a
    reader sees of them. A list item or a paragraph that ends without a period goes on in the next one."""
    for pattern in NO_PROSE:
        text = re.sub(pattern, "\0", text, flags=re.MULTILINE | re.DOTALL if "?" in pattern else re.MULTILINE)
    text = re.sub(r"(?s)^---\n.*?\n---\n", "", text)
    text = re.sub(r"^( {2,}|> )", "", text, flags=re.MULTILINE)
    text = re.sub(r"^([-*+]|\d+\.) +", "", text, flags=re.MULTILINE)
    text = re.sub(r"`+[^`]+`+|\$[^$]+\$", "code", text)
    text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return [" ".join(run.split()).replace("*", "") for run in text.split("\0") if run.strip()]


def sentences(text):
    """Sentences of at least two words; numbers and signs between spaces are words, as in `wc -w`."""
    found = []
    for run in prose(text):
        whole = re.sub(rf"\b({ABBREVIATIONS})\.(?= )", r"\1", run)
        found += [part for part in re.split(r"(?<=[.!?])[\"”’)]* +", whole) if " " in part]
    return found


def n_words(sentence):
    return len(sentence.split())


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_no_sentence_is_longer_than_can_be_taken_in(document):
    long = [s for s in sentences(document.read_text(encoding="utf-8")) if n_words(s) > MAX_WORDS]
    assert long == []


def test_sentences_are_short_in_the_mean():
    lengths = [n_words(s) for document in DOCUMENTS for s in sentences(document.read_text(encoding="utf-8"))]
    assert len(lengths) > 1000
    assert mean(lengths) <= MEAN_WORDS


def test_the_readme_is_short():
    assert n_words(README.read_text(encoding="utf-8")) <= README_WORDS


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("One sentence here. Another `x.y` one (Fig. 3) et al. say.", [3, 8]),
        ("- an item;\n- another item. Two sentences.\n- One more.\n", [4, 2, 2]),
        ("These belong to it:\n\n- the first\n- the second.\n", [8]),
        ("| a table | cell |\n\nText [with a link](https://x.y/z.html) and $a + b$.\n", [6]),
        ("```python\nprint('A sentence. Or two.')\n```\nAfter the code.\n", [3]),
        ("A line\n  goes on.\n\n$$\na = b\n$$\n\nThe end.", [4, 2]),
    ],
)
def test_what_counts_as_a_sentence(text, expected):
    assert [n_words(s) for s in sentences(text)] == expected
