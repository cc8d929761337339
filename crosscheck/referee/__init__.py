"""The same robot in Pinocchio and in MuJoCo, what is compared, on which states, scales and bounds. Not public."""
