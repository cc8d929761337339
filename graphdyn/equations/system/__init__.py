"""The constrained system, Eq. (111): its blocks A and B, φ_q and ζ, its solution, and its Cardano form."""
