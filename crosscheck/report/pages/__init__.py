"""Comparisons and judgements as pages: one file each, readable without network, script or colour."""

from crosscheck.report.pages.comparisons import comparison_page
from crosscheck.report.pages.judgements import judgement_page
from crosscheck.report.pages.rendering import write_page

__all__ = ["comparison_page", "judgement_page", "write_page"]
