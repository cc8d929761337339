"""The words of the glossary: one term for each thing, American spelling, one name for each class, no fragments."""

import ast
import re
from collections import Counter

import pytest
from shared_data import REPOSITORY

PACKAGES = ("graphdyn", "urdf", "crosscheck")
FILES = [path for package in PACKAGES for path in sorted((REPOSITORY / package).rglob("*.py"))]
SCRIPTS = sorted((REPOSITORY / "crosscheck" / "viewing" / "player").glob("*.js"))
DOCUMENTS = sorted((REPOSITORY / "docs").glob("*.md"))
TERMS = {
    "referee": "reference",
    "foreign": "function under test, user code",
    "ball_cover": "bounding spheres",
    "carriage": "moving base",
    "yardstick": "validation metric",
    "freedoms": "degrees of freedom, nv",
    "watched": "guard, checked",
    "body by body": "rolled code",
    "turns_ahead": "sincos pipelining",
    "RecordingHealth": "data quality",
    "doubts": "rejection reasons",
    "told apart": "distinguished",
    "telling_apart": "distinguishing",
    "links real": "physically consistent links",
    "nothing need be done": "no action needed",
    "judgement": "judgment",
}
"""By the home-made word: the term of the field."""
ALLOWED = {
    "carriage": ("crosscheck/commands/paper/", "crosscheck/paper/"),  # the paper's own rail carriage
    "body by body": ("crosscheck/paper/identification.py", "crosscheck/reference/"),  # the plain meaning
}
"""By the word: where it is the right one."""
BRITISH = (
    r"(?:optim|general|normal|stabil|summar|recogn|minim|maxim|polar|factor|linear|initial|symmetr|parametr|amort"
    r"|regular|organ|visual)is(?:e[ds]?|ing|ation|er)\b",
    r"colour|(?<![a-z])(?:milli|centi|kilo)?metres?\b|\bcentre|neighbour|behaviour|modell(?:ed|ing)|labell(?:ed|ing)",
    r"travell(?:ed|ing)|catalogue|analyse|anticlockwise|\bgrey\b",
)
FRAGMENTS = {"Of", "As", "With", "From", "Where", "In", "At", "For", "By", "Those", "To"}
"""First words of a docstring that has no subject and no verb."""
SHARED_NAMES = {
    "EPILOG": "the examples of each command",
    "FORMATS": "the formats that each file reads",
    "FIELDS": "the fields of each kind of message",
    "COUPLED": "the quantities of coupled robots, and the trials of a coupling",
}
"""Constants of one name and several values: why."""


def place(path):
    return path.relative_to(REPOSITORY).as_posix()


def found(pattern, paths, allowed=()):
    """Lines in which the pattern stands, as file:line: text."""
    lines = []
    for path in paths:
        if not place(path).startswith(tuple(allowed)):
            for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
                if re.search(pattern, line):
                    lines.append(f"{place(path)}:{number}: {line.strip()[:100]}")
    return lines


def documented():
    """Place, name and text of every docstring, those of constants included."""
    for path in FILES:
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            body = getattr(node, "body", None)
            if not isinstance(body, list):
                continue
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and (text := ast.get_docstring(node)):
                yield place(path), getattr(node, "name", "module"), text
            for statement, after in zip(body, body[1:], strict=False):
                if isinstance(statement, ast.Assign | ast.AnnAssign) and isinstance(after, ast.Expr):
                    if isinstance(after.value, ast.Constant) and isinstance(after.value.value, str):
                        yield place(path), ast.unparse(statement).split(" ")[0], after.value.value


@pytest.mark.parametrize("word", TERMS)
def test_one_term_for_each_thing(word):
    pattern = rf"(?i)(?<![a-z]){re.escape(word)}"
    assert found(pattern, [*FILES, *SCRIPTS, *DOCUMENTS], ALLOWED.get(word, ())) == [], f"say {TERMS[word]}"


@pytest.mark.parametrize("pattern", BRITISH)
def test_american_spelling(pattern):
    assert found(f"(?i){pattern}", [*FILES, *SCRIPTS, *DOCUMENTS]) == []


def test_every_class_has_a_name_of_its_own():
    names = Counter(
        node.name
        for path in FILES
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.ClassDef)
    )
    assert [name for name, number in names.items() if number > 1] == []


def test_public_constants_of_one_name_have_one_value():
    values = {}
    for path in FILES:
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                name = node.targets[0].id
                if re.fullmatch(r"[A-Z][A-Z0-9_]+", name):
                    values.setdefault(name, set()).add(ast.unparse(node.value))
    assert {name for name, written in values.items() if len(written) > 1} <= SHARED_NAMES.keys()


def test_docstrings_begin_with_what_the_thing_is_or_does():
    fragments = [
        f"{where}: {name}: {text[:80]}"
        for where, name, text in documented()
        if re.sub(r"^\[[^\]]*\] ", "", text.strip()).split(maxsplit=1)[0].strip(",:") in FRAGMENTS
    ]
    assert fragments == []


def test_the_glossary_names_pages_that_exist():
    glossary = (REPOSITORY / "docs" / "glossary.md").read_text(encoding="utf-8")
    rows = [line for line in glossary.splitlines() if line.startswith("| ")][2:]
    assert rows == sorted(rows, key=str.lower)
    for page in re.findall(r"\]\(([a-z_]+\.md)\)", glossary):
        assert (REPOSITORY / "docs" / page).exists()
