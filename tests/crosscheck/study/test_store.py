"""The store of a study: whatever becomes of its file, what is read was written, and what is lost is said."""

import random
import sqlite3
from contextlib import closing
from dataclasses import fields

import pytest

from crosscheck.study.folder import DATABASE
from crosscheck.study.store import STORE_SCHEMA, opened
from crosscheck.study.tasks import Result, StudyOutcome
from graphdyn import InvalidInput

INPUTS = {"configuration": "[study]\nseed = 1\n", "numpy": "2.0"}
PAGE = 4096
"""Bytes of a page of SQLite."""


def outcome(k):
    """About a page of JSON."""
    x = tuple(random.Random(k).random() for _ in range(60))
    return StudyOutcome((Result("ols", "torques", None, 60, 1, 0, x, x, 0.1, 0.2, 0.3, True),), (1.5,), 2.5)


OUTCOMES = {("few" if k < 5 else "many", k): outcome(k) for k in range(12)}


@pytest.fixture(scope="module")
def content(tmp_path_factory):
    """Bytes of a store with all outcomes."""
    file = tmp_path_factory.mktemp("store") / DATABASE
    with opened(file) as store:
        store.begin(INPUTS)
        for key, one in OUTCOMES.items():
            store.add(key, one)
    return file.read_bytes()


@pytest.fixture
def file(content, tmp_path):
    path = tmp_path / DATABASE
    path.write_bytes(content)
    return path


def changed(file, *statements):
    with closing(sqlite3.connect(file)) as connection:
        for statement in statements:
            connection.execute(statement)
        connection.commit()


def read(file):
    """What is read and what is said; the second time it is the same, and nothing is said."""
    told = []
    with opened(file, told.append) as store:
        found = store.inputs(), dict(store.outcomes())
        assert store.done().keys() == found[1].keys()
    with opened(file, told.append) as store:
        assert (store.inputs(), dict(store.outcomes())) == found
    return *found, told


def test_what_was_written_is_read(file, content):
    assert read(file) == (INPUTS, OUTCOMES, [])
    assert file.read_bytes() == content


@pytest.mark.parametrize("left", [3 * PAGE, 5 * PAGE + 7, 8 * PAGE, -PAGE, -1])
def test_a_store_that_is_cut_off_keeps_what_is_left_of_it(file, content, left):
    file.write_bytes(content[:left])
    inputs, outcomes, told = read(file)
    assert inputs == INPUTS
    assert outcomes.items() < OUTCOMES.items()
    assert len(outcomes) >= len(content[:left]) // PAGE - 6  # pages: header, inputs, index, and those between outcomes
    (line,) = told
    assert line.endswith("can be read, all others are computed again")


@pytest.mark.parametrize("left", [99, 100, PAGE - 1, PAGE])
def test_a_store_without_its_beginning_is_refused(file, content, left):
    file.write_bytes(content[:left])
    with pytest.raises(InvalidInput, match=r"is damaged: .*; remove it, or name another") as caught, opened(file):
        pass
    assert str(caught.value).startswith(str(file))
    assert file.read_bytes() == content[:left]


@pytest.mark.parametrize(
    "harm",
    [
        "UPDATE tasks SET outcome = replace(outcome, '\"total\": 2.5', '\"total\": 2.6') WHERE run = 3",
        "UPDATE tasks SET outcome = replace(outcome, '\"simulations\": 0, ', '') WHERE run = 3",
        "UPDATE tasks SET outcome = CAST(x'FF00' AS TEXT) WHERE run = 3",
        "UPDATE tasks SET run = 30 WHERE run = 3",
        "UPDATE tasks SET outcome = 3 WHERE run = 3",
    ],
)
def test_a_changed_row_is_left_out(harm, file):
    changed(file, harm)
    inputs, found, told = read(file)
    assert (inputs, found) == (INPUTS, {key: one for key, one in OUTCOMES.items() if key != ("few", 3)})
    assert told == [f"{file} is damaged: 11 runs can be read, all others are computed again"]


@pytest.mark.parametrize("fill", [bytes(PAGE), random.Random(0).randbytes(PAGE)], ids=["empty", "random"])
def test_a_damaged_page_takes_only_its_rows(fill, file, content):
    """Of indices, beginnings and ends of rows; all of them where it leads to them. The first two hold the inputs."""
    kept = []
    for start in range(0, len(content), PAGE):
        file.write_bytes(content[:start] + fill + content[start + PAGE :])
        if start < 2 * PAGE:
            with pytest.raises(InvalidInput, match=r"study\.sqlite is damaged: .*; remove it, or name another folder"):
                read(file)
            continue
        inputs, found, told = read(file)
        assert inputs == INPUTS
        assert found.items() <= OUTCOMES.items()
        assert told == [f"{file} is damaged: {len(found)} runs can be read, all others are computed again"]
        kept.append(len(found))
    assert sorted(set(kept)) == [0, 11, 12]


@pytest.mark.parametrize(
    ("harm", "said"),
    [
        ("UPDATE inputs SET content = replace(content, '2.0', '2.1')", "what the study was begun with cannot be read"),
        ("DELETE FROM inputs", "what the study was begun with cannot be read"),
        ("DROP TABLE inputs", "what the study was begun with cannot be read"),
        ("PRAGMA user_version = 2", "has form 2, and this graphdyn reads form 4; go on with the one that began it, or"),
    ],
)
def test_what_cannot_be_mended(harm, said, file):
    changed(file, harm)
    with pytest.raises(InvalidInput, match=rf"study\.sqlite (is damaged: )?{said}"), opened(file):
        pass


def test_no_folder(tmp_path):
    with (
        pytest.raises(InvalidInput, match=r"study\.sqlite cannot be opened: unable"),
        opened(tmp_path / "no" / DATABASE),
    ):
        pass


def test_other_fields_of_an_outcome_need_another_number():
    """Raise STORE_SCHEMA with them: else rows of before would be read as rows of now."""
    known = {
        4: "method measures reason rank iterations simulations base sigma parameter_error torque_error "
        "trajectory_error consistent d_beta d_tau d_q diverged redrawn repeat results seconds total"
    }
    assert known[STORE_SCHEMA] == " ".join(field.name for kind in (Result, StudyOutcome) for field in fields(kind))
