"""The compared quantities: how they are computed, their scales, tolerances and states."""
