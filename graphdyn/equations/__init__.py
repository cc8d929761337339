"""The specification: the dynamics as the paper's equations read, one state or many, without a fast path."""
