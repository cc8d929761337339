"""How many examples hypothesis draws for a test that needs more or fewer than the others."""

from hypothesis import settings


def examples(count: int) -> settings:
    """So many of the fixed examples; under HYPOTHESIS_PROFILE=nightly as many random ones as of every other test."""
    return settings(max_examples=count) if settings.default.derandomize else settings()
