"""Pictures as SVG elements of a page: text stays text, and the same drawing gives the same characters."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Callable, Mapping, MutableMapping
from typing import TYPE_CHECKING, cast

from lxml import etree
from markupsafe import Markup

from crosscheck.report.plain_text import printable

if TYPE_CHECKING:
    from matplotlib.axes import Axes
INK, SOFT_COLOR, MIDDLE_COLOR = "#222222", "#39424e", "#8a8f96"
FAINT_COLOR, GROUND, BAR = "#d9d9d9", "#eef0f2", "#7d96ad"
CURVES = ("#14507f", "#a3161a", "#2f7d32", "#7a5200", "#5b2a86", "#00707a", "#b0487a", "#8b9096")
"""Colors of the curves of a plot and of other marks, in order."""

VARIABLES = {
    INK: "--ink",
    FAINT_COLOR: "--faint",
    MIDDLE_COLOR: "--middle",
    BAR: "--bar",
    SOFT_COLOR: "--soft",
    GROUND: "--ground",
    "#000000": "--ink",
    "#ffffff": "--paper",
    **{color: f"--c{k}" for k, color in enumerate(CURVES)},
}
"""Variables of page/style.css, so that pictures on a page follow dark mode."""

_SVG = "{http://www.w3.org/2000/svg}"
_XLINK = "{http://www.w3.org/1999/xlink}"
_COLOR = re.compile(r"#[0-9a-f]{6}\b")
_FAMILY = re.compile(r"font-family: [^;]*;? ?")
_COORDINATE = re.compile(r"\d+\.\d{3,}")
_COORDINATES = {"d", "x", "y", "width", "height", "viewBox"}
_NO_TURN = re.compile(r"rotate\(-?0 [^)]*\)")
_UNWANTED = (f"{_SVG}metadata", f"{_SVG}style")
"""Dates and addresses; a style sheet that would apply to the whole page."""


def picture(
    key: str,
    label: str,
    size: tuple[float, float],
    draw: Callable[[Axes], None],
    hovers: Mapping[str, str] | None = None,
) -> Markup:
    """What draw puts on empty axes that fill the picture, as an <svg> that scales with its container.

    key: a prefix that keeps its ids apart from those of other pictures; label: what a screen reader says
    size: width, height; text has its natural size at this width                 [inches]
    hovers: what links of the picture say where a pointer rests on them, by their address, such as "#run-1"
    """
    import matplotlib  # a third of a second that only pages need
    from matplotlib.figure import Figure

    written = io.BytesIO()
    with matplotlib.rc_context(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", message="Glyph .* missing")  # the page has fonts of its own
        matplotlib.rcdefaults()  # whatever the user has set: the same page everywhere
        matplotlib.rcParams["svg.fonttype"] = "none"
        matplotlib.rcParams["svg.hashsalt"] = "graphdyn"
        matplotlib.rcParams["text.parse_math"] = False
        figure = Figure(figsize=size)
        draw(figure.add_axes((0, 0, 1, 1)))
        figure.savefig(written, format="svg", transparent=True, metadata={"Date": None})
    root = etree.fromstring(printable(written.getvalue().decode(), keep="\n\t").encode())
    etree.strip_tags(root, etree.Comment)
    for element in list(root.iter(*_UNWANTED)):
        parent = element.getparent()
        assert parent is not None
        parent.remove(element)
    _separate_ids(root, key)
    _say(root, hovers or {})
    for name in ("width", "height", "version"):
        root.attrib.pop(name)
    _follow_the_page(root)
    _shorten(root)
    root.attrib.update({"class": "picture", "role": "img", "aria-label": printable(label)})
    etree.cleanup_namespaces(root)
    return Markup(etree.tostring(root, encoding="unicode", with_tail=False))


def _say(root: etree._Element, hovers: Mapping[str, str]) -> None:
    for link in root.iter(f"{_SVG}a"):
        if said := hovers.get(link.get("href", "")):
            etree.SubElement(link, f"{_SVG}title").text = printable(said)


def _follow_the_page(root: etree._Element) -> None:
    """Colors that are known to the style sheet become its variables; text has the font of the page, and its ink."""

    def variable(found: re.Match[str]) -> str:
        color = found.group()
        return f"var({VARIABLES[color]}, {color})" if color in VARIABLES else color

    for element in root.iter():
        attributes = cast("MutableMapping[str, str]", element.attrib)
        if "style" in attributes:
            attributes["style"] = _FAMILY.sub("", _COLOR.sub(variable, attributes["style"]))
        if element.tag == f"{_SVG}text" and "fill" not in attributes.get("style", ""):
            attributes["style"] = f"fill: {variable(_COLOR.match(INK))}; {attributes.get('style', '')}"  # type: ignore[arg-type]


def _shorten(root: etree._Element) -> None:
    """Coordinates to a hundredth of a point, no white space between elements, no turns by nothing."""
    for element in root.iter():
        if element.text is not None and not element.text.strip():
            element.text = None
        element.tail = None
        attributes = cast("MutableMapping[str, str]", element.attrib)
        for name in _COORDINATES & set(attributes):
            short = _COORDINATE.sub(lambda found: f"{float(found.group()):.2f}", attributes[name])
            attributes[name] = " ".join(short.split())
        if _NO_TURN.fullmatch(attributes.get("transform", "")):
            del attributes["transform"]


def _separate_ids(root: etree._Element, key: str) -> None:
    """Drop the ids that nothing refers to; the others, and the references, get a prefix.

    A link to what is not in the picture is one to the page.
    """
    text = etree.tostring(root, encoding="unicode")
    own_ids = {element.get("id") for element in root.iter()}
    used = set(re.findall(r"""(?:url\(#|href="#)([^)"]+)""", text))
    for element in root.iter():
        attributes = cast("MutableMapping[str, str]", element.attrib)
        own = attributes.pop("id", None)
        if own in used:
            attributes["id"] = f"{key}-{own}"
        target = attributes.pop(f"{_XLINK}href", None)
        if target is not None:
            attributes.pop("target", None)  # a page of its own
            name = target.removeprefix("#")
            attributes["href"] = f"#{key}-{name}" if name in own_ids else target
        for name, value in attributes.items():
            attributes[name] = value.replace("url(#", f"url(#{key}-")
