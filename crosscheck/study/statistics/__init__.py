"""Statistics of a study: intervals, ranks and tests."""
