"""Links from the guide to the reference: names in the text of a guide lead to their page."""

from __future__ import annotations

import re

from docutils import nodes
from mentions import targets
from sphinx.addnodes import pending_xref
from sphinx.application import Sphinx

CALL = re.compile(r"([\w.]+)(?:\(.*\))?", re.DOTALL)
"""Code that is a name, or a call of it."""


def link_names(app: Sphinx, doctree: nodes.document) -> None:
    """Turn inline code that is a public name, or a call of one, into a link to the reference."""
    if app.env.docname.startswith("reference/"):
        return
    for literal in list(doctree.findall(nodes.literal)):
        call = CALL.fullmatch(literal.astext())
        target = None if call is None else targets().get(call[1])
        if target is None or isinstance(literal.parent, nodes.reference | pending_xref | nodes.title):
            continue
        link = pending_xref(
            "", refdomain="py", reftype="obj", reftarget=target, refexplicit=True, refdoc=app.env.docname
        )
        literal.replace_self(link)
        link += literal


def setup(app: Sphinx) -> dict[str, bool]:
    app.connect("doctree-read", link_names)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
