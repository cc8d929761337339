"""The command `graphdyn paper`."""
