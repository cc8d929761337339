"""Mapping of the columns of a file to channels of joints and units, by name or by a TOML file."""
