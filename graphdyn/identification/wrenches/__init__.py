"""Inertial parameters of each body from measured joint wrenches: the paper's section 2.3, generalized."""
