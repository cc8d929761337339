"""The fast forms: recursions over the bodies, written once on scalars, and the table of them."""
