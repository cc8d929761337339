"""How fast graphdyn is beside other libraries, measured side by side in one run."""
