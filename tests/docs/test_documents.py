"""The documents say what the code does: code blocks run, the equation map is whole, tables hold the named bounds."""

import importlib
import inspect
import re
import subprocess
import sys
import tomllib
from collections import Counter

import pytest
from long_check import LONG
from shared_data import REPOSITORY

import graphdyn
from crosscheck.commands.crosscheck.command import DEFAULT_ROBOTS
from crosscheck.comparing.accuracy.measured_states import measured_quantities
from crosscheck.paper.errata import ERRATA
from crosscheck.quantities import COMPARED
from crosscheck.quantities.tolerances import EPS
from crosscheck.recordings.mapping import mapping
from crosscheck.recordings.mapping.mapping import mapping_of

ROOT = REPOSITORY
DOCUMENTS = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
EQUATIONS = 118
"""The paper numbers its equations from 1 to 118."""
MADE_BY_THE_SITE = {"gallery/index", "reference/index"}
PATTERNS = {"docs/peers/peer_NAME.py", "tests/tools/FOLDER/NAME.py", "urdf/arms"}
"""What looks like a place of the repository and is none."""
CONTINUED = "tutorial.md"
"""Its blocks build on one another."""


def table_rows(document, first_cell):
    """Cells of the rows of a Markdown table whose first cell matches."""
    lines = (ROOT / document).read_text(encoding="utf-8").splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line.startswith("|")]
    return [row for row in rows if re.fullmatch(first_cell, row[0])]


def equation_map():
    rows = table_rows("docs/equations.md", r"\(.*")
    entries = []
    for cell, _, where in rows:
        for part in cell.split(","):
            first, *last = (int(number) for number in re.findall(r"\d+", part))
            entries += [(number, where.strip("`")) for number in range(first, (last or [first])[0] + 1)]
    return entries


def test_the_map_lists_every_equation_once():
    assert sorted(number for number, _ in equation_map()) == list(range(1, EQUATIONS + 1))


@pytest.mark.parametrize("name", sorted({where for _, where in equation_map()}))
def test_every_name_in_the_map_exists(name):
    parts = name.split(".")
    for split in range(len(parts) - 1, 0, -1):
        try:
            found = importlib.import_module(".".join(parts[:split]))
        except ModuleNotFoundError:
            continue
        for attribute in parts[split:]:
            found = getattr(found, attribute)
        assert found.__doc__ or isinstance(found, property)
        return
    pytest.fail(f"{name} does not exist")


SLOW = ("identification.md-0", "closed_loop_identification.md-0", "excitation.md-0", "exact.md-3", "payload.md-0")
"""Blocks that take five seconds and more."""


def code_blocks():
    """Every Python block alone; those of the tutorial, which build on one another, as one."""
    found = []
    for document in DOCUMENTS:
        blocks = re.findall(r"```python\n(.*?)```", document.read_text(encoding="utf-8"), re.DOTALL)
        if document.name == CONTINUED:
            blocks = ["\n".join(blocks)]
        found += [(f"{document.name}-{k}", block) for k, block in enumerate(blocks)]
    assert {name for name, _ in found} >= set(SLOW)
    return [pytest.param(block, id=name, marks=[LONG] * (name in SLOW)) for name, block in found]


@pytest.mark.parametrize("block", code_blocks())
def test_code_blocks_run(block, capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for package in re.findall(r"^import (casadi|jax)$", block, re.MULTILINE):
        pytest.importorskip(package, reason=f"{package} is not installed: pip install 'graphdyn[{package}]'")
    exec(compile(block, "<document>", "exec"), {})
    printed = capsys.readouterr().out.splitlines()
    for promised in re.findall(r"print\(.*\) +# → (.*)", block):
        assert promised in printed


def agreement(document):
    return {row[0]: row[1:] for row in table_rows(document, r"[a-z0-9_]+") if row[0] in COMPARED}


def test_the_table_of_agreement_has_every_quantity_within_its_bound():
    rows = agreement("docs/agreement.md")
    assert list(rows) == list(COMPARED)
    for name, (bound, *errors) in rows.items():
        assert bound == f"{COMPARED[name].tolerance.bound:.1e}"
        assert len(errors) == 6
        assert all(error == "–" or float(error) <= COMPARED[name].tolerance.bound for error in errors)


def test_the_tables_of_accuracy_have_every_quantity_within_its_bound():
    rows = table_rows("docs/accuracy.md", r"[a-z0-9_]+")
    measured = {name for name, quantity in measured_quantities().items() if quantity is not None}
    assert {name for name, *_ in rows} - {"quantity", "bound"} == measured
    assert Counter(name for name, *_ in rows)["inverse_dynamics"] == 2 + len(DEFAULT_ROBOTS)
    by_arm = [row for row in rows if row[1].isdigit()]
    assert len(by_arm) == len(DEFAULT_ROBOTS) * len(measured)
    for name, bound, *codes in by_arm:
        assert bound == f"{measured_quantities()[name].row.tolerance.bound / EPS:.0f}"
        for code in codes:
            assert code == "–" or float(code.split("; ")[2]) <= float(bound)


def test_the_readme_shows_the_rows_that_come_closest_to_their_bounds():
    def share(row):
        bound, *errors = row
        return max(float(error) for error in errors if error != "–") / (float(bound) or 1)

    rows = agreement("docs/agreement.md")
    shown = agreement("README.md")
    worst = sorted(rows, key=lambda name: share(rows[name]), reverse=True)[: len(shown)]
    assert len(shown) >= 5
    assert shown == {name: rows[name] for name in worst}
    assert f"of {len(rows)} (" in (ROOT / "README.md").read_text(encoding="utf-8")


def test_the_address_of_the_project_is_the_same_everywhere():
    address = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["urls"]["Repository"]
    for document in ("README.md", "docs/contributing.md"):
        assert f"git clone {address} &&" in (ROOT / document).read_text(encoding="utf-8")
    assert f"repository-code: {address}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_the_citation_names_this_version():
    assert f"\nversion: {graphdyn.__version__}\n" in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


def test_every_erratum_is_measured_and_explained():
    rows = table_rows("docs/deviations.md", r"A\d")
    assert {row[0] for row in rows} == set(ERRATA)
    text = (ROOT / "docs/deviations.md").read_text(encoding="utf-8")
    for name in ERRATA:
        assert f"**{name}. " in text
    assert text.count("*Instead:*") == len(ERRATA)
    assert all(
        float(row[-1]) < 1e6 * EPS for row in rows
    )  # the corrected form: rounding, whatever the printed one does


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(document):
    for target in re.findall(r"\]\(([^)#]+)", document.read_text(encoding="utf-8")):
        known = target.startswith("https://") or (document.parent / target).exists()
        assert known or target in MADE_BY_THE_SITE, target


def test_the_guide_to_the_dynamics_names_every_function_with_these_keywords():
    with_keywords = {
        name
        for name in graphdyn.__all__
        if inspect.isfunction(function := getattr(graphdyn, name))
        and {"method", "threads"} <= set(inspect.signature(function).parameters)
    }
    named = {name for row in table_rows("docs/dynamics.md", r"`.*") for name in re.findall(r"`(\w+)[(`]", row[0])}
    assert with_keywords - {"rollout"} <= named  # which docs/simulation.md is about


def test_the_guide_to_recordings_shows_a_mapping_that_is_read_and_names_every_key():
    text = (ROOT / "docs/recordings.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    assert mapping_of(tomllib.loads(example), "docs/recordings.md").joints == ("shoulder", "elbow")
    for key in {*mapping._TOP, *mapping._CHANNEL, *(key for keys in mapping._ONLY_IN.values() for key in keys)}:
        assert re.search(rf"`(\[{key}\]|{key}|{key}: .*)`", text), key


def test_the_places_that_recipes_name_exist():
    """Paths from the root of the repository, with the name of a test or of a group of tests after ::."""
    text = (ROOT / "docs/recipes.md").read_text(encoding="utf-8")
    places = re.findall(r"`((?:graphdyn|urdf|crosscheck|tests|docs)/[^`:]+)(?:::(\w+))?`", text)
    assert len(places) > 20
    for place, test in places:
        assert (ROOT / place).exists(), place
        assert not test or f"def {test}(" in (ROOT / place).read_text(encoding="utf-8"), (place, test)


def test_contributing_lists_every_program_of_the_tests():
    found = subprocess.run(
        [sys.executable, ROOT / "tests" / "tools"], capture_output=True, text=True, check=True
    ).stdout
    table = (ROOT / "docs/contributing.md").read_text("utf-8").partition("| program | answers |")[2]
    listed = re.findall(r"^\| `(\w+)[^`]*` \|", table, re.MULTILINE)
    programs = dict(line.split(maxsplit=1) for line in found.splitlines() if line.startswith(" "))
    assert listed == [*programs]
    assert all(len(line) <= 120 for line in programs.values())


def test_the_changelog_names_this_version():
    assert f"## {graphdyn.__version__}" in (ROOT / "CHANGELOG.md").read_text(encoding="utf-8")


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_the_places_that_documents_name_exist(document):
    text = document.read_text(encoding="utf-8")
    places = {
        *re.findall(r"`(?:graphdyn|urdf|crosscheck|tests|docs)/[^`: ]+", text),
        *re.findall(r"\btests/[\w/]+\.py", text),
    }
    missing = [place for place in places if not (ROOT / place.strip("`")).exists()]
    assert [place for place in missing if place.strip("`") not in PATTERNS] == []
