"""Which columns of a file are which channels of which joints, by name or by a TOML file, and in which units."""
