"""Names in the guide lead to the reference; .ci/run has Sphinx for this."""

from types import SimpleNamespace

import pytest

pytest.importorskip("sphinx", reason="the extra graphdyn[docs] is not installed")

import guides
from docutils import nodes
from docutils.utils import new_document
from sphinx.addnodes import pending_xref


@pytest.mark.parametrize(
    ("code", "target"),
    [
        ("inverse_dynamics(model, q, v, a)", "graphdyn.inverse_dynamics"),
        ("graphdyn.kr500()", "graphdyn.kr500"),
        ("InvalidInput", "graphdyn.InvalidInput"),
        ("crosscheck.judge", "crosscheck.judge"),
        ("judge", None),  # the command
        ("q", None),
        ("graphdyn judge arm.urdf", None),
    ],
)
def test_names_in_a_guide_lead_to_their_page(code, target):
    document = new_document("guide")
    document += nodes.paragraph("", "", nodes.literal("", code))
    guides.link_names(SimpleNamespace(env=SimpleNamespace(docname="dynamics")), document)
    links = [link["reftarget"] for link in document.findall(pending_xref)]
    assert links == ([] if target is None else [target])
    assert document.astext() == code


def test_the_reference_links_itself():
    document = new_document("page")
    document += nodes.literal("", "InvalidInput")
    guides.link_names(SimpleNamespace(env=SimpleNamespace(docname="reference/graphdyn/compile")), document)
    assert list(document.findall(pending_xref)) == []
