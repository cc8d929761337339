"""The records that the program writes as JSON: one file per format, the fields with their descriptions and units.

The published schemas (docs/schemas) are generated from these classes: python -m crosscheck.report.json docs/schemas.
"""
