"""An MJCF file with those that it includes as one document, and what is refused before MuJoCo sees it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from lxml import etree

from urdf.document.document import MAX_URDF_BYTES, UNNAMED_SOURCES, check_size, root_of
from urdf.document.elements import line_of, name_of, tag_of
from urdf.errors import InvalidMJCF, TooLarge, UnsupportedJoint, URDFError, shortened

MAX_INCLUDES = 200
"""Largest number of included files."""

MAX_COPIES = 2000
"""Largest number of copies that nested <replicate> make."""

FLEXIBLE = ("composite", "flexcomp", "flex")
"""Elements that make bodies deform."""

_TEXTS = ("name", "file", "class", "childclass")

_READ_NUMBERS = ("body", "frame", "inertial", "joint", "site", "option")
"""Elements whose numbers become the robot's; MuJoCo passes infinite ones on."""

_INFINITE = {"inf", "infinity"}

Place = tuple[Path, int | None]


@dataclass
class Merged:
    """One document, without <include>.

    text: as MuJoCo reads it; as_written: whether its lines are those of the file
    places: file and line by tag and name, of elements with a name
    """

    path: Path
    text: str = ""
    as_written: bool = True
    places: dict[tuple[str, str], Place] = field(default_factory=dict)

    def place(self, tag: str, name: str, info: str = "") -> Place:
        """File and line of an element. info: what MuJoCo notes about it, "line 12" """
        found = self.places.get((tag, name))
        number = info.removeprefix("line ").strip()
        if found is None and self.as_written and number.isdigit():
            return self.path, int(number)
        return found or (self.path, None)


def merged(path: Path, content: bytes, root: etree._Element) -> Merged:
    """The document; root: of the file, which is modified. Raises InvalidMJCF, MalformedXML, TooLarge,
    UnsupportedJoint."""
    whole = Merged(path)
    _take(whole, root, path)
    included: list[Path] = []
    while (element := next(_tagged(root, "include"), None)) is not None:
        whole.as_written = False
        _insert(whole, element, included)
    for element in _tagged(root, "model"):
        if element.get("file"):
            element.set("file", str(path.resolve().parent / element.get("file", "")))
            whole.as_written = False
    text = _as_text(content) if whole.as_written else None
    whole.as_written = text is not None
    whole.text = etree.tostring(root, encoding="unicode") if text is None else text
    return whole


def _as_text(content: bytes) -> str | None:
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return None


def _insert(whole: Merged, element: etree._Element, included: list[Path]) -> None:
    """The children of the file that it names in place of <include>. MuJoCo looks for it beside the first file."""
    name, line = element.get("file", ""), line_of(element)

    def refused(problem: str, remedy: str) -> URDFError:
        return InvalidMJCF(problem, remedy, path=whole.path, line=line, element="<include>")

    if whole.path in UNNAMED_SOURCES:
        raise refused(f"includes '{shortened(name)}', which text alone does not find", "give the file")
    file = whole.path.parent / name
    if not name or not file.is_file():
        raise refused(f"there is no file '{shortened(name)}'", "correct its name, relative to the first file")
    if file.resolve() in included or file.resolve() == whole.path.resolve():
        raise refused(f"'{shortened(name)}' is included twice", "include it once")
    if len(included) == MAX_INCLUDES:
        raise refused(f"more than {MAX_INCLUDES} files are included", "give a smaller robot")
    included.append(file.resolve())
    with file.open("rb") as stream:
        content = stream.read(MAX_URDF_BYTES + 1)
    check_size(content, file)
    root = root_of(file, content)
    _take(whole, root, file)
    parent = element.getparent()
    if parent is None:
        raise refused("is the root element", "give a file whose root element is <mujoco>")
    position = parent.index(element)
    for child in reversed(list(root)):
        parent.insert(position, child)
    parent.remove(element)


def _take(whole: Merged, root: etree._Element, file: Path) -> None:
    """Note the places of one file, and refuse what it must not have."""
    for element in root.iter(etree.Element):
        tag, line = tag_of(element), line_of(element)
        if name_of(element):
            whole.places.setdefault((tag, name_of(element)), (file, line))
        place = {"path": file, "line": line, "element": f"<{shortened(tag)}>"}
        if tag in FLEXIBLE:
            raise UnsupportedJoint("its bodies deform", "leave it out; bodies here are rigid", **place)  # type: ignore[arg-type]
        for name, value in ((str(key), str(value)) for key, value in element.attrib.items()):
            words = set() if name in _TEXTS else {word.lstrip("+-") for word in value.lower().split()}
            if "nan" in words:
                raise InvalidMJCF(f"attribute '{name}' is not a number", "give a finite number", **place)  # type: ignore[arg-type]
            if tag in _READ_NUMBERS and words & _INFINITE:
                raise InvalidMJCF(f"attribute '{name}' is infinite", "give a finite number", **place)  # type: ignore[arg-type]
        if tag == "replicate" and _copies(element) > MAX_COPIES:
            raise TooLarge(f"makes more than {MAX_COPIES} copies", "give a smaller robot", **place)  # type: ignore[arg-type]


def _copies(element: etree._Element) -> int:
    """Copies that a <replicate> and those around it make."""
    product = 1
    for one in (element, *element.iterancestors("replicate")):
        count = one.get("count", "1").strip()
        product *= int(count) if count.isascii() and count.isdigit() and len(count) < 9 else MAX_COPIES + 1
    return product


def _tagged(root: etree._Element, tag: str) -> Iterator[etree._Element]:
    return (element for element in root.iter(etree.Element) if tag_of(element) == tag)
