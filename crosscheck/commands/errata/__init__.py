"""The command `graphdyn errata`."""
