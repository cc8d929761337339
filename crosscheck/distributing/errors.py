"""What can be wrong with the workers themselves, whatever the tasks."""

from graphdyn import GraphDynError


class NoWorkers(GraphDynError):
    """A scheduler or workers that cannot be used; the message says why and what to do."""
