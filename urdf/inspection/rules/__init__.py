"""The rules of the inspection, one file for each part of the document."""
