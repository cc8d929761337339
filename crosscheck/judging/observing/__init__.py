"""The function under test: calls, checks, conventions, and what is observed of it."""
