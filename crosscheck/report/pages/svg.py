"""Pictures as SVG elements of a page: text stays text, and the same drawing gives the same characters."""

from __future__ import annotations

import io
import re
from collections.abc import Callable, MutableMapping
from typing import TYPE_CHECKING, cast

from lxml import etree
from markupsafe import Markup

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_SVG = "{http://www.w3.org/2000/svg}"
_XLINK = "{http://www.w3.org/1999/xlink}"
_UNWANTED = (f"{_SVG}metadata", f"{_SVG}style")
"""Dates and addresses; a style sheet that would apply to the whole page (templates/style.css has its one rule)."""


def picture(key: str, label: str, size: tuple[float, float], draw: Callable[[Axes], None]) -> Markup:
    """What draw puts on empty axes that fill the picture, as an <svg> that scales with its container.

    key: a prefix that keeps its ids apart from those of other pictures; label: what a screen reader says
    size: width, height; text has its natural size at this width                 [inches]
    """
    import matplotlib  # a third of a second that only pages need
    from matplotlib.figure import Figure

    written = io.BytesIO()
    with matplotlib.rc_context():
        matplotlib.rcdefaults()  # whatever the user has set: the same page everywhere
        matplotlib.rcParams["svg.fonttype"] = "none"
        matplotlib.rcParams["svg.hashsalt"] = "graphdyn"
        matplotlib.rcParams["text.parse_math"] = False
        figure = Figure(figsize=size)
        draw(figure.add_axes((0, 0, 1, 1)))
        figure.savefig(written, format="svg", transparent=True, metadata={"Date": None})
    root = etree.fromstring(written.getvalue())
    etree.strip_tags(root, etree.Comment)
    for element in list(root.iter(*_UNWANTED)):
        parent = element.getparent()
        assert parent is not None
        parent.remove(element)
    _separate_ids(root, key)
    for name in ("width", "height", "version"):
        root.attrib.pop(name)
    root.attrib.update({"class": "picture", "role": "img", "aria-label": label})
    etree.cleanup_namespaces(root)
    return Markup(etree.tostring(root, encoding="unicode", with_tail=False))


def _separate_ids(root: etree._Element, key: str) -> None:
    """Drop the ids that nothing refers to; the others, and the references, get a prefix."""
    text = etree.tostring(root, encoding="unicode")
    used = set(re.findall(r"""(?:url\(#|href="#)([^)"]+)""", text))
    for element in root.iter():
        attributes = cast("MutableMapping[str, str]", element.attrib)
        own = attributes.pop("id", None)
        if own in used:
            attributes["id"] = f"{key}-{own}"
        target = attributes.pop(f"{_XLINK}href", None)
        if target is not None:
            attributes["href"] = f"#{key}-{target.removeprefix('#')}"
        for name, value in attributes.items():
            attributes[name] = value.replace("url(#", f"url(#{key}-")
