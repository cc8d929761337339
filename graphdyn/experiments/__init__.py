"""Virtual experiments: prescribed motions, what instruments would record of them, and the paper's robot."""
