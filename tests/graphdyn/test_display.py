"""Results are short as text, whatever they hold, and ask whoever draws pages for their HTML."""

from dataclasses import dataclass, field, is_dataclass
from importlib.metadata import EntryPoint

import numpy as np
import public_names
import pytest

from graphdyn import display, kr500
from graphdyn.display import MAX_CHARACTERS, Displayed, described, short_repr


@dataclass(frozen=True)
@short_repr
class Answer:
    values: object
    others: object = None
    hidden: object = field(default=1, repr=False)


@dataclass(frozen=True, repr=False)
class Told(Displayed):
    words: str

    def summary(self):
        return self.words


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (np.array([1.0, 0.25]), "[1.  , 0.25]"),
        (np.zeros((100, 6)), "array of shape (100, 6)"),
        (np.array(["a"]), "array of shape (1,)"),
        ((), "()"),
        ([1, "two", 3.0], "[1, 'two', 3]"),
        (tuple(range(9)), "(0, 1, 2, 3, 4, 5, … 9 in all)"),
        ((np.zeros(9), [1, 2]), "(array of shape (9,), list of 2)"),
        ({"a": 1.5, "b": Answer(2)}, "{'a': 1.5, 'b': Answer(…)}"),
        (kr500(), "RobotModel('kr500')"),
        (np.sin, "sin"),
        (1 / 3, "0.333333"),
    ],
)
def test_a_field_is_shown_in_few_characters(value, shown):
    assert repr(Answer(value)) == f"Answer(values={shown}, others=None)"


@pytest.mark.parametrize(
    "value",
    [
        "x" * 10**5,
        ["x" * 10**5] * 10**3,
        {k: np.zeros((k + 1, 50)) for k in range(10**3)},
        [[[1] * 1000] * 1000],
        type("Long", (), {"__repr__": lambda self: "y" * 10**5})(),
    ],
)
def test_nothing_makes_it_long(value):
    assert len(repr(Answer(value, value))) < 400
    assert len(str(Answer(value, value))) < 400


def test_many_fields_are_cut_at_the_end():
    names = [f"field_{k}" for k in range(500)]
    many = dataclass(short_repr(type("Many", (), {"__annotations__": dict.fromkeys(names, int)})))
    said = repr(many(*range(500)))
    assert len(said) == MAX_CHARACTERS
    assert said.endswith("…")


def test_a_summary_is_the_text():
    assert str(Told("ur5 agrees")) == "ur5 agrees"
    assert repr(Told("ur5 agrees")) == "<Told: ur5 agrees>"
    assert len(str(Told("x" * 10**4))) == len(repr(Told("x" * 10**4))) == MAX_CHARACTERS


def test_every_public_class_of_data_has_a_short_text():
    """All others have single numbers, names and choices for their fields."""
    long_kinds = ("Array", "Mapping", "Sequence", "dict", "list[", "...]")
    others = set()
    for value in public_names.everything().values():
        if isinstance(value, type) and is_dataclass(value):
            short = issubclass(value, Displayed) or value.__repr__ is described
            types = [str(one.type) for one in value.__dataclass_fields__.values()]
            if not short and any(kind in one for one in types for kind in long_kinds):
                others.add(value.__name__)
    assert others == {"Verb"}  # its text is a line of the documentation


class TestHTML:
    @pytest.fixture(autouse=True)
    def fresh(self):
        display._drawers.cache_clear()
        yield
        display._drawers.cache_clear()

    def test_it_comes_from_the_installed_package_that_draws(self, monkeypatch):
        point = EntryPoint("drawer", "reprlib:repr", display.GROUP)
        asked = []
        monkeypatch.setattr(display, "entry_points", lambda group: asked.append(group) or [point])
        assert Told("words")._repr_html_() == "<Told: words>"
        assert asked == [display.GROUP]

    def test_without_one_a_notebook_shows_the_text(self, monkeypatch):
        monkeypatch.setattr(display, "entry_points", lambda group: [])
        assert Told("words")._repr_html_() is None
