"""`graphdyn crosscheck --exact`: how far graphdyn and Pinocchio are from exact values."""
