"""The reference implementations: the same robot in Pinocchio and in MuJoCo."""
