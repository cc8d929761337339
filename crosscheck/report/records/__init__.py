"""The records that the program writes as JSON, with descriptions and units of the fields: a file per format, and beside
it one for each part of a long format.

The published schemas (docs/schemas) are generated from these classes: python -m crosscheck.report.json docs/schemas.
"""
