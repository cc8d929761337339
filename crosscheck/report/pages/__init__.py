"""Comparisons and judgements as pages: one file each, readable without network, script or colour."""

from crosscheck.report.pages.judgements import judgement_page as judgement_page
from crosscheck.report.pages.rendering import write_page as write_page
