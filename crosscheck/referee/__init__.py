"""The cross-check: the robot in Pinocchio and in MuJoCo; quantities, states, scales and bounds. Not public."""
