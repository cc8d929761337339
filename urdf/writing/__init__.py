"""From the model to URDF, and new inertial parameters into an existing file."""
