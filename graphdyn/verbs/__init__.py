"""The public functions of the dynamics, the table that says how each is computed, and what they answer."""
