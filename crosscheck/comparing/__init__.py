"""The cross-check of one robot: graphdyn beside Pinocchio, quantity by quantity."""
