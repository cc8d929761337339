"""Choice of the terms of the drives by held-out error, and what the residuals still hold."""
