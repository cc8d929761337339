"""What notebooks show of results: the beginning of the page that the command of the result writes."""

from crosscheck.notebook.results import html

__all__ = ["html"]
