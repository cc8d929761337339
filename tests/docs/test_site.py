"""How the site is made from docstrings, public names and commands; .ci/run builds it as a whole."""

import functools
import inspect
import re
from dataclasses import dataclass

import docstrings
import gallery
import mentions
import public_names
import pytest
import reference
import rooms
import typer

import graphdyn
from crosscheck.commands import app
from crosscheck.report.records.docstrings import DocstringEntry, names_of, taken_apart
from graphdyn.identification import Estimator


def parts(text, *names):
    return taken_apart(inspect.cleandoc(text).splitlines(), names)


def rst(text, *names, links=()):
    return "\n".join(docstrings.as_rst(inspect.cleandoc(text).splitlines(), names, "Parameters", dict(links))).strip(
        "\n"
    )


class TestEntries:
    def test_shape_and_unit_at_the_end_are_taken_off(self):
        (entry,) = parts("a: joint acceleration          (…, n)     [rad/s² or m/s²]", "a").entries
        assert entry == DocstringEntry(("a",), "joint acceleration", "(…, n)", "[rad/s² or m/s²]")

    def test_several_names_on_a_line(self):
        (entry,) = parts("q, v, tau: joint state   (…, n)", "q", "v", "tau").entries
        assert entry.names == ("q", "v", "tau")

    def test_several_shapes(self):
        text = "rotation, translation: placement of the moving base   (…, 3, 3), (…, 3)  [m]"
        (entry,) = parts(text, "rotation", "translation").entries
        assert (entry.meaning, entry.shape, entry.unit) == ("placement of the moving base", "(…, 3, 3), (…, 3)", "[m]")

    def test_a_shape_without_a_meaning(self):
        (entry,) = parts("q, v, a: (…, n)", "q", "v", "a").entries
        assert (entry.meaning, entry.shape) == ("", "(…, n)")

    @pytest.mark.parametrize("remark", ["(revolute without position limits)", "(a list)", "(see above)", "f(x)"])
    def test_brackets_that_are_no_shape_stay_in_the_meaning(self, remark):
        (entry,) = parts(f"kind: of the joint {remark}", "kind").entries
        assert (entry.meaning, entry.shape) == (f"of the joint {remark}", "")

    def test_an_indented_line_goes_on(self):
        (entry,) = parts(
            "base: motion of the moving base: rails, and at most one\n    turntable   (3,)", "base"
        ).entries
        assert (entry.meaning, entry.shape) == ("motion of the moving base: rails, and at most one turntable", "(3,)")

    def test_a_unit_on_a_line_of_its_own(self):
        (entry,) = parts("center: box of the center (2, 3)\n                      [m]", "center").entries
        assert (entry.meaning, entry.shape, entry.unit) == ("box of the center", "(2, 3)", "[m]")

    def test_a_line_in_mid_sentence_goes_on(self):
        (entry,) = parts("limits: on masses, the\nmodel's if left out", "limits").entries
        assert entry.meaning == "on masses, the model's if left out"

    def test_several_entries_on_a_line(self):
        first, second = parts("names: of the bodies; units: of their parameters; of all", "names", "units").entries
        assert (first.names, first.meaning) == (("names",), "of the bodies")
        assert (second.names, second.meaning) == (("units",), "of their parameters; of all")

    def test_only_names_of_the_thing_are_entries(self):
        found = parts("Never the normal equations: they square the condition number.\ntolerance: smallest", "tolerance")
        assert [entry.names for entry in found.entries] == [("tolerance",)]
        assert found.prose == ["Never the normal equations: they square the condition number."]

    def test_a_sentence_between_entries_is_prose(self):
        found = parts("q, v: joint state\nA missing v stands for zero.\nbase: motion of the base", "q", "v", "base")
        assert [entry.names for entry in found.entries] == [("q", "v"), ("base",)]
        assert found.prose == ["A missing v stands for zero."]


class TestRest:
    def test_raises_and_warns_become_fields(self):
        found = parts("The robot.\n\nRaises InvalidInput for NaN,\nand OSError.\nWarns ChainWarning.")
        assert found.prose == ["The robot."]
        assert found.fields == [("Raises", "InvalidInput for NaN, and OSError."), ("Warns", "ChainWarning.")]

    def test_raises_in_the_middle_of_a_paragraph(self):
        found = parts("The record of these rows. Raises InvalidInput for none,\nand others. Warns ChainWarning.")
        assert found.prose == ["The record of these rows."]
        assert found.fields == [("Raises", "InvalidInput for none, and others."), ("Warns", "ChainWarning.")]

    def test_a_sentence_that_goes_on_with_raises_inside_is_prose(self):
        assert parts("A method\nthat Raises nothing.").prose == ["A method that Raises nothing."]

    def test_errors_are_linked_where_they_are_public(self):
        text = rst("Raises InvalidInput for NaN, OSError.", links={"InvalidInput": "graphdyn.InvalidInput"}.items())
        assert text == ":Raises: :exc:`~graphdyn.InvalidInput` for NaN, OSError."

    @pytest.mark.parametrize(
        ("plain", "escaped"),
        [
            ("|R_kk| / |R_11|", r"\|R_kk\| / \|R_11\|"),
            ("S* and J_", r"S\* and J\_"),
            ("t_1 × t_2", "t_1 × t_2"),
            ("`model.base` stays", "``model.base`` stays"),
            ("a lone ` stays", r"a lone \` stays"),
            ("(docs/deviations.md, A2)", "(:doc:`docs/deviations.md </deviations>`, A2)"),
        ],
    )
    def test_signs_of_the_markup_mean_themselves(self, plain, escaped):
        assert rst(plain) == escaped

    def test_a_list_of_parameters(self):
        text = rst("Torques.\n\nq: joint state   (…, n)  [rad or m]\nv: (…, n)\nbase: its motion", "q", "v", "base")
        assert text.splitlines() == [
            "Torques.",
            "",
            ":Parameters:",
            "    **q** : (…, n)  [rad or m]",
            "        joint state",
            "    **v**",
            "        (…, n)",
            "    **base**",
            "        its motion",
        ]

    def test_names_of_a_function_and_of_a_class(self):
        @dataclass
        class Answer:
            a: float

            @property
            def b(self):
                return self.a

        def verb(model, *, method="auto"):
            return model, method

        assert names_of(verb) == {"model", "method"}
        assert {"a", "b"} <= names_of(Answer)


@pytest.fixture(scope="module")
def described():
    """What can have a docstring, by name: (value, its docstring taken apart)."""
    found = {}
    for full, value in public_names.everything().items():
        if public_names.kind_of(value) != "data":
            lines = (inspect.getdoc(value) or "").splitlines()
            found[full] = value, taken_apart(lines, names_of(value))
    assert len(found) > 300
    return found


@pytest.fixture(scope="module")
def pages(tmp_path_factory):
    """The folder of the reference; it held a page of a module that is gone."""
    folder = tmp_path_factory.mktemp("reference")
    (folder / "gone.rst").write_text("gone")
    reference.write(folder)
    return folder


class TestPublicNames:
    @pytest.mark.parametrize("module", public_names.MODULES)
    def test_every_public_name_has_an_entry_and_is_listed(self, module, pages):
        entries = []
        for path in (pages / module).glob("*.rst"):
            text = path.read_text(encoding="utf-8")
            entries += re.findall(r"^\.\. (?:auto\w+:: (?:\w+\.)*|py:data:: )(\w+)$", text, re.MULTILINE)
        listed = re.findall(r"^- :py:obj:`(\w+) <", (pages / f"{module}.rst").read_text("utf-8"), re.MULTILINE)
        names = public_names.public_names(module)
        assert sorted(entries) == [name for name in names if public_names.home(module, name) == f"{module}.{name}"]
        assert sorted(listed) == names

    def test_every_function_has_a_page_of_its_own_and_no_page_is_long(self, pages):
        for module in public_names.FOR_USERS:
            for page, names in reference.pages_of(module).items():
                kinds = [public_names.kind_of(public_names.value_of(module, name)) for name in names]
                assert kinds.count("function") <= 1, page
                assert kinds.count("class") <= 10, page

    def test_every_public_name_says_what_it_is(self, described):
        silent = [
            full
            for full, (value, _) in described.items()
            if not value.__doc__ or value.__doc__.startswith(f"{full.rpartition('.')[2]}(")  # what @dataclass writes
        ]
        assert silent == []

    def test_every_docstring_begins_with_a_sentence(self, described):
        assert [full for full, (_, found) in described.items() if not found.prose] == []
        entries = [(full, entry) for full, (_, found) in described.items() for entry in found.entries]
        assert [x for x in entries if not (x[1].meaning or x[1].shape or x[1].unit)] == []

    def test_every_public_property_says_what_it_is(self, described):
        silent = []
        for full, (value, found) in described.items():
            said = {name for entry in found.entries for name in entry.names} | set(vars(Estimator))
            silent += [
                f"{full}.{name}"
                for name, member in (vars(value) if isinstance(value, type) else {}).items()
                if isinstance(member, (property, functools.cached_property)) and not name.startswith("_")
                if not member.__doc__ and name not in said
            ]
        assert silent == []

    def test_a_name_without_an_entry_is_found(self):
        documented = set(public_names.everything())
        assert reference.missing(documented) == []
        assert reference.missing(documented - {"urdf.load"}) == ["urdf.load"]

    def test_a_verb_by_hand(self):
        found = taken_apart(inspect.getdoc(graphdyn.forward_dynamics).splitlines(), names_of(graphdyn.forward_dynamics))
        assert found.entries[0] == DocstringEntry(
            ("q", "v", "tau"), "joint state and actuator torques", "(…, n)", "[rad or m, …/s, N m or N]"
        )
        assert found.fields[0][0] == "Raises"
        assert found.fields[0][1].startswith("InvalidInput; SingularMassMatrix")

    def test_pages_of_names_that_are_gone_are_removed(self, pages):
        assert {path.stem for path in pages.glob("*.rst")} == {"index", *public_names.MODULES}

    def test_an_example_is_a_block_of_code(self):
        found = rst("Torques.\n\nRaises InvalidInput.\n\n>>> 1 + 1\n2")
        assert found.endswith(".. code-block:: pycon\n\n   >>> 1 + 1\n   2")
        assert parts("Torques.\n\n>>> q: 1", "q").entries == []


class TestGuides:
    def test_the_page_of_a_verb_leads_to_its_guide(self, pages):
        text = (pages / "graphdyn/inverse_dynamics.rst").read_text("utf-8")
        assert re.search(r"^\*\*In the guide\*\*: :doc:`/dynamics`", text, re.MULTILINE)

    def test_every_verb_is_in_a_guide(self):
        assert [name for name in graphdyn.verbs.VERBS if not mentions.speaking_of([f"graphdyn.{name}"])] == []


class TestGallery:
    def test_a_command_with_its_output_and_its_page(self, tmp_path):
        show = gallery.Exhibit("robot", "The robot.", ("show", "kr500"))
        gallery.write(tmp_path / "gallery", (show,))
        index = (tmp_path / "gallery/index.md").read_text(encoding="utf-8")
        assert "graphdyn show kr500 --html robot.html" in index
        assert "kr500: 6 bodies, 6 joints" in index
        page = tmp_path / "gallery/pages/gallery-pages/robot.html"
        assert page.read_text(encoding="utf-8").lower().startswith("<!doctype html>")

    def test_a_command_that_ends_otherwise_stops_the_build(self, tmp_path):
        with pytest.raises(gallery.WrongExit, match=r"graphdyn show nothing ended with 2, not 0:\n.*nothing"):
            gallery.write(tmp_path / "gallery", (gallery.Exhibit("show", "A robot.", ("show", "nothing")),))

    def test_every_command_that_writes_a_page_has_one(self):
        commands = typer.main.get_command(app).commands
        writing = {
            name for name, command in commands.items() if any("--html" in option.opts for option in command.params)
        }
        assert len(writing) >= 7
        assert {exhibit.arguments[0] for exhibit in gallery.EXHIBITS + gallery.SLOW} == writing

    def test_the_site_can_be_built_without_it(self, tmp_path):
        gallery.write(tmp_path / "gallery", ())
        assert "without the gallery" in (tmp_path / "gallery/index.md").read_text(encoding="utf-8")


class TestRooms:
    def test_every_folder_and_file_of_a_package_is_a_room_with_a_purpose(self):
        for package in rooms.PACKAGES:
            found = rooms.rooms(package)
            assert {"__init__", "vendor", "robots"}.isdisjoint(found)
            assert len(found) >= 6
            assert all(rooms.summary(path) for path in found.values())

    def test_imports_within_functions_count(self, tmp_path):
        file = tmp_path / "a.py"
        file.write_text("import x.y\ndef f():\n    from p.q import r\n")
        assert set(rooms.imported(file)) == {"x.y", "p.q.r"}

    def test_known_imports_are_among_the_arrows(self):
        direct = rooms.uses("graphdyn")
        assert {"model", "arguments"} <= direct["verbs"]
        assert "verbs" not in rooms.reach(direct, "model")

    def test_imports_that_follow_from_others_are_left_out(self):
        direct = {"a": {"b", "c"}, "b": {"c"}, "c": set()}
        assert rooms.reduced(direct) == {"a": {"b"}, "b": {"c"}, "c": set()}
        assert rooms.floors(direct) == {"a": 2, "b": 1, "c": 0}

    def test_an_arrow_over_a_row_passes_beside_its_boxes(self):
        found, arrows = rooms.rows({"a": {"b", "d"}, "b": {"c"}, "c": set(), "d": set()})
        assert [len(row) for row in found] == [2, 2, 1]
        assert ["a", "a>d@1", "d"] in arrows

    def test_the_picture_has_a_box_for_every_room_and_an_arrow_for_every_import(self):
        picture = rooms.picture()
        for package in rooms.PACKAGES:
            for room in rooms.rooms(package):
                assert f">{room}</text></g>" in picture
        arrows = sum(len(names) for p in rooms.PACKAGES for names in rooms.reduced(rooms.uses(p)).values())
        assert picture.count('class="arrow"') == arrows + len(rooms.PACKAGES)
        assert "href" not in picture

    def test_the_table_names_a_room_before_those_that_it_uses(self):
        for package in rooms.PACKAGES:
            order = re.findall(r"^\| `(\w+)` \|", rooms.table(package), re.MULTILINE)
            assert sorted(order) == sorted(rooms.rooms(package))
            for room, names in rooms.uses(package).items():
                assert all(order.index(room) < order.index(name) for name in names)

    def test_the_places_that_the_page_names_exist(self):
        text = (rooms.ROOT / "docs/architecture.md").read_text(encoding="utf-8")
        places = re.findall(r"`((?:graphdyn|urdf|crosscheck)/[\w/]+)`", text)
        assert len(places) >= 15
        assert [place for place in places if not (rooms.ROOT / place).is_dir()] == []
