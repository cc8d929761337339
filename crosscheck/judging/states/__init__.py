"""The states of a judgment and the experiments made at them."""
