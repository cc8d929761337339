"""Pages that are not yet made of a report: one file each, readable without network, script or colour."""

from crosscheck.report.pages.rendering import write_page as write_page
