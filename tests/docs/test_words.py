"""The words of the glossary: one term for each thing, American spelling, one name for each class, no fragments."""

import ast
import re
from collections import Counter
from functools import cache
from itertools import pairwise

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
    "referee": ("docs/json.md",),  # the names in files of earlier formats
    "doubts": ("docs/json.md",),
    "carriage": ("crosscheck/commands/paper/", "crosscheck/paper/"),  # the paper's own rail carriage
    "body by body": ("crosscheck/paper/", "crosscheck/reference/"),  # the plain meaning
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


@cache
def text(path):
    return path.read_text(encoding="utf-8")


@cache
def tree(path):
    return ast.parse(text(path))


@cache
def nodes(path):
    """All nodes of a file."""
    return [*ast.walk(tree(path))]


def found(pattern, paths, allowed=()):
    """Where the pattern stands, with what follows."""
    lines = []
    for path in paths:
        if not place(path).startswith(tuple(allowed)):
            for match in re.finditer(pattern, text(path)):
                lines.append(f"{place(path)}: … {text(path)[match.start() : match.start() + 60]!r} …")
    return lines


def string(statement):
    """The string that a statement consists of, None for any other."""
    value = getattr(statement, "value", None) if isinstance(statement, ast.Expr) else None
    return value.value if isinstance(value, ast.Constant) and isinstance(value.value, str) else None


def documented():
    """Place, name and text of every docstring, those of constants included."""
    for path in FILES:
        for node in nodes(path):
            body = getattr(node, "body", None)
            if not isinstance(body, list):
                continue
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef) and (said := ast.get_docstring(node)):
                yield place(path), getattr(node, "name", "module"), said
            for statement, after in pairwise(body):
                if isinstance(statement, ast.Assign | ast.AnnAssign) and (said := string(after)):
                    yield place(path), ast.unparse(statement).split(" ")[0], said


def constants(nodes):
    """Names in capitals that a file defines or imports."""
    names = set()
    for node in nodes:
        if isinstance(node, ast.Import | ast.ImportFrom):
            names |= {alias.asname or alias.name for alias in node.names}
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            names.add(node.id)
    return {name for name in names if re.fullmatch(r"_?[A-Z][A-Z0-9_]+", name)}


def quoted_constants(nodes):
    """Strings with the name of a constant in them, without docstrings and headings (all in capitals, as in __all__)."""
    names = constants(nodes)
    aside = {id(node.value) for node in nodes if isinstance(node, ast.Expr)}
    parts = {id(part) for node in nodes if isinstance(node, ast.JoinedStr) for part in node.values}
    for node in nodes if names else ():
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in aside:
            heading = node.value.isupper() and id(node) not in parts
            if not heading and names & set(re.findall(r"\w+", node.value)):
                yield node.value


def test_no_message_holds_the_name_of_a_constant():
    """As a renaming of constants leaves it that replaces words in texts too."""
    said = {place(file): [*quoted_constants(nodes(file))] for file in FILES}
    assert {file: texts for file, texts in said.items() if texts} == {}


def test_a_constant_within_a_message_is_found():
    module = ast.parse(
        "from a import FEW\nMOST = 3\n'MOST, of all'\nx = 'the MOST of it', f'{MOST} or FEW', f' FEW {MOST}', 'MOST'"
    )
    assert [*quoted_constants([*ast.walk(module)])] == ["the MOST of it", " or FEW", " FEW "]


@pytest.mark.parametrize("word", TERMS)
def test_one_term_for_each_thing(word):
    pattern = rf"(?i)(?<![a-z]){re.escape(word)}"
    assert found(pattern, [*FILES, *SCRIPTS, *DOCUMENTS], ALLOWED.get(word, ())) == [], f"say {TERMS[word]}"


@pytest.mark.parametrize("pattern", BRITISH)
def test_american_spelling(pattern):
    assert found(f"(?i){pattern}", [*FILES, *SCRIPTS, *DOCUMENTS]) == []


def test_every_class_has_a_name_of_its_own():
    names = Counter(node.name for path in FILES for node in nodes(path) if isinstance(node, ast.ClassDef))
    assert [name for name, number in names.items() if number > 1] == []


def test_public_constants_of_one_name_have_one_value():
    values = {}
    for path in FILES:
        for node in tree(path).body:
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                name = node.targets[0].id
                if re.fullmatch(r"[A-Z][A-Z0-9_]+", name):
                    values.setdefault(name, set()).add(ast.unparse(node.value))
    assert {name for name, written in values.items() if len(written) > 1} <= SHARED_NAMES.keys()


def test_docstrings_begin_with_what_the_thing_is_or_does():
    fragments = [
        f"{where}: {name}: {said[:80]}"
        for where, name, said in documented()
        if re.sub(r"^\[[^\]]*\] ", "", said.strip()).split(maxsplit=1)[0].strip(",:") in FRAGMENTS
    ]
    assert fragments == []


def test_the_glossary_names_pages_that_exist():
    glossary = (REPOSITORY / "docs" / "glossary.md").read_text(encoding="utf-8")
    rows = [line for line in glossary.splitlines() if line.startswith("| ")][2:]
    assert rows == sorted(rows, key=str.lower)
    for page in re.findall(r"\]\(([a-z_]+\.md)\)", glossary):
        assert (REPOSITORY / "docs" / page).exists()
