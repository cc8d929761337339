"""The configuration of a study: TOML tables, scenarios, robots, methods."""
