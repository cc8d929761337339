"""Comparisons and judgements as pages: one file each, readable without network, script or colour."""

from crosscheck.page.comparisons import comparison_page
from crosscheck.page.judgements import judgement_page
from crosscheck.page.rendering import write_page

__all__ = ["comparison_page", "judgement_page", "write_page"]
