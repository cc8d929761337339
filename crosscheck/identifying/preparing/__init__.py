"""From a recording to equations: filters, which rows are fitted, and which are predicted."""
